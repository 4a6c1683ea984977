use std::f64::consts::{FRAC_PI_2, TAU};

use super::*;
use crate::geometry::{Pose, direction};
use crate::race::{CarLimits, RacerParameters};

/// Radius of the circular way (m).
const RADIUS: f64 = 60.0;

fn at(way: f64) -> Pose {
    let angle = way / RADIUS;
    let place = direction(angle) * RADIUS;
    Pose::new(place.x, place.y, angle + FRAC_PI_2)
}

/// A ring with a half width, on whose centre line the car is.
fn passing(half_width: f64) -> Passing {
    let n = 360;
    let place = |k: i32| at(TAU * RADIUS * f64::from(k) / f64::from(n)).position();
    let rows: Vec<_> = (0..n).map(|k| (place(k), half_width, half_width)).collect();
    let corridor = Corridor::closed(&rows).unwrap();
    let outline = RacerParameters::default().outline;
    let parameters = RacingLineParameters::default();
    let margins = LineSolver::default().margins_for(&corridor, &outline, &parameters).unwrap();
    let points: Vec<Point> = corridor.stations().iter().map(|station| station.position).collect();
    let profile = SpeedProfile::closed(&points, &CarLimits::circle(10.0, 8.0, 8.0, 12.0)).unwrap();
    Passing::new(corridor, outline, margins, vec![0.0; 360], &profile)
}

/// Follows a car at 3 m/s, of which the rear is visible, for a second. Returns the last line and the
/// distance driven.
fn follow(passing: &mut Passing, aside: f64) -> (Option<Vec<Point>>, f64) {
    let mut line = None;
    for step in 0..20 {
        let way = 0.15 * f64::from(step);
        let rear = at(way + 10.0);
        let points = [-0.7, 0.0, 0.7].map(|y| rear.to_world(Point::new(0.0, y + aside))).to_vec();
        passing.watch(at(way).position(), 3.0, &[points], 0.05);
        line = passing.change(&mut LineSolver::default(), |line| Some(line.to_vec())).or(line);
    }
    (line, 0.15 * 19.0)
}

#[test]
fn a_slower_car_is_passed_where_there_is_more_room() {
    for aside in [0.8, -0.8] {
        let mut passing = passing(3.5);
        let (line, way) = follow(&mut passing, aside);
        let line = line.expect("a line around it");
        // Beside the middle of the other car, some seconds later.
        let beside = at(way + 20.0);
        let nearest = line
            .iter()
            .map(|point| beside.to_local(*point))
            .min_by(|a, b| a.coords.norm().total_cmp(&b.coords.norm()));
        let offset = nearest.unwrap().y;
        assert!(offset * aside < 0.0 && (offset - aside).abs() > 1.9, "{aside}: {offset}");
        assert!(!passing.is_idle());
    }
}

#[test]
fn where_there_is_no_room_it_follows() {
    let mut passing = passing(2.0);
    assert!(follow(&mut passing, 0.0).0.is_none());
    let limit = passing.limit(5.0, 4.5).expect("a car is in the way");
    assert!((3.0..8.0).contains(&limit), "{limit}");
}

#[test]
fn what_is_beside_the_track_or_past_does_not_matter() {
    let mut passing = passing(3.5);
    assert!(follow(&mut passing, 6.0).0.is_none() && passing.is_idle());
    follow(&mut passing, 0.0);
    assert!(!passing.is_idle());
    // Far past it.
    passing.watch(at(30.0).position(), 10.0, &[], 0.05);
    let line = passing.change(&mut LineSolver::default(), |line| Some(line.len()));
    let again = (0..5).find_map(|_| passing.change(&mut LineSolver::default(), |line| Some(line.len())));
    assert!(line.or(again).is_some() && passing.is_idle(), "back to the racing line");
    assert!(passing.limit(5.0, 4.5).is_none_or(|limit| limit > 50.0));
}

#[test]
fn a_car_that_was_passed_is_expected_a_lap_later() {
    let mut passing = passing(3.5);
    let (_, way) = follow(&mut passing, 0.0);
    let (seen, lap) = (way + 10.0, TAU * RADIUS);
    // On past it at 20 m/s, and around the lap to where it was; it drives 3 m/s.
    let mut limits = Vec::new();
    for step in 0..420 {
        let way = way + f64::from(step);
        passing.watch(at(way).position(), 20.0, &[], 0.05);
        limits.push((way, passing.limit(5.0, 4.5).unwrap_or(f64::INFINITY)));
    }
    let limit = |way: f64| limits.iter().find(|(at, _)| *at >= way).unwrap().1;
    assert!(limit(seen + 0.5 * lap) > 30.0, "on the far side");
    let [sighted, expected] = [seen + lap - HORIZON, seen + lap - 10.0].map(limit);
    assert!(sighted < 18.0 && expected < 18.0, "{sighted} {expected}");
    assert_eq!(limit(way + 419.0), limit(way + 418.0), "as long as it may come into sight");
}

#[test]
fn a_car_that_comes_nearer_from_the_side_is_given_way() {
    // It is passed on its right; its tail is 3 m ahead.
    let speed = |drift: f64| {
        let mut passing = passing(4.5);
        let mut limit = f64::INFINITY;
        for step in 0..14 {
            let (way, time) = (0.9 * f64::from(step), 0.05 * f64::from(step));
            let rear = at(way + 3.0);
            let aside = 2.5 - drift * time;
            let points = [-0.7, 0.0, 0.7].map(|y| rear.to_world(Point::new(0.0, y + aside))).to_vec();
            passing.watch(at(way).position(), 18.0, &[points], 0.05);
            limit = passing.limit(5.0, 4.5).unwrap();
        }
        limit
    };
    // 18 m/s, once it is seen to drive as fast.
    let [straight, across] = [0.0, 1.0].map(speed);
    assert!(across < 0.8 * straight, "{across} {straight}");
}

#[test]
fn a_line_that_is_refused_at_first_begins_at_the_car_later_too() {
    let mut passing = passing(3.5);
    let stations = passing.corridor.stations().iter();
    let earlier: Vec<Point> = stations.map(|station| station.aside(2.0)).collect();
    let mut solver = LineSolver::default();
    let place = |way: f64| at(way).to_world(Point::new(0.0, 2.0));
    let beside = |line: &[Point], way: f64| {
        line.iter().map(|point| (point - place(way)).norm()).fold(f64::INFINITY, f64::min)
    };
    let aside = beside(&earlier, 0.0);
    assert!(aside < 0.6 && passing.leads_over(&earlier, place(0.0), 10.0));
    assert!(passing.change(&mut solver, |_| None::<()>).is_none());
    let mut line = None;
    for step in 1..12 {
        let way = 0.5 * f64::from(step);
        passing.watch(place(way), 10.0, &[], 0.05);
        let found = passing.change(&mut solver, |line| Some(line.to_vec()));
        line = line.or(found.map(|line| beside(&line, way)));
    }
    assert!(line.is_some_and(|aside| aside < 0.8), "{line:?}");
}
