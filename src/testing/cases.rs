use std::env;

use proptest::test_runner::{Config, RngSeed};

/// Configuration of a property test with a number of cases, which are the same in every run and on every
/// machine.
///
/// The environment variable `PROPTEST_RNG_SEED`, an integer, selects other cases. `PROPTEST_CASES` changes
/// their number: it is the number for a property of 256, and scales all others in proportion. A failing case
/// is printed and not written to a file.
///
/// # Panics
///
/// If `PROPTEST_RNG_SEED` is not an integer, because its cases could not be reproduced.
///
/// ```
/// use proptest::prelude::*;
///
/// proptest! {
///     #![proptest_config(roverlab::testing::cases(48))]
///     # /*
///     #[test]
///     # */
///     fn a_sum_does_not_depend_on_the_order(a in 0..100, b in 0..100) {
///         prop_assert_eq!(a + b, b + a);
///     }
/// }
/// # a_sum_does_not_depend_on_the_order();
/// ```
pub fn cases(cases: u32) -> Config {
    let seed = env::var_os("PROPTEST_RNG_SEED").map_or(1, |seed| {
        let number = seed.to_str().and_then(|seed| seed.parse().ok());
        number.unwrap_or_else(|| panic!("PROPTEST_RNG_SEED is {}; expected a whole number", seed.display()))
    });
    let usual = Config::default();
    let wanted = u64::from(cases) * u64::from(usual.cases) / u64::from(USUAL_CASES);
    let cases = u32::try_from(wanted.max(1)).unwrap_or(u32::MAX);
    Config {
        cases,
        rng_seed: RngSeed::Fixed(seed),
        // Scale the limit on rejected cases.
        max_global_rejects: usual.max_global_rejects.max(cases.saturating_mul(4)),
        failure_persistence: None,
        ..usual
    }
}

/// Default number of cases of `proptest`.
const USUAL_CASES: u32 = 256;
