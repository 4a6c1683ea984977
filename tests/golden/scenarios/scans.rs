//! Lidar scans: features, maps, matching and localisation, and the navigation that uses them.

use std::sync::Arc;

use roverlab::drive::{RandomDrive, RandomDriveObservation, RandomDriveParameters};
use roverlab::geometry::{Point, Pose, Twist};
use roverlab::io::control::{Senses, run};
use roverlab::io::sim::Lcd;
use roverlab::io::{Clock, Drive, Lidar, LidarScan, Odometry, Result};
use roverlab::nav::{Navigator, NavigatorParameters};
use roverlab::random::Stream;
use roverlab::scan::{
    Localisation, LocalisationMap, Localiser, LocaliserParameters, LogOddsMap, LogOddsMapParameters,
    ScanFeaturesParameters, ScanFilter, ScanMatcher, extract_features, local_extrema, plot_scan,
};
use roverlab::world::{Object, ObjectKind, RobotSpec, Scene};

use super::{Scenario, fnv, in_room, noise, note, other, ride, room};

pub(super) const SCENARIOS: &[Scenario] = &[
    Scenario::new("scan-features", features),
    Scenario::new("scan-map", map),
    Scenario::new("scan-matching", matching),
    Scenario::new("localisation", localisation),
    Scenario::new("navigate", navigate),
];

/// Walls, corners, things and extremes of scans from several places, and the scans on a display.
fn features() -> Result<String> {
    let mut found = String::new();
    let log = ride(&in_room(0.5, 0.5, 0.2), noise(1.0, 101), |robot| {
        robot.set_speed(Twist::new(0.15, 0.35))?;
        let mut lcd = Lcd::new();
        for round in 0..8 {
            robot.wait(0.8)?;
            let scan = robot.scan()?;
            let features = extract_features(&scan, &ScanFeaturesParameters::default())?;
            for wall in &features.walls {
                let line = (wall.line.middle, wall.line.direction, wall.line.rms, wall.line.points);
                note(&mut found, "wall", &(line, wall.ends, wall.beams.clone()));
            }
            for corner in &features.corners {
                note(&mut found, "corner", &(corner.position, corner.angle));
            }
            for thing in &features.objects {
                note(&mut found, "thing", &(thing.centre, thing.radius, thing.points));
            }
            for extremum in local_extrema(&scan, 5, 0.05) {
                note(&mut found, "extremum", &(extremum.beam, extremum.angle, extremum.range, extremum.kind));
            }
            plot_scan(&mut lcd, &scan, (round % 2 == 0).then_some(2.0))?;
            note(&mut found, "display", &fnv(lcd.frame().as_raw().iter().copied()));
        }
        Ok(())
    })?;
    Ok(log + &found)
}

/// A map of what was seen from a way around.
fn map() -> Result<String> {
    let scene = in_room(0.5, 0.5, 0.2);
    let start = scene.robots[0].pose;
    let mut map = LogOddsMap::new(64, 44, 0.05, Pose::new(-0.1, -0.1, 0.0), LogOddsMapParameters::default())
        .map_err(other)?;
    let mut log = ride(&scene, noise(0.5, 102), |robot| {
        robot.set_speed(Twist::new(0.15, 0.35))?;
        let mut scan = LidarScan::default();
        for _ in 0..12 {
            robot.wait(0.5)?;
            robot.scan_into(&mut scan)?;
            map.add(start.compose(&robot.pose()?), &scan);
        }
        Ok(())
    })?;
    let grid = map.to_occupancy(0.3, 0.7);
    for row in 0..44 {
        note(&mut log, "row", &(0..64).map(|column| map.probability(column, row)).collect::<Vec<_>>());
        note(&mut log, "cells", &(0..64).map(|column| grid.cell(column, row)).collect::<Vec<_>>());
    }
    Ok(log)
}

