//! A robot driven through the library by `RobiosRobot` matches a simulated robot inside `Quantised`: the same
//! calls with the same answers at the same times.
//!
//! The library's robot belongs to its process, so each run is a separate process: this test starts itself
//! again.

use std::path::{Path, PathBuf};
use std::process::Command;

use eyesim::costs::Costs;
use eyesim::plan::{Plan, names};
use eyesim::seat::{Seat, Terms};
use roverlab::drive::{RandomDrive, RandomDriveParameters};
use roverlab::geometry::{Point, Pose, Twist};
use roverlab::io::control::run;
use roverlab::io::robios::RobiosRobot;
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::io::wrappers::{Quantised, Stamp, Traced};
use roverlab::io::{
    DisplayImage, ErrorKind, Fill, LidarSettings, Psd, Resolution, Result, RobotIo, Viewport,
};
use roverlab::nav::{BugParameters, DistBug};
use roverlab::random::Stream;
use roverlab::world::Colour;

const NOISE: f64 = 1.0;
const JOB: &str = "CLIENT_JOB";
const OUTPUT: &str = "CLIENT_OUTPUT";

fn plan() -> Plan {
    let start = Some(Pose::from_mm_deg(1000.0, 1200.0, 30.0));
    let world = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/programs/corner.wld");
    Plan {
        world: Some(world),
        start,
        noise: NOISE,
        seed: 4,
        time_limit: 1000.0,
        costs: Costs::Free,
        ..Plan::default()
    }
}

/// A robot's actions in a job. Errors are part of the log.
fn work(job: &str, robot: &mut impl RobotIo) {
    match job {
        "tour" => tour(robot),
        "random" => {
            let drive = RandomDrive::new(RandomDriveParameters::default(), Stream::new(7));
            let _ = drive.and_then(|mut drive| run(robot, &mut drive, 40.0, |_, _, _| {}));
        }
        _ => {
            let bug = DistBug::new(Point::new(1.5, 0.9), BugParameters::default());
            let _ = bug.and_then(|mut bug| run(robot, &mut bug, 120.0, |_, _, _| {}));
        }
    }
}

/// Every capability once, and failures.
fn tour(robot: &mut impl RobotIo) {
    let mut tour = || -> Result<()> {
        robot.straight(0.3004, 0.2501)?;
        robot.wait(0.7)?;
        robot.remaining()?;
        robot.speed()?;
        robot.wait_done()?;
        robot.pose()?;
        robot.turn(-0.8, 1.1)?;
        while !robot.is_done()? {}
        robot.curve(0.25, 0.5, 0.2)?;
        robot.wait_done()?;
        robot.drive_to(0.2, 0.11, 0.2)?;
        robot.wait_done()?;
        robot.set_pose(Pose::new(0.1234, 0.5, 3.1))?;
        robot.pose()?;
        robot.set_speed(Twist::new(0.1, 0.3333))?;
        robot.wait(1.234_567)?;
        robot.is_stalled()?;
        for sensor in [Psd::FRONT, Psd::LEFT, Psd::RIGHT, Psd::BACK] {
            robot.distance(sensor)?;
        }
        let _ = robot.distance(Psd(77));
        robot.scan()?;
        robot.configure_lidar(LidarSettings { field_of_view: 2.0, tilt: 0.0, points: 31 })?;
        robot.scan()?;
        let image = robot.image()?;
        robot.set_resolution(Resolution::Qvga)?;
        robot.image()?;
        robot.draw_image(DisplayImage::Rgb(&image), Viewport::default())?;
        robot.print("hello\nworld")?;
        robot.print_at(4, 5, "text")?;
        robot.cursor()?;
        robot.draw_line((0, 0), (50, 9999), Colour::RED)?;
        robot.draw_circle((100, 100), 20, Colour::GREEN, Fill::Solid)?;
        robot.pixel((100, 100))?;
        robot.set_menu(["A", "B", "", "END"])?;
        robot.read_key()?;
        robot.read_touch()?;
        robot.radio_id()?;
        robot.radio_peers()?;
        robot.send(1, b"to myself")?;
        robot.wait(0.02)?;
        robot.receive()?;
        robot.receive()?;
        let _ = robot.send(9, b"nobody");
        robot.set_motor(1, 0.507)?;
        robot.set_motor(2, -0.25)?;
        robot.wait(1.0)?;
        robot.encoder(1)?;
        robot.reset_encoder(2)?;
        robot.encoder(2)?;
        robot.set_servo(1, 0.4)?;
        robot.set_speed(Twist::STOP)?;
        robot.wait(0.5)?;
        robot.now().map(|_| ())
    };
    tour().expect("a robot that can do all of it");
}

