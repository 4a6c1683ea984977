//! Whole recordings: written content can be read back, and damage is detected.

mod damage;
mod fleets;
mod packed;

use std::io::{self, Write};
use std::ops::ControlFlow;

use image::{Rgb, RgbImage};

use super::*;
use crate::geometry::{Aabb, Point, Pose, Twist};
use crate::io::sim::{Fleet, SimOptions, Simulation};
use crate::io::wrappers::{Fault, Faulty};
use crate::io::{
    Camera, Clock, Display, DistanceSensors, Drive, ErrorKind, GroundTruth, LidarScan, MockRobot, Odometry,
    Psd, Resolution, Result, RobotIo,
};
use crate::world::{HeightField, LidarSpec, RobotSpec, Scene, Terrain, World};

fn header() -> Header {
    Header { seed: Some(7), ..Header::new("test", ["--noise=1", "--seed=7"]) }
}

fn scene() -> Scene {
    // Few beams keep the files small.
    let lidar = RobotSpec::s4().lidar.map(|lidar| LidarSpec { points: 12, ..lidar });
    let spec = RobotSpec { lidar, ..RobotSpec::s4() };
    Scene::with_robot(World::walled(2.0, 2.0), spec, Pose::new(1.0, 1.0, 0.3))
}

/// Calls of every kind.
fn tour(robot: &mut (impl RobotIo + ?Sized), seconds: f64) -> Result<()> {
    robot.print("hello, \"world\"\n")?;
    blind_tour(robot, seconds)
}

/// The same without the display, whose picture would be nearly all of the file.
fn blind_tour(robot: &mut (impl RobotIo + ?Sized), seconds: f64) -> Result<()> {
    robot.set_speed(Twist::new(0.2, 0.4))?;
    let mut scan = LidarScan::default();
    while robot.now()? < seconds {
        robot.scan_into(&mut scan)?;
        robot.pose()?;
        robot.read_key()?;
        robot.encoder(1)?;
        robot.wait(0.1)?;
    }
    let _ = robot.distance(Psd(77));
    let id = robot.radio_id()?;
    robot.send(id, b"x\0y")?;
    robot.receive()?;
    robot.turn(0.5, 1.0)?;
    robot.wait_done()
}

fn recorded(seconds: f64) -> Vec<u8> {
    recorded_by(|robot| tour(robot, seconds))
}

fn recorded_by(run: impl FnOnce(&mut dyn RobotIo) -> Result<()>) -> Vec<u8> {
    let simulation = Simulation::new(&scene(), SimOptions::with_noise(1.0, 7)).unwrap();
    let writer = LogWriter::new(Vec::new(), &header()).unwrap();
    writer.show(&scene());
    let mut robot = writer.recorder(simulation.robot(0).unwrap(), 0);
    let mut truth = writer.truth(simulation.truth(), 0);
    run(&mut robot).unwrap();
    drop(robot);
    truth.robot(0).unwrap();
    writer.finish().unwrap()
}

fn replayed(
    log: &Log,
    run: impl FnOnce(&mut Recorder<Replay, Vec<u8>>) -> Result<()>,
) -> (Result<()>, Vec<u8>) {
    let player = Player::new(log);
    let writer = LogWriter::new(Vec::new(), log.header()).unwrap();
    writer.show(&scene());
    let mut robot = writer.recorder(player.robot(0).unwrap(), 0);
    let mut truth = writer.truth(player.truth(0).unwrap(), 0);
    let result = run(&mut robot);
    drop(robot);
    let _ = truth.robot(0);
    (result, writer.finish().unwrap())
}

#[test]
fn a_replay_records_the_same_bytes() {
    let bytes = recorded(2.5);
    assert!(bytes == recorded(2.5));
    let log = Log::read(bytes.clone()).unwrap();
    assert_eq!((log.header(), log.robots()), (&header(), 1));
    assert_eq!((log.topics()["/robot1/lcd"], log.topics()["/scene"]), (1, 1));
    assert!(log.chunks() >= 3, "a chunk for each second: {}", log.chunks());
    let (result, again) = replayed(&log, |robot| tour(robot, 2.5));
    result.unwrap();
    assert!(again == bytes, "{}", Difference::between(&log, &Log::read(again).unwrap()).unwrap());
}

