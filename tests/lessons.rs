//! Every example runs to its end: it asserts its own result.
//!
//! Cargo builds the examples before it runs all tests. For some of these alone: `cargo test --examples --test
//! lessons`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Runs an example in a folder of its own. Returns the folder of its pictures.
fn run(name: &str) -> PathBuf {
    let test = std::env::current_exe().unwrap();
    let program = test.ancestors().nth(2).unwrap().join("examples").join(name);
    let program = program.with_extension(std::env::consts::EXE_EXTENSION);
    assert!(program.is_file(), "{} is missing: cargo test --examples --test lessons", program.display());
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("lessons").join(name);
    fs::create_dir_all(&folder).unwrap();
    let output = Command::new(program).current_dir(&folder).output().unwrap();
    let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    assert!(output.status.success() && err.is_empty() && !out.is_empty(), "{name}: {out}{err}");
    folder.join("target/pictures")
}

/// A test for each example, and their names.
macro_rules! lessons {
    ($($(#[$attribute:meta])* $name:ident),* $(,)?) => {
        const LESSONS: &[&str] = &[$(stringify!($name)),*];
        $($(#[$attribute])*
        #[test]
        fn $name() {
            run(stringify!($name));
        })*
    };
}

lessons!(
    a_to_b,
    ackermann,
    base_station,
    boat,
    bug_compare,
    camera,
    color_tracking,
    cone_drive,
    cone_race,
    coverage,
    d_star_lite,
    distbug,
    dive,
    edges,
    #[cfg(feature = "weights")]
    end_to_end,
    first_steps,
    follow_me,
    genetic,
    grid_planning,
    lane_keeping,
    lidar_scan,
    localise,
    maze_explore,
    maze_left,
    maze_lidar,
    micromouse,
    motion,
    navigate,
    omni,
    #[cfg(feature = "testing")]
    own_planner,
    own_robot,
    parking,
    path_following,
    ping,
    pool_search,
    pool_wall,
    quadtree,
    random_drive,
    #[cfg(feature = "log")]
    record_replay,
    safety,
    signs,
    #[cfg(feature = "physics")]
    starman,
    ramp,
    summit,
    survey,
    terrain_plan,
    traffic,
    two_robots,
    wall_following,
    world_files,
);

#[test]
fn no_example_is_forgotten_and_none_is_long() {
    for entry in fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("examples")).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap();
        assert!(LESSONS.contains(&name), "{name} is missing in this test");
        let text = fs::read_to_string(&path).unwrap();
        let lines = text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with("//"));
        assert!(lines.count() <= 80, "{name} has more than 80 lines of code");
    }
}