fn trace<R: RobotIo>(robot: R, job: &str) -> String {
    let mut traced = Traced::new(robot, Vec::new()).with_stamp(Stamp::EachCall);
    work(job, &mut traced);
    let (_, written) = traced.finish();
    let text = String::from_utf8(written.unwrap()).unwrap();
    // Error messages differ: the library only returns a code.
    let lines = text.lines().map(|line| match line.split_once("-> error ") {
        Some((call, _)) => format!("{call}-> error"),
        None => line.to_owned(),
    });
    lines.collect::<Vec<_>>().join("\n")
}

fn library() -> PathBuf {
    let folder = Path::new(env!("CARGO_BIN_EXE_robios")).parent().unwrap();
    let name = if cfg!(target_os = "macos") { "libeyesim.dylib" } else { "libeyesim.so" };
    [folder.join(name), folder.join("deps").join(name)].into_iter().find(|file| file.is_file()).unwrap()
}

/// Run by the tests below in a process per job, as a process has one robot behind the library.
#[test]
#[ignore = "run by the tests below, in processes of their own"]
fn child() {
    let (Ok(job), Ok(output)) = (std::env::var(JOB), std::env::var(OUTPUT)) else { return };
    std::fs::write(output, trace(RobiosRobot::open(library()).unwrap(), &job)).unwrap();
}

fn compare(job: &str) {
    let output = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("client-{job}"));
    let status = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "child", "--ignored"])
        .envs(plan().variables())
        .env(names::KEYS, "NONE")
        .env(names::COSTS, "free")
        .env(JOB, job)
        .env(OUTPUT, &output)
        .output()
        .unwrap();
    assert!(status.status.success(), "{}", String::from_utf8_lossy(&status.stdout));
    let through_library = std::fs::read_to_string(output).unwrap();

    let (scene, _) = plan().scene().unwrap();
    let simulation = Simulation::new(&scene, plan().options()).unwrap();
    let seat = Seat::take(&simulation, &scene, 0, Terms::of(&plan().options())).unwrap();
    let scale = seat.identity().full_speed / seat.identity().top_speed;
    drop(seat);
    let options = SimOptions { call_duration: 1e-4, ..plan().options() };
    let simulation = Simulation::new(&scene, options).unwrap();
    let direct = trace(Quantised::new(simulation.robot(0).unwrap()).with_motor_scale(scale), job);
    for (number, (found, expected)) in through_library.lines().zip(direct.lines()).enumerate() {
        assert_eq!(found, expected, "{job}, line {}", number + 1);
    }
    assert_eq!(through_library.lines().count(), direct.lines().count());
    assert!(direct.lines().count() > 50, "{direct}");
}

#[test]
fn every_capability_gives_the_same_log() {
    compare("tour");
}

#[test]
fn behaviours_give_the_same_log() {
    compare("random");
    compare("distbug");
}

#[test]
fn libraries_that_are_none_are_refused_by_name() {
    let error = RobiosRobot::open("missing/libeyebot.so").unwrap_err();
    assert_eq!(error.kind(), ErrorKind::InvalidInput);
    assert!(error.to_string().contains("missing/libeyebot.so"));
    let error = RobiosRobot::open(std::env::current_exe().unwrap()).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::InvalidInput, "{error}");
}
