//! Races: cars between cones with lidar and camera, alone and in pairs, for laps and in events.

use std::cell::RefCell;
use std::f64::consts::TAU;
use std::ops::ControlFlow;

use roverlab::geometry::{Point, Pose, Twist, direction};
use roverlab::io::sim::{Fleet, SimOptions, Simulation, TICK, Truth};
use roverlab::io::wrappers::Traced;
use roverlab::io::{
    Camera, Clock, Drive, Encoders, Lidar, LidarScan, LidarSettings, Manoeuvres, Motors, Odometry,
    Resolution, Result, RobotTruth, Servos, StallDetector,
};
use roverlab::race::{
    CameraMount, CameraSight, Cone, ConeColour, ConeMap, ConeTrack, EventCourse, EventParameters, EventRacer,
    EventReferee, GapDriver, GeneratedTrack, LaneFinder, Racer, RacerParameters, Referee, TrackOptions,
    generate, sightings,
};

use super::{Scenario, note, other, text};

pub(super) const SCENARIOS: &[Scenario] = &[
    Scenario::new("race-car", car),
    Scenario::new("race-laps", laps),
    Scenario::new("race-camera", camera),
    Scenario::new("race-two-cars", two_cars),
    Scenario::new("race-by-gaps", gaps),
    Scenario::new("acceleration", acceleration),
    Scenario::new("skidpad", figure_of_eight),
];

/// Where the wheels are, from the middle of the rear axle.
const WHEELS: [Point; 4] =
    [Point::new(0.0, 0.6), Point::new(0.0, -0.6), Point::new(1.55, 0.6), Point::new(1.55, -0.6)];

fn world(track: &ConeTrack, starts: &[Pose], seed: u64) -> Result<Simulation> {
    Simulation::new(&track.scene(starts), SimOptions { seed, ..SimOptions::default() })
}

/// What is true about a car, number by number, without the names of fields.
fn note_car(log: &mut String, time: f64, truth: &RobotTruth) {
    note(log, "car", &(time, truth.pose, truth.contacts, &truth.contact_places, truth.path_length));
}

/// Lets time pass in ticks, at each of which a referee looks.
fn pass(
    car: &mut impl Clock,
    truth: &Truth,
    seconds: f64,
    mut see: impl FnMut(f64, Pose, usize),
) -> Result<()> {
    for _ in 0..(seconds / TICK).round() as u32 {
        car.wait(TICK)?;
        let now = truth.robot(0)?;
        see(truth.time(), now.pose, now.contacts as usize);
    }
    Ok(())
}

/// A car by its speeds, its motor and its servo and by manoeuvres, over a cone and into another car.
fn car() -> Result<String> {
    let mut log = String::new();
    let cones = [(14.0, 0.1), (8.0, 4.0)].map(|(x, y)| Cone::unknown(Point::new(x, y))).to_vec();
    let track = ConeTrack { cones, ..ConeTrack::default() };
    let starts = [Pose::default(), Pose::new(50.0, 0.3, 3.0)];
    let race = Simulation::new(&track.scene(&starts), SimOptions::with_noise(2.0, 60))?;
    let mut robot = Traced::new(race.robot(0)?, Vec::new()).whole_scans();
    robot.configure_lidar(LidarSettings { field_of_view: 3.0, tilt: 0.0, points: 120 })?;
    for (linear, angular) in [(4.0, 0.0), (8.0, 0.0), (12.0, 1.0), (18.0, -0.9), (0.0, 0.0)] {
        robot.set_speed(Twist::new(linear, angular))?;
        for _ in 0..3 {
            robot.wait(0.5)?;
            robot.pose()?;
            robot.speed()?;
            robot.scan()?;
            robot.is_stalled()?;
        }
    }
    robot.set_motor(1, 0.3)?;
    robot.set_servo(1, -0.4)?;
    robot.wait(2.0)?;
    robot.encoder(1)?;
    robot.curve(12.0, 0.8, 5.0)?;
    robot.wait(1.0)?;
    robot.remaining()?;
    robot.wait_done()?;
    robot.set_resolution(Resolution::Qqvga)?;
    robot.image()?;
    log += &text(robot)?;
    note_car(&mut log, race.truth().time(), &race.truth().robot(0)?);
    note(&mut log, "fallen", &(race.truth().has_fallen(0)?, race.truth().has_fallen(1)?));
    Ok(log)
}

