use std::env;

use proptest::test_runner::{Config, RngSeed};

/// The configuration of a property test that draws so many cases, the same ones in every run and on every machine.
///
/// The environment variable `PROPTEST_RNG_SEED`, a whole number, draws other cases. `PROPTEST_CASES` draws more of them: it is
/// the number for a property of 256, and changes that of every other one in proportion. A failing case is printed, and written to
/// no file.
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
    let mut config = Config { failure_persistence: None, ..Config::default() };
    if env::var_os("PROPTEST_RNG_SEED").is_none() {
        config.rng_seed = RngSeed::Fixed(1);
    }
    let wanted = u64::from(cases) * u64::from(config.cases) / u64::from(USUAL_CASES);
    config.cases = u32::try_from(wanted.max(1)).unwrap_or(u32::MAX);
    config
}

/// The number of cases that `proptest` draws unless it is told otherwise.
const USUAL_CASES: u32 = 256;
