use super::*;
use crate::geometry::{Point, Pose, Twist};
use crate::io::control::run;
use crate::io::sim::{SimOptions, Simulation, TICK};
use crate::io::{Clock, Drive, Lidar, LidarScan, Odometry};
use crate::random::Stream;

/// Result of a race on a generated track.
#[derive(Debug)]
struct Raced {
    verdict: RaceScore,
    phase: RacePhase,
    laps: usize,
    /// Number of cones hit in the first lap.
    first: usize,
    /// Maximum distance of a mapped cone from the nearest true one (m).
    error: f64,
}

fn race(seed: u64, laps: usize) -> Raced {
    let GeneratedTrack { track, corridor } = generate(seed, &TrackOptions::drawn(seed)).unwrap();
    race_on(&track, corridor, seed, laps)
}

fn race_on(track: &ConeTrack, corridor: Corridor, seed: u64, laps: usize) -> Raced {
    let start = track.start.unwrap();
    let simulation =
        Simulation::new(&track.scene(&[start]), SimOptions { seed, ..SimOptions::default() }).unwrap();
    let (mut car, world) = (simulation.robot(0).unwrap(), simulation.truth());
    let wheels = [(0.0, 0.6), (0.0, -0.6), (1.55, 0.6), (1.55, -0.6)].map(|(x, y)| Point::new(x, y));
    let mut referee = Referee::new(corridor, wheels);
    let mut racer = Racer::new(RacerParameters { laps, ..RacerParameters::default() }).unwrap();
    let mut scan = LidarScan::default();
    let mut first = 0;
    while world.time() < 150.0 * laps as f64 {
        car.scan_into(&mut scan).unwrap();
        let (pose, speed) = (car.pose().unwrap(), car.speed().unwrap());
        let command = racer.step(pose, speed, &scan);
        car.set_speed(command).unwrap();
        for _ in 0..5 {
            car.wait(TICK).unwrap();
            let truth = world.robot(0).unwrap();
            let hits = truth.contacts as usize;
            referee.see(world.time(), truth.pose, hits);
            if racer.phase() == RacePhase::Mapping {
                first = hits;
            }
        }
        if racer.phase() == RacePhase::Finished && speed.linear < 0.05 {
            break;
        }
    }
    let away = |place: Point| {
        track.cones.iter().map(|cone| (cone.position - place).norm()).fold(f64::INFINITY, f64::min)
    };
    let error = racer.map().cones().map(|cone| away(start.to_world(cone.position))).fold(0.0, f64::max);
    Raced { verdict: referee.verdict().clone(), phase: racer.phase(), laps: racer.laps(), first, error }
}

#[test]
fn a_line_that_moves_aside_is_come_to_without_weaving() {
    let straight = |y: f64| -> Vec<Point> { (0..1000).map(|k| Point::new(f64::from(k), y)).collect() };
    let profile = SpeedProfile::open(&straight(0.0), &RacerParameters::default().limits, 30.0, 0.0).unwrap();
    let tracker = |y: f64| {
        LineTracker::new(straight(y), profile.clone(), false, LineTrackerParameters::default()).unwrap()
    };
    let scene = ConeTrack::default().scene(&[Pose::default()]);
    let world = Simulation::new(&scene, SimOptions::ideal()).unwrap();
    let mut car = world.robot(0).unwrap();
    let (mut before, mut moved) = (tracker(0.0), tracker(0.8));
    let (mut most, mut last) = (0.0_f64, 0.0);
    while world.truth().pose(0).unwrap().x < 700.0 {
        let pose = world.truth().pose(0).unwrap();
        let speed = car.speed().unwrap();
        let line = if pose.x < 500.0 { &mut before } else { &mut moved };
        let (command, aside) = line.step(pose, speed).unwrap();
        car.set_speed(command).unwrap();
        car.wait(0.05).unwrap();
        if pose.x > 500.0 {
            assert!(speed.linear > 29.0, "{speed:?}");
            (most, last) = (most.max(aside), aside);
        }
    }
    assert!(most < 0.1 && last.abs() < 0.02, "{most} beyond, {last} in the end");
}

#[test]
fn the_first_lap_makes_the_map() {
    for seed in 0..3 {
        let raced = race(seed, 1);
        assert!(raced.phase == RacePhase::Finished && raced.laps == 1, "{seed}: {raced:?}");
        assert!(raced.first == 0 && raced.error < 0.4, "{seed}: {raced:?}");
        assert!(raced.verdict.off_course == 0 && raced.verdict.lap_times.len() == 1, "{seed}: {raced:?}");
    }
}

fn assert_clean(seed: u64, laps: usize, raced: &Raced) {
    let RaceScore { lap_times, off_course, cones_hit } = &raced.verdict;
    assert_eq!((lap_times.len(), *off_course, *cones_hit), (laps, 0, 0), "{seed}: {raced:?}");
    assert!(laps < 2 || lap_times[laps - 1] < 0.7 * lap_times[0], "{seed}: {raced:?}");
}

#[test]
fn races_are_clean() {
    for seed in 20..23 {
        assert_clean(seed, 3, &race(seed, 3));
    }
}

/// Removes a fraction of the cones, and adds another fraction beside the track, on both sides.
fn spoil(track: &mut ConeTrack, corridor: &Corridor, seed: u64, [missing, added]: [f64; 2]) {
    let mut random = Stream::new(seed).child("change", 0);
    let before = track.cones.len() as f64;
    track.cones.retain(|_| !random.chance(missing));
    let stations = corridor.stations();
    for _ in 0..(added * before).round() as usize {
        let station = stations[random.below(stations.len())];
        let beyond = random.between(0.8, 3.0);
        let left = random.chance(0.5);
        let place = station.aside(if left { station.left + beyond } else { -station.right - beyond });
        if stations.iter().all(|s| (s.position - place).norm() > s.left.max(s.right) + 0.5) {
            track.cones.push(Cone::unknown(place));
        }
    }
}

