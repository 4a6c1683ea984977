use proptest::prelude::*;

use crate::geometry::{Pose, Twist, angle_difference};
use crate::io::sim::{SimOptions, SimRobot, Simulation};
use crate::io::wrappers::{Fault, Faulty, Limited, Limits, Manoeuvring, ManoeuvringParameters};
use crate::io::{
    Call, Clock, Drive, Error, ErrorKind, Manoeuvres, MockRobot, Motors, Odometry, Result, StallDetector,
};
use crate::kinematics::{Displacement, advance};
use crate::world::{RobotSpec, Scene, World};

fn manoeuvring<R>(robot: R) -> Manoeuvring<R> {
    Manoeuvring::new(robot, ManoeuvringParameters::default()).unwrap()
}

fn ideal() -> Manoeuvring<MockRobot> {
    manoeuvring(MockRobot::new().with_ideal_drive())
}

/// A simulated robot in the open, by itself and with manoeuvres made of its speeds.
fn simulated() -> (SimRobot, Manoeuvring<SimRobot>) {
    let spec = RobotSpec::s4();
    let lag = spec.motor.time_constant;
    let scene = Scene::with_robot(World::empty(4.0, 4.0), spec, Pose::new(2.0, 2.0, 0.0));
    let robot = || Simulation::new(&scene, SimOptions::ideal()).unwrap().robot(0).unwrap();
    let parameters = ManoeuvringParameters { lag, ..ManoeuvringParameters::default() };
    (robot(), Manoeuvring::new(robot(), parameters).unwrap())
}

/// A cart on rails with a buffer after a metre that blocks its wheels.
#[derive(Default)]
struct Cart {
    time: f64,
    place: f64,
    speed: f64,
}

impl Clock for Cart {
    fn now(&mut self) -> Result<f64> {
        Ok(self.time)
    }

    fn wait(&mut self, seconds: f64) -> Result<()> {
        self.time += seconds;
        self.place = (self.place + self.speed * seconds).min(1.0);
        Ok(())
    }
}

impl Drive for Cart {
    fn set_speed(&mut self, twist: Twist) -> Result<()> {
        self.speed = twist.linear;
        Ok(())
    }
}

impl Odometry for Cart {
    fn speed(&mut self) -> Result<Twist> {
        Ok(Twist::new(if self.place < 1.0 { self.speed } else { 0.0 }, 0.0))
    }

    fn pose(&mut self) -> Result<Pose> {
        Ok(Pose::new(self.place, 0.0, 0.0))
    }

    fn set_pose(&mut self, _: Pose) -> Result<()> {
        Err(Error::unsupported("way to set its place"))
    }
}

fn is_near(pose: Pose, goal: Pose, metres: f64, radians: f64) -> bool {
    let turned = angle_difference(pose.heading, goal.heading).abs();
    pose.distance_to(goal.position()) < metres && turned < radians
}

proptest! {
    #![proptest_config(crate::testing::cases(256))]

    /// A robot without errors ends at the end of the arc, whatever the waits in between.
    #[test]
    fn an_arc_is_driven_to_its_end(
        length in -2.0..2.0f64, angle in -7.0..7.0f64, speed in 0.05..0.8f64, waits in 0.003..0.4f64,
    ) {
        prop_assume!(length.abs() > 0.3);
        let mut robot = ideal();
        robot.curve(length, angle, speed).unwrap();
        let mut before = length.abs();
        while !robot.is_done().unwrap() {
            robot.wait(waits).unwrap();
            let left = robot.remaining().unwrap();
            prop_assert!(left <= before && !robot.is_stalled().unwrap());
            before = left;
        }
        let (pose, goal) = (robot.pose().unwrap(), advance(Pose::default(), Displacement { length, angle }));
        prop_assert!(is_near(pose, goal, 1e-6, 1e-6), "{pose:?} instead of {goal:?}");
        prop_assert!(before == 0.0 && robot.speed().unwrap() == Twist::STOP);
        let is_speed = |call: &Call| matches!(call, Call::SetSpeed(_) | Call::Wait(_));
        prop_assert!(robot.inner().calls().iter().all(is_speed), "the robot inside knows no manoeuvres");
    }

    #[test]
    fn a_turn_takes_its_time(angle in -7.0..7.0f64, speed in 0.2..3.0f64) {
        let mut robot = ideal();
        robot.turn(angle, speed).unwrap();
        robot.wait_done().unwrap();
        prop_assert!(is_near(robot.pose().unwrap(), Pose::new(0.0, 0.0, angle), 1e-9, 1e-9));
        let (time, shortest) = (robot.now().unwrap(), angle.abs() / speed);
        prop_assert!(time >= shortest - 1e-9 && time < shortest + 1.0, "{time} s");
    }
}

