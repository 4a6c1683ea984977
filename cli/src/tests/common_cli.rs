//! The command line and report shared by all commands.

use std::ffi::OsString;
use std::path::PathBuf;

use super::support::{said, temporary, text};
use crate::commands::COMMANDS;
use crate::common::{
    CommonArgs, Failure, Outcome, Report, parse_noise, parse_point, parse_pose, parse_seconds, run,
};
use clap::Parser;
use proptest::prelude::*;
use roverlab::geometry::{Pose, units};
use serde_json::{Value, json};

#[derive(Debug, Parser)]
#[command(after_help = "JSON fields: laps")]
struct Args {
    #[command(flatten)]
    common: CommonArgs,
    /// An option of this command.
    #[arg(long, default_value_t = 3)]
    laps: u32,
}

crate::common::shares_options!(Args, common: CommonArgs);

/// Result of a program.
struct Ended {
    status: u8,
    out: String,
    err: String,
}

fn run_with(options: &[&str], work: impl FnOnce(&Args) -> Result<Report, Failure>) -> Ended {
    let command_line = std::iter::once("trial").chain(options.iter().copied()).map(OsString::from);
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let status = run("trial", command_line, &mut out, &mut err, work);
    let text = |bytes| String::from_utf8(bytes).unwrap();
    Ended { status, out: text(out), err: text(err) }
}

fn parse(options: &[&str]) -> Args {
    Args::try_parse_from(std::iter::once(&"trial").chain(options)).unwrap()
}

fn never(_: &Args) -> Result<Report, Failure> {
    panic!("the work begins in spite of a wrong command line")
}

/// A run's message is one line that contains all of `parts`.
fn assert_refused(ended: &Ended, parts: &[&str]) {
    assert_eq!((ended.status, ended.out.as_str()), (2, ""), "{}", ended.err);
    assert_eq!(ended.err.lines().count(), 1, "{}", ended.err);
    for part in parts {
        assert!(ended.err.contains(part), "`{part}` is missing in: {}", ended.err);
    }
}

#[test]
fn without_options_everything_has_its_default() {
    let args = parse(&[]);
    let common = args.common;
    assert_eq!((common.seed, common.noise, args.laps), (1, 1.0, 3));
    assert!(
        common.world.is_none() && common.robot.is_none() && common.start.is_none() && common.goal.is_none()
    );
    assert!(common.time_limit.is_none() && common.picture.is_none() && common.robios.is_none());
    assert!(!common.json && !common.realtime && common.fault.is_empty());
}

#[test]
fn all_options_are_understood() {
    let line = "--world a.sim --robot b.robi --start -100,200,90 --goal -1.5,-2e3 --seed 7 --noise 0 --time-limit 60 \
                --picture run.png --json --realtime --fault stuck@3 --fault lost@4.5 --laps 9";
    let args = parse(&line.split_whitespace().collect::<Vec<_>>());
    let common = args.common;
    assert_eq!(common.world, Some(PathBuf::from("a.sim")));
    assert_eq!(common.robot, Some(PathBuf::from("b.robi")));
    assert_eq!(common.start, Some(Pose::from_mm_deg(-100.0, 200.0, 90.0)));
    assert_eq!(
        common.goal.map(|goal| (goal.position.x, goal.position.y, goal.heading)),
        Some((-0.0015, -2.0, None))
    );
    assert_eq!((common.seed, common.noise, common.time_limit), (7, 0.0, Some(60.0)));
    assert_eq!(common.picture, Some(PathBuf::from("run.png")));
    assert_eq!(common.fault, ["stuck@3", "lost@4.5"]);
    assert!(common.json && common.realtime && args.laps == 9);
}

proptest! {
    #![proptest_config(roverlab::testing::cases(256))]
    #[test]
    fn poses_survive_the_command_line(x in -1e6..1e6f64, y in -1e6..1e6f64, heading in -720.0..720.0f64) {
        let separate = parse(&["--start", &format!("{x},{y},{heading}")]);
        let joined = parse(&[&format!("--start={x}, {y} ,{heading}")]);
        prop_assert_eq!(separate.common.start, Some(Pose::from_mm_deg(x, y, heading)));
        prop_assert_eq!(separate.common.start, joined.common.start);
    }

    #[test]
    fn no_text_is_taken_for_a_number_that_is_none(text in "[-+0-9a-zA-Z,. ]{0,12}") {
        for parsed in [parse_noise(&text), parse_seconds(&text)].into_iter().flatten() {
            prop_assert!(parsed.is_finite() && parsed >= 0.0);
        }
        if let Ok(point) = parse_point(&text) {
            prop_assert!(point.x.is_finite() && point.y.is_finite() && text.matches(',').count() == 1);
        }
        if let Ok(pose) = parse_pose(&text) {
            prop_assert!(pose.is_finite() && text.matches(',').count() == 2);
        }
    }
}

