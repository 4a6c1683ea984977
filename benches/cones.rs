//! Planning between cones: the lane around the car in a map of about 200 cones, the way through all of it,
//! and the racing line on it, with all cones and with some that are missing and some that are false. What
//! counts is the worst track, so the slowest of many is printed beside the mean; each is the fastest of some
//! repetitions, as the machine has other things to do.

use std::hint::black_box;
use std::time::Instant;

use criterion::{Criterion, criterion_group, criterion_main};
use roverlab::geometry::{Point, Pose, Vector, math};
use roverlab::race::{
    CarLimits, CentreLine, CentreLineParameters, Cone, GeneratedTrack, Lane, LaneParameters, LineSolver,
    RacingLineParameters, SpeedProfile, TrackOptions, generate, lane,
};

/// A map without colours, where the car is, and a way that was driven.
struct Map {
    cones: Vec<Cone>,
    start: Pose,
    driven: Vec<Point>,
}

/// Maps of 190 to 210 cones.
fn maps() -> Vec<Map> {
    let mut maps = Vec::new();
    for seed in 0..2000 {
        let GeneratedTrack { track, corridor } = generate(seed, &TrackOptions::drawn(seed)).expect("a track");
        if !(190..=210).contains(&track.cones.len()) {
            continue;
        }
        let cones = track.cones.iter().map(|cone| Cone::unknown(cone.position)).collect();
        let driven = corridor.stations().iter().step_by(2).map(|station| station.position).collect();
        maps.push(Map { cones, start: track.start.expect("a start"), driven });
    }
    maps
}

/// The lane from a place on the way that was driven, as it is looked for in the first lap.
fn lane_from(map: &Map, place: usize) -> Option<Lane> {
    let pose = |i: usize| {
        let ahead = map.driven[i + 1] - map.driven[i];
        Pose::new(map.driven[i].x, map.driven[i].y, math::atan2(ahead.y, ahead.x))
    };
    let behind: Vec<Pose> = (place - 5..place).map(pose).collect();
    let unknown = Lane { points: Vec::new(), edges: [Vec::new(), Vec::new()], half_width: 1.9 };
    lane(&map.cones, &behind, pose(place), &unknown, &LaneParameters::default())
}

/// A map in which one cone in ten is missing and as many are false.
fn spoilt(map: &Map) -> Map {
    let kept = map.cones.iter().enumerate().filter(|(index, _)| index % 10 != 3).map(|(_, cone)| *cone);
    let aside = |cone: &Cone| Cone::unknown(cone.position + Vector::new(1.6, -1.9));
    let cones = kept.chain(map.cones.iter().step_by(10).map(aside)).collect();
    Map { cones, start: map.start, driven: map.driven.clone() }
}

/// Milliseconds, the fastest of twenty.
#[allow(clippy::disallowed_methods, reason = "a benchmark measures")]
fn fastest(mut work: impl FnMut()) -> f64 {
    let times = (0..20).map(|_| {
        let begin = Instant::now();
        work();
        begin.elapsed().as_secs_f64() * 1e3
    });
    times.fold(f64::INFINITY, f64::min)
}

fn tell(name: &str, times: &[f64]) {
    let worst = times.iter().copied().fold(0.0, f64::max);
    let mean = times.iter().sum::<f64>() / times.len() as f64;
    println!("{name}: worst {worst:.3} ms, mean {mean:.3} ms of {}", times.len());
}

fn planning(c: &mut Criterion) {
    let parameters = CentreLineParameters::default();
    let limits = CarLimits::circle(8.5, 5.0, 7.0, 20.0);
    let racing = RacingLineParameters { margin: 0.95, ..RacingLineParameters::default() };
    let maps = maps();
    let (mut lanes, mut ways, mut lines, mut profiles) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let (mut spoilt_lanes, mut spoilt_ways) = (Vec::new(), Vec::new());
    let mut solver = LineSolver::default();
    for map in &maps {
        for place in (5..map.driven.len() - 1).step_by(100) {
            assert!(lane_from(map, place).is_some(), "there are cones beside the car");
            lanes.push(fastest(|| {
                black_box(lane_from(map, place));
            }));
        }
        let spoilt = spoilt(map);
        for place in (5..map.driven.len() - 1).step_by(100) {
            spoilt_lanes.push(fastest(|| {
                black_box(lane_from(&spoilt, place));
            }));
        }
        // Whether it finds a way or not: both take their time.
        spoilt_ways.push(fastest(|| {
            let _ = black_box(CentreLine::along(&spoilt.cones, spoilt.start, &spoilt.driven, &parameters));
        }));
        let plan = || CentreLine::along(&map.cones, map.start, &map.driven, &parameters).expect("a way");
        let way = plan();
        assert!(way.corridor.is_closed(), "the whole track is planned");
        ways.push(fastest(|| {
            black_box(plan());
        }));
        let line = solver.solve(&way.corridor, &racing).expect("a line");
        lines.push(fastest(|| {
            black_box(solver.solve(&way.corridor, &racing).expect("a line"));
        }));
        profiles.push(fastest(|| {
            black_box(SpeedProfile::closed(&line.points, &limits).expect("a profile"));
        }));
    }
    tell("lane around the car", &lanes);
    tell("triangulation, way and corridor", &ways);
    tell("lane, cones missing and false", &spoilt_lanes);
    tell("way, cones missing and false", &spoilt_ways);
    tell("racing line", &lines);
    tell("speed profile", &profiles);
    let map = &maps[0];
    c.bench_function("cones: way through 200", |b| {
        b.iter(|| CentreLine::along(black_box(&map.cones), map.start, &map.driven, &parameters));
    });
}

criterion_group!(benches, planning);
criterion_main!(benches);
