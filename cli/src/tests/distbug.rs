//! The command `distbug` as a whole: worlds from files, options, faults, verdicts, pictures and exit
//! statuses.

use std::fs;
use std::path::PathBuf;

use super::support::{DATA, number, said, temporary};
use crate::{common, distbug};
use roverlab::world::formats::robi;
use roverlab::world::{DriveSpec, LidarSpec, RobotSpec};
use serde_json::{Value, json};

/// Result of the command.
struct Ended {
    status: u8,
    out: String,
    err: String,
}

impl Ended {
    /// The one JSON object on standard output.
    fn json(&self) -> Value {
        assert_eq!(self.out.lines().count(), 1, "{}{}", self.out, self.err);
        serde_json::from_str(&self.out).unwrap()
    }
}

/// Runs the command with `--json` and options.
fn run(options: &[&str]) -> Ended {
    let (status, out, err) = said("distbug", &[&["--json"], options].concat());
    Ended { status, out, err }
}

fn data(name: &str) -> String {
    format!("{DATA}/{name}")
}

/// A fresh folder for one test.
fn folder(name: &str) -> PathBuf {
    let folder = temporary("distbug").join(name);
    if folder.exists() {
        fs::remove_dir_all(&folder).unwrap();
    }
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn count(report: &Value, name: &str) -> usize {
    report[name].as_array().unwrap_or_else(|| panic!("{name} in {report}")).len()
}

/// A run that reached the goal, without contact and to within a tolerance.
fn assert_arrived(ended: &Ended, tolerance: f64) -> Value {
    let report = ended.json();
    assert_eq!((ended.status, ended.err.as_str()), (0, ""), "{report}");
    assert_eq!(
        (report["outcome"].as_str(), number(&report, "collisions")),
        (Some("reached"), 0.0),
        "{report}"
    );
    assert!(number(&report, "goal_distance_mm") <= tolerance, "{report}");
    assert_eq!(count(&report, "hit_points"), count(&report, "leave_points"), "{report}");
    report
}

/// A refusal: status 2, nothing on standard output, and one line that contains all of `parts`.
fn assert_refused(options: &[&str], parts: &[&str]) {
    let ended = run(options);
    assert_eq!((ended.status, ended.out.as_str()), (2, ""), "{options:?}: {}", ended.err);
    assert_eq!(ended.err.lines().count(), 1, "{}", ended.err);
    for part in parts {
        assert!(ended.err.contains(part), "{options:?}: `{part}` is missing in: {}", ended.err);
    }
}

#[test]
fn the_commands_own_world_is_crossed_untouched() {
    let report = assert_arrived(&run(&[]), 250.0);
    assert!(count(&report, "hit_points") >= 3, "{report}");
    // Longer than the straight line from (500, 500) to (3850, 3850), because of detours around three hollows.
    assert!(number(&report, "path_length_mm") > 6000.0, "{report}");
    assert_eq!(report["picture"], Value::Null);
}

#[test]
fn a_world_file_gives_walls_and_start() {
    let field = data("field.wld");
    let report = assert_arrived(&run(&["--world", &field, "--goal", "3600,3500", "--noise", "0"]), 50.0);
    assert_eq!(report["goal"], json!([3600.0, 3500.0]));
    assert!(count(&report, "hit_points") >= 1, "{report}");
}

#[test]
fn a_script_gives_robots_and_goal() {
    let report = assert_arrived(&run(&["--world", &data("field.sim"), "--noise", "1"]), 250.0);
    assert_eq!(report["goal"], json!([3600.0, 3500.0]));
}

#[test]
fn a_marker_where_the_robot_starts_is_not_the_goal() {
    let folder = folder("markers");
    fs::write(folder.join("floor.wld"), "floor 2000 2000\n").unwrap();
    let markers = ["marker 500 500 0 255 0", "marker 1500 1500 255 0 0"];
    for order in [[0, 1], [1, 0]] {
        let markers = order.map(|index| markers[index]).join("\n");
        let script = folder.join("course.sim");
        fs::write(&script, format!("world floor.wld\n{markers}\nS4 500 500 0\n")).unwrap();
        let report = assert_arrived(&run(&["--world", script.to_str().unwrap(), "--noise", "0"]), 50.0);
        assert_eq!(report["goal"], json!([1500.0, 1500.0]));
    }
}

#[test]
fn a_maze_gives_start_and_goal_by_letters() {
    let report = assert_arrived(&run(&["--world", &data("maze.maz"), "--noise", "0"]), 50.0);
    assert_eq!(report["goal"], json!([1620.0, 900.0]));
}

#[test]
fn options_come_before_files() {
    let report = assert_arrived(
        &run(&[
            "--world",
            &data("field.sim"),
            "--start",
            "3600,400,90",
            "--goal",
            "3600,600",
            "--noise",
            "0",
        ]),
        50.0,
    );
    assert_eq!((report["goal"].clone(), count(&report, "hit_points")), (json!([3600.0, 600.0]), 0));
    assert!(number(&report, "path_length_mm") < 250.0, "{report}");
}

#[test]
fn another_robot_drives_by_its_own_size() {
    let file = folder("robot").join("big.robi");
    fs::write(&file, robi::print(&RobotSpec::labbot())).unwrap();
    let (file, field) = (file.to_str().unwrap(), data("field.wld"));
    assert_arrived(&run(&["--world", &field, "--robot", file, "--goal", "3600,3500", "--noise", "0"]), 50.0);
}

#[test]
fn a_goal_within_an_obstacle_is_unreachable() {
    let ended = run(&["--world", &data("field.wld"), "--goal", "1300,1150", "--noise", "0"]);
    let report = ended.json();
    assert_eq!((ended.status, report["outcome"].as_str()), (0, Some("unreachable")), "{report}");
    assert_eq!(number(&report, "collisions"), 0.0, "{report}");
    assert_eq!(count(&report, "hit_points"), count(&report, "leave_points") + 1, "{report}");
}

#[test]
fn the_same_options_give_the_same_report() {
    let once = || run(&["--world", &data("field.wld"), "--goal", "1000,2600", "--seed", "7"]).json();
    let first = once();
    assert_eq!(first, once());
    let other = run(&["--world", &data("field.wld"), "--goal", "1000,2600", "--seed", "8"]).json();
    assert_ne!(first["odometry"], other["odometry"]);
}

#[test]
fn a_run_ends_with_its_time() {
    let ended = run(&["--time-limit", "1.5"]);
    let report = ended.json();
    assert_eq!((ended.status, report["outcome"].as_str()), (1, Some("timed_out")), "{report}");
    assert!((1.4..=1.7).contains(&number(&report, "sim_time_s")), "{report}");
}

#[test]
fn a_blind_robot_collides_and_goes_on() {
    let ended = run(&["--fault", "stuck:lidar@2", "--time-limit", "15", "--noise", "0"]);
    let report = ended.json();
    assert_eq!((ended.status, report["outcome"].as_str()), (1, Some("collided")), "{report}");
    assert_eq!(number(&report, "collisions") as usize, count(&report, "contact_points"), "{report}");
    assert!(number(&report, "sim_time_s") > 10.0, "{report}");
}

#[test]
fn a_robot_that_fails_ends_the_run_with_its_error() {
    for (fault, error) in
        [("link@2", "link"), ("lost:lidar@1.5", "lidar is gone"), ("nan:odometry@1", "observed pose")]
    {
        let ended = run(&["--fault", fault]);
        let report = ended.json();
        assert_eq!((ended.status, report["outcome"].as_str()), (1, Some("failed")), "{fault}: {report}");
        let said = report["error"].as_str().unwrap();
        assert!(said.contains(error), "{fault}: {said}");
        assert_eq!(ended.err, format!("{said}\n"));
        assert!((0.9..3.0).contains(&number(&report, "sim_time_s")), "{fault}: {report}");
    }
}

#[test]
fn a_stopped_clock_does_not_make_the_run_endless() {
    let ended = run(&["--fault", "clock@1", "--time-limit", "20"]);
    assert_eq!(ended.status, 1, "{}", ended.out);
    assert!(number(&ended.json(), "sim_time_s") <= 22.0, "{}", ended.out);
}

#[test]
fn places_that_make_no_sense_are_refused() {
    let field = data("field.wld");
    let at = |start| ["--world", field.as_str(), "--goal", "3600,3500", "--start", start];
    assert_refused(
        &at("1720,1150,0"),
        &["--start: found a start at 1720, 1150 mm", "in a wall", "60 mm radius"],
    );
    assert_refused(&at("30,2000,0"), &["in a wall"]);
    // The robot is round with a radius of 60 mm: less than a millimetre from the wall counts as contact.
    assert_refused(&at("60.8,2000,0"), &["in a wall"]);
    assert_refused(&at("-500,2000,0"), &["outside of the world", "from 0, 0 to 4000, 4000 mm"]);
    assert_refused(&["--world", &data("field.sim"), "--start", "2300,2250,0"], &["another robot"]);
    assert_refused(&["--goal", "nan,0"], &["--goal", "two finite numbers"]);
    assert_refused(&["--goal", "1e300,0"], &["--goal", "at most 1000000000 mm"]);
    assert_refused(&["--start", "1150,3950,0"], &["an object"]);
}

#[test]
fn what_is_missing_is_named() {
    assert_refused(&["--world", &data("field.wld")], &["field.wld: found no goal; expected --goal X,Y"]);
    let empty = folder("missing").join("empty.wld");
    fs::write(&empty, "floor 1000 1000\n").unwrap();
    let empty = empty.to_str().unwrap();
    assert_refused(
        &["--world", empty, "--goal", "1,1"],
        &["empty.wld: found no start; expected --start X,Y,DEG"],
    );
    assert_refused(&["--world", "no/such.sim"], &["no/such.sim:1:1: found"]);
    assert_refused(&["--world", "Cargo.toml"], &["Cargo.toml", ".sim, .wld, .maz"]);
    assert_refused(&["--robot", "no/such.robi"], &["no/such.robi:1:1: found"]);
    assert_refused(&["--picture", "no/such/folder/run.svg"], &["found no folder no/such/folder"]);
}

#[test]
fn errors_in_files_have_their_place() {
    let file = folder("broken").join("broken.sim");
    fs::write(&file, "world field.wld\nS4 400 oops 0\n").unwrap();
    fs::copy(data("field.wld"), file.with_file_name("field.wld")).unwrap();
    assert_refused(&["--world", file.to_str().unwrap()], &["broken.sim:2:", "found", "expected"]);
}

#[test]
fn robots_that_cannot_do_it_are_refused() {
    let folder = folder("robots");
    let refused = |name: &str, spec: RobotSpec, parts: &[&str]| {
        let file = folder.join(name);
        fs::write(&file, robi::print(&spec)).unwrap();
        assert_refused(&["--robot", file.to_str().unwrap()], parts);
    };
    let s4 = RobotSpec::s4();
    refused("blind.robi", RobotSpec { lidar: None, ..s4.clone() }, &["blind.robi", "without a lidar"]);
    let car = DriveSpec::Ackermann {
        dynamics: None,
        wheel_diameter: 0.05,
        track: 0.1,
        wheelbase: 0.1,
        max_steering: 0.5,
        max_wheel_speed: 20.0,
        ticks_per_turn: 1000.0,
    };
    refused(
        "car.robi",
        RobotSpec { drive: car, ..s4.clone() },
        &["car.robi: found", "a car", "expected one that turns on the spot"],
    );

    // No file can specify this, but a scene can: a lidar that only looks ahead.
    let lidar = LidarSpec { field_of_view: 3.0, ..LidarSpec::default() };
    let mut scene = distbug::scene();
    scene.robots[0].spec = RobotSpec { lidar: Some(lidar), ..s4 }.into();
    let trip = common::Trip { goal: scene.world.markers[0].position, scene };
    let options = distbug::Options { seed: 1, noise: 0.0, time_limit: 5.0 };
    let stage = common::Stage::simulated(&trip.scene, distbug::sim_options(&options), Vec::new()).unwrap();
    let drive = distbug::drive(&trip, &options, &stage, |_, _| {}).unwrap();
    assert!(matches!(&drive.ending, Err(error) if error.contains("full turn")), "{:?}", drive.ending);
}

#[test]
fn wrong_faults_are_refused() {
    assert_refused(&["--fault", "stuk@3"], &["--fault", "unknown kind", "expected stuck"]);
    assert_refused(&["--fault", "stuck"], &["--fault", "no time"]);
}

#[test]
fn the_picture_shows_the_run() {
    let file = folder("picture").join("run.svg");
    let (name, field) = (file.to_str().unwrap(), data("field.wld"));
    let report = run(&["--world", &field, "--goal", "3600,3500", "--picture", name]).json();
    assert_eq!(report["picture"].as_str(), Some(name));
    let svg = fs::read_to_string(&file).unwrap();
    for part in
        ["DistBug: goal reached", "true path", "odometry", "hit point", "leave point", "\nH1\n", "lidar hits"]
    {
        assert!(svg.contains(part), "{part} is missing");
    }
    assert!(!svg.contains("contact"));
}

#[test]
fn what_happens_is_told_in_order() {
    let scene = distbug::scene();
    let trip = common::Trip { goal: scene.world.markers[0].position, scene };
    let options = distbug::Options { seed: 1, noise: 1.0, time_limit: 600.0 };
    let stage = common::Stage::simulated(&trip.scene, distbug::sim_options(&options), Vec::new()).unwrap();
    let mut told = Vec::new();
    let mut clock = 0.0;
    let drive = distbug::drive(&trip, &options, &stage, |time, news| {
        assert!(time >= clock);
        clock = time;
        told.extend(news.iter().cloned());
    })
    .unwrap();
    assert_eq!(told, drive.events);
    let is_hit = |event: &distbug::Event| matches!(event.happening, distbug::Happening::Hit { .. });
    assert!(told.iter().enumerate().all(|(i, event)| is_hit(event) == (i % 2 == 0)), "{told:?}");
    // The robot knows its pose: the points lie on its true path, to within its error.
    for point in drive.hit_points().iter().chain(&drive.leave_points()) {
        assert!(drive.trail.iter().any(|(_, pose)| pose.distance_to(*point) < 0.1), "{point}");
    }
}
