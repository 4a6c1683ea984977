//! Complete runs on generated strips and skidpads.

use std::f64::consts::TAU;

use super::*;
use crate::geometry::{Point, Pose, Vector, direction};
use crate::io::sim::{SimOptions, Simulation, TICK};
use crate::io::{Camera, Clock, Drive, Lidar, LidarScan, Odometry, Resolution, control};
use crate::race::{
    CameraMount, CameraSight, CarLimits, CarOutline, Cone, ConeColour, ConeTrack, Event, RaceOutcome,
    RaceScore,
};
use crate::world::RobotSpec;

const OUTLINE: CarOutline = CarOutline { half_width: 0.7, nose: 2.15, ahead: 0.9, room: 0.0 };

/// A strip with a half-width, a cone spacing, and a lane behind the finish that two cones close.
fn strip(half_width: f64, spacing: f64, lane: f64) -> ConeTrack {
    let mut track = ConeTrack { start: Some(Pose::new(-2.45, 0.3, 0.05)), ..ConeTrack::default() };
    let mut both = |x: f64, colours: [ConeColour; 2]| {
        for (side, colour) in [1.0, -1.0].into_iter().zip(colours) {
            track.cones.push(Cone::new(Point::new(x, side * half_width), colour));
        }
    };
    for x in [-0.25, 0.25, 74.75, 75.25] {
        both(x, [ConeColour::BigOrange; 2]);
    }
    for k in 1..(74.0 / spacing) as u32 {
        both(spacing * f64::from(k), [ConeColour::Blue, ConeColour::Yellow]);
    }
    for k in 1..=(lane / spacing) as u32 {
        both(75.0 + spacing * f64::from(k), [ConeColour::Orange; 2]);
    }
    for y in [-0.5, 0.5] {
        track.cones.push(Cone::new(Point::new(75.0 + lane, y * half_width), ConeColour::Orange));
    }
    track
}

/// A skidpad by the rules, or nearly so, at an arbitrary pose.
fn skidpad(apart: f64, inner: f64, outer: f64) -> ConeTrack {
    let frame = Pose::new(7.0, -3.0, 0.8);
    let mut track =
        ConeTrack { start: Some(frame.compose(&Pose::new(-17.0, 0.1, -0.03))), ..ConeTrack::default() };
    let mut put =
        |x: f64, y: f64, colour| track.cones.push(Cone::new(frame.to_world(Point::new(x, y)), colour));
    for (side, near, far) in
        [(1.0, ConeColour::Blue, ConeColour::Yellow), (-1.0, ConeColour::Yellow, ConeColour::Blue)]
    {
        for k in 0..16 {
            let arm = direction(TAU * f64::from(k) / 16.0);
            put(arm.x * inner, side * apart + arm.y * inner, near);
            let (x, y) = (arm.x * outer, side * apart + arm.y * outer);
            if y * side > 1.0 {
                put(x, y, far);
            }
        }
        for x in [-15.0, -11.0, 11.0, 16.0, 21.0] {
            put(x, side * (apart - inner), ConeColour::Orange);
        }
        put(21.0, side * 0.5, ConeColour::Orange);
    }
    track
}

fn racer_for(course: &EventCourse) -> EventRacer {
    match course.event() {
        Event::Acceleration => EventRacer::acceleration(EventParameters::default()).unwrap(),
        _ => EventRacer::skidpad(EventParameters::default()).unwrap(),
    }
}

fn world(track: &ConeTrack, seed: u64) -> Simulation {
    let scene = track.scene(&[track.start.unwrap()]);
    Simulation::new(&scene, SimOptions { seed, ..SimOptions::default() }).unwrap()
}