/// Two laps: the first makes the map, the second is raced.
fn laps() -> Result<String> {
    let GeneratedTrack { track, corridor } = generate(61, &TrackOptions::drawn(61)).map_err(other)?;
    let race = world(&track, &[track.start_pose().unwrap_or_default()], 61)?;
    let (mut robot, truth) = (race.robot(0)?, race.truth());
    let mut referee = Referee::new(corridor, WHEELS);
    let parameters = RacerParameters { laps: 2, ..RacerParameters::default() };
    let (mut racer, mut scan) = (Racer::new(parameters)?, LidarScan::default());
    let mut log = String::new();
    let mut noted = None;
    while truth.time() < 200.0 {
        let mut car = Traced::new(&mut robot, Vec::new());
        car.scan_into(&mut scan)?;
        let (pose, speed) = (car.pose()?, car.speed()?);
        car.set_speed(racer.step(pose, speed, &scan))?;
        log += &text(car)?;
        pass(&mut robot, &truth, parameters.period, |time, pose, hits| referee.see(time, pose, hits))?;
        if noted.replace(racer.phase()) != Some(racer.phase()) {
            note_car(&mut log, truth.time(), &truth.robot(0)?);
            note(&mut log, "phase", &(racer.phase(), racer.laps(), racer.map().pose()));
            note(&mut log, "map", &racer.map().cones().collect::<Vec<_>>());
            note(&mut log, "line", &racer.line().map(|line| (line.points(), &line.profile().speeds)));
        }
        if racer.is_done(speed) {
            break;
        }
    }
    let verdict = referee.verdict();
    note(&mut log, "verdict", &(&verdict.lap_times, verdict.off_course, verdict.cones_hit, verdict.total()));
    Ok(log)
}

/// The first lap's beginning by camera alone, and by camera and lidar.
fn camera() -> Result<String> {
    let track = generate(62, &TrackOptions::drawn(62)).map_err(other)?.track;
    let mut log = String::new();
    for both in [false, true] {
        let race = world(&track, &[track.start_pose().unwrap_or_default()], 62)?;
        let (mut car, truth) = (race.robot(0)?, race.truth());
        let mut racer = Racer::new(RacerParameters::default())?;
        let mut sight = CameraSight::new(CameraMount::default());
        car.set_resolution(Resolution::Vga)?;
        for _ in 0..40 {
            let found = sight.find(&car.image()?);
            let seen = if both { sight.fuse(&sightings(&car.scan()?), &found) } else { found };
            let (pose, speed) = (car.pose()?, car.speed()?);
            let command = racer.decide(pose, speed, &seen);
            car.set_speed(command)?;
            for cone in &seen {
                note(&mut log, "seen", &(cone.position, cone.size, cone.confidence, cone.error, cone.colour));
            }
            note(&mut log, "decision", &(pose, speed, command, racer.map().pose()));
            car.wait(0.05)?;
        }
        note(&mut log, "map", &racer.map().cones().collect::<Vec<_>>());
        note_car(&mut log, truth.time(), &truth.robot(0)?);
    }
    Ok(log)
}

/// A racer behind a car that strolls in the middle of the lane.
fn two_cars() -> Result<String> {
    let track = generate(63, &TrackOptions::drawn(63)).map_err(other)?.track;
    let start = track.start_pose().unwrap_or_default();
    let scene = track.scene(&[start, start.compose(&Pose::new(6.0, 0.0, 0.0))]);
    let parameters = RacerParameters::default();
    let (mut racer, mut seen) = (Racer::new(parameters)?, LidarScan::default());
    let log = RefCell::new(String::new());
    {
        let mut fleet = Fleet::new(&scene, SimOptions { seed: 63, ..SimOptions::default() })?;
        fleet.control(0, parameters.period, |car| {
            car.scan_into(&mut seen)?;
            let (pose, speed) = (car.pose()?, car.speed()?);
            car.set_speed(racer.step(pose, speed, &seen))?;
            Ok(ControlFlow::Continue(()))
        })?;
        let (mut map, mut finder) = (ConeMap::new(parameters.map)?, LaneFinder::new(parameters.lane)?);
        let mut scan = LidarScan::default();
        let log = &log;
        fleet.control(1, parameters.period, move |car| {
            car.scan_into(&mut scan)?;
            let seen = sightings(&scan);
            map.update(car.pose()?, &seen);
            let pose = map.pose();
            let near = map.fresh_cones().filter(|cone| (cone.position - pose.position()).norm() < 24.0);
            let near: Vec<Cone> = near.collect();
            let lane = finder.step(pose, &near).map(|lane| lane.points.clone()).unwrap_or_default();
            let aim = lane.iter().map(|point| pose.to_local(*point)).find(|point| point.x > 3.0);
            car.set_speed(aim.map_or(Twist::STOP, |aim| {
                Twist::new(3.0, 6.0 * aim.y / aim.coords.norm_squared().max(1.0))
            }))?;
            let numbers = (seen.len(), near.len(), lane.len(), aim, pose, map.tolerance());
            note(&mut log.borrow_mut(), "seen", &numbers);
            Ok(ControlFlow::Continue(()))
        })?;
        for _ in 0..300 {
            fleet.run_for(parameters.period)?;
            for car in 0..2 {
                note_car(&mut log.borrow_mut(), fleet.time(), &fleet.truth(car)?);
            }
        }
    }
    let mut log = log.into_inner();
    note(&mut log, "others", &racer.map().fresh_others().collect::<Vec<_>>());
    Ok(log)
}

