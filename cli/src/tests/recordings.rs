//! Recorded and replayed runs of the commands.

use std::fs;
use std::path::{Path, PathBuf};

use super::support::{DATA, Ended, run, temporary, text};
use crate::commands::COMMANDS;
use roverlab::io::log::{Header, Log, LogFile, LogWriter};
use roverlab::world::{LidarSpec, RobotSpec, formats};

fn file(name: &str) -> PathBuf {
    temporary(name)
}

/// Records a run twice and replays it: all recordings and reports are equal. Returns the recording.
fn assert_replays(name: &str, options: &[&str]) -> PathBuf {
    let words = options.concat().replace(['/', '.'], "_");
    let [first, second, third] = [1, 2, 3].map(|n| file(&format!("{name}-{words}-{n}.mcap")));
    let plain = run(name, options);
    for recording in [&first, &second] {
        let options = [options, &["--record", recording.to_str().unwrap()]].concat();
        assert_eq!(run(name, &options), plain, "recording changes the run {name} {options:?}");
    }
    assert!(
        fs::read(&first).unwrap() == fs::read(&second).unwrap(),
        "{name} {options:?} is not deterministic"
    );
    let options = ["--replay", first.to_str().unwrap(), "--record", third.to_str().unwrap()];
    assert_eq!(run(name, &options), plain, "{name} {options:?}");
    assert!(fs::read(&first).unwrap() == fs::read(&third).unwrap(), "the replay of {name} differs");
    for old in [second, third] {
        fs::remove_file(old).unwrap();
    }
    first
}

#[test]
fn runs_replay_to_the_bit() {
    for noise in ["0", "1", "2"] {
        let options = ["--noise", noise, "--seed", "5"];
        assert_replays("distbug", &options);
        for method in ["turn", "spline"] {
            assert_replays("a_to_b", &[&options[..], &["--method", method]].concat());
        }
        assert_replays("a_to_b", &[&options[..], &["--landmark"]].concat());
        assert_replays("ackermann", &options);
        assert_replays("omni", &options);
    }
}

#[test]
fn faults_and_failures_replay() {
    for fault in ["link@2", "stuck@1", "nan@1.5", "clock@2"] {
        assert_replays("a_to_b", &["--fault", fault, "--fault", "late@0.5"]);
    }
    assert_replays("distbug", &["--time-limit", "3"]);
}

#[test]
fn another_behaviour_is_found_at_the_first_call_that_differs() {
    let recording = assert_replays("a_to_b", &["--method", "spline"]);
    let name = recording.to_str().unwrap();
    let (status, report, err) = run("a_to_b", &["--replay", name, "--scale", "1.01"]);
    assert_eq!((status, report["outcome"].as_str()), (1, Some("failed")), "{report}");
    assert!(err.contains("found the call set_speed(") && err.contains("expected set_speed("), "{err}");
    let (status, _, err) = run("a_to_b", &["--campaign", "--runs", "1", "--record", name]);
    assert!(status == 2 && err.contains("found no robot that drives"), "{err}");
    let (status, _, err) = run("distbug", &["--replay", name]);
    assert!(status == 2 && err.contains("`a-to-b`") && err.contains("expected one of `distbug`"), "{err}");
}

fn manage(words: &[&str]) -> Ended {
    run("replay", words)
}

/// Options for a short run of each command.
fn short(program: &str) -> &'static [&'static str] {
    match program {
        "base_station" => &["--cars", "2"],
        "bug_compare" => &["--bugs", "bug1,tangentbug"],
        "camera" => &["--images", "3"],
        "color_tracking" => &["--job", "home"],
        "cone_drive" | "cone_race" => &["--track", "../tests/data/cones/oval.csv"],
        "edges" => &["--repeat", "3"],
        "follow_me" => &["--followers", "3", "--mode", "radio"],
        "genetic" => &["--task", "wall", "--generations", "1"],
        "end_to_end" | "lane_keeping" => &["--course", "3", "--minutes", "0.05"],
        "random_drive" => &["--robots", "3"],
        "safety" => &["--track", "../tests/data/cones/oval.csv", "--event", "radio"],
        "traffic" => &["--course", "3"],
        "starman" => &["--population", "4", "--generations", "2", "--seconds", "4"],
        _ => &[],
    }
}

