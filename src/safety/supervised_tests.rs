use super::*;
use crate::geometry::{Point, Pose, Twist, math};
use crate::io::control;
use crate::io::sim::{SimOptions, Simulation, TICK};
use crate::io::wrappers::{Fault, Faulty};
use crate::io::{
    Camera, Clock, Display, DistanceSensors, Drive, ErrorKind, Key, Keys, Lidar, LidarScan, Manoeuvres,
    MockRobot, Motors, Odometry, Psd, Servos,
};
use crate::kinematics::PlanarMotion;
use crate::race::GapDriver;
use crate::world::{RobotSpec, Scene, World};

/// A station that arms and starts at once and sends a heartbeat; `change` adds further inputs.
pub(super) fn station(change: impl Fn(f64, &mut Panel)) -> impl FnMut(f64, Heartbeat) -> Panel {
    move |now, heartbeat| {
        let requests = Requests { arm: now > 0.03, start: now > 0.07, disarm: false };
        let mut panel = Panel { heartbeat: Some(heartbeat.count), requests, ..Panel::default() };
        change(now, &mut panel);
        panel
    }
}

/// Drives at 0.5 m/s for `seconds`, with a command every 0.1 s.
pub(super) fn drive<R: Clock + Drive + Odometry, S: Station>(car: &mut Supervised<R, S>, seconds: f64) {
    for _ in 0..(10.0 * seconds).round() as usize {
        let _ = car.set_speed(Twist::new(0.5, 0.1));
        let _ = car.wait(0.1);
    }
}

pub(super) fn mock() -> MockRobot {
    MockRobot::new().with_ideal_drive()
}

/// A car with a base station, armed and started.
pub(super) fn stationed() -> Supervised<MockRobot, BaseStation> {
    let mut car =
        Supervised::new(mock(), BaseStation::new(0.5).unwrap(), SupervisedParameters::default()).unwrap();
    drive(&mut car, 0.1);
    car.station_mut().panel.requests.arm = true;
    drive(&mut car, 0.2);
    car.station_mut().panel.requests.start = true;
    drive(&mut car, 1.0);
    assert_eq!(car.state(), SafetyState::Auto);
    car
}

#[test]
fn nothing_drives_before_it_is_armed_and_started() {
    let never = |_: f64, heartbeat: Heartbeat| Panel { heartbeat: Some(heartbeat.count), ..Panel::default() };
    let mut car = Supervised::new(mock(), never, SupervisedParameters::default()).unwrap();
    drive(&mut car, 1.0);
    assert_eq!((car.state(), car.pose().unwrap()), (SafetyState::Manual, Pose::default()));
    assert!(car.drive_by_hand(Twist::new(0.2, 0.0)).unwrap(), "a person drives");
    car.wait(0.1).unwrap();
    assert!(car.pose().unwrap().x > 0.0);
}

#[test]
fn every_cause_stops_it_within_a_period() {
    type Change = fn(f64, &mut Panel);
    let causes: [(Change, SafetyState, Causes); 4] = [
        (
            |now, panel| panel.emergency_button = now > 1.0,
            SafetyState::EmergencyStop,
            Causes::EMERGENCY_BUTTON,
        ),
        (|now, panel| panel.remote_stop = now > 1.0, SafetyState::EmergencyStop, Causes::REMOTE_STOP),
        (
            |now, panel| panel.heartbeat = panel.heartbeat.filter(|_| now < 0.5),
            SafetyState::SafeStop,
            Causes::HEARTBEAT_LOST,
        ),
        (
            |now, panel| panel.remote_stop = (1.0..1.05).contains(&now),
            SafetyState::EmergencyStop,
            Causes::REMOTE_STOP,
        ),
    ];
    for (change, state, cause) in causes {
        let mut car = Supervised::new(mock(), station(change), SupervisedParameters::default()).unwrap();
        drive(&mut car, 0.9);
        assert_eq!(car.state(), SafetyState::Auto);
        drive(&mut car, 2.0);
        let stop = car.last_stop().unwrap();
        assert!(stop.state == state && stop.causes.has(cause), "{stop:?}");
        assert!(stop.time <= 1.0 + 0.02 + 1e-6, "{stop:?}");
        assert_eq!((car.state(), car.speed().unwrap().linear.abs() < 1e-3), (state, true));
        let there = car.pose().unwrap();
        drive(&mut car, 1.0);
        assert!((car.pose().unwrap().position() - there.position()).norm() < 1e-3, "it stands");
    }
}

