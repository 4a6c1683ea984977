//! Recorded and replayed runs of the examples.

use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

use crate::common::{CommonArgs, Failure, Report};
use crate::{a_to_b, ackermann, common, distbug, omni, programs, replay};
use roverlab::io::log::{Header, LogWriter, recover};
use roverlab::world::{LidarSpec, RobotSpec, formats};
use serde_json::Value;

/// Runs an example with `--json`. Returns its status and its report, and what it said on standard error.
fn run<A: clap::Parser + AsRef<CommonArgs>>(
    name: &'static str,
    work: fn(&A) -> Result<Report, Failure>,
    options: &[&str],
) -> (u8, Value, String) {
    let first = [name, "--json"];
    let words = first.iter().chain(options).map(OsString::from);
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let status = common::run(name, words, &mut out, &mut err, work);
    let mut report: Value = serde_json::from_slice(&out).unwrap_or(Value::Null);
    if let Some(object) = report.as_object_mut() {
        object.remove("wall_time_s");
    }
    (status, report, String::from_utf8(err).unwrap())
}

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(name)
}

/// Records a run twice and replays it: all recordings and all reports are the same. Returns the recording.
fn assert_replays<A: clap::Parser + AsRef<CommonArgs>>(
    name: &'static str,
    work: fn(&A) -> Result<Report, Failure>,
    options: &[&str],
) -> PathBuf {
    let [first, second, third] = [1, 2, 3].map(|n| file(&format!("{name}-{}-{n}.mcap", options.concat())));
    let plain = run(name, work, options);
    for recording in [&first, &second] {
        let options = [options, &["--record", recording.to_str().unwrap()]].concat();
        assert_eq!(run(name, work, &options), plain, "recording changes the run {name} {options:?}");
    }
    assert!(
        fs::read(&first).unwrap() == fs::read(&second).unwrap(),
        "{name} {options:?} is not deterministic"
    );
    let options = ["--replay", first.to_str().unwrap(), "--record", third.to_str().unwrap()];
    assert_eq!(run(name, work, &options), plain, "{name} {options:?}");
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
        assert_replays("distbug", distbug::work, &options);
        for method in ["turn", "spline"] {
            assert_replays("a_to_b", a_to_b::work, &[&options[..], &["--method", method]].concat());
        }
        assert_replays("a_to_b", a_to_b::work, &[&options[..], &["--landmark"]].concat());
        assert_replays("ackermann", ackermann::work, &options);
        assert_replays("omni", omni::work, &options);
    }
}

#[test]
fn faults_and_failures_replay() {
    for fault in ["link@2", "stuck@1", "nan@1.5", "clock@2"] {
        assert_replays("a_to_b", a_to_b::work, &["--fault", fault, "--fault", "late@0.5"]);
    }
    assert_replays("distbug", distbug::work, &["--time-limit", "3"]);
}

#[test]
fn another_behaviour_is_found_at_the_first_call_that_differs() {
    let recording = assert_replays("a_to_b", a_to_b::work, &["--method", "spline"]);
    let name = recording.to_str().unwrap();
    let (status, report, err) = run("a_to_b", a_to_b::work, &["--replay", name, "--scale", "1.01"]);
    assert_eq!((status, report["outcome"].as_str()), (1, Some("failed")), "{report}");
    assert!(err.contains("found the call set_speed(") && err.contains("expected set_speed("), "{err}");
    let (status, _, err) = run("a_to_b", a_to_b::work, &["--campaign", "--runs", "1", "--record", name]);
    assert!(status == 2 && err.contains("found no robot that drives"), "{err}");
    let (status, _, err) = run("distbug", distbug::work, &["--replay", name]);
    assert!(status == 2 && err.contains("`a_to_b`") && err.contains("expected one of `distbug`"), "{err}");
}

fn manage(words: &[&str]) -> (u8, Value, String) {
    let words = ["replay", "--json"].iter().chain(words).map(OsString::from);
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let status = replay::run(words, &mut out, &mut err);
    (status, serde_json::from_slice(&out).unwrap_or(Value::Null), String::from_utf8(err).unwrap())
}

/// Options for a short run of each example.
fn short(program: &str) -> &'static [&'static str] {
    match program {
        "bug_compare" => &["--bugs", "bug1,tangentbug"],
        "camera" => &["--images", "3"],
        "color_tracking" => &["--job", "home"],
        "cone_drive" | "cone_race" => &["--track", "tests/data/cones/oval.csv"],
        "edges" => &["--repeat", "3"],
        "follow_me" => &["--followers", "3", "--mode", "radio"],
        "genetic" => &["--task", "wall", "--generations", "1"],
        "random_drive" => &["--robots", "3"],
        "safety" => &["--track", "tests/data/cones/oval.csv", "--event", "radio"],
        "starman" => &["--population", "4", "--generations", "2", "--seconds", "4"],
        _ => &[],
    }
}