/// One run with lidar or camera: the referee's result, whether it was complete, and the final phase.
fn run(track: &ConeTrack, seed: u64, camera: bool) -> (RaceScore, bool, EventPhase) {
    let course = EventCourse::of(track, &OUTLINE).unwrap();
    let wheels = [(0.0, 0.6), (0.0, -0.6), (1.55, 0.6), (1.55, -0.6)].map(|(x, y)| Point::new(x, y));
    let mut racer = racer_for(&course);
    let mut referee = EventReferee::new(course, wheels, Point::new(OUTLINE.nose, 0.0));
    let world = world(track, seed);
    let (mut car, truth) = (world.robot(0).unwrap(), world.truth());
    car.set_resolution(Resolution::Vga).unwrap();
    let (mut scan, mut sight) = (LidarScan::default(), CameraSight::new(CameraMount::default()));
    while truth.time() < 60.0 {
        let (pose, speed) = (car.pose().unwrap(), car.speed().unwrap());
        let command = if camera {
            racer.decide(pose, speed, &sight.find(&car.image().unwrap()))
        } else {
            car.scan_into(&mut scan).unwrap();
            racer.step(pose, speed, &scan)
        };
        car.set_speed(command).unwrap();
        for _ in 0..5 {
            car.wait(TICK).unwrap();
            let seen = truth.robot(0).unwrap();
            referee.see(truth.time(), seen.pose, seen.contacts as usize);
        }
        if racer.is_done(car.speed().unwrap()) {
            break;
        }
    }
    (referee.verdict().clone(), referee.is_complete(), racer.phase())
}

/// Checks that a run ends behind its finish, without penalty, near the optimum.
fn assert_clean(track: &ConeTrack, seed: u64, camera: bool, over: f64) {
    let course = EventCourse::of(track, &OUTLINE).unwrap();
    let limits = CarLimits::of(&RobotSpec::race_car()).unwrap();
    let optima = course.optima(&limits, &OUTLINE);
    let found = run(track, seed, camera);
    let (verdict, complete, phase) = &found;
    assert!(*complete && *phase == EventPhase::Finished, "{seed}: {found:?}");
    assert_eq!((verdict.cones_hit, verdict.off_course), (0, 0), "{seed}: {found:?}");
    assert_eq!(verdict.lap_times.len(), optima.len(), "{seed}: {found:?}");
    for (time, optimum) in verdict.lap_times.iter().zip(&optima) {
        assert!((1.0..over).contains(&(time / optimum)), "{seed}: {found:?} {optima:?}");
    }
}

#[test]
fn strips_of_all_widths_are_driven_to_the_lane_behind_them() {
    for (seed, half_width, spacing, lane) in
        [(1, 1.5, 5.0, 25.0), (2, 1.9, 5.0, 100.0), (3, 2.4, 4.0, 50.0), (4, 1.6, 6.0, 30.0)]
    {
        assert_clean(&strip(half_width, spacing, lane), seed, false, 1.08);
    }
    assert_clean(&strip(1.5, 5.0, 25.0), 5, true, 1.08);
}

#[test]
fn skidpads_are_driven_four_times_around() {
    for (seed, apart, inner, outer) in [
        (1, 9.125, 7.625, 10.625),
        (2, 9.25, 7.61, 10.61),
        (3, 9.125, 7.475, 10.775),
        (4, 9.125, 7.625, 10.625),
    ] {
        assert_clean(&skidpad(apart, inner, outer), seed, false, 1.08);
    }
    assert_clean(&skidpad(9.125, 7.625, 10.625), 5, true, 1.08);
}