#[test]
fn a_simulated_robot_gets_where_its_own_manoeuvres_lead() {
    let ways: [fn(&mut dyn Manoeuvres) -> Result<()>; 4] = [
        |robot| robot.straight(-0.7, 0.3),
        |robot| robot.turn(2.5, 1.5),
        |robot| robot.curve(0.6, -1.3, 0.2),
        |robot| robot.drive_to(0.4, 0.3, 0.2),
    ];
    for (number, way) in ways.into_iter().enumerate() {
        let (mut own, mut robot) = simulated();
        way(&mut robot).unwrap();
        while !robot.is_done().unwrap() {}
        way(&mut own).unwrap();
        own.wait_done().unwrap();
        own.wait(1.0).unwrap();
        let (pose, goal) = (robot.pose().unwrap(), own.pose().unwrap());
        assert!(is_near(pose, goal, 0.004, 0.02), "way {number}: {pose:?} instead of {goal:?}");
    }
}

#[test]
fn who_is_held_stalls_and_is_free_backwards() {
    let mut cart = manoeuvring(Cart::default());
    cart.straight(5.0, 0.5).unwrap();
    cart.wait_done().unwrap();
    assert!(cart.is_stalled().unwrap() && !cart.is_done().unwrap());
    assert!((cart.remaining().unwrap() - 4.0).abs() < 1e-9);
    assert!((2.45..2.65).contains(&cart.now().unwrap()), "half a second after the buffer");
    cart.stop().unwrap();
    assert!(!cart.is_stalled().unwrap() && cart.is_done().unwrap(), "nothing drives the wheels");

    // Repeated equal speed commands are detected, too.
    let stalls: Vec<_> = (0..10)
        .map(|_| {
            cart.set_speed(Twist::new(0.2, 0.0)).unwrap();
            cart.wait(0.1).unwrap();
            cart.is_stalled().unwrap()
        })
        .collect();
    assert!(!stalls[..4].contains(&true) && !stalls[6..].contains(&false), "{stalls:?}");
    cart.straight(-0.5, 0.3).unwrap();
    cart.wait(0.1).unwrap();
    assert!(!cart.is_stalled().unwrap());
    cart.wait_done().unwrap();
    assert!(cart.is_done().unwrap() && (cart.pose().unwrap().x - 0.5).abs() < 1e-9);
}

#[test]
fn who_speeds_up_slowly_or_creeps_is_not_held() {
    let slow = Limits { linear_acceleration: 0.1, ..Limits::default() };
    let mut robot = manoeuvring(Limited::new(MockRobot::new().with_ideal_drive(), slow).unwrap());
    robot.straight(1.0, 2.0).unwrap();
    while !robot.is_done().unwrap() {
        assert!(!robot.is_stalled().unwrap());
        robot.wait(0.02).unwrap();
    }
    let mut robot = ideal();
    robot.set_speed(Twist::new(1e-3, 0.0)).unwrap();
    for _ in 0..100 {
        robot.wait(0.5).unwrap();
        assert!(!robot.is_stalled().unwrap());
    }
}

