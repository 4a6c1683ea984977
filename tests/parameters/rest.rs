use roverlab::geometry::Pose;
use roverlab::io::MockRobot;
use roverlab::io::sim::{NoiseModel, SimOptions, Simulation};
use roverlab::random::Stream;
use roverlab::safety::{BaseStation, HealthLimits, SpeedError, Supervised, SupervisedParameters};
use roverlab::vision::{Hog, HogParameters};
use roverlab::world::generate::{CourseOptions, RoomOptions, obstacle_course, room};
use roverlab::world::{CameraSpec, LidarSpec, MotorSpec, PsdSpec, RobotSpec, Scene, World};

use crate::check::check;

fn simulation(spec: RobotSpec, options: SimOptions) -> roverlab::io::Result<()> {
    let scene = Scene::with_robot(World::walled(2.0, 1.0), spec, Pose::new(1.0, 0.5, 0.0));
    Simulation::new(&scene, options).map(|_| ())
}

#[test]
fn the_simulator() {
    check!(SimOptions = SimOptions::default(), |p| simulation(RobotSpec::s4(), p)?,
        { BoundedFromZero: light; Bounded: call_duration; NotNegative: time_limit; Positive: trail_interval; }
        but seed, noise, pushing, ideal_encoders);
    check!(NoiseModel = NoiseModel::real(),
        |p| simulation(RobotSpec::s4(), SimOptions { noise: p, ..SimOptions::default() })?,
        { BoundedFromZero: wheel_scale, wheel_mismatch, track, slip, range, command, shot, exposure, blur; });
}

#[test]
fn robots() {
    let s4 = RobotSpec::s4;
    check!(RobotSpec = s4(), |p| simulation(p, SimOptions::default())?, { Positive: height; NotNegative: mass; }
        but name, drive, motor, footprint, mast, psds, lidar, camera, model, body);
    check!(MotorSpec = MotorSpec::default(), |p| simulation(RobotSpec { motor: p, ..s4() }, SimOptions::default())?,
        { NotNegative: time_constant; Positive: max_acceleration; });
    check!(PsdSpec = s4().psds[0].clone(),
        |p| simulation(RobotSpec { psds: vec![p], ..s4() }, SimOptions::default())?,
        { Positive: max_range; } but id, name, mount);
    check!(LidarSpec = LidarSpec::default(),
        |p| simulation(RobotSpec { lidar: Some(p), ..s4() }, SimOptions::default())?,
        { Bounded: field_of_view, points; Finite: tilt; Positive: max_range; } but mount);
    check!(CameraSpec = s4().camera.unwrap(),
        |p| simulation(RobotSpec { camera: Some(p), ..s4() }, SimOptions::default())?,
        { Bounded: field_of_view; Finite: tilt; NotNegative: max_pan, max_tilt; } but mount, fisheye);
}

#[test]
fn safety() {
    let parameters = SupervisedParameters::default;
    let supervised = |parameters: SupervisedParameters| {
        Supervised::new(MockRobot::new(), BaseStation::new(1.0), parameters).map(|_| ())
    };
    check!(SupervisedParameters = parameters(), |p| supervised(p)?,
        { Positive: period, heartbeat, watchdog, override_threshold, gentle, standing; AnyCount: fence_debounce; }
        but fence, speed_error, health);
    check!(SpeedError = SpeedError::default(), |p| supervised(SupervisedParameters { speed_error: p, ..parameters() })?,
        { NotNegative: share, offset; });
    check!(HealthLimits = HealthLimits::default(), |p| supervised(SupervisedParameters { health: p, ..parameters() })?,
        { Positive: acceleration, speed_step, age; Count: repeats; });
}

#[test]
fn worlds_and_pictures() {
    check!(CourseOptions = CourseOptions::default(), |p| obstacle_course(&mut Stream::new(1), &p)?,
        { Bounded: size, min_corridor, robot_radius; CountRange: obstacles; CountUpTo: objects;
          BoundedFromZero: unreachable_share; });
    check!(RoomOptions = RoomOptions::default(), |p| room(&mut Stream::new(1), &p)?,
        { Bounded: reach, corners, least_radius, distance; });
    check!(HogParameters = HogParameters::default(), |p| Hog::new(p)?, { Bounded: cell, block, bins; });
}

#[cfg(feature = "physics")]
#[test]
fn a_walking_robot() {
    use roverlab::io::sim::starman::{Starman, StarmanSpec};
    check!(StarmanSpec = StarmanSpec::book(), |p| Starman::new(&p)?,
        { Positive: body_radius, body_mass, limb_length, limb_radius, limb_mass, friction, servo_speed, servo_torque;
          Bounded: servo_range, time_step; });
}