/// Odometry corrected by scans, and ranges smoothed on the way.
fn matching() -> Result<String> {
    let mut found = String::new();
    let log = ride(&in_room(0.5, 0.5, 0.2), noise(2.0, 103), |robot| {
        let (mut matcher, mut filter) = (ScanMatcher::new(), ScanFilter::new());
        let (mut scan, mut points) = (LidarScan::default(), Vec::<Point>::new());
        robot.set_speed(Twist::new(0.15, 0.35))?;
        for _ in 0..120 {
            robot.wait(0.1)?;
            robot.scan_into(&mut scan)?;
            let odometry = robot.pose()?;
            points.clear();
            points.extend(scan.points());
            let pose = matcher.update(odometry, &points);
            filter.update(pose, &scan)?;
            // A reference takes smoothed points: it needs the directions of surfaces.
            points.clear();
            points.extend(filter.points());
            matcher.learn(&points);
            note(&mut found, "matched", &(pose, matcher.corrected(odometry), matcher.references()));
            note(&mut found, "filtered", &(filter.noise(), filter.ranges().step_by(9).collect::<Vec<_>>()));
        }
        note(&mut found, "points", &filter.points().collect::<Vec<_>>());
        Ok(())
    })?;
    Ok(log + &found)
}

/// A robot that does not know where it is drives about until it does.
fn localisation() -> Result<String> {
    let scene = in_room(2.4, 1.4, 2.0);
    let map = LocalisationMap::new(&scene.world)?;
    let mut found = String::new();
    let log = ride(&scene, noise(1.0, 104), |robot| {
        let parameters = LocaliserParameters { range_error: 0.01, ..LocaliserParameters::default() };
        let mut localiser = Localiser::new(map, parameters)?;
        let mut wander = RandomDrive::new(RandomDriveParameters::default(), Stream::new(104))?;
        let mut seen = RandomDriveObservation::default();
        for step in 0..120 {
            wander.sense(robot, 0.0, &mut seen)?;
            let odometry = seen.pose;
            if step % 4 == 0 {
                localiser.update(odometry, &seen.scan)?;
                let is_one = matches!(localiser.localisation(), Localisation::One(_));
                note(&mut found, "place", &(is_one, localiser.searches(), localiser.place(odometry)));
                for Hypothesis { pose, covariance, probability, explained } in numbers(&localiser) {
                    note(&mut found, "hypothesis", &(pose, covariance, probability, explained));
                }
            }
            let twist = wander.step(odometry, &seen.points)?;
            robot.set_speed(twist)?;
            robot.wait(0.1)?;
        }
        Ok(())
    })?;
    Ok(log + &found)
}

/// The numbers of a place where the robot may be.
struct Hypothesis {
    pose: Pose,
    covariance: [f64; 9],
    probability: f64,
    explained: f64,
}

fn numbers(localiser: &Localiser) -> impl Iterator<Item = Hypothesis> + '_ {
    localiser.hypotheses().iter().map(|hypothesis| Hypothesis {
        pose: hypothesis.pose,
        covariance: std::array::from_fn(|k| hypothesis.covariance[k]),
        probability: hypothesis.probability,
        explained: hypothesis.explained,
    })
}

/// Through a known room with a crate that is not on the map.
fn navigate() -> Result<String> {
    let (known, start, goal) = (room(), Pose::new(0.4, 0.4, 0.3), Point::new(2.6, 1.7));
    let mut scene = Scene::with_robot(known.clone(), RobotSpec::s4(), start);
    let crate_kind = ObjectKind::predefined("crate").expect("the kind is predefined");
    scene.world.objects.push(Object::new(Arc::new(crate_kind), Pose::new(1.3, 1.5, 0.2)));
    let mut told = String::new();
    let log = ride(&scene, noise(1.0, 105), |robot| {
        let mut navigator = Navigator::new(&known, start, goal, NavigatorParameters::default())?;
        note(&mut told, "plan", &(navigator.path_length(), navigator.path()));
        let outcome = run(robot, &mut navigator, 40.0, |_, navigator, step| {
            let events = navigator.take_events();
            note(&mut told, "at", &(step.time, navigator.phase(), navigator.pose(), events));
        })?;
        note(&mut told, "outcome", &(outcome, navigator.goal_distance(), navigator.unknown_obstacles()));
        Ok(())
    })?;
    Ok(log + &told)
}