#[test]
fn recording_leaves_the_run_as_it_is() {
    let simulation = Simulation::new(&scene(), SimOptions::with_noise(1.0, 7)).unwrap();
    let mut robot = simulation.robot(0).unwrap();
    tour(&mut robot, 2.5).unwrap();
    drop(robot);
    let log = Log::read(recorded(2.5)).unwrap();
    let player = Player::new(&log);
    let mut truth = player.truth(0).unwrap();
    tour(&mut player.robot(0).unwrap(), 2.5).unwrap();
    assert_eq!(truth.robot(0).unwrap(), simulation.truth().robot(0).unwrap());
    assert_eq!(player.rest(), None);
}

/// Elevation, roll and pitch: what the inertial unit says, and what is true.
#[test]
fn a_recording_on_hills_tells_all_of_the_pose() {
    let area = Aabb::new(Point::origin(), Point::new(4.0, 4.0));
    let slope = HeightField::from_fn(41, 41, area, |at| 0.1 * at.x - 0.05 * at.y).unwrap();
    let world = World { terrain: Some(Terrain::new("made.png", slope)), ..World::empty(4.0, 4.0) };
    let scene = Scene::with_robot(world, RobotSpec::blizzard(), Pose::new(2.0, 2.0, 0.4));
    let drive = |robot: &mut dyn RobotIo, truth: &mut dyn GroundTruth| -> Result<Vec<String>> {
        robot.set_speed(Twist::new(0.2, 0.1))?;
        (0..5)
            .map(|_| {
                robot.wait(0.3)?;
                let unit = (robot.attitude()?, robot.turn_rates()?, robot.acceleration()?);
                Ok(format!("{unit:?} {:?}", truth.in_space(0)?.pose))
            })
            .collect()
    };
    let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 7)).unwrap();
    let writer = LogWriter::new(Vec::new(), &header()).unwrap();
    let mut robot = writer.recorder(simulation.robot(0).unwrap(), 0);
    let mut truth = writer.truth(simulation.truth(), 0);
    let seen = drive(&mut robot, &mut truth).unwrap();
    let end = truth.in_space(0).unwrap().pose;
    assert!(end.position.z > 0.1 && end.tilt() > 0.1, "{end:?}");
    drop(robot);
    let log = Log::read(writer.finish().unwrap()).unwrap();
    assert_eq!(log.topics()["/robot1/transforms"], 6);
    let player = Player::new(&log);
    let mut truth = player.truth(0).unwrap();
    assert_eq!(drive(&mut player.robot(0).unwrap(), &mut truth).unwrap(), seen);
    // One from before there were hills does not know.
    let old = Log::read(recorded(0.5)).unwrap();
    let error = Player::new(&old).truth(0).unwrap().in_space(0).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Unsupported);
}

#[test]
fn the_first_call_that_differs_is_named() {
    let log = Log::read(recorded(1.0)).unwrap();
    let (result, again) = replayed(&log, |robot| {
        robot.print("hello, \"world\"\n")?;
        robot.set_speed(Twist::new(0.2, 0.400_000_000_000_000_1))
    });
    let error = result.unwrap_err();
    let expected = "at 0.0001 s: found the call set_speed(0.2, 0.4000000000000001); expected set_speed(0.2, 0.4), \
                    as recorded";
    assert_eq!((error.kind(), error.to_string().as_str()), (ErrorKind::Diverged, expected));
    let difference = Difference::between(&log, &Log::read(again).unwrap()).unwrap();
    assert_eq!((difference.robot, difference.time), (Some(0), 0.0001));

    let mut robot = Replay::new(&log, 0).unwrap();
    let error = robot.pose().unwrap_err();
    assert_eq!(
        error.to_string(),
        "at 0 s: found the call pose(); expected print(\"hello, \\\"world\\\"\\n\"), as recorded"
    );
    assert_eq!(robot.print("hello, \"world\"\n").unwrap_err().kind(), ErrorKind::Diverged);
}

#[test]
fn a_call_behind_the_end_says_so() {
    let log = Log::read(recorded(1.0)).unwrap();
    let mut robot = Replay::new(&log, 0).unwrap();
    tour(&mut robot, 1.0).unwrap();
    let error = robot.wait(1.0).unwrap_err();
    assert_eq!(
        (error.kind(), error.to_string().as_str()),
        (ErrorKind::EndOfLog, "the recording has ended before the call wait(1.0)")
    );
}

#[test]
fn a_program_that_ends_early_leaves_a_rest() {
    let log = Log::read(recorded(1.0)).unwrap();
    let player = Player::new(&log);
    player.robot(0).unwrap().print("hello, \"world\"\n").unwrap();
    assert_eq!(player.rest(), Some((0.0001, "set_speed(0.2, 0.4)".into())));
}

