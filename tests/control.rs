//! The loop that runs every behaviour: clocks that stop, jump and run backwards, time limits, errors, and the
//! stop at the end.

#[path = "control/cases.rs"]
mod cases;
#[path = "control/faults.rs"]
mod faults;
#[path = "control/strays.rs"]
mod strays;

use std::cell::RefCell;
use std::ops::ControlFlow;

use cases::{CASES, Case, Robot, START, rig, room};
use roverlab::drive::{AToB, AToBParameters, Goal, Method};
use roverlab::geometry::{Point, Pose, Twist};
use roverlab::io::control::{Behaviour, Decision, Halt, Run, Senses, run};
use roverlab::io::sim::{Fleet, SimOptions, Simulation};
use roverlab::io::wrappers::Faulty;
use roverlab::io::{Call, Clock, Drive, Error, ErrorKind, MockRobot, Result};
use roverlab::maze::{
    Direction, Maze, MazeRunner, MazeRunnerParameters, RecursiveExplorer, Scale, WallState, mouse,
};
use roverlab::nav::{BugParameters, DistBug};
use roverlab::race::{Cone, ConeTrack, RaceOutcome, Racer, RacerParameters};
use roverlab::world::{RobotSpec, Scene};

/// A robot in the room with a fault, and the simulation, which ends by itself after a minute.
fn robot(spec: RobotSpec, fault: &str) -> (Robot, Simulation) {
    let options = SimOptions { time_limit: Some(60.0), ..SimOptions::ideal() };
    let simulation = Simulation::new(&Scene::with_robot(room(), spec, START), options).unwrap();
    let faults = if fault.is_empty() { Vec::new() } else { vec![fault.parse().unwrap()] };
    (Faulty::new(simulation.robot(0).unwrap(), faults), simulation)
}

/// How a run ended, and when, really. From a second later on the robot must stand.
fn ended(case: &Case, fault: &str, limit: f64, stop: f64) -> (std::result::Result<String, String>, f64) {
    let (name, spec, run) = case;
    let (mut robot, simulation) = robot(spec(), fault);
    let outcome = run(&mut robot, limit, stop).map_err(|error| error.to_string());
    let time = simulation.truth().time();
    let mut robot = robot.into_inner();
    let poses = [1.0, 1.0].map(|seconds| {
        robot.wait(seconds).unwrap();
        simulation.truth().pose(0).unwrap()
    });
    let [moved, turned] = [poses[1].distance_to(poses[0].position()), poses[1].heading - poses[0].heading];
    assert!(moved < 0.01 && turned.abs() < 0.02, "{name} {fault}: drives on after {outcome:?}");
    (outcome, time)
}

#[test]
fn a_clock_that_stops_or_runs_backwards_ends_every_run_with_an_error() {
    for case in CASES {
        for (fault, expected) in [("clock@2", "stands still"), ("clock=-1@2", "runs backwards")] {
            let (outcome, time) = ended(case, fault, 20.0, f64::INFINITY);
            let error = outcome.expect_err(case.0);
            assert!(error.contains(expected), "{} {fault}: {error}", case.0);
            assert!((2.0..2.4).contains(&time), "{} {fault}: ended after {time} s", case.0);
        }
    }
}

#[test]
fn a_clock_that_jumps_ahead_is_time_that_has_passed() {
    for case in CASES {
        let (outcome, time) = ended(case, "clock=1000@2", 20.0, f64::INFINITY);
        assert_eq!(outcome.as_deref(), Ok("TimedOut"), "{}", case.0);
        assert!((2.0..2.4).contains(&time), "{}: ended after {time} s", case.0);
        // Steps that were missed are not made up for, all at once.
        let (outcome, time) = ended(case, "clock=3@1", 5.0, f64::INFINITY);
        assert_eq!(outcome.as_deref(), Ok("TimedOut"), "{}", case.0);
        assert!((1.99..2.01).contains(&time), "{}: ended after {time} s", case.0);
    }
}