#[test]
fn the_last_command_counts() {
    let mut robot = ideal();
    robot.straight(1.0, 0.5).unwrap();
    robot.wait(0.73).unwrap();
    let there = robot.pose().unwrap();
    robot.curve(0.3, 1.0, 0.5).unwrap();
    robot.wait_done().unwrap();
    let goal = advance(there, Displacement { length: 0.3, angle: 1.0 });
    assert!(is_near(robot.pose().unwrap(), goal, 1e-9, 1e-9));

    // Setting odometry shifts the manoeuvre with it.
    robot.straight(1.0, 0.5).unwrap();
    robot.wait(0.73).unwrap();
    let gone = 1.0 - robot.remaining().unwrap();
    robot.set_pose(Pose::new(-3.0, 2.0, 0.0)).unwrap();
    let left = robot.remaining().unwrap();
    assert!((left - (1.0 - 0.5 * 0.73)).abs() < 1e-9 && gone <= 0.5 * 0.73 + 1e-9);
    robot.wait_done().unwrap();
    assert!(is_near(robot.pose().unwrap(), Pose::new(-3.0 + left, 2.0, 0.0), 1e-9, 1e-9));

    robot.straight(1.0, 0.5).unwrap();
    robot.set_speed(Twist::new(0.0, 0.5)).unwrap();
    assert!(robot.is_done().unwrap() && robot.remaining().unwrap() == 0.0);
    robot.wait(10.0).unwrap();
    assert_eq!(robot.speed().unwrap(), Twist::new(0.0, 0.5), "a speed has no end");
    robot.straight(1.0, 0.5).unwrap();
    robot.set_motor(1, 0.3).unwrap();
    robot.wait(1.0).unwrap();
    let last = [Call::SetMotor(1, 0.3), Call::Wait(1.0)];
    assert!(robot.inner().calls().ends_with(&last), "a program that turns the motors is let alone");
}

#[test]
fn clocks_and_odometry_that_fail_leave_no_robot_driving() {
    let driven = |fault: &str| {
        let fault: Fault = fault.parse().unwrap();
        let mut robot = manoeuvring(Faulty::new(MockRobot::new().with_ideal_drive(), vec![fault]));
        let told = robot.straight(1.0, 0.2).and_then(|()| robot.wait(20.0));
        (told, robot.into_inner().into_inner().ideal_pose().unwrap().x)
    };
    let (told, x) = driven("clock@1");
    assert!(told.is_ok() && (x - 1.0).abs() < 1e-9, "time that was waited for has passed: {x} m");
    let (told, x) = driven("clock=5@1");
    assert!(told.is_ok() && (x - 1.0).abs() < 0.02, "{x} m");
    let (told, x) = driven("clock=-0.5@1");
    assert!(told.unwrap_err().to_string().contains("backwards") && x < 0.3, "{x} m");
    let (told, x) = driven("lost:odometry@1");
    assert!(told.unwrap_err().kind() == ErrorKind::Disconnected && x < 0.3, "{x} m");
}

#[test]
fn a_robot_at_rest_is_asked_nothing_more() {
    let mut robot = manoeuvring(MockRobot::new().with_call_charge(0.01).with_ideal_drive());
    robot.wait(1.0).unwrap();
    robot.pose().unwrap();
    assert!(robot.is_done().unwrap() && !robot.is_stalled().unwrap());
    assert!((robot.inner().time() - 1.02).abs() < 1e-9);
}

#[test]
fn ways_that_are_none() {
    let mut robot = ideal();
    for refused in [
        robot.straight(1.0, 0.0),
        robot.straight(f64::NAN, 1.0),
        robot.turn(f64::INFINITY, 1.0),
        robot.curve(1.0, 1.0, f64::NAN),
        robot.drive_to(-1.0, 0.0, 1.0),
    ] {
        assert_eq!(refused.unwrap_err().kind(), ErrorKind::InvalidInput);
    }
    assert!(robot.inner().calls().is_empty());
    robot.straight(0.0, 1.0).unwrap();
    assert!(robot.is_done().unwrap());
    for period in [0.0, f64::NAN, f64::INFINITY] {
        let parameters = ManoeuvringParameters { period, ..ManoeuvringParameters::default() };
        assert!(Manoeuvring::new(MockRobot::new(), parameters).is_err());
    }
}
