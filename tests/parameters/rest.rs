use roverlab::geometry::{Aabb, Point, Pose};
use roverlab::io::MockRobot;
use roverlab::io::sim::{NoiseModel, SimOptions, Simulation};
use roverlab::io::wrappers::{Manoeuvring, ManoeuvringParameters};
use roverlab::random::Stream;
use roverlab::safety::{
    BaseStation, CliffGuard, CliffGuardParameters, Deadline, Debounce, HealthLimits, SignalLimits,
    SignalMonitor, SpeedError, Supervised, SupervisedParameters,
};
use roverlab::vision::{Hog, HogParameters};
use roverlab::world::generate::{CourseOptions, RoomOptions, obstacle_course, room};
use roverlab::world::{
    CameraSpec, CarDynamics, DriveSpec, Footprint, LidarSpec, Mast, MotorSpec, Mount, PsdSpec, RobotSpec,
    Scene, World,
};

use crate::check::{check, check_variant};

fn simulation(spec: RobotSpec, options: SimOptions) -> roverlab::io::Result<()> {
    let scene = Scene::with_robot(World::walled(2.0, 1.0), spec, Pose::new(1.0, 0.5, 0.0));
    Simulation::new(&scene, options).map(|_| ())
}

#[test]
fn the_simulator() {
    check!(SimOptions = SimOptions::default(), |p| simulation(RobotSpec::s4(), p)?,
        { BoundedFromZero: light, radio_loss; Bounded: call_duration, patience; NotNegative: time_limit; Positive: trail_interval; }
        but seed, noise, pushing, ideal_encoders);
    check!(NoiseModel = NoiseModel::real(),
        |p| simulation(RobotSpec::s4(), SimOptions { noise: p, ..SimOptions::default() })?,
        { BoundedFromZero: wheel_scale, wheel_mismatch, track, slip, range, command, shot, exposure, blur, depth, doppler, attitude, turn_rate,
            acceleration; });
}