#[test]
fn the_driver_takes_over_by_pedals_and_wheel() {
    type Change = fn(f64, &mut Panel);
    let touches: [Change; 5] = [
        |now, panel| panel.accelerator = if now > 1.0 { 0.5 } else { 0.05 },
        |now, panel| panel.brake = if now > 1.0 { 0.2 } else { 0.0 },
        |now, panel| panel.steering_force = if now > 1.0 { -0.3 } else { 0.02 },
        |now, panel| panel.disengage = now > 1.0,
        |now, panel| panel.brake = if now > 1.0 { f64::NAN } else { 0.0 },
    ];
    for touch in touches {
        let mut car = Supervised::new(mock(), station(touch), SupervisedParameters::default()).unwrap();
        drive(&mut car, 1.5);
        assert_eq!(car.state(), SafetyState::Manual);
        assert!(car.drive_by_hand(Twist::new(0.1, 0.0)).unwrap());
    }
}

#[test]
fn the_fence_holds_and_is_not_jumpy() {
    let fence = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| Point::new(x, y)).to_vec();
    let parameters = SupervisedParameters { fence, ..SupervisedParameters::default() };
    let mut car = Supervised::new(mock(), station(|_, _| {}), parameters.clone()).unwrap();
    drive(&mut car, 8.0);
    let stop = car.last_stop().unwrap();
    assert!(stop.causes.has(Causes::OUTSIDE_FENCE) && stop.state == SafetyState::SafeStop);
    let bound = parameters.stopping(0.0, f64::INFINITY).distance(0.5) + 0.5 * 0.02 * 4.0;
    let pose = car.pose().unwrap();
    assert!(pose.x.max(pose.y) < 1.0 + bound, "{pose:?} beyond {bound}");
}

#[test]
fn a_program_that_hangs_is_stopped() {
    let mut car = Supervised::new(mock(), station(|_, _| {}), SupervisedParameters::default()).unwrap();
    drive(&mut car, 1.0);
    car.wait(5.0).unwrap();
    let stop = car.last_stop().unwrap();
    assert!(stop.causes.has(Causes::WATCHDOG) && stop.time < 1.0 + 0.4 + 0.05);
    assert_eq!(car.state(), SafetyState::SafeStop);
}

#[test]
fn a_program_that_lives_steers_while_it_brakes_but_never_drives() {
    let silent: fn(f64, &mut Panel) = |now, panel| panel.heartbeat = panel.heartbeat.filter(|_| now < 1.0);
    let ordered: fn(f64, &mut Panel) = |now, panel| panel.remote_stop = now > 1.0;
    for (change, steers) in [(silent, true), (ordered, false)] {
        let parameters = SupervisedParameters::default();
        let mut car = Supervised::new(mock(), station(change), parameters.clone()).unwrap();
        let mut from = Pose::default();
        for _ in 0..200 {
            if car.last_stop().is_none() {
                from = car.pose().unwrap();
            }
            let turn = if car.last_stop().is_some() { 2.0 } else { 0.0 };
            car.set_speed(Twist::new(0.5, turn)).unwrap();
            car.wait(0.02).unwrap();
        }
        let pose = car.pose().unwrap();
        assert_eq!(pose.heading > 0.01, steers, "{pose:?}");
        let bound = parameters.stopping(0.0, f64::INFINITY).distance(0.5);
        assert!((pose.position() - from.position()).norm() < bound && car.speed().unwrap() == Twist::STOP);
    }
}

#[test]
fn the_base_station_hears_and_is_heard() {
    let mut car = stationed();
    car.station_mut().connect(false);
    drive(&mut car, 1.0);
    assert_eq!(car.state(), SafetyState::SafeStop);
    // The link is back. The station has missed the car as well and orders a stop.
    car.station_mut().connect(true);
    drive(&mut car, 0.2);
    assert_eq!(car.state(), SafetyState::EmergencyStop);
    car.station_mut().take_back();
    drive(&mut car, 0.5);
    assert_eq!(car.state(), SafetyState::EmergencyStop, "only arming leaves it");
    car.station_mut().panel.requests = Requests::default();
    drive(&mut car, 0.1);
    car.station_mut().panel.requests.arm = true;
    drive(&mut car, 0.1);
    assert_eq!(car.state(), SafetyState::Armed);
}

/// Eight faults of the simulator.
const FAULTS: [&str; 8] = [
    "stuck:odometry@3",
    "lost:odometry@3",
    "nan:odometry@3",
    "jump=400,200,40@3",
    "late:odometry=1@3",
    "link@3",
    "hang=2@3",
    "clock@3",
];