#[test]
fn the_course_is_measured_out_among_the_cones() {
    let course = EventCourse::of(&strip(1.5, 5.0, 25.0), &OUTLINE).unwrap();
    let place = |station: usize| course.corridor().stations()[station].position;
    let [begin, end] = course.timed()[0];
    assert!((place(begin).x.abs() < 0.3) && (place(end).x - 75.0).abs() < 0.3, "{:?}", course.timed());
    assert_eq!(course.event(), Event::Acceleration);
    let course = EventCourse::of(&skidpad(9.125, 7.625, 10.625), &OUTLINE).unwrap();
    let laps: Vec<usize> = course.timed().iter().map(|[begin, end]| end - begin).collect();
    assert_eq!((course.event(), laps), (Event::Skidpad, vec![224; 2]));
    // Without its orange cones it is the same event, and it is none without one of its circles.
    let mut bare = skidpad(9.125, 7.625, 10.625);
    bare.cones.retain(|cone| cone.colour != ConeColour::Orange);
    assert_eq!(EventCourse::of(&bare, &OUTLINE).unwrap().event(), Event::Skidpad);
    let frame = course.layout().pose;
    bare.cones.retain(|cone| frame.to_local(cone.position).y < 5.0);
    assert!(EventCourse::of(&bare, &OUTLINE).is_none());
    // Laps of a circuit are no event, and neither is a random heap with orange cones.
    let mut track = strip(1.5, 5.0, 25.0);
    track.cones.retain(|cone| cone.colour != ConeColour::Orange);
    assert_eq!(EventCourse::of(&track, &OUTLINE), None);
    let mut heap = skidpad(9.125, 7.625, 10.625);
    for (k, cone) in heap.cones.iter_mut().enumerate() {
        cone.position = Point::new((7 * k % 23) as f64, (11 * k % 19) as f64);
    }
    assert_eq!(EventCourse::of(&heap, &OUTLINE), None);
    // False cones beside a strip make no skidpad of it, and a lane that nothing closes is as long as by the
    // rules.
    for seed in 0..20 {
        let mut random = crate::random::Stream::new(seed);
        let mut false_cone = |cone: &Cone| {
            let [x, y] = [(); 2].map(|()| random.between(-3.0, 3.0));
            random.chance(0.15).then(|| Cone { position: cone.position + Vector::new(x, y), ..*cone })
        };
        let mut track = strip(1.5, 5.0, 25.0);
        let painted = |cone: &&Cone| cone.colour.side() != 0;
        let added: Vec<Cone> = track.cones.iter().filter(painted).filter_map(&mut false_cone).collect();
        track.cones.extend(added);
        track.cones.retain(|cone| cone.position.x < 85.0);
        let course = EventCourse::of(&track, &OUTLINE).unwrap();
        assert_eq!(course.event(), Event::Acceleration, "{seed}");
        assert!((course.corridor().length() - 103.3).abs() < 1.0, "{}", course.corridor().length());
    }
    // A start far away makes no long course.
    assert_eq!(EventCourse::of(&strip(1.5, 5.0, 25.0), &CarOutline { nose: 1e300, ..OUTLINE }), None);
}

/// Length of the course of a strip with another orange cone.
fn length_with(track: &ConeTrack, x: f64, y: f64) -> f64 {
    let mut track = track.clone();
    track.cones.push(Cone::new(Point::new(x, y), ConeColour::Orange));
    EventCourse::of(&track, &OUTLINE).unwrap().corridor().length()
}

#[test]
fn stray_cones_are_no_part_of_a_lane() {
    let closed = strip(1.5, 5.0, 25.0);
    let mut open = closed.clone();
    open.cones.retain(|cone| cone.position.x < 100.0 || cone.position.y.abs() > 1.0);
    // On the edge, in the lane and beside it, near and far behind its end.
    for (x, y) in [(125.0, 1.5), (125.0, 0.0), (98.0, 9.5), (225.0, 9.5), (1e9, 1.5)] {
        for track in [&closed, &open] {
            let length = length_with(track, x, y);
            assert!((length - 103.3).abs() < 1.0, "({x}, {y}): {length} m");
        }
    }
    // Next in the row, a cone is none.
    assert!((length_with(&open, 105.0, 1.5) - 108.3).abs() < 1.0);
    // Where the finish is by the large cones, the row up to the lane goes on behind it.
    let mut early = closed.clone();
    for cone in early.cones.iter_mut().filter(|cone| cone.colour == ConeColour::BigOrange) {
        cone.position.x -= if cone.position.x > 50.0 { 20.0 } else { 0.0 };
    }
    early.cones.push(Cone::new(Point::new(70.0, 1.5), ConeColour::Blue));
    let length = EventCourse::of(&early, &OUTLINE).unwrap().corridor().length();
    assert!((length - 103.3).abs() < 1.0, "{length} m");
}