#[test]
fn wrong_values_are_named_with_what_was_expected() {
    let cases: &[(&[&str], &[&str])] = &[
        (&["--start", "1,2"], &["--start", "'1,2'", "expected X,Y,DEG: three finite numbers"]),
        (&["--start", "1,2,3,4"], &["--start", "'1,2,3,4'"]),
        (&["--start", "1,,3"], &["--start", "'1,,3'"]),
        (&["--start", "nan,2,3"], &["--start", "finite"]),
        (&["--start", "0,0,1e300"], &["--start", "at most 360000 degrees"]),
        (&["--start", "0,-1e10,0"], &["--start", "at most 1000000000 mm"]),
        (&["--goal", "1e300,0"], &["--goal", "at most 1000000000 mm"]),
        (&["--goal", "inf,0"], &["--goal", "two finite numbers"]),
        (&["--goal", "--json"], &["--goal", "'--json'"]),
        (&["--noise", "5.1"], &["--noise", "0 to 5"]),
        (&["--noise", "-1"], &["--noise", "0 to 5"]),
        (&["--time-limit", "0"], &["--time-limit", "above 0"]),
        (&["--seed", "-1"], &["--seed", "'-1'"]),
        (&["--picture", "run.gif"], &["--picture", "run.gif", ".svg or .png"]),
        (&["--record", "no/such/run.mcap"], &["--record no/such/run.mcap", "expected one that exists"]),
        (&["--replay", "no-such.mcap"], &["--replay no-such.mcap"]),
        (&["--fault", "stuck@-1"], &["--fault", "time is -1"]),
        (&["--robios", "libeyebot.so"], &["libeyebot.so", "no library that can be loaded"]),
        (&["--robios", "libeyebot.so", "--replay", "no-such.mcap"], &["--replay"]),
    ];
    for &(options, parts) in cases {
        assert_refused(&run_with(options, never), parts);
    }
    assert_refused(&run_with(&["--wrold", "a"], never), &["--wrold", "did you mean --world?"]);
    assert_refused(&run_with(&["--qqq"], never), &["--qqq", "--help"]);
    assert_refused(&run_with(&["stray"], never), &["stray"]);
    assert_refused(&run_with(&["--world"], never), &["--world"]);
}

#[test]
fn help_is_no_failure() {
    let ended = run_with(&["--help"], never);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""));
    for word in ["--start <X,Y,DEG>", "--laps", "JSON fields: laps", "[default: 1]"] {
        assert!(ended.out.contains(word), "{word} is missing in: {}", ended.out);
    }
}

fn a_report(outcome: Outcome) -> Report {
    Report {
        sim_time: Some(12.5),
        collisions: Some(0),
        path_length: Some(1.25),
        pose: Some(Pose::from_mm_deg(1200.1, 800.0, 450.0)),
        odometry: Some(Pose::new(f64::NAN, 0.8, 0.0)),
        ..Report::new(outcome)
    }
}

#[test]
fn json_is_one_object_with_all_fields() {
    let ended = run_with(&["--json", "--seed", "18446744073709551615"], |args| {
        Ok(a_report(Outcome::verdict("reached")).field("laps", args.laps).field("best", [1.0, f64::INFINITY]))
    });
    assert_eq!((ended.status, ended.err.as_str(), ended.out.lines().count()), (0, "", 1));
    let object: Value = serde_json::from_str(&ended.out).unwrap();
    let expected = json!({
        "example": "trial",
        "outcome": "reached",
        "seed": u64::MAX,
        "noise": 1.0,
        "sim_time_s": 12.5,
        "collisions": 0,
        "path_length_mm": 1250.0,
        "pose": { "x_mm": 1200.1, "y_mm": 800.0, "heading_deg": 90.0 },
        "odometry": { "x_mm": null, "y_mm": 800.0, "heading_deg": 0.0 },
        "laps": 3,
        "best": [1.0, null],
    });
    assert_eq!(object, expected);
}