#[test]
fn a_robot_in_the_simulator_stands_after_every_fault() {
    for (index, text) in FAULTS.iter().enumerate() {
        let scene = Scene::with_robot(World::walled(8.0, 8.0), RobotSpec::s4(), Pose::new(2.0, 4.0, 0.0));
        let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, index as u64)).unwrap();
        let robot = Faulty::new(simulation.robot(0).unwrap(), vec![text.parse::<Fault>().unwrap()]);
        let mut car = Supervised::new(robot, station(|_, _| {}), SupervisedParameters::default()).unwrap();
        for _ in 0..60 {
            let _ = car.set_speed(Twist::new(0.3, 0.2));
            let _ = car.wait(0.1);
        }
        let stop = car.last_stop();
        assert!(stop.is_some(), "{text}: no stop");
        let before = simulation.truth().pose(0).unwrap();
        for _ in 0..10 {
            let _ = car.wait(0.1);
        }
        let way = simulation.truth().pose(0).unwrap().distance_to(before.position());
        // Without a link no command reaches the wheels; the watchdog on board has to stop the car.
        assert!(way < 1e-3 || text.starts_with("link"), "{text}: goes on {way} m after {stop:?}");
    }
}

/// A racing car among cones.
fn race(cones: &[Point], noise: f64) -> Simulation {
    use crate::race::{Cone, ConeTrack};
    let cones = cones.iter().copied().map(Cone::unknown).collect();
    let scene = ConeTrack { cones, ..ConeTrack::default() }.scene(&[Pose::default()]);
    Simulation::new(&scene, SimOptions::with_noise(noise, 1)).unwrap()
}

/// True speed of a racing car, measured over one tick (m/s).
fn speed(race: &Simulation, car: &mut impl Clock) -> f64 {
    let before = race.truth().robot(0).unwrap().path_length;
    let _ = car.wait(TICK);
    (race.truth().robot(0).unwrap().path_length - before) / TICK
}

#[test]
fn a_racing_car_brakes_on_its_line() {
    // Cones beside the road give the lidar something to see.
    let cones: Vec<Point> =
        (0..40).flat_map(|i| [-3.0, 3.0].map(|y| Point::new(5.0 * f64::from(i), y))).collect();
    for text in ["stuck:lidar@4", "lost:lidar@4", "nan:lidar@4", "nan:odometry@4", "clock@4"] {
        let simulation = race(&cones, 1.0);
        let race = simulation.truth();
        let parameters = SupervisedParameters::default();
        let bound = parameters.stopping(1.0 / 12.0, 11.0).distance(10.1);
        let robot = Faulty::new(simulation.robot(0).unwrap(), vec![text.parse::<Fault>().unwrap()]);
        let mut car = Supervised::new(robot, station(|_, _| {}), parameters).unwrap();
        let mut scan = LidarScan::default();
        let mut from = Pose::default();
        while car.last_stop().is_none() {
            assert!(race.time() < 8.0, "{text}: no stop");
            from = race.robot(0).unwrap().pose;
            let _ = car.scan_into(&mut scan);
            let _ = car.set_speed(Twist::new(10.0, 0.0));
            let _ = car.wait(0.02);
        }
        for _ in 0..300 {
            let _ = car.set_speed(Twist::new(10.0, 0.0));
            let _ = car.wait(0.02);
        }
        let stood = race.robot(0).unwrap();
        let _ = car.wait(1.0);
        let way = stood.pose.distance_to(from.position());
        assert!(way > 5.0 && way < bound, "{text}: {way} of {bound}");
        assert!(race.robot(0).unwrap().path_length - stood.path_length < 1e-3, "{text}: it stands");
    }
}

#[test]
fn programs_run_supervised_as_they_are() {
    let cones: Vec<Point> =
        (0..30).flat_map(|i| [-1.8, 1.8].map(|y| Point::new(3.0 * f64::from(i), y))).collect();
    let race = race(&cones, 1.0);
    let mut car = Supervised::new(
        race.robot(0).unwrap(),
        station(|now, panel| panel.remote_stop = now > 10.0),
        SupervisedParameters::default(),
    )
    .unwrap();
    car.wait(0.2).unwrap();
    control::run(&mut car, &mut GapDriver::default(), 15.0, |_, _, _| {}).unwrap();
    assert_eq!(car.state(), SafetyState::EmergencyStop);
    let x = race.truth().pose(0).unwrap().x;
    assert!(speed(&race, &mut car) < 0.01 && x > 15.0 && x < 40.0, "{x}");
}