/// Records a short run of an example twice, which gives the same, and checks a recording with `replay check`.
fn assert_checks(program: &programs::Program, options: &[&str]) {
    let words = options.concat().replace('/', "-");
    let logs = [1, 2].map(|n| file(&format!("check-{}{words}-{n}.mcap", program.name)));
    for log in &logs {
        let words = [&[program.name, "--json"], options, &["--time-limit", "6", "--record"]].concat();
        let words = words.iter().map(OsString::from).chain([log.into()]).collect();
        let (mut out, mut err) = (Vec::new(), Vec::new());
        (program.run)(words, &mut out, &mut err);
        assert!(log.is_file(), "{}: {}", program.name, String::from_utf8_lossy(&err));
    }
    let (name, same) = (program.name, fs::read(&logs[0]).unwrap() == fs::read(&logs[1]).unwrap());
    assert!(same, "{name} {options:?} is not deterministic");
    let (status, report, err) = manage(&["check", logs[0].to_str().unwrap()]);
    assert_eq!((status, report["outcome"].as_str()), (0, Some("same")), "{report} {err}");
    for log in logs {
        fs::remove_file(log).unwrap();
    }
}

#[test]
fn every_program_checks() {
    for program in programs::PROGRAMS {
        for noise in ["0", "1", "2"] {
            assert_checks(program, &[short(program.name), &["--noise", noise]].concat());
        }
    }
}

const TRACK: &str = "tests/data/cones/oval.csv";

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
        ("cone_race", &["--track", TRACK, "--line", "tests/data/cones/oval_line.csv", "--laps", "1"]),
        ("wall_following", &["--seed", "9"]),
    ] {
        assert_checks(programs::named(name).unwrap(), options);
    }
}

/// Every example with the shared command line is in the table.
#[test]
fn no_program_is_forgotten() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap();
        let is_shared = path.is_file() && fs::read_to_string(&path).unwrap().contains("common::main(");
        if is_shared {
            assert!(programs::named(name).is_some(), "{name} is missing in examples/common/programs.rs");
        }
    }
}

#[test]
fn several_runs_are_no_recording() {
    for (name, options) in [("a_to_b", ["--campaign", "--record"]), ("micromouse", ["--plan", "--record"])] {
        let program = programs::named(name).unwrap();
        let words = [&[name, "--json"], &options[..], &["x.mcap"]].concat();
        let (mut out, mut err) = (Vec::new(), Vec::new());
        let status = (program.run)(words.iter().map(OsString::from).collect(), &mut out, &mut err);
        let err = String::from_utf8(err).unwrap();
        assert!(status == 2 && err.contains("found no robot that drives"), "{err}");
    }
}

/// A maze belongs to its recording.
#[test]
fn a_recorded_maze_is_replayed() {
    let (maze, log) = (file("some.txt"), file("some-maze.mcap"));
    fs::write(&maze, "o---o---o\n|     G |\no   o---o\n| S     |\no---o---o\n").unwrap();
    let (maze_name, name) = (maze.to_str().unwrap(), log.to_str().unwrap());
    let program = programs::named("micromouse").unwrap();
    let words = ["micromouse", "--json", "--maze", maze_name, "--record", name].map(OsString::from).to_vec();
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let status = (program.run)(words, &mut out, &mut err);
    assert_eq!(status, 0, "{}", String::from_utf8_lossy(&err));
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
    let first = run("distbug", distbug::work, &["--world", world.to_str().unwrap(), "--record", name]);
    assert_eq!((first.0, first.1["outcome"].as_str()), (0, Some("reached")), "{}", first.1);
    fs::remove_dir_all(&folder).unwrap();
    assert_eq!(run("distbug", distbug::work, &["--replay", name]), first);
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
    assert_eq!(run("a_to_b", a_to_b::work, &["--record", name]).0, 0);
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
    let (status, _, err) = run("a_to_b", a_to_b::work, &["--replay", name]);
    assert!(status == 2 && err.contains("found no MCAP file"), "{err}");
    let log = file("cut-off.mcap");
    let name = log.to_str().unwrap();
    run("a_to_b", a_to_b::work, &["--record", name]);
    let bytes = fs::read(&log).unwrap();
    fs::write(&log, &bytes[..bytes.len() / 2]).unwrap();
    let (status, _, err) = manage(&["check", name]);
    assert!(status == 2 && err.contains("`recover`"), "{err}");
    let out = file("saved.mcap");
    let (status, report, _) = manage(&["recover", name, out.to_str().unwrap()]);
    assert!(status == 0 && report["chunks"].as_u64() > Some(1), "{report}");
    // What is saved replays as far as it goes.
    let (status, report, _) = manage(&["check", out.to_str().unwrap()]);
    assert_eq!((status, report["outcome"].as_str()), (1, Some("different")));
    assert!(report["difference"]["found"].as_str().unwrap().contains("the recording has ended"), "{report}");
}

