//! Supervision: the state machine, the monitors, and vehicles that are stopped.

use roverlab::geometry::{Point, Pose, Twist};
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::io::wrappers::{Fault, Faulty, Traced};
use roverlab::io::{Clock, Drive, Lidar, MockRobot, Motors, Odometry, Result, Servos};
use roverlab::race::{Cone, ConeTrack, GapDriver};
use roverlab::random::Stream;
use roverlab::safety::{
    BaseStation, Causes, Deadline, Debounce, Heartbeat, Panel, Requests, SafetyCore, SafetyInputs,
    SafetyState, SignalLimits, SignalMonitor, Station, Supervised, SupervisedParameters, is_inside,
};

use super::{Scenario, in_room, noise, note, text};

pub(super) const SCENARIOS: &[Scenario] = &[
    Scenario::new("safety-machine", machine),
    Scenario::new("safety-monitors", monitors),
    Scenario::new("safety-events", events),
    Scenario::new("safety-faults", faults),
    Scenario::new("safety-race-car", race_car),
    Scenario::new("safety-base-station", base_station),
];

/// The state machine under requests and causes by chance, and the stopping distances.
fn machine() -> Result<String> {
    let mut log = String::new();
    let mut core = SafetyCore::new();
    let mut random = Stream::new(140);
    for _ in 0..2000 {
        let bits = if random.chance(0.15) { random.bits() as u16 & 0x1ff } else { 0 };
        let causes = Causes::from_bits(bits);
        let [arm, start, disarm] = [0.5, 0.5, 0.1].map(|probability| random.chance(probability));
        let requests = Requests { arm, start, disarm };
        let state = core.step(SafetyInputs { causes, requests, standing: random.chance(0.7) });
        note(&mut log, "state", &(causes.bits(), causes.is_hard(), requests, state, state.severity()));
    }
    let parameters = SupervisedParameters::default();
    for state in [SafetyState::SafeStop, SafetyState::EmergencyStop] {
        let model = parameters.stopping_in(state, 0.3, 4.0);
        let distances = [0.0, 0.5, 3.0, 12.0].map(|speed| (model.distance(speed), model.speed_within(speed)));
        note(&mut log, "stopping", &(state, distances));
    }
    Ok(log)
}

fn monitors() -> Result<String> {
    let mut log = String::new();
    let mut signal = SignalMonitor::new(SignalLimits { age: 0.3, rate: 2.0, step: 0.1, repeats: 3 })?;
    let (mut deadline, mut debounce) = (Deadline::new(0.25)?, Debounce::new(3));
    let readings = [0.0, 0.1, 0.2, 0.9, 0.9, 0.9, 0.9, f64::NAN, 0.8, 0.7, 0.7];
    for (step, value) in readings.into_iter().enumerate() {
        let now = 0.1 * step as f64 + if step > 8 { 0.5 } else { 0.0 };
        let before = signal.health(now);
        signal.read(now, value, step > 2);
        let over = deadline.is_over(now);
        deadline.feed(now);
        note(&mut log, "signal", &(now, before, signal.health(now), over, debounce.update(value > 0.5)));
    }
    let fence = [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [2.0, 1.0], [0.0, 3.0]];
    let points = (0..40).map(|k| [0.13 * f64::from(k) - 0.5, 2.0 - 0.03 * f64::from(k)]);
    note(&mut log, "inside", &points.map(|[x, y]| is_inside(&fence, [x, y])).collect::<Vec<_>>());
    Ok(log)
}

/// Notes the state of a supervised vehicle, why it is in it, and its last stop.
fn note_state<R: Clock + Drive + Odometry, S: Station>(log: &mut String, car: &Supervised<R, S>) {
    let stop = car.last_stop().map(|stop| (stop.time, stop.causes.bits(), stop.state, stop.speed));
    let causes: Vec<&str> = car.causes().names().collect();
    note(log, "vehicle", &(car.state(), causes, stop, car.asked()));
}

/// Armed and started at once, with a change to the panel.
fn station(change: impl Fn(f64, &mut Panel)) -> impl FnMut(f64, Heartbeat) -> Panel {
    move |now, heartbeat| {
        let requests = Requests { arm: now > 0.03, start: now > 0.07, disarm: false };
        let mut panel = Panel { heartbeat: Some(heartbeat.count), requests, ..Panel::default() };
        change(now, &mut panel);
        panel
    }
}

/// What a driver or a crew may do.
type Change = fn(f64, &mut Panel);

