//! Tests that a plain `cargo test` leaves out, as they need features that are off by default, or packages of
//! their own. They show as ignored, each with the command that runs them.

/// A name that shows as ignored while a feature is off.
macro_rules! left_out {
    ($($name:ident without $feature:literal: $command:literal),* $(,)?) => {
        $(#[cfg(not(feature = $feature))]
        #[test]
        #[ignore = $command]
        fn $name() {
            panic!($command);
        })*
    };
}

left_out!(
    evolutions_that_are_resumed without "checkpoint": "cargo test --features checkpoint",
    recordings without "log": "cargo test --features log",
    graphs_of_petgraph without "petgraph": "cargo test --features petgraph",
    the_walking_robot without "physics": "cargo test --features physics",
    pictures_as_png without "png": "cargo test --features png",
    several_threads without "rayon": "cargo test --features rayon",
    the_client_of_robios without "robios": "cargo test --features robios",
    checks_of_planners without "testing": "cargo test --features testing",
);

#[test]
#[ignore = "cargo test --workspace --all-features"]
fn commands_programs_for_robios_and_oracles() {
    panic!("cargo test --workspace --all-features");
}