#[test]
fn a_replay_begins_at_any_time() {
    let log = Log::read(recorded(2.0)).unwrap();
    let player = Player::new(&log);
    player.seek(1.0);
    let (time, call) = player.rest().unwrap();
    assert!((1.0..1.11).contains(&time), "{time}");
    let mut robot = player.robot(0).unwrap();
    assert_eq!(robot.peek_time().unwrap(), time);
    // The calls from there on, in their order.
    let expected = robot.print("?").unwrap_err().to_string();
    assert!(expected.ends_with(&format!("expected {call}, as recorded")), "{expected}");
    player.seek(1e6);
    assert_eq!(player.rest(), None);
}

#[test]
fn files_that_are_no_recordings_are_named() {
    let bytes = recorded(1.0);
    let named = |bytes: &[u8]| Log::read(bytes.to_vec()).unwrap_err();
    assert!(matches!(named(b""), LogError::NoMcap));
    assert!(matches!(named(b"PK\x03\x04 something else"), LogError::NoMcap));
    assert!(matches!(named(&bytes[..5]), LogError::Truncated { at: 5 }));
    assert!(matches!(named(&bytes[..bytes.len() - 3]), LogError::Truncated { .. }));
    assert!(matches!(named(&[&bytes[..], b"!"].concat()), LogError::Damaged { .. }));
    assert!(matches!(
        Replay::new(&Log::read(bytes).unwrap(), 3),
        Err(LogError::NoRobot { index: 3, robots: 1 })
    ));

    let foreign = mcap::Writer::new(io::Cursor::new(Vec::new())).and_then(|mut file| {
        file.finish()?;
        Ok(file.into_inner().into_inner())
    });
    assert!(
        matches!(named(&foreign.unwrap()), LogError::Foreign { library } if library.starts_with("mcap-rust"))
    );
}

/// Accepts a number of bytes and then fails.
struct FullDisk(usize);

impl Write for FullDisk {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0 = self.0.checked_sub(bytes.len()).ok_or(io::ErrorKind::StorageFull)?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_full_disk_does_not_disturb_the_run() {
    let writer = LogWriter::new(FullDisk(10_000), &header()).unwrap();
    let simulation = Simulation::new(&scene(), SimOptions::with_noise(1.0, 7)).unwrap();
    let mut robot = writer.recorder(simulation.robot(0).unwrap(), 0);
    tour(&mut robot, 3.0).unwrap();
    assert_eq!(writer.finish().map(|_| ()).unwrap_err().kind(), io::ErrorKind::StorageFull);
    robot.now().unwrap();
    assert!(LogWriter::new(FullDisk(10), &header()).is_err());
}

#[test]
fn errors_of_the_robot_are_replayed() {
    let fault: Fault = "link@0.5".parse().unwrap();
    let run = |robot: &mut dyn RobotIo| tour(robot, 1.0).unwrap_err();
    let simulation = Simulation::new(&scene(), SimOptions::ideal()).unwrap();
    let writer = LogWriter::new(Vec::new(), &header()).unwrap();
    let mut robot = writer.recorder(Faulty::new(simulation.robot(0).unwrap(), vec![fault]), 0);
    let first = run(&mut robot);
    drop(robot);
    let log = Log::read(writer.finish().unwrap()).unwrap();
    let second = run(&mut Replay::new(&log, 0).unwrap());
    assert_eq!((first.kind(), first.to_string()), (second.kind(), second.to_string()));
}

/// A robot with only a camera.
struct Eye(u8, Resolution);

impl Clock for Eye {
    fn now(&mut self) -> Result<f64> {
        Ok(f64::from(self.0))
    }

    fn wait(&mut self, _seconds: f64) -> Result<()> {
        Ok(())
    }
}

impl Camera for Eye {
    fn set_resolution(&mut self, resolution: Resolution) -> Result<()> {
        self.1 = resolution;
        Ok(())
    }

    fn resolution(&mut self) -> Result<Resolution> {
        Ok(self.1)
    }

