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
    training_of_networks without "learn": "cargo test --features learn",
    recordings_packed_by_lz4 without "lz4": "cargo test --features lz4",
    shapes_of_parry2d without "parry2d": "cargo test --features parry2d",
    graphs_of_petgraph without "petgraph": "cargo test --features petgraph",
    the_walking_robot without "physics": "cargo test --features physics",
    pictures_as_png without "png": "cargo test --features png",
    several_threads without "rayon": "cargo test --features rayon",
    the_client_of_robios without "robios": "cargo test --features robios",
    checks_of_planners without "testing": "cargo test --features testing",
    what_has_been_learned without "weights": "cargo test --features weights",
    recordings_packed_by_zstandard without "zstd": "cargo test --features zstd",
);

/// Each feature that is off by default is told here, in the library's documentation and in the README.
#[test]
fn every_feature_that_is_off_is_told() {
    let manifest = include_str!("../Cargo.toml");
    let features = manifest.split_once("\n[features]\n").expect("the features").1;
    let features = features.split_once("\n[").expect("the dependencies").0;
    let lines = || features.lines().filter_map(|line| line.split_once(" = "));
    let (_, on) = lines().find(|&(name, _)| name == "default").expect("a default");
    let is_on = |name: &str| name == "default" || on.contains(&format!("\"{name}\""));
    // `image` comes with wings that are on.
    let off: Vec<&str> =
        lines().map(|(name, _)| name).filter(|&name| !is_on(name) && name != "image").collect();
    assert!(off.len() > 10, "{off:?}");
    for name in off {
        let quoted = format!("`{name}`");
        assert!(include_str!("left_out.rs").contains(&format!("\"cargo test --features {name}\"")), "{name}");
        assert!(include_str!("../src/lib.rs").contains(&quoted), "src/lib.rs: {name}");
        assert!(include_str!("../README.md").contains(&quoted), "README.md: {name}");
    }
}

#[test]
#[ignore = "cargo test --workspace --all-features"]
fn commands_programs_for_robios_and_oracles() {
    panic!("cargo test --workspace --all-features");
}
