//! Tests of what the documentation of `Supervised` claims: reaction times, trust in sensors, stopping
//! distances.

use super::supervised_tests::{drive, mock, station, stationed};
use super::*;
use crate::geometry::{Point, Pose, Twist};
use crate::io::sim::{SimOptions, Simulation};
use crate::io::wrappers::{Fault, Faulty};
use crate::io::{
    Clock, DistanceSensors, Drive, Lidar, LidarScan, Manoeuvres, MockRobot, Motors, Odometry, Psd, Script,
};
use crate::world::{DriveSpec, RobotSpec, Scene, World};

/// A supervised mock robot with an injected fault.
type FaultyMock<S> = Supervised<Faulty<MockRobot>, S>;

/// Drives at 0.5 m/s, commanded every 5 ms, until the safety system first commands a lower speed. Returns the
/// time of that command (s) and the pose.
fn brakes<S: Station>(car: &mut FaultyMock<S>) -> Option<(f64, Pose)> {
    let seen = |car: &FaultyMock<S>| (car.inner().inner().time(), car.inner().inner().ideal_pose().unwrap());
    let mut drove = false;
    while car.inner().inner().time() < 4.0 {
        let (before, from) = seen(car);
        let _ = car.set_speed(Twist::new(0.5, 0.0));
        let _ = car.wait(0.005);
        let (time, pose) = seen(car);
        let slow = pose.x - from.x < 0.5 * (time - before) - 1e-6;
        if drove && slow {
            return Some((before, from));
        }
        drove |= !slow;
    }
    None
}

fn faulty(fault: &str) -> Faulty<MockRobot> {
    Faulty::new(mock(), vec![fault.parse::<Fault>().unwrap()])
}

/// The safety system brakes within one control period of the moment at which a fault is noticeable.
#[test]
fn wheels_are_told_within_a_period_of_what_can_be_noticed() {
    type Change = fn(f64, &mut Panel);
    let parameters = SupervisedParameters::default();
    let period = parameters.period;
    let panels: [(&str, Change, f64, Causes); 7] = [
        ("button", |now, panel| panel.emergency_button = now >= 1.0, 0.0, Causes::EMERGENCY_BUTTON),
        ("remote", |now, panel| panel.remote_stop = now >= 1.0, 0.0, Causes::REMOTE_STOP),
        (
            "accelerator",
            |now, panel| panel.accelerator = if now >= 1.0 { 0.5 } else { 0.0 },
            0.0,
            Causes::DRIVER,
        ),
        ("brake", |now, panel| panel.brake = if now >= 1.0 { 0.5 } else { 0.0 }, 0.0, Causes::DRIVER),
        (
            "wheel",
            |now, panel| panel.steering_force = if now >= 1.0 { -0.5 } else { 0.0 },
            0.0,
            Causes::DRIVER,
        ),
        ("disengage", |now, panel| panel.disengage = now >= 1.0, 0.0, Causes::DRIVER),
        (
            "heartbeat",
            |now, panel| panel.heartbeat = panel.heartbeat.filter(|_| now < 1.0),
            parameters.heartbeat,
            Causes::HEARTBEAT_LOST,
        ),
    ];
    for (name, change, noticed, cause) in panels {
        let robot = Faulty::new(mock(), Vec::new());
        let mut car = Supervised::new(robot, station(change), parameters.clone()).unwrap();
        let (time, _) = brakes(&mut car).unwrap_or_else(|| panic!("{name}: no stop"));
        assert!(car.causes().has(cause) && time >= 1.0 - period, "{name}: {time} {:?}", car.causes());
        assert!(time <= 1.0 + noticed + period + 1e-6, "{name}: {time}");
    }
    let frozen = f64::from(parameters.health.repeats) * period;
    for (fault, noticed, cause) in [
        ("lost:odometry@1", 0.0, Causes::SENSOR),
        ("nan:odometry@1", 0.0, Causes::SENSOR),
        ("jump=400,200,40@1", 0.0, Causes::SENSOR),
        // The first late reading is old enough to count as a jump.
        ("late:odometry=0.3@1", 0.0, Causes::SENSOR),
        ("stuck:odometry@1", frozen, Causes::SENSOR),
        ("clock@1", period, Causes::CLOCK),
        ("clock=-2@1", 0.0, Causes::CLOCK),
    ] {
        let mut car = Supervised::new(faulty(fault), station(|_, _| {}), parameters.clone()).unwrap();
        let (time, _) = brakes(&mut car).unwrap_or_else(|| panic!("{fault}: no stop"));
        assert!(car.causes().has(cause) && time >= 1.0 - period, "{fault}: {time} {:?}", car.causes());
        assert!(time <= 1.0 + noticed + period + 1e-6, "{fault}: {time}");
    }
}