#[test]
fn the_time_limit_and_who_watches_end_every_run() {
    for case in CASES {
        let (outcome, time) = ended(case, "", 1.23, f64::INFINITY);
        assert_eq!(outcome.as_deref(), Ok("TimedOut"), "{}", case.0);
        assert!((1.22..1.25).contains(&time), "{}: ended after {time} s", case.0);
        let (outcome, _) = ended(case, "", 9.0, 0.5);
        assert_eq!(outcome.as_deref(), Ok("Stopped"), "{}", case.0);
        let (outcome, time) = ended(case, "", 0.0, f64::INFINITY);
        assert_eq!((outcome.as_deref(), time < 0.02), (Ok("TimedOut"), true), "{}", case.0);
        assert!(ended(case, "", f64::NAN, f64::INFINITY).0.unwrap_err().contains("time limit"), "{}", case.0);
    }
}

#[test]
fn an_exploration_ends_by_the_same_rules() {
    let explored = |fault: &str, limit: f64| {
        let (scale, spec) = (Scale::MICROMOUSE, mouse());
        let mut maze = Maze::filled(1, 12, WallState::Present).unwrap();
        for y in 0..11 {
            maze.set_wall(roverlab::maze::Cell::new(0, y), Direction::North, WallState::Absent);
        }
        let start = scale.pose(maze.start(), maze.heading());
        let scene = Scene::with_robot(scale.world(&maze), spec.clone(), start);
        let options = SimOptions { time_limit: Some(60.0), ..SimOptions::ideal() };
        let simulation = Simulation::new(&scene, options).unwrap();
        let mut robot =
            Faulty::new(simulation.robot(0).unwrap(), fault.parse().into_iter().collect::<Vec<_>>());
        let known = Maze::unexplored(1, 12).unwrap();
        let parameters = MazeRunnerParameters::MICROMOUSE;
        let mut runner =
            MazeRunner::new(&mut robot, rig(&spec).unwrap(), known, scale, parameters, limit).unwrap();
        let found = runner.explore(&mut RecursiveExplorer::new(), &mut |_| ());
        (found.map(|found| found.verdict).map_err(|error| error.to_string()), simulation.truth().time())
    };
    let (whole, takes) = explored("", f64::INFINITY);
    assert!(whole.is_ok() && takes > 3.0, "{whole:?} in {takes} s");
    for (fault, limit, expected) in [
        ("clock@1", 20.0, "stands still"),
        ("clock=-0.5@1", 20.0, "runs backwards"),
        ("clock=1000@1", 20.0, "TimedOut"),
        ("", 1.0, "TimedOut"),
    ] {
        let (outcome, time) = explored(fault, limit);
        assert!(format!("{outcome:?}").contains(expected), "{fault}: {outcome:?}");
        assert!((0.9..1.2).contains(&time), "{fault}: ended after {time} s");
    }
}

/// A racer that was given 20 s once drove 266.7 s with such a clock, and reported that it had finished.
#[test]
fn a_racing_car_with_a_broken_clock_stops() {
    let rows = (0..200).flat_map(|k| [1.7, -1.7].map(|y| Point::new(3.5 * f64::from(k), y)));
    let track = ConeTrack { cones: rows.map(Cone::unknown).collect(), ..ConeTrack::default() };
    let scene = track.scene(&[Pose::new(-2.0, 0.0, 0.0)]);
    for (fault, expected) in [("clock@2", "stands still"), ("clock=-60@2", "runs backwards"), ("", "")] {
        let race = Simulation::new(&scene, SimOptions::default()).unwrap();
        let faults = if fault.is_empty() { Vec::new() } else { vec![fault.parse().unwrap()] };
        let mut car = Faulty::new(race.robot(0).unwrap(), faults);
        let mut racer = Racer::new(RacerParameters::default()).unwrap();
        let ended = run(&mut car, &mut racer, 4.0, |_, _, _| {});
        match ended {
            Err(error) => assert!(!fault.is_empty() && error.to_string().contains(expected), "{error}"),
            Ok(outcome) => assert_eq!((outcome, fault), (RaceOutcome::TimedOut, "")),
        }
        drop(car);
        let time = race.truth().time();
        assert!(time < 4.1, "{fault}: drove for {time} s");
    }
}