/// Drives a robot of the simulator while something happens to its panel.
fn events() -> Result<String> {
    const CHANGES: [Change; 8] = [
        |_, _| (),
        |now, panel| panel.emergency_button = now > 1.5,
        |now, panel| panel.remote_stop = (1.5..2.5).contains(&now),
        |now, panel| panel.disengage = now > 1.5,
        |now, panel| panel.heartbeat = panel.heartbeat.filter(|_| now < 1.2),
        |now, panel| panel.brake = if now > 1.5 { 0.6 } else { 0.0 },
        |now, panel| panel.steering_force = if now > 1.5 { 0.4 } else { 0.05 },
        |now, panel| panel.requests.disarm = now > 1.5,
    ];
    let mut log = String::new();
    let fence = [(-0.5, -0.5), (0.9, -0.5), (0.9, 1.0), (-0.5, 1.0)].map(|(x, y)| Point::new(x, y));
    for (index, change) in CHANGES.into_iter().enumerate() {
        let fence = if index == 0 { fence.to_vec() } else { Vec::new() };
        let simulation = Simulation::new(&in_room(0.5, 0.5, 0.3), noise(1.0, 141))?;
        let traced = Traced::new(simulation.robot(0)?, Vec::new());
        let parameters = SupervisedParameters { fence, ..SupervisedParameters::default() };
        let mut car = Supervised::new(traced, station(change), parameters)?;
        for _ in 0..40 {
            // Refused calls show in the vehicle's state.
            let _ = car.set_speed(Twist::new(0.3, 0.2));
            let _ = car.wait(0.1);
            note_state(&mut log, &car);
        }
        let by_hand = car.drive_by_hand(Twist::new(0.1, 0.0));
        note(&mut log, "by hand", &by_hand.map_err(|error| error.to_string()));
        log += &text(car.into_inner())?;
    }
    Ok(log)
}

/// Sensors, link and clock that fail.
fn faults() -> Result<String> {
    let mut log = String::new();
    for fault in [
        "stuck:odometry@1",
        "jump=300,0,0@1",
        "nan:odometry@1",
        "lost@1-2",
        "link@1-2",
        "hang=1@1",
        "clock@1",
        "clock=3@1",
        "stuck:lidar@1",
        "late:lidar=1@1",
    ] {
        let simulation = Simulation::new(&in_room(0.5, 0.5, 0.3), noise(1.0, 142))?;
        let fault: Fault = fault.parse()?;
        let robot = Faulty::new(simulation.robot(0)?, vec![fault]);
        let mut car = Supervised::new(robot, station(|_, _| ()), SupervisedParameters::default())?;
        for _ in 0..30 {
            let commanded = car.set_speed(Twist::new(0.25, 0.3)).is_ok();
            let seen = car.scan().map(|scan| scan.ranges.len()).map_err(|error| error.to_string());
            let waited = car.wait(0.1).map_err(|error| error.to_string());
            note(&mut log, "calls", &(commanded, seen, waited, car.now().ok()));
            note_state(&mut log, &car);
        }
        note(&mut log, "truth", &(simulation.truth().pose(0)?, simulation.truth().time()));
    }
    Ok(log)
}

/// A car that steers by motor and servo, and is braked from full speed.
fn race_car() -> Result<String> {
    let mut log = String::new();
    let rows = (0..40).flat_map(|k| [1.7, -1.7].map(|y| Point::new(3.0 * f64::from(k), y)));
    let track = ConeTrack { cones: rows.map(Cone::unknown).collect(), ..ConeTrack::default() };
    let scene = track.scene(&[Pose::new(-2.0, 0.2, 0.0)]);
    let race = Simulation::new(&scene, SimOptions { seed: 143, ..SimOptions::default() })?;
    let stop = station(|now, panel| panel.remote_stop = now > 3.0);
    let mut car = Supervised::new(race.robot(0)?, stop, SupervisedParameters::default())?;
    let mut driver = GapDriver::default();
    for _ in 0..60 {
        let scan = car.scan()?;
        let _ = car.set_motor(1, 0.25);
        if let Some(position) = driver.step(&scan) {
            let _ = car.set_servo(1, position);
        }
        let _ = car.wait(0.1);
        note(&mut log, "odometry", &(car.pose()?, car.speed()?));
        note_state(&mut log, &car);
    }
    drop(car);
    let truth = race.truth().robot(0)?;
    note(&mut log, "truth", &(truth.pose, truth.path_length, truth.contacts));
    Ok(log)
}

/// A crew that arms, starts, stops, and whose radio fails.
fn base_station() -> Result<String> {
    let mut log = String::new();
    let robot = MockRobot::new().with_ideal_drive();
    let mut car = Supervised::new(robot, BaseStation::new(0.5)?, SupervisedParameters::default())?;
    for step in 0..120_u32 {
        let crew = car.station_mut();
        match step {
            2 | 50 => crew.panel.requests.arm = true,
            6 | 54 => crew.panel.requests.start = true,
            30 => crew.stop(),
            45 => crew.take_back(),
            46 => crew.panel.requests = Requests::default(),
            80 => crew.connect(false),
            100 => crew.connect_each(true, false),
            _ => (),
        }
        let quiet = crew.look(0.1 * f64::from(step));
        let _ = car.set_speed(Twist::new(0.5, 0.1));
        let _ = car.wait(0.1);
        note(&mut log, "crew", &(quiet, car.pose()?));
        note_state(&mut log, &car);
    }
    note(&mut log, "calls", &car.into_inner().take_calls());
    Ok(log)
}