/// A single position outside the fence does not count; the reaction comes right after the debounce count.
#[test]
fn wheels_are_told_within_a_period_of_the_debounced_fence() {
    let fence = [(-1.0, -1.0), (0.7, -1.0), (0.7, 1.0), (-1.0, 1.0)].map(|(x, y)| Point::new(x, y)).to_vec();
    let parameters = SupervisedParameters { fence, ..SupervisedParameters::default() };
    let robot = Faulty::new(mock(), Vec::new());
    let mut car = Supervised::new(robot, station(|_, _| {}), parameters.clone()).unwrap();
    let (_, pose) = brakes(&mut car).unwrap();
    let noticed = f64::from(parameters.fence_debounce - 1) * parameters.period;
    let beyond = (pose.x - 0.7) / 0.5;
    assert!(beyond > noticed - 1e-6 && beyond <= noticed + parameters.period + 1e-6, "{beyond}");
}

/// After the link is lost, no command reaches the car. The safety system notices within one control period;
/// the car's own watchdog stops it.
#[test]
fn a_link_that_is_gone_is_noticed_within_a_period() {
    let mut car =
        Supervised::new(faulty("link@1"), station(|_, _| {}), SupervisedParameters::default()).unwrap();
    drive(&mut car, 3.0);
    let stop = car.last_stop().unwrap();
    assert!(stop.causes.has(Causes::LINK) && stop.time <= 1.0 + 0.02 + 1e-6, "{stop:?}");
}

type Exchange = Box<dyn FnMut(f64, Heartbeat) -> Panel>;

/// Time at which a program that starts moving and then only reads sensors is stopped (s).
fn stopped_reading(begin: impl FnOnce(&mut Supervised<MockRobot, Exchange>)) -> Option<f64> {
    let other_end: Exchange = Box::new(station(|_, _| {}));
    let robot = mock().with_distance(Psd::FRONT, Script::function(|time| Ok(2.0 - 0.1 * time)));
    let mut car = Supervised::new(robot, other_end, SupervisedParameters::default()).unwrap();
    car.wait(0.2).unwrap();
    begin(&mut car);
    for _ in 0..100 {
        let _ = (car.distance(Psd::FRONT), car.pose(), car.remaining(), car.wait(0.02));
    }
    car.last_stop().map(|stop| {
        assert_eq!((stop.state, stop.causes), (SafetyState::SafeStop, Causes::WATCHDOG));
        stop.time
    })
}

/// Sensor reads alone do not keep a program alive, unless its last command has an end or nothing moves.
#[test]
fn a_program_that_only_reads_is_stopped_while_it_drives() {
    let speed = stopped_reading(|car| car.set_speed(Twist::new(0.3, 0.0)).unwrap()).unwrap();
    assert!(speed > 0.55 && speed <= 0.2 + 0.4 + 0.02 + 1e-6, "{speed}");
    let turns = stopped_reading(|car| car.set_speed(Twist::new(0.0, 0.3)).unwrap()).unwrap();
    assert!(turns <= 0.2 + 0.4 + 0.02 + 1e-6, "{turns}");
    let motor = stopped_reading(|car| {
        car.set_motor(1, 0.3).unwrap();
        car.set_motor(2, 0.3).unwrap();
        car.set_motor(2, 0.0).unwrap();
    })
    .unwrap();
    assert!(motor <= 0.2 + 0.4 + 0.02 + 1e-6, "{motor}");
    assert_eq!(stopped_reading(|car| car.straight(0.6, 0.3).unwrap()), None, "a way with an end");
    assert_eq!(stopped_reading(|car| car.set_speed(Twist::STOP).unwrap()), None, "it stands");
    assert_eq!(stopped_reading(|_| {}), None, "it has not begun");
    assert_eq!(stopped_reading(|car| car.wait(5.0).unwrap()), None, "it waits as it asked for");
    assert_eq!(
        stopped_reading(|car| {
            car.set_motor(1, 0.3).unwrap();
            car.set_motor(1, 0.0).unwrap();
        }),
        None,
        "the motor is off again"
    );
}