    fn image_into(&mut self, image: &mut RgbImage) -> Result<()> {
        let (width, height) = self.1.dimensions();
        self.0 += 1;
        *image = RgbImage::from_fn(width, height, |x, y| Rgb([x as u8, y as u8, self.0]));
        Ok(())
    }
}

#[test]
fn images_are_replayed() {
    let writer = LogWriter::new(Vec::new(), &header()).unwrap();
    let mut eye = writer.recorder(Eye(0, Resolution::Qqvga), 0);
    let look = |robot: &mut dyn Camera| -> Vec<RgbImage> {
        let first = robot.image().unwrap();
        robot.set_resolution(Resolution::Qvga).unwrap();
        vec![first, robot.image().unwrap(), robot.image().unwrap()]
    };
    let seen = look(&mut eye);
    let log = Log::read(writer.finish().unwrap()).unwrap();
    assert_eq!(look(&mut Replay::new(&log, 0).unwrap()), seen);
    assert_eq!(log.topics()["/robot1/camera"], 3);
}

#[test]
fn robots_in_threads_are_merged_by_their_time() {
    let record = |reverse: bool| {
        let mut scene = scene();
        scene
            .robots
            .push(crate::world::RobotPlacement::new(scene.robots[0].spec.clone(), Pose::new(0.5, 0.5, 0.0)));
        let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 3)).unwrap();
        let writer = LogWriter::new(Vec::new(), &header()).unwrap();
        let robots = [0, 1].map(|index| writer.recorder(simulation.robot(index).unwrap(), index));
        std::thread::scope(|scope| {
            let mut robots: Vec<_> = robots.into_iter().collect();
            if reverse {
                robots.reverse();
            }
            for mut robot in robots {
                scope.spawn(move || tour(&mut robot, 1.5).unwrap());
            }
        });
        writer.finish().unwrap()
    };
    let first = record(false);
    for reverse in [true, false, true] {
        assert!(record(reverse) == first);
    }
    let log = Log::read(first).unwrap();
    let counts = [0, 1].map(|robot| log.entries(robot).count());
    assert!(log.robots() == 2 && counts.iter().all(|&count| count > 50), "{counts:?}");
}

#[test]
fn what_depends_on_more_than_the_robot_is_indeterminate() {
    let mut speed = 0.1;
    let result = check_determinism(&scene(), &SimOptions::default(), [4], |robot| {
        speed += 0.01;
        robot.set_speed(Twist::new(speed, 0.0))
    });
    let Err(Indeterminate::Runs { seed: 4, difference }) = result else { panic!("{result:?}") };
    assert_eq!(
        difference.to_string(),
        "robot 1 at 0 s: found set_speed(0.12, 0.0) -> (); expected set_speed(0.11, 0.0) -> ()"
    );
    check_determinism(&scene(), &SimOptions::default(), 1..=2, |robot| tour(robot, 1.0)).unwrap();
}

#[test]
fn the_open_loop_answers_by_time() {
    let log = Log::read(recorded(2.0)).unwrap();
    // The same program gives the same commands.
    let mut robot = OpenLoop::new(&log, 0).unwrap();
    tour(&mut robot, 2.0).unwrap();
    let report = robot.report();
    assert_eq!((report.same, report.first_difference), (report.recorded, None));
    // Another one gets the same readings at the same time.
    let mut robot = OpenLoop::new(&log, 0).unwrap();
    robot.seek(1.0);
    robot.set_speed(Twist::new(0.3, 0.4)).unwrap();
    let pose = robot.pose().unwrap();
    let entries: Vec<Entry> = log.entries(0).filter(|entry| entry.method == "pose").collect();
    let last = entries.iter().rfind(|entry| entry.time <= robot.commands()[0].time + 1e-3).unwrap();
    assert_eq!([pose.x, pose.y, pose.heading][..], last.numbers[..]);
    let report = robot.report();
    assert_eq!((report.same, report.given), (0, 1));
    robot.wait(100.0).unwrap();
    assert_eq!(robot.pose().unwrap_err().kind(), ErrorKind::EndOfLog);
    assert_eq!(
        OpenLoop::new(&log, 0).unwrap().distance(Psd::LEFT).unwrap_err().kind(),
        ErrorKind::Unsupported
    );
}

#[test]
fn a_mock_robot_without_a_clock_that_moves_is_recorded() {
    let writer = LogWriter::new(Vec::new(), &header()).unwrap();
    let mut robot = writer.recorder(MockRobot::new().with_distance(Psd::FRONT, [0.5, 0.25]), 0);
    assert_eq!(robot.distance(Psd::FRONT).unwrap(), 0.5);
    let _inner: MockRobot = robot.into_inner();
    let log = Log::read(writer.finish().unwrap()).unwrap();
    assert_eq!(log.entries(0).map(|entry| entry.numbers).collect::<Vec<_>>(), [[0.5]]);
}