/// Records a short run of a command twice with equal results, and checks a recording with `replay check`.
fn assert_checks(name: &str, options: &[&str]) {
    let words = options.concat().replace('/', "-");
    let logs = [1, 2].map(|n| file(&format!("check-{name}{words}-{n}.mcap")));
    for log in &logs {
        // The length of an evolution is given by its generations.
        let limit = if ["genetic", "starman"].contains(&name) { &[][..] } else { &["--time-limit", "4"] };
        let (_, _, err) = run(name, &[options, limit, &["--record", text(log)]].concat());
        assert!(log.is_file(), "{name}: {err}");
    }
    let same = fs::read(&logs[0]).unwrap() == fs::read(&logs[1]).unwrap();
    assert!(same, "{name} {options:?} is not deterministic");
    let (status, report, err) = manage(&["check", text(&logs[0])]);
    assert_eq!((status, report["outcome"].as_str()), (0, Some("same")), "{report} {err}");
    for log in logs {
        fs::remove_file(log).unwrap();
    }
}

#[test]
fn every_program_checks() {
    for (number, command) in COMMANDS.iter().filter(|command| command.drives()).enumerate() {
        // Starman's world has no noise.
        let option = if command.name == "starman" { "--seed" } else { "--noise" };
        let value = ["0", "1", "2"][number % 3];
        assert_checks(command.name, &[short(command.name), &[option, value]].concat());
    }
}

const TRACK: &str = "../tests/data/cones/oval.csv";

#[test]
fn other_jobs_check() {
    for (name, options) in [
        ("follow_me", &["--followers", "1"][..]),
        ("follow_me", &["--followers", "5"]),
        ("random_drive", &[]),
        ("maze_explore", &["--micromouse"]),
        ("maze_left", &["--drive", "open"]),
        ("micromouse", &["--doubled"]),
        ("omni", &["--seed", "9"]),
        ("cone_race", &["--track", TRACK, "--line", "../tests/data/cones/oval_line.csv", "--laps", "1"]),
        ("wall_following", &["--seed", "9"]),
        ("first_steps", &["--task", "circle"]),
        (
            "starman",
            &["--figure", "../cli/figures/worm.toml", "--body", "--population", "4", "--generations", "2"],
        ),
    ] {
        assert_checks(name, options);
    }
}

#[test]
fn several_runs_are_no_recording() {
    for (name, options) in [("a_to_b", ["--campaign", "--record"]), ("micromouse", ["--plan", "--record"])] {
        let (status, _, err) = run(name, &[&options[..], &["x.mcap"]].concat());
        assert!(status == 2 && err.contains("found no robot that drives"), "{err}");
    }
}

/// A maze is stored in its recording.
#[test]
fn a_recorded_maze_is_replayed() {
    let (maze, log) = (file("some.txt"), file("some-maze.mcap"));
    fs::write(&maze, "o---o---o\n|     G |\no   o---o\n| S     |\no---o---o\n").unwrap();
    let (maze_name, name) = (maze.to_str().unwrap(), log.to_str().unwrap());
    let (status, _, err) = run("micromouse", &["--maze", maze_name, "--record", name]);
    assert_eq!(status, 0, "{err}");
    fs::remove_file(&maze).unwrap();
    assert_eq!(manage(&["check", name]).0, 0);
    assert_eq!(manage(&["info", name]).1["options"], serde_json::json!(["--maze=maze.txt"]));
}

#[test]
fn a_recording_holds_its_world() {
    let folder = file("world-of-a-recording");
    fs::create_dir_all(&folder).unwrap();
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
    write(
        "yard.wld",
        "floor 3000 3000\n0 0 3000 0\n3000 0 3000 3000\n3000 3000 0 3000\n0 3000 0 0\n1500 800 1500 2000\n",
    );
    write("yard.sim", "world yard.wld\nS4 500 1500 0\nmarker 2500 1500 0 255 0\ncan 1000 2500 0\n");
    let log = file("yard.mcap");
    let (world, name) = (folder.join("yard.sim"), log.to_str().unwrap());
    let first = run("distbug", &["--world", world.to_str().unwrap(), "--record", name]);
    assert_eq!((first.0, first.1["outcome"].as_str()), (0, Some("reached")), "{}", first.1);
    fs::remove_dir_all(&folder).unwrap();
    assert_eq!(run("distbug", &["--replay", name]), first);
    assert_eq!(manage(&["check", name]).0, 0);

    let (status, info, _) = manage(&["info", name]);
    assert_eq!((status, info["program"].as_str()), (0, Some("distbug")));
    assert_eq!(info["options"], serde_json::json!(["--world=world.sim"]));
    let text = String::from_utf8_lossy(&fs::read(&log).unwrap()).into_owned();
    assert!(!text.contains("world-of-a-recording"), "the recording names a folder");
}