/// Seeds whose races of two laps are not clean.
fn dirty(seeds: std::ops::Range<u64>, shares: [f64; 2]) -> Vec<(u64, Raced)> {
    let raced = |seed| {
        let GeneratedTrack { mut track, corridor } = generate(seed, &TrackOptions::drawn(seed)).unwrap();
        spoil(&mut track, &corridor, seed, shares);
        (seed, race_on(&track, corridor, seed, 2))
    };
    let is_clean = |raced: &Raced| {
        let RaceScore { lap_times, off_course, cones_hit } = &raced.verdict;
        (lap_times.len(), *off_course, *cones_hit) == (2, 0, 0)
    };
    seeds.map(raced).filter(|(_, raced)| !is_clean(raced)).collect()
}

#[test]
fn missing_cones_are_borne() {
    let dirty = dirty(100..104, [0.1, 0.0]);
    assert!(dirty.is_empty(), "{dirty:?}");
}

#[test]
fn false_cones_are_borne() {
    let dirty = dirty(100..104, [0.0, 0.1]);
    assert!(dirty.is_empty(), "{dirty:?}");
}

#[test]
fn missing_and_false_cones_are_borne() {
    let dirty = dirty(100..110, [0.1, 0.1]);
    assert!(dirty.len() <= 1, "{dirty:?}");
}

/// A car in front of a straight lane of cone pairs, four metres apart.
fn on_a_strip(pairs: u32) -> (RaceOutcome, f64, f64) {
    let strip = |x: f64| [1.6, -1.6].map(|y| Cone::unknown(Point::new(x, y)));
    let cones = (0..pairs).map(|k| 4.0 * f64::from(k)).flat_map(strip).collect();
    let scene = ConeTrack { cones, ..ConeTrack::default() }.scene(&[Pose::new(-2.0, 0.0, 0.0)]);
    let world = Simulation::new(&scene, SimOptions::default()).unwrap();
    let mut racer = Racer::new(RacerParameters::default()).unwrap();
    let outcome = run(&mut world.robot(0).unwrap(), &mut racer, 120.0, |_, _, _| {}).unwrap();
    (outcome, world.truth().pose(0).unwrap().x, world.truth().time())
}

#[test]
fn a_car_without_a_lane_stops() {
    for pairs in [0, 10] {
        let (outcome, x, time) = on_a_strip(pairs);
        assert_eq!(outcome, RaceOutcome::Lost);
        assert!(x < 4.0 * f64::from(pairs) + 25.0 && time < 60.0, "{x} m after {time} s");
    }
}

#[test]
fn a_car_that_is_not_where_its_map_says_stops() {
    let GeneratedTrack { track, corridor } = generate(21, &TrackOptions::drawn(21)).unwrap();
    let world = Simulation::new(&track.scene(&[track.start.unwrap()]), SimOptions::default()).unwrap();
    let mut car = world.robot(0).unwrap();
    let metres = || world.truth().robot(0).unwrap().path_length;
    let mut racer = Racer::new(RacerParameters::default()).unwrap();
    let mut scan = LidarScan::default();
    // The estimated pose leaps by some metres in the third lap, as after a wrong correction.
    let leap = |racer: &Racer| if racer.laps() < 2 { Pose::default() } else { Pose::new(4.0, 3.0, 0.4) };
    let (mut before, mut fast) = (0.0, 0.0);
    while car.now().unwrap() < 400.0 {
        car.scan_into(&mut scan).unwrap();
        let (pose, speed) = (car.pose().unwrap(), car.speed().unwrap());
        let command = racer.step(leap(&racer).compose(&pose), speed, &scan);
        car.set_speed(command).unwrap();
        car.wait(0.05).unwrap();
        if racer.laps() < 2 {
            (before, fast) = (metres(), speed.linear);
        }
        if racer.is_done(speed) {
            break;
        }
    }
    let gone = metres() - before;
    // It notices within a second and then brakes at 4 m/s²; a tenth is added for lags.
    let most = 1.1 * (fast + fast * fast / 8.0);
    assert!(racer.phase() == RacePhase::Lost && gone < most, "{:?} after {gone} of {most} m", racer.phase());
    assert!(corridor.length() > 2.0 * gone);
}

#[test]
fn the_same_seed_gives_the_same_race() {
    let [a, b] = [0, 1].map(|_| race(2, 1).verdict);
    assert_eq!(a, b);
}

#[test]
fn odometry_that_is_no_number_stops_a_racer_and_nothing_else() {
    let mut racer = Racer::new(RacerParameters::default()).unwrap();
    let before = racer.decide(Pose::default(), Twist::new(2.0, 0.0), &[]);
    for wrong in [f64::NAN, f64::INFINITY] {
        assert_eq!(racer.decide(Pose::new(wrong, 0.0, 0.0), Twist::new(2.0, 0.0), &[]), Twist::STOP);
        assert_eq!(racer.decide(Pose::default(), Twist::new(2.0, wrong), &[]), Twist::STOP);
    }
    let after = racer.decide(Pose::default(), Twist::new(2.0, 0.0), &[]);
    assert!(before.is_finite() && after.is_finite());
}