/// NaN and infinite commands do not block the brakes, and no wait is endless.
#[test]
fn a_program_that_tells_nonsense_is_stopped_all_the_same() {
    for angular in [f64::NAN, f64::INFINITY, 1e308] {
        let ordered = station(|now, panel| panel.emergency_button = now > 1.0);
        let race = race(&[], 1.0);
        let mut car =
            Supervised::new(race.robot(0).unwrap(), ordered, SupervisedParameters::default()).unwrap();
        drive(&mut car, 0.9);
        let _ = car.set_speed(Twist::new(0.01, angular));
        assert!(car.wait(f64::INFINITY).is_err() && car.wait(f64::NAN).is_err());
        for seconds in [1e300, 86_401.0] {
            assert_eq!(car.wait(seconds).unwrap_err().kind(), ErrorKind::InvalidInput, "{seconds}");
        }
        car.wait(2.0).unwrap();
        assert_eq!(car.state(), SafetyState::EmergencyStop);
        assert!(speed(&race, &mut car) < 1e-3, "{angular}: {:?}", race.truth().robot(0));
    }
}

/// Frozen odometry reports too high a speed while the program brakes: the brakes must not be released.
#[test]
fn brakes_that_are_on_stay_on() {
    let simulation = race(&[], 0.0);
    let race = simulation.truth();
    let parameters = SupervisedParameters::default();
    let model = parameters.stopping(1.0 / 12.0, 11.0);
    let faults = vec!["stuck:odometry@4.2".parse::<Fault>().unwrap()];
    let robot = Faulty::new(simulation.robot(0).unwrap(), faults);
    let mut car = Supervised::new(robot, station(|_, _| {}), parameters).unwrap();
    let (mut metres, mut began) = (0.0, None);
    while race.time() < 12.0 {
        let speed = if race.time() < 4.0 { 20.0 } else { 2.0 };
        let _ = car.set_speed(Twist::new(speed, 0.0));
        let _ = car.wait(0.02);
        let now = race.robot(0).unwrap().path_length;
        if car.last_stop().is_some() {
            began = began.or(Some((metres, (now - metres) / 0.02)));
        }
        metres = now;
    }
    let (from, speed) = began.unwrap();
    assert!(speed > 5.0 && car.last_stop().unwrap().speed > speed + 0.5, "{:?}", car.last_stop());
    let (way, bound) = (metres - from, model.distance(speed));
    assert!(way < bound, "{way} of {bound}");
}

/// A program that drives by motors and servos is braked on its curve, too.
#[test]
fn the_bend_of_a_servo_is_kept() {
    let race = race(&[], 0.0);
    let ordered = station(|now, panel| panel.emergency_button = now > 3.0);
    let mut car = Supervised::new(race.robot(0).unwrap(), ordered, SupervisedParameters::default()).unwrap();
    car.wait(0.2).unwrap();
    while car.state() != SafetyState::EmergencyStop {
        assert!(race.truth().time() < 4.0);
        car.set_motor(1, 0.1).unwrap();
        car.set_servo(1, -0.5).unwrap();
        car.wait(0.1).unwrap();
    }
    assert_eq!(car.state(), SafetyState::EmergencyStop);
    let before = race.truth().pose(0).unwrap();
    let _ = car.wait(0.02);
    let motion = PlanarMotion::between(before, race.truth().pose(0).unwrap());
    let steering = math::atan(1.55 * motion.angle / motion.forward);
    assert!(motion.forward > 0.2 * 0.02 && (steering - 0.3).abs() < 0.05, "{motion:?}: {steering}");
}

/// A program that never waits is checked as well, whatever calls it makes.
#[test]
fn reading_takes_time_in_which_it_is_looked_at() {
    let scene = Scene::with_robot(World::walled(8.0, 8.0), RobotSpec::s4(), Pose::new(2.0, 4.0, 0.0));
    let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 7)).unwrap();
    let ordered = station(|now, panel| panel.emergency_button = now > 0.5);
    let mut car =
        Supervised::new(simulation.robot(0).unwrap(), ordered, SupervisedParameters::default()).unwrap();
    car.wait(0.1).unwrap();
    car.straight(2.0, 0.3).unwrap();
    while car.peek_time().unwrap() < 1.5 {
        car.distance(Psd::FRONT).unwrap();
    }
    let stop = car.last_stop().unwrap();
    assert!(stop.causes.has(Causes::EMERGENCY_BUTTON) && stop.time < 0.5 + 0.02 + 1e-3, "{stop:?}");
    let there = simulation.truth().pose(0).unwrap();
    while car.peek_time().unwrap() < 2.0 {
        car.set_menu(["", "", "", "END"]).unwrap();
    }
    assert!(simulation.truth().pose(0).unwrap().distance_to(there.position()) < 1e-3, "it stands");
}