#[test]
fn what_is_exported_shows_the_run() {
    let log = file("exported.mcap");
    let name = log.to_str().unwrap();
    assert_eq!(run("a_to_b", &["--record", name]).0, 0);
    let (table, picture) = (file("exported.csv"), file("exported.svg"));
    let words = ["export", name, "--csv", table.to_str().unwrap(), "--picture", picture.to_str().unwrap()];
    let (status, report, err) = manage(&words);
    assert_eq!((status, err.as_str()), (0, ""), "{report}");
    let text = fs::read_to_string(table).unwrap();
    assert_eq!(text.lines().count() as u64, 1 + report["rows"].as_u64().unwrap());
    assert!(text.contains(",calls,set_speed,") && text.contains(",truth,robot,0,"), "{text}");
    let svg = fs::read_to_string(picture).unwrap();
    assert!(svg.contains("Recording of a_to_b") && svg.contains("true path") && svg.contains("odometry"));
}

#[test]
fn files_that_cannot_be_replayed_are_named() {
    let text = file("no-recording.mcap");
    fs::write(&text, "floor 3000 3000\n").unwrap();
    let name = text.to_str().unwrap();
    for words in [["check", name], ["info", name], ["check", "no/such/file"]] {
        let (status, _, err) = manage(&words);
        assert!(status == 2 && err.contains("expected") && err.lines().count() == 1, "{words:?}: {err}");
    }
    let (status, _, err) = run("a_to_b", &["--replay", name]);
    assert!(status == 2 && err.contains("found no MCAP file"), "{err}");
    let log = file("cut-off.mcap");
    let name = log.to_str().unwrap();
    run("a_to_b", &["--record", name]);
    let bytes = fs::read(&log).unwrap();
    fs::write(&log, &bytes[..bytes.len() / 2]).unwrap();
    let (status, _, err) = manage(&["check", name]);
    assert!(status == 2 && err.contains("`recover`"), "{err}");
    let out = file("saved.mcap");
    let (status, report, _) = manage(&["recover", name, out.to_str().unwrap()]);
    assert!(status == 0 && report["chunks"].as_u64() > Some(1), "{report}");
    // The recovered part replays as far as it goes.
    let (status, report, _) = manage(&["check", out.to_str().unwrap()]);
    assert_eq!((status, report["outcome"].as_str()), (1, Some("different")));
    assert!(report["difference"]["found"].as_str().unwrap().contains("the recording has ended"), "{report}");
}

#[test]
fn a_replay_meets_what_was_recorded() {
    let log = file("met.mcap");
    let name = log.to_str().unwrap();
    run("a_to_b", &["--seed", "3", "--record", name]);
    let again = |options: &[&str]| run("a_to_b", &[&["--replay", name], options].concat());
    assert_eq!(again(&["--seed=3"]).0, 0);
    assert_eq!(again(&["--seed", "03", "--noise", "1.0"]).0, 0);
    let refused =
        [(["--seed", "4"], "--seed=4"), (["--noise", "0"], "--noise=0"), (["--record", name], "--replay")];
    for (options, part) in refused {
        let (status, _, err) = again(&options);
        assert!(status == 2 && err.contains(part) && err.lines().count() == 1, "{err}");
    }
}

#[test]
fn a_recording_has_no_files_written() {
    let (log, picture) = (file("foreign-options.mcap"), file("foreign-options.svg"));
    let name = log.to_str().unwrap();
    let written = format!("--picture={}", picture.display());
    for option in [&written, "--help", "--", "--world=/etc/hostname", "--no-such-option"] {
        let header = Header::new("a_to_b", [option]);
        fs::write(&log, LogWriter::new(Vec::new(), &header).unwrap().finish().unwrap()).unwrap();
        let (status, _, err) = run("a_to_b", &["--replay", name]);
        assert!(status == 2 && err.contains("expected options that affect the run"), "{option}: {err}");
        assert_eq!(manage(&["check", name]).0, 2);
    }
    assert!(!picture.exists());
    // Files outside the recording are not read either.
    let header = Header::new("a_to_b", ["--world=world.wld"]);
    fs::write(&log, LogWriter::new(Vec::new(), &header).unwrap().finish().unwrap()).unwrap();
    let (status, _, err) = run("a_to_b", &["--replay", name]);
    assert!(status == 2 && err.contains("no such file in the recording"), "{err}");
}