/// Drives for one second while the station polls ten times on its own clock, offset by 100 s. Returns whether
/// the station orders a stop.
fn drive_looked_at(car: &mut Supervised<MockRobot, BaseStation>) -> bool {
    for _ in 0..10 {
        drive(car, 0.1);
        let now = car.inner().time() + 100.0;
        car.station_mut().look(now);
    }
    let now = car.inner().time() + 100.0;
    car.station_mut().look(now)
}

#[test]
fn each_direction_of_the_heartbeat_is_missed_by_its_listener() {
    // The vehicle receives nothing: it stops by itself, and the station does not notice.
    let mut car = stationed();
    assert!(!drive_looked_at(&mut car));
    car.station_mut().connect_each(true, false);
    assert!(!drive_looked_at(&mut car));
    assert!(car.state() == SafetyState::SafeStop && car.causes() == Causes::HEARTBEAT_LOST);
    // The station receives nothing: it orders a stop, which reaches the vehicle.
    let mut car = stationed();
    assert!(!drive_looked_at(&mut car));
    car.station_mut().connect_each(false, true);
    assert!(drive_looked_at(&mut car));
    assert!(car.state() == SafetyState::EmergencyStop && car.causes() == Causes::REMOTE_STOP);
}

/// A vehicle that hangs does not call its station, so the station notices by its own clock.
#[test]
fn a_vehicle_that_hangs_is_missed() {
    let mut car = stationed();
    assert!(!drive_looked_at(&mut car));
    let now = car.inner().time() + 100.0;
    let station = car.station_mut();
    assert!(!station.look(now + 0.4) && station.look(now + 0.6), "nobody has driven since");
    drive(&mut car, 0.1);
    assert_eq!(car.state(), SafetyState::EmergencyStop, "and learns it as soon as it is back");
}

/// Stopping distance (m) of a car with the given brake, from 10 m/s, after a hard or a soft cause; and the
/// bound computed for the nominal brake.
fn stopping_way(hard: bool, brake: f64) -> (f64, f64) {
    let mut spec = RobotSpec::race_car();
    if let DriveSpec::Ackermann { dynamics: Some(dynamics), .. } = &mut spec.drive {
        dynamics.brake = brake;
    }
    let scene = Scene::with_robot(World::empty(1.0, 1.0), spec, Pose::default());
    let simulation = Simulation::new(&scene, SimOptions::default()).unwrap();
    let race = simulation.truth();
    let parameters = SupervisedParameters::default();
    let ordered = station(move |now, panel| {
        panel.emergency_button = hard && now > 4.0;
        panel.heartbeat = panel.heartbeat.filter(|_| hard || now < 4.0);
    });
    let mut car = Supervised::new(simulation.robot(0).unwrap(), ordered, parameters.clone()).unwrap();
    let (mut from, mut fast) = (0.0, 0.0);
    while race.time() < 14.0 {
        if car.last_stop().is_none() {
            let metres = race.robot(0).unwrap().path_length;
            (from, fast) = (metres, (metres - from) / 0.02);
        }
        let _ = car.set_speed(Twist::new(10.0, 0.0));
        let _ = car.wait(0.02);
    }
    let (state, spec) = (car.last_stop().unwrap().state, RobotSpec::race_car());
    assert_eq!(state.severity(), if hard { 2 } else { 1 });
    let metres = race.robot(0).unwrap().path_length;
    car.wait(0.1).unwrap();
    assert!(race.robot(0).unwrap().path_length - metres < 1e-3 && fast > 9.0, "it stands: {fast}");
    let model = parameters.stopping_in(state, spec.motor.time_constant, spec.deceleration());
    (metres - from, model.distance(fast))
}

