//! Robots around robots: noise, faults, limits, coarse numbers and a dead man's switch; and the scripted
//! robot.

use roverlab::geometry::{Pose, Twist};
use roverlab::io::sim::{SimRobot, Simulation};
use roverlab::io::wrappers::{
    Deadman, Excess, Fault, Faulty, Limited, Limits, Noise, Noisy, Quantised, Traced,
};
use roverlab::io::{
    Camera, Clock, DistanceSensors, Drive, Encoders, Lidar, LidarScan, Manoeuvres, MockRobot, Motors,
    Odometry, Psd, Result, RobotIo, Script, StallDetector,
};
use roverlab::random::Stream;

use super::{Scenario, in_room, noise, note, note_truth, text};

pub(super) const SCENARIOS: &[Scenario] = &[
    Scenario::new("noisy", noisy),
    Scenario::new("faulty", faulty),
    Scenario::new("limited", limited),
    Scenario::new("quantised", quantised),
    Scenario::new("deadman", deadman),
    Scenario::new("mock", mock),
];

/// Commands and readings of every kind. Calls that fail are in the trace as well.
fn tour<R: RobotIo>(robot: R) -> Result<String> {
    let mut robot = Traced::new(robot, Vec::new()).whole_scans();
    for (linear, angular) in [(0.2, 0.0), (0.9, 1.0), (-0.3, -4.0), (0.123_456_789, 0.5)] {
        let _ = robot.set_speed(Twist::new(linear, angular));
        for _ in 0..4 {
            let _ = robot.wait(0.24);
            let _ = (robot.now(), robot.pose(), robot.speed(), robot.encoder(1), robot.is_stalled());
            let _ = (robot.distance(Psd::FRONT), robot.distance(Psd::LEFT));
        }
        let _ = (robot.scan(), robot.image());
    }
    let _ = robot.straight(0.15, 0.9);
    let _ = robot.wait_done();
    let _ = robot.drive_to(0.05, 0.1, 0.3);
    let _ = (robot.remaining(), robot.wait_done(), robot.pose());
    let _ = (robot.set_motor(1, 0.8), robot.set_motor(2, -0.437), robot.wait(0.5), robot.pose());
    text(robot)
}

/// A wrapped robot of the simulator, and what is true about it in the end.
fn wrapped<R: RobotIo>(seed: u64, wrap: impl FnOnce(SimRobot) -> Result<R>) -> Result<String> {
    let simulation = Simulation::new(&in_room(0.6, 0.5, 0.4), noise(1.0, seed))?;
    let mut log = tour(wrap(simulation.robot(0)?)?)?;
    note_truth(&mut log, &simulation.truth().robot(0)?);
    Ok(log)
}

fn noisy() -> Result<String> {
    wrapped(161, |robot| Noisy::new(robot, Noise::default(), &Stream::new(161)))
}

/// Each kind of fault, alone and together.
fn faulty() -> Result<String> {
    let mut log = String::new();
    for faults in [
        "stuck:front@1-2",
        "lost:lidar@1 late:left=0.3@0.5",
        "nan:odometry@2 jump=100,-50,10@1",
        "late:odometry=0.2@1-3 stuck:camera@0",
        "link@1-2 hang=1.5@3",
        "clock=2@1 late:all=0.4@2",
    ] {
        let faults = faults.split(' ').map(str::parse).collect::<Result<Vec<Fault>>>()?;
        note(&mut log, "faults", &faults.iter().map(ToString::to_string).collect::<Vec<_>>());
        log += &wrapped(162, |robot| Ok(Faulty::new(robot, faults)))?;
    }
    Ok(log)
}

fn limited() -> Result<String> {
    let mut log = String::new();
    for excess in [Excess::Clamp, Excess::Refuse] {
        let limits = Limits {
            linear: 0.4,
            angular: 1.5,
            linear_acceleration: 0.5,
            angular_acceleration: 3.0,
            motor: 0.5,
            excess,
        };
        log += &wrapped(163, |robot| Limited::new(robot, limits))?;
    }
    Ok(log)
}

fn quantised() -> Result<String> {
    wrapped(164, |robot| Ok(Quantised::new(robot).with_motor_scale(0.9)))
}

fn deadman() -> Result<String> {
    wrapped(165, |robot| Deadman::new(robot, 0.3))
}

/// Readings that are functions of time.
fn mock() -> Result<String> {
    let scan = |time: f64| LidarScan {
        angle_min: -1.0,
        angle_increment: 0.5,
        range_max: 5.0,
        mount: Pose::new(0.1, 0.0, 0.0),
        ranges: vec![1.0 + time, f64::INFINITY, 0.3, 5.0, 2.0],
    };
    let mut robot = MockRobot::new()
        .lenient()
        .with_call_charge(0.001)
        .with_distance(Psd::FRONT, Script::function(|time| Ok(0.5 + 0.1 * time)))
        .with_distance(Psd::LEFT, vec![0.4, 0.3, f64::INFINITY])
        .with_scan(Script::function(move |time| Ok(scan(time))))
        .with_encoder(1, Script::function(|time| Ok((1000.0 * time) as i64)))
        .with_ideal_drive();
    let mut log = tour(&mut robot)?;
    note(&mut log, "calls", &robot.calls());
    note(&mut log, "in the end", &(robot.time(), robot.ideal_pose()));
    Ok(log)
}