/// Values that differ from run to run are separate, and printed only on request.
#[test]
fn times_are_told_on_request() {
    let timed = |_: &Args| Ok(a_report(Outcome::verdict("reached")).timing("images_per_s", 12.5));
    let [plain, asked] =
        [&["--json"][..], &["--json", "--timing"]].map(|options| run_with(options, timed).out);
    let [plain, mut asked]: [Value; 2] = [plain, asked].map(|text| serde_json::from_str(&text).unwrap());
    let timing = asked.as_object_mut().unwrap().remove("timing").unwrap();
    assert_eq!((&plain, &timing["images_per_s"]), (&asked, &json!(12.5)));
    assert!(timing["wall_time_s"].as_f64().unwrap() >= 0.0);
    let [plain, asked] = [&[][..], &["--timing"]].map(|options| run_with(options, timed).out);
    assert!(!plain.contains("wall time") && asked.contains("wall time s"), "{asked}");
}

#[test]
fn a_mistyped_command_is_told_what_was_meant() {
    let (status, out, err) = said("distbgu", &[]);
    assert!(status == 2 && out.is_empty() && err.contains("did you mean distbug?"), "{err}");
    let (status, out, err) = said("systems", &[]);
    assert_eq!((status, err.as_str(), out.lines().count()), (0, "", COMMANDS.len()));
    assert_eq!(said("a-to-b", &["--json"]), said("a_to_b", &["--json"]));
    let (status, out, err) = said("replay", &[]);
    assert!(status == 2 && out.is_empty() && err.contains("subcommands: check, recover"), "{err}");
    let (status, out, err) = said("--version", &[]);
    assert_eq!(
        (status, err.as_str(), out.as_str()),
        (0, "", concat!("roverlab ", env!("CARGO_PKG_VERSION"), "\n"))
    );
}

#[test]
fn what_only_a_simulator_knows_is_null_without_one() {
    let ended = run_with(&["--json"], |_| Ok(Report::new(Outcome::verdict("done"))));
    let object: Value = serde_json::from_str(&ended.out).unwrap();
    for name in ["sim_time_s", "collisions", "path_length_mm", "pose", "odometry"] {
        assert_eq!(object.get(name), Some(&Value::Null), "{name}");
    }
}

#[test]
fn the_status_says_how_the_run_ended() {
    let status = |report: Report| run_with(&["--json"], |_| Ok(report)).status;
    assert_eq!(status(a_report(Outcome::verdict("unreachable"))), 0);
    assert_eq!(status(a_report(Outcome::failure("timed_out"))), 1);

    let touched = Report { collisions: Some(2), ..a_report(Outcome::verdict("reached")) };
    assert_eq!(touched.word(), "collided");
    assert_eq!(status(touched), 1);
}

#[test]
fn trouble_after_the_run_does_not_lose_the_report() {
    let ended = run_with(&["--json"], |_| {
        let trouble = Some("run.svg: the disk is full".into());
        Ok(Report { trouble, ..a_report(Outcome::verdict("reached")) })
    });
    assert_eq!((ended.status, ended.err.as_str()), (1, "run.svg: the disk is full\n"));
    let object: Value = serde_json::from_str(&ended.out).unwrap();
    assert_eq!((object["outcome"].as_str(), object.get("trouble")), (Some("reached"), None));
}

#[test]
fn pictures_that_cannot_be_written_are_refused_before_the_run() {
    let folder = temporary("pictures");
    std::fs::create_dir_all(folder.join("taken.svg")).unwrap();
    let check = |name: &str| {
        let options = ["--picture", folder.join(name).to_str().unwrap()].map(str::to_owned);
        parse(&options.each_ref().map(String::as_str))
            .common
            .check_picture()
            .map_err(|f| (f.status(), f.to_string()))
    };
    for (name, found) in [("none/run.svg", "found no folder"), ("taken.svg", "found a folder")] {
        let (status, message) = check(name).unwrap_err();
        assert!(status == 2 && message.contains(found) && message.contains("expected"), "{message}");
    }
    assert_eq!(check("free.svg"), Ok(()));
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1, "the check leaves nothing behind");
}

#[cfg(unix)]
#[test]
fn pipes_and_devices_are_no_files() {
    let pipe = temporary("pipe");
    let _ = std::fs::remove_file(&pipe);
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let pipe = text(&pipe);
    let folder = env!("CARGO_MANIFEST_DIR");
    let cases: [(&str, &[&str]); 8] = [
        ("a_to_b", &["--record", pipe]),
        ("distbug", &["--robios", pipe]),
        ("edges", &["--input", pipe]),
        ("signs", &["--evaluate", folder, "--weights", pipe]),
        ("replay", &["info", pipe]),
        ("replay", &["recover", "run.mcap", pipe]),
        ("replay", &["export", "run.mcap", "--csv", pipe]),
        ("navigate", &["--world", pipe]),
    ];
    for (command, options) in cases {
        let (status, _, err) = said(command, options);
        let expected = "is a FIFO; expected a regular file";
        assert!(status == 2 && err.contains(expected), "{command} {options:?}: {err}");
    }
    if std::path::Path::new("/proc/self").exists() {
        let (status, _, err) = said("navigate", &["--world", "/proc/self/status"]);
        assert!(status == 2 && err.contains("is a file of the system; expected a regular file"), "{err}");
    }
    if cfg!(feature = "native") {
        let (status, _, err) = said("grade", &["/dev/zero", "roverlab distbug"]);
        assert!(status == 2 && err.contains("/dev/zero: is a device; expected a regular file"), "{err}");
    }
}