/// Drives at a speed, and fails or ends at a step.
struct Plain {
    period: f64,
    steps: u32,
    at: u32,
    ending: fn() -> Decision<Plain>,
}

impl Default for Plain {
    fn default() -> Self {
        let ending = || Ok(ControlFlow::Break(Halt::Stopped));
        Self { period: 0.1, steps: 0, at: u32::MAX, ending }
    }
}

impl Behaviour for Plain {
    type Observation = f64;
    type Command = Twist;
    type Outcome = Halt;

    fn period(&self) -> f64 {
        self.period
    }

    fn step(&mut self, _time: f64, _seen: &f64) -> Decision<Self> {
        self.steps += 1;
        if self.steps < self.at { Ok(ControlFlow::Continue(Twist::new(0.1, 0.0))) } else { (self.ending)() }
    }
}

impl<R: ?Sized> Senses<R> for Plain {
    fn sense(&mut self, _robot: &mut R, time: f64, seen: &mut f64) -> Result<()> {
        *seen = time;
        Ok(())
    }
}

/// A robot whose clock shows what a function makes of the time, and which cannot be stopped if wished.
struct Odd {
    time: f64,
    shown: fn(f64) -> f64,
    drive: bool,
    told: Vec<Twist>,
}

impl Clock for Odd {
    fn now(&mut self) -> Result<f64> {
        Ok((self.shown)(self.time))
    }

    fn wait(&mut self, seconds: f64) -> Result<()> {
        self.time += seconds;
        Ok(())
    }
}

impl Odd {
    fn new(shown: fn(f64) -> f64) -> Self {
        Self { time: 0.0, shown, drive: true, told: Vec::new() }
    }
}

impl Drive for Odd {
    fn set_speed(&mut self, twist: Twist) -> Result<()> {
        if !self.drive && twist == Twist::STOP {
            return Err(Error::new(ErrorKind::Other, "the drive is broken"));
        }
        self.told.push(twist);
        Ok(())
    }
}

#[test]
fn periods_and_clocks_that_are_no_numbers_are_refused() {
    for period in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        let error = run(&mut MockRobot::new(), &mut Plain { period, ..Plain::default() }, 1.0, |_, _, _| {});
        let error = error.unwrap_err();
        assert!(error.kind() == ErrorKind::InvalidInput && error.to_string().starts_with("control period"));
    }
    let clocks: [fn(f64) -> f64; 3] = [
        |_| f64::NAN,
        |time| if time < 0.5 { time } else { f64::INFINITY },
        |time| if time < 0.5 { time } else { f64::NAN },
    ];
    for clock in clocks {
        let mut robot = Odd::new(clock);
        let error = run(&mut robot, &mut Plain::default(), 9.0, |_, _, _| {}).unwrap_err().to_string();
        assert!(error.contains("expected a finite number"), "{error}");
        assert_eq!(robot.told.last(), Some(&Twist::STOP));
        assert!(robot.time < 0.6);
    }
}

#[test]
fn a_clock_that_goes_back_while_the_robot_waits_is_found_out() {
    // It goes back by less than a period between a step and the wait after it.
    let mut robot = Odd::new(|time| time);
    let mut behaviour = Plain::default();
    let error = run(&mut robot, &mut behaviour, 9.0, |robot, behaviour, _| {
        if behaviour.steps == 5 {
            robot.time -= 0.05;
        }
    });
    assert!(error.unwrap_err().to_string().contains("runs backwards"));
}