#[test]
fn robots() {
    let s4 = RobotSpec::s4;
    check!(RobotSpec = s4(), |p| simulation(p, SimOptions::default())?, { Positive: height; NotNegative: mass, friction; }
        but name, drive, motor, footprint, mast, psds, lidar, camera, depth_sensor, dvl, inertial, compass, model, mesh, body);
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
fn drives() {
    let with = |drive| RobotSpec { drive, ..RobotSpec::car() }.validate();
    check_variant!(DriveSpec::Differential = RobotSpec::s4().drive, |p| with(p)?,
        { Positive: wheel_diameter, track, max_wheel_speed, ticks_per_turn; });
    check_variant!(DriveSpec::Ackermann = RobotSpec::car().drive, |p| with(p)?,
        { Positive: wheel_diameter, track, wheelbase, max_wheel_speed, ticks_per_turn; Bounded: max_steering; }
        but dynamics);
    check_variant!(DriveSpec::Omni = RobotSpec::omni().drive, |p| with(p)?,
        { Positive: wheel_diameter, track, wheelbase, max_wheel_speed, ticks_per_turn; });
    check!(CarDynamics = CarDynamics::default(), |p| {
            let mut spec = RobotSpec::race_car();
            if let DriveSpec::Ackermann { dynamics, .. } = &mut spec.drive {
                *dynamics = Some(p);
            }
            simulation(spec, SimOptions::default())?;
        },
        { Bounded: mass_centre, gyration, grip, stiffness, balance, brake, steering_rate; });
}

#[test]
fn outlines_and_mounts() {
    let s4 = RobotSpec::s4;
    let stands = |footprint| RobotSpec { footprint, mast: None, ..s4() }.validate();
    check_variant!(Footprint::Disc = Footprint::Disc { radius: 0.1 }, |p| stands(p)?, { Positive: radius; });
    let box_of = |low, high| Aabb { min: Point::new(low, -0.1), max: Point::new(high, 0.1) };
    for (low, high) in [(f64::NAN, 0.1), (-0.1, f64::NAN), (f64::NEG_INFINITY, 0.1), (0.1, 0.1), (0.2, 0.1)] {
        let error = stands(Footprint::Rectangle(box_of(low, high))).unwrap_err();
        assert!(error.name().ends_with("footprint: outline along x"), "{low} to {high}: {error}");
        let mast = Some(Mast { outline: box_of(low, high), top: 1.0 });
        let error = RobotSpec { mast, ..s4() }.validate().unwrap_err();
        assert!(error.name().ends_with("mast: outline along x"), "{low} to {high}: {error}");
    }
    let mast =
        Mast { outline: Aabb { min: Point::new(-0.01, -0.01), max: Point::new(0.01, 0.01) }, top: 1.0 };
    for top in [f64::NAN, f64::INFINITY, -1.0, 0.0, s4().height] {
        let error = RobotSpec { mast: Some(Mast { top, ..mast }), ..s4() }.validate().unwrap_err();
        assert!(error.name().ends_with("the mast's top"), "{top}: {error}");
    }
    assert!(RobotSpec { mast: Some(mast), ..s4() }.validate().is_ok());
    check!(Mount = Mount::default(),
        |p| RobotSpec { lidar: Some(LidarSpec { mount: p, ..LidarSpec::default() }), ..s4() }.validate()?,
        { Finite: x, y, z, roll, pitch, yaw; });
}

#[test]
fn safety() {
    let parameters = SupervisedParameters::default;
    let supervised = |parameters: SupervisedParameters| {
        Supervised::new(MockRobot::new(), BaseStation::new(1.0)?, parameters).map(|_| ())
    };
    check!(SupervisedParameters = parameters(), |p| supervised(p)?,
        { Positive: period, heartbeat, watchdog, override_threshold, gentle, standing; AnyCount: fence_debounce; }
        but fence, speed_error, health);
    check!(SpeedError = SpeedError::default(), |p| supervised(SupervisedParameters { speed_error: p, ..parameters() })?,
        { NotNegative: share, offset; });
    check!(HealthLimits = HealthLimits::default(), |p| supervised(SupervisedParameters { health: p, ..parameters() })?,
        { Positive: acceleration, speed_step, age; Count: repeats; });
    let spec = RobotSpec::s4();
    check!(CliffGuardParameters = CliffGuardParameters::of(&spec), |p| CliffGuard::new(MockRobot::new(), &spec, p).map(|_| ())?,
        { Positive: drop; Bounded: speed, creep, period; } but stopping);
    check!(SignalLimits = SignalLimits { age: 0.2, rate: 2.0, step: 0.1, repeats: 3 }, |p| SignalMonitor::new(p)?,
        { Positive: age; NotNegative: rate, step; Count: repeats; });
    for limit in [f64::NAN, f64::INFINITY, -1.0, 0.0] {
        assert_eq!(Deadline::new(limit).unwrap_err().name(), "limit of a deadline", "{limit}");
        assert_eq!(BaseStation::new(limit).unwrap_err().name(), "limit of a deadline", "{limit}");
    }
    // However often something has to be seen, once is enough for none and for one.
    for needed in [0, 1, u16::MAX] {
        assert_eq!(Debounce::new(needed).update(true), needed <= 1, "{needed}");
    }
}

#[test]
fn manoeuvres() {
    check!(ManoeuvringParameters = ManoeuvringParameters::default(), |p| Manoeuvring::new(MockRobot::new(), p)?,
        { Positive: period; NotNegative: lag; });
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
    use roverlab::io::sim::starman::{BodyPlan, LimbPlan, Starman, StarmanSpec};
    check!(StarmanSpec = StarmanSpec::book(), |p| Starman::new(&p)?,
        { Positive: body_radius, body_mass, limb_length, limb_radius, limb_mass, friction, servo_speed, servo_torque;
          Bounded: servo_range, time_step; });
    let body = |limb: LimbPlan| BodyPlan { limbs: vec![limb], ..BodyPlan::default() };
    check!(BodyPlan = body(LimbPlan::default()), |p| Starman::of(&p)?,
        { BoundedFromZero: length; Bounded: radius, mass, friction, servo_speed, servo_torque, time_step; } but limbs);
    check!(LimbPlan = LimbPlan::default(), |p| Starman::of(&body(p))?,
        { AroundZero: hinge, rest; Bounded: length, radius, mass, range; } but parent);
}