#[cfg(unix)]
#[test]
fn devices_are_no_recordings() {
    for command in
        [&["info", "/dev/zero"][..], &["check", "/dev/zero"], &["recover", "/dev/zero", "/dev/null"]]
    {
        let (status, _, err) = manage(command);
        assert!(status == 2 && err.contains("device"), "{command:?}: {err}");
    }
    let (status, _, err) = run("a_to_b", &["--replay", "/dev/zero"]);
    assert!(status == 2 && err.contains("device"), "{err}");
}

/// A robot has its 3D model, and a recording has it too.
#[test]
fn the_model_of_a_robot_is_recorded() {
    let robot = Path::new(DATA).join("formats/cart.robi");
    let log = assert_replays("a_to_b", &["--robot", text(&robot), "--time-limit", "1"]);
    let log = Log::read(fs::read(log).unwrap()).unwrap();
    assert!(log.header().attachment("robot.robi 001 cart.obj").is_some());
}

#[test]
fn no_other_file_is_recorded_over() {
    let letter = file("letter.mcap");
    let options = ["--time-limit", "1", "--record", text(&letter)];
    fs::write(&letter, "Dear all").unwrap();
    let (status, _, err) = run("a_to_b", &options);
    assert!(status == 2 && err.contains("no recording") && err.contains("--force"), "{err}");
    assert_eq!(fs::read(&letter).unwrap(), b"Dear all");
    assert_eq!(run("a_to_b", &[&options[..], &["--force", "--fsync"]].concat()).2, "");
    let first = fs::read(&letter).unwrap();
    let writer = LogFile::create(&letter).unwrap();
    let (status, _, err) = run("a_to_b", &options);
    assert!(status == 2 && err.contains("somebody who records"), "{err}");
    drop(writer);
    assert!(run("a_to_b", &options).2.is_empty() && fs::read(&letter).unwrap() == first);
    let (status, _, err) = run("a_to_b", &["--force"]);
    assert!(status == 2 && err.contains("--record"), "{err}");
}

#[test]
fn nothing_else_is_recovered_over() {
    let [log, out] = ["to-recover.mcap", "recovered-over.mcap"].map(file);
    run("a_to_b", &["--time-limit", "1", "--record", text(&log)]);
    let ways: [&[&str]; 2] =
        [&["recover", text(&log), text(&out)], &["export", text(&log), "--ros2", text(&out)]];
    for words in &ways[..if cfg!(feature = "ros2") { 2 } else { 1 }] {
        fs::write(&out, "Dear all").unwrap();
        let (status, _, err) = manage(words);
        assert!(status == 2 && err.contains("no recording") && err.contains("--force"), "{words:?}: {err}");
        assert_eq!(fs::read(&out).unwrap(), b"Dear all");
        assert_eq!(manage(&[*words, &["--force"]].concat()).0, 0);
        let whole = fs::read(&out).unwrap();
        let recorder = LogFile::create(&out).unwrap();
        let (status, _, err) = manage(words);
        assert!(status == 2 && err.contains("somebody who records"), "{words:?}: {err}");
        drop(recorder);
        assert_eq!(manage(words).0, 0);
        assert!(fs::read(&out).unwrap() == whole);
    }
}

/// Small stored recordings, perhaps from another machine. After an intended change of runs, the first one is
/// regenerated by `REGENERATE=1 cargo test -p roverlab-cli recordings`.
#[test]
fn recordings_of_before_check() {
    let data = Path::new(DATA).join("logs");
    let log = data.join("distbug.mcap");
    let name = log.to_str().unwrap();
    if std::env::var_os("REGENERATE").is_some() {
        // Few beams keep the file small.
        let lidar = RobotSpec::s4().lidar.map(|lidar| LidarSpec { points: 60, ..lidar });
        let robot = file("coarse.robi");
        fs::write(&robot, formats::robi::print(&RobotSpec { lidar, ..RobotSpec::s4() })).unwrap();
        let options =
            ["--robot", robot.to_str().unwrap(), "--seed", "3", "--time-limit", "8", "--record", name];
        run("distbug", &options);
    }
    let (status, report, err) = manage(&["check", name]);
    assert_eq!((status, report["outcome"].as_str()), (0, Some("same")), "{report} {err}");
    // A recording by an earlier commit, whose program made more calls in another order, can still be read.
    let (old, table) = (data.join("ackermann.mcap"), file("ackermann.csv"));
    let (status, report, err) = manage(&["export", text(&old), "--csv", text(&table)]);
    assert_eq!((status, err.as_str()), (0, ""), "{report}");
    assert!(fs::read_to_string(table).unwrap().contains(",calls,set_motor,"));
}