/// Each kind of stop has its own bound. The bounds are tight: a car with weaker brakes exceeds them.
#[test]
fn safe_and_emergency_stops_have_their_own_bounds() {
    let brake = RobotSpec::race_car().deceleration();
    let (hard, hard_bound) = stopping_way(true, brake);
    assert!(hard <= hard_bound && hard_bound < 1.25 * hard, "{hard} of {hard_bound}");
    let (soft, soft_bound) = stopping_way(false, brake);
    assert!(soft <= soft_bound && soft_bound < 1.3 * soft, "{soft} of {soft_bound}");
    assert!(hard_bound < 0.5 * soft, "{hard_bound} {soft}");
    let (weak, _) = stopping_way(true, 0.5 * brake);
    assert!(weak > hard_bound, "half a brake: {weak} of {hard_bound}");
    let (weak, _) = stopping_way(false, 0.5 * SupervisedParameters::default().gentle);
    assert!(weak > soft_bound, "half of a gentle brake: {weak} of {soft_bound}");
}

/// A faulty sensor stays distrusted until somebody confirms it, whatever it reads meanwhile.
#[test]
fn a_sensor_at_fault_is_not_trusted_again_by_itself() {
    // This includes sensors that recover: nobody knows what they did in between.
    for (text, found_out) in [
        ("late:lidar=0.5@3", false),
        ("late:front=0.5@3", false),
        ("jump=400,200,40@3", false),
        ("stuck:lidar@3-4", false),
        ("lost:front@3", true),
        ("nan:lidar@3", true),
    ] {
        let scene = Scene::with_robot(World::walled(8.0, 8.0), RobotSpec::s4(), Pose::new(2.0, 4.0, 0.0));
        let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 7)).unwrap();
        let robot = Faulty::new(simulation.robot(0).unwrap(), vec![text.parse::<Fault>().unwrap()]);
        // The operator presses buttons repeatedly, and confirms the sensors after 8 s.
        let people = station(|now, panel| {
            if now > 4.0 {
                let presses = now.fract() < 0.5;
                panel.requests = Requests { arm: presses, start: !presses, disarm: false };
            }
            panel.sensors_checked = now > 8.0;
        });
        let mut car = Supervised::new(robot, people, SupervisedParameters::default()).unwrap();
        let mut scan = LidarScan::default();
        let mut drives = Vec::new();
        while car.peek_time().unwrap() < 11.0 {
            let _ = car.set_speed(Twist::new(0.3, 0.2));
            let _ = (car.distance(Psd::FRONT), car.scan_into(&mut scan));
            let _ = car.wait(0.05);
            if car.last_stop().is_some() && car.state() == SafetyState::Auto {
                drives.push(car.peek_time().unwrap());
            }
        }
        let stop = car.last_stop().unwrap();
        assert!(stop.causes.has(Causes::SENSOR), "{text}: {stop:?}");
        assert_eq!(drives.is_empty(), found_out, "{text}: {drives:?}");
        assert!(drives.iter().all(|time| *time > 8.0), "{text}: {drives:?}");
    }
}

/// A clock that leaps does not make time pass.
#[test]
fn a_clock_that_leaps_to_the_end_of_time_is_waited_for_no_longer() {
    let parameters = SupervisedParameters::default();
    let mut car = Supervised::new(faulty("clock=1e300@1"), station(|_, _| {}), parameters).unwrap();
    drive(&mut car, 3.0);
    let stop = car.last_stop().unwrap();
    assert!(stop.causes.has(Causes::CLOCK) && stop.time <= 1.0 + 0.02 + 1e-6, "{stop:?}");
    assert!((car.inner().inner().time() - 3.0).abs() < 0.01);
}