#[test]
fn the_first_error_is_told_and_the_robot_is_stopped() {
    let broken = || Err(Error::new(ErrorKind::Other, "the behaviour is at its wits' end"));
    let mut robot = Odd::new(|time| time);
    let mut behaviour = Plain { at: 3, ending: broken, ..Plain::default() };
    let error = run(&mut robot, &mut behaviour, 9.0, |_, _, _| {}).unwrap_err();
    assert_eq!(error.to_string(), "the behaviour is at its wits' end");
    assert_eq!((robot.told.len(), robot.told[2]), (3, Twist::STOP));
    // A robot that cannot be stopped comes second.
    robot.drive = false;
    let mut behaviour = Plain { at: 3, ending: broken, ..Plain::default() };
    let ended = run(&mut robot, &mut behaviour, 9.0, |_, _, _| {});
    assert_eq!(ended.unwrap_err().to_string(), "the behaviour is at its wits' end");
    // Where nothing else is wrong, it is the error.
    let ended = run(&mut robot, &mut Plain::default(), 0.35, |_, _, _| {});
    assert_eq!(ended.unwrap_err().to_string(), "the drive is broken");
    // So is one of who watches.
    robot.drive = true;
    let ended = run(&mut robot, &mut Plain::default(), 9.0, |_, _, _| {
        Result::<()>::Err(Error::new(ErrorKind::Other, "nobody saw it"))
    });
    assert_eq!(ended.unwrap_err().to_string(), "nobody saw it");
    assert_eq!(robot.told.last(), Some(&Twist::STOP));
}

#[test]
fn steps_are_a_period_apart_and_what_was_missed_is_left_out() {
    let mut robot = Odd::new(|time| time);
    let mut times = Vec::new();
    let outcome = run(&mut robot, &mut Plain::default(), 1.05, |robot, behaviour, step| {
        times.push((10.0 * step.time).round() / 10.0);
        // The fourth step takes three periods and a half.
        robot.time += if behaviour.steps == 4 { 0.35 } else { 0.01 };
    });
    assert_eq!(outcome.unwrap(), Halt::TimedOut);
    assert_eq!(times[..5], [0.0, 0.1, 0.2, 0.3, 0.7]);
    assert_eq!(times.len(), 9, "{times:?}");
}

#[test]
fn a_mock_is_told_what_it_was_told_by_every_loop_before() {
    let mut robot = MockRobot::new().with_ideal_drive();
    let mut behaviour = Plain { at: 3, ..Plain::default() };
    assert_eq!(run(&mut robot, &mut behaviour, 9.0, |_, _, _| {}).unwrap(), Halt::Stopped);
    let speeds = robot.calls().iter().filter(|call| matches!(call, Call::SetSpeed(_))).count();
    assert_eq!((speeds, behaviour.steps), (3, 3));
}

#[test]
fn a_fleet_steps_any_behaviour_and_its_runs_end_by_the_same_rules() {
    let mut scene = Scene::with_robot(room(), RobotSpec::s4(), START);
    scene.robots.push(scene.robots[0].clone());
    scene.robots[1].pose = Pose::new(1.0, 1.0, 0.0);
    let ended = RefCell::new(Vec::new());
    let note = |outcome: String| ended.borrow_mut().push(outcome);
    let goal = Goal::point(Point::new(0.5, 0.2));
    let mut drive = AToB::new(Method::Dog, goal, AToBParameters::default()).unwrap();
    let mut bug = DistBug::new(Point::new(3.0, 0.0), BugParameters::default()).unwrap();
    let (mut one, mut other) = (Run::new(&drive, 30.0).unwrap(), Run::new(&bug, 4.0).unwrap());
    let mut fleet = Fleet::new(&scene, SimOptions::ideal()).unwrap();
    let control = fleet.control(0, drive.period(), |robot| {
        Ok(one.step(robot, &mut drive)?.map_break(|outcome| note(format!("{outcome:?}"))))
    });
    control.unwrap();
    let control = fleet.control(1, bug.period(), |robot| {
        Ok(other.step(robot, &mut bug)?.map_break(|outcome| note(format!("{outcome:?}"))))
    });
    control.unwrap();
    fleet.run_for(40.0).unwrap();
    let time = fleet.time();
    drop(fleet);
    ended.borrow_mut().sort();
    assert_eq!(*ended.borrow(), ["Reached", "TimedOut"]);
    assert!((4.0..30.0).contains(&time), "all runs were over after {time} s, and the fleet's with them");
}