#[test]
fn no_file_is_written_over_one_that_is_read_or_written() {
    let same = std::env::current_dir().unwrap().join("a.svg");
    let same = same.to_str().unwrap();
    for (options, parts) in [
        (vec!["--picture", "a.svg", "--record", same], ["--picture a.svg: ", "--record", "another one"]),
        (vec!["--picture", "./a.svg", "--world", "a.svg"], ["--picture ./a.svg: ", "--world", "another one"]),
        (vec!["--record", "a", "--robot", "src/../a"], ["--record a: ", "--robot", "another one"]),
    ] {
        assert_refused(&run_with(&options, never), &parts);
    }
    let apart = run_with(&["--picture", "a.svg", "--world", "src/a.svg"], |_| {
        Ok(a_report(Outcome::verdict("reached")))
    });
    assert_eq!((apart.status, apart.err.as_str()), (0, ""));
}

#[test]
fn files_that_nobody_named_go_into_a_folder_of_their_own_if_a_person_looks_on() {
    let file = |options: &[&str]| parse(options).common.unnamed_file("run.png");
    let own = PathBuf::from("target/pictures/run.png");
    assert_eq!((file(&[]), file(&["--json"])), (Some(own.clone()), None));
    let named = parse(&["--picture", "target/pictures/run.png"]).common;
    assert_eq!((named.unnamed_file("run.png"), named.picture_file("run.png")), (None, Some(own)));
}

#[test]
fn failures_have_one_message_and_their_status() {
    let file = run_with(&["--json"], |_| Err(Failure::input("a.sim:3:7: found `abc`; expected a number")));
    assert_eq!((file.status, file.out.as_str()), (2, ""));
    assert_eq!(file.err, "a.sim:3:7: found `abc`; expected a number\n");

    let source = std::io::Error::other("cable out");
    let robot = roverlab::io::Error::new(roverlab::io::ErrorKind::Disconnected, "the link is gone")
        .with_source(source);
    let lost = run_with(&[], |_| Err(robot.into()));
    assert_eq!((lost.status, lost.err.as_str()), (1, "the link is gone: cable out\n"));
}

#[test]
fn people_get_words() {
    let ended = run_with(&[], |_| {
        let hits: Vec<u32> = (0..200).collect();
        Ok(a_report(Outcome::verdict("reached"))
            .field("leave_points", 4)
            .field("trace", hits)
            .field("goal", [1, 2])
            .field("hits", [[1, 2]]))
    });
    assert!(ended.out.starts_with("trial: reached\n"), "{}", ended.out);
    for part in [
        "12.50 s",
        "1250 mm",
        "1200, 800 mm, 90.0 deg",
        "leave points",
        "0; 1; 2; 3; 4; 5; 6; 7; and 192 more",
        " 1, 2\n",
    ] {
        assert!(ended.out.contains(part), "`{part}` is missing in: {}", ended.out);
    }
}

#[test]
#[should_panic(expected = "`pose` already")]
fn no_field_can_be_given_twice() {
    let _ = Report::new(Outcome::verdict("done")).field("pose", units::from_mm(1.0));
}

/// An output that fails like a full disk or a closed pipe.
struct Broken(std::io::ErrorKind);

impl std::io::Write for Broken {
    fn write(&mut self, _: &[u8]) -> std::io::Result<usize> {
        Err(self.0.into())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_report_that_cannot_be_written_is_a_failure() {
    let end = |kind| {
        let mut err = Vec::new();
        let work = |_: &Args| Ok(Report::new(Outcome::verdict("done")));
        let status = run("trial", [OsString::from("trial")], &mut Broken(kind), &mut err, work);
        (status, String::from_utf8(err).unwrap())
    };
    let (status, message) = end(std::io::ErrorKind::StorageFull);
    assert!(status == 1 && message.contains("standard output"), "{message}");
    assert_eq!(end(std::io::ErrorKind::BrokenPipe), (0, String::new()));
}