#[test]
fn a_replay_meets_what_was_recorded() {
    let log = file("met.mcap");
    let name = log.to_str().unwrap();
    run("a_to_b", a_to_b::work, &["--seed", "3", "--record", name]);
    let again = |options: &[&str]| run("a_to_b", a_to_b::work, &[&["--replay", name], options].concat());
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
        let (status, _, err) = run("a_to_b", a_to_b::work, &["--replay", name]);
        assert!(status == 2 && err.contains("expected options that affect the run"), "{option}: {err}");
        assert_eq!(manage(&["check", name]).0, 2);
    }
    assert!(!picture.exists());
    // Nor are files read that it does not hold.
    let header = Header::new("a_to_b", ["--world=world.wld"]);
    fs::write(&log, LogWriter::new(Vec::new(), &header).unwrap().finish().unwrap()).unwrap();
    let (status, _, err) = run("a_to_b", a_to_b::work, &["--replay", name]);
    assert!(status == 2 && err.contains("no such file in the recording"), "{err}");
}

/// A small recording that was made once, perhaps on another machine. After a change that is meant to change runs, it is
/// made anew by `REGENERATE=1 cargo test --test examples recordings`.
#[test]
fn a_recording_of_another_machine_checks() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/logs");
    let log = data.join("distbug.mcap");
    let name = log.to_str().unwrap();
    if std::env::var_os("REGENERATE").is_some() {
        // Few beams, so that the file is small.
        let lidar = RobotSpec::s4().lidar.map(|lidar| LidarSpec { points: 60, ..lidar });
        let robot = file("coarse.robi");
        fs::write(&robot, formats::robi::print(&RobotSpec { lidar, ..RobotSpec::s4() })).unwrap();
        let options =
            ["--robot", robot.to_str().unwrap(), "--seed", "3", "--time-limit", "8", "--record", name];
        run("distbug", distbug::work, &options);
    }
    let (status, report, err) = manage(&["check", name]);
    assert_eq!((status, report["outcome"].as_str()), (0, Some("same")), "{report} {err}");
}

/// Where the process to be killed records.
const VICTIM: &str = "ROVERLAB_KILLED_RECORDING";

/// Records for the test that kills it.
#[test]
fn a_process_to_be_killed() {
    if let Some(log) = std::env::var_os(VICTIM) {
        run("distbug", distbug::work, &["--seed", "2", "--record", log.to_str().unwrap()]);
    }
}

/// Kills recording processes at random times; `ROVERLAB_KILLS` says how many. What is on disk is the beginning of the
/// whole recording, and all of its complete chunks can be saved.
#[test]
fn a_killed_process_loses_its_last_chunk_at_most() {
    let kills = std::env::var("ROVERLAB_KILLS").ok().and_then(|kills| kills.parse().ok()).unwrap_or(4);
    let log = file("killed.mcap");
    let start = || {
        let _ = fs::remove_file(&log);
        let mut command = std::process::Command::new(std::env::current_exe().unwrap());
        command.args(["--exact", "runs::recordings::a_process_to_be_killed"]).env(VICTIM, &log);
        command.stdout(std::process::Stdio::null()).spawn().unwrap()
    };
    let watch = common::Stopwatch::start();
    assert!(start().wait().unwrap().success());
    let duration = watch.seconds();
    let whole = fs::read(&log).unwrap();
    let mut times = roverlab::random::Stream::new(1);
    let mut cut = 0;
    for _ in 0..kills {
        let mut child = start();
        std::thread::sleep(std::time::Duration::from_secs_f64(times.between(0.0, duration)));
        child.kill().unwrap();
        child.wait().unwrap();
        let Ok(part) = fs::read(&log) else { continue };
        assert!(whole.starts_with(&part), "the file is not the beginning of the whole recording");
        if let Ok(saved) = recover(&part) {
            cut += usize::from(part.len() < whole.len());
            // All that is lost is what is behind the last complete chunk.
            let again = recover(&saved.bytes).unwrap();
            assert_eq!((again.chunks, again.lost), (saved.chunks, 0));
            assert!(saved.lost < 2 << 20, "{} bytes are lost", saved.lost);
        }
    }
    println!("{cut} of {kills} recordings were cut off");
}