/// Steering for the nearest gap, as the book prints it.
fn gaps() -> Result<String> {
    let GeneratedTrack { track, corridor } = generate(64, &TrackOptions::drawn(64)).map_err(other)?;
    let race = world(&track, &[track.start_pose().unwrap_or_default()], 64)?;
    let (mut robot, truth) = (race.robot(0)?, race.truth());
    let mut referee = Referee::new(corridor, WHEELS);
    let (mut driver, mut scan) = (GapDriver::default(), LidarScan::default());
    robot.configure_lidar(LidarSettings { field_of_view: std::f64::consts::PI, tilt: 0.0, points: 180 })?;
    robot.set_motor(1, 0.1)?;
    let mut log = String::new();
    for _ in 0..200 {
        let mut car = Traced::new(&mut robot, Vec::new());
        car.scan_into(&mut scan)?;
        if let Some(position) = driver.step(&scan) {
            car.set_servo(1, position)?;
        }
        log += &text(car)?;
        pass(&mut robot, &truth, 0.1, |time, pose, hits| referee.see(time, pose, hits))?;
        note_car(&mut log, truth.time(), &truth.robot(0)?);
    }
    note(&mut log, "verdict", &(referee.verdict().off_course, referee.verdict().cones_hit));
    Ok(log)
}

/// The strip of an acceleration, and the lane behind it.
pub(super) fn strip() -> ConeTrack {
    let mut track = ConeTrack { start: Some(Pose::new(-2.45, 0.3, 0.05)), ..ConeTrack::default() };
    let mut both = |x: f64, colours: [ConeColour; 2]| {
        for (y, colour) in [1.6, -1.6].into_iter().zip(colours) {
            track.cones.push(Cone::new(Point::new(x, y), colour));
        }
    };
    for x in [-0.25, 0.25, 74.75, 75.25] {
        both(x, [ConeColour::BigOrange; 2]);
    }
    (1..15).for_each(|k| both(5.0 * f64::from(k), [ConeColour::Blue, ConeColour::Yellow]));
    (1..=8).for_each(|k| both(75.0 + 5.0 * f64::from(k), [ConeColour::Orange; 2]));
    track.cones.extend([-0.8, 0.8].map(|y| Cone::new(Point::new(115.0, y), ConeColour::Orange)));
    track
}

/// The figure of eight of a skidpad, by the rules.
pub(super) fn skidpad() -> ConeTrack {
    let (apart, inner, outer) = (9.125, 7.625, 10.625);
    let mut track = ConeTrack { start: Some(Pose::new(-17.0, 0.1, -0.03)), ..ConeTrack::default() };
    let mut put = |x: f64, y: f64, colour| track.cones.push(Cone::new(Point::new(x, y), colour));
    let sides = [(1.0, ConeColour::Blue, ConeColour::Yellow), (-1.0, ConeColour::Yellow, ConeColour::Blue)];
    for (side, near, far) in sides {
        for arm in (0..16).map(|k| direction(TAU * f64::from(k) / 16.0)) {
            put(arm.x * inner, side * apart + arm.y * inner, near);
            if side * (side * apart + arm.y * outer) > 1.0 {
                put(arm.x * outer, side * apart + arm.y * outer, far);
            }
        }
        for x in [-15.0, -11.0, 11.0, 16.0, 21.0] {
            put(x, side * (apart - inner), ConeColour::Orange);
        }
        put(21.0, side * 0.5, ConeColour::Orange);
    }
    track
}

/// One run of an event, to its end.
fn event(track: &ConeTrack, mut racer: EventRacer, seed: u64) -> Result<String> {
    let outline = EventParameters::default().outline;
    let Some(course) = EventCourse::of(track, &outline) else { unreachable!("the track is an event's") };
    let mut referee = EventReferee::new(course, WHEELS, Point::new(outline.nose, 0.0));
    let race = world(track, &[track.start_pose().unwrap_or_default()], seed)?;
    let (mut robot, truth) = (race.robot(0)?, race.truth());
    let mut scan = LidarScan::default();
    let mut log = String::new();
    while truth.time() < 60.0 {
        let mut car = Traced::new(&mut robot, Vec::new());
        car.scan_into(&mut scan)?;
        let (pose, speed) = (car.pose()?, car.speed()?);
        car.set_speed(racer.step(pose, speed, &scan))?;
        log += &text(car)?;
        pass(&mut robot, &truth, 0.05, |time, pose, hits| referee.see(time, pose, hits))?;
        note_car(&mut log, truth.time(), &truth.robot(0)?);
        note(&mut log, "layout", &(racer.phase(), racer.layout(), racer.map().pose()));
        if racer.is_done(speed) {
            break;
        }
    }
    let verdict = referee.verdict();
    note(&mut log, "verdict", &(&verdict.lap_times, verdict.off_course, verdict.cones_hit));
    note(&mut log, "line", &racer.line().map(|line| (line.points(), &line.profile().speeds)));
    Ok(log)
}

fn acceleration() -> Result<String> {
    event(&strip(), EventRacer::acceleration(EventParameters::default())?, 65)
}

fn figure_of_eight() -> Result<String> {
    event(&skidpad(), EventRacer::skidpad(EventParameters::default())?, 66)
}