/// So is one that waits for a key.
#[test]
fn waiting_for_a_key_takes_time_in_which_it_is_looked_at() {
    let scene = Scene::with_robot(World::walled(8.0, 8.0), RobotSpec::s4(), Pose::new(2.0, 4.0, 0.0));
    let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 7)).unwrap();
    simulation.press_key(0, 3.0, Key::Key2).unwrap();
    let ordered = station(|now, panel| panel.emergency_button = now > 1.0);
    let mut car =
        Supervised::new(simulation.robot(0).unwrap(), ordered, SupervisedParameters::default()).unwrap();
    car.wait(0.1).unwrap();
    car.straight(2.0, 0.3).unwrap();
    assert_eq!(car.wait_key().unwrap(), Key::Key2);
    let stop = car.last_stop().unwrap();
    assert!(stop.causes == Causes::EMERGENCY_BUTTON && stop.time < 1.0 + 0.02 + 1e-3, "{stop:?}");
    assert!(simulation.truth().pose(0).unwrap().x < 2.45 && car.peek_time().unwrap() < 3.1);
}

/// Late readings are detected while their delay builds up.
#[test]
fn late_readings_stop_it() {
    for text in ["late:front=0.5@3", "late:lidar=0.5@3", "late:camera=0.5@3"] {
        let scene = Scene::with_robot(World::walled(8.0, 8.0), RobotSpec::s4(), Pose::new(2.0, 4.0, 0.0));
        let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 7)).unwrap();
        let robot = Faulty::new(simulation.robot(0).unwrap(), vec![text.parse::<Fault>().unwrap()]);
        let mut car = Supervised::new(robot, station(|_, _| {}), SupervisedParameters::default()).unwrap();
        let (mut scan, mut image) = (LidarScan::default(), image::RgbImage::default());
        while car.last_stop().is_none() && car.peek_time().unwrap() < 5.0 {
            let _ = car.set_speed(Twist::new(0.3, 0.2));
            let _ = (car.distance(Psd::FRONT), car.scan_into(&mut scan), car.image_into(&mut image));
            let _ = car.wait(0.05);
        }
        let stop = car.last_stop();
        assert!(
            stop.is_some_and(|stop| stop.causes.has(Causes::SENSOR) && stop.time < 3.5),
            "{text}: {stop:?}"
        );
    }
}

#[test]
fn a_pose_that_is_set_all_the_time_hides_no_jump() {
    for pose in [Pose::new(f64::NAN, 0.0, 0.0), Pose::default()] {
        let scene = Scene::with_robot(World::walled(8.0, 8.0), RobotSpec::s4(), Pose::new(2.0, 4.0, 0.0));
        let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 7)).unwrap();
        let faults = vec!["jump=400,200,40@3".parse::<Fault>().unwrap()];
        let robot = Faulty::new(simulation.robot(0).unwrap(), faults);
        let mut car = Supervised::new(robot, station(|_, _| {}), SupervisedParameters::default()).unwrap();
        for _ in 0..200 {
            let _ = car.set_speed(Twist::new(0.3, 0.0));
            if car.peek_time().unwrap() < 2.9 || !pose.is_finite() {
                let _ = car.set_pose(pose);
            }
            let _ = car.wait(0.02);
        }
        assert!(car.last_stop().is_some_and(|stop| stop.causes.has(Causes::SENSOR)), "{:?}", car.last_stop());
    }
}

#[test]
fn parameters_that_are_none() {
    let parameters = SupervisedParameters { watchdog: 0.0, ..SupervisedParameters::default() };
    let error = Supervised::new(mock(), station(|_, _| {}), parameters).err().unwrap();
    assert_eq!(error.to_string(), "watchdog is 0; expected a positive, finite number");
    let parameters = SupervisedParameters { period: 1e-9, ..SupervisedParameters::default() };
    let error = Supervised::new(mock(), station(|_, _| {}), parameters).err().unwrap();
    assert_eq!(error.to_string(), "control period is 0.000000001; expected at least 0.0001 s");
}