#[test]
fn a_strip_begins_ahead_of_its_start() {
    let from = |x: f64| {
        let track = ConeTrack { start: Some(Pose::new(x, 0.0, 0.0)), ..strip(1.5, 5.0, 25.0) };
        EventCourse::of(&track, &OUTLINE).is_some()
    };
    assert!(from(-9.0) && from(-2.45));
    for x in [-12.0, 0.0, 4.0, 12.0, 30.0, 65.0, 80.0] {
        assert!(!from(x), "{x}");
    }
    // Without a start, it is at some cones in the middle of the strip.
    let track = ConeTrack { start: None, ..strip(1.5, 5.0, 25.0) };
    assert_eq!(EventCourse::of(&track, &OUTLINE), None);
}

#[test]
fn without_cones_it_stops_and_says_so() {
    for mut racer in [
        EventRacer::acceleration(EventParameters::default()).unwrap(),
        EventRacer::skidpad(EventParameters::default()).unwrap(),
    ] {
        let world = world(&ConeTrack { start: Some(Pose::default()), ..ConeTrack::default() }, 1);
        let outcome = control::run(&mut world.robot(0).unwrap(), &mut racer, 20.0, |_, _, _| {}).unwrap();
        assert_eq!((outcome, racer.layout()), (RaceOutcome::Lost, None));
        let truth = world.truth().robot(0).unwrap();
        assert!(truth.path_length < 0.1 && world.truth().time() < 5.0, "{truth:?}");
    }
}

#[test]
fn it_stops_when_it_sees_no_more() {
    for track in [strip(1.5, 5.0, 25.0), skidpad(9.125, 7.625, 10.625)] {
        let mut racer = racer_for(&EventCourse::of(&track, &OUTLINE).unwrap());
        let world = world(&track, 3);
        let mut car = world.robot(0).unwrap();
        let mut scan = LidarScan::default();
        while car.now().unwrap() < 20.0 && racer.phase() != EventPhase::Finished {
            car.scan_into(&mut scan).unwrap();
            if car.now().unwrap() > 4.0 {
                scan.ranges.fill(f64::INFINITY);
            }
            let (pose, speed) = (car.pose().unwrap(), car.speed().unwrap());
            car.set_speed(racer.step(pose, speed, &scan)).unwrap();
            car.wait(0.05).unwrap();
        }
        let before = world.truth().robot(0).unwrap();
        car.wait(1.0).unwrap();
        let truth = world.truth().robot(0).unwrap();
        assert_eq!((racer.phase(), truth.contacts), (EventPhase::Lost, 0), "{truth:?}");
        assert!(truth.path_length - before.path_length < 0.05, "{truth:?}");
    }
}

#[test]
fn time_may_be_over_before_the_finish() {
    let track = skidpad(9.125, 7.625, 10.625);
    let mut racer = racer_for(&EventCourse::of(&track, &OUTLINE).unwrap());
    let world = world(&track, 1);
    let outcome = control::run(&mut world.robot(0).unwrap(), &mut racer, 5.0, |_, _, _| {}).unwrap();
    assert_eq!((outcome, racer.phase()), (RaceOutcome::TimedOut, EventPhase::Driving));
    assert!(world.truth().time() < 5.1);
}

#[test]
fn the_same_seed_gives_the_same_run() {
    let track = strip(1.5, 5.0, 25.0);
    assert_eq!(run(&track, 7, false), run(&track, 7, false));
}
