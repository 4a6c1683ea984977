use super::*;
use crate::geometry::direction;
use crate::geometry::units::from_deg;

/// Radius within which ends are remembered (m).
const REACH: f64 = 0.3;
/// Maximum distance between two observations of one point (m).
const ERROR: f64 = 0.003;

/// A thin wall ahead, across the robot's way and half a metre long to the left, and another one far
/// behind.
fn wall_and_background() -> Vec<Point> {
    let background = (0..60).map(|i| Point::new(-0.3, -0.6 + 0.02 * f64::from(i)));
    (0..40).map(|i| Point::new(0.1, 0.01 * f64::from(i))).chain(background).collect()
}

fn background() -> Vec<Point> {
    wall_and_background().split_off(40)
}

/// The hidden ends, for a robot that sees exactly the measured points.
fn hidden(ends: &mut WallEnds, pose: &Pose, measured: &[Point]) -> Vec<Point> {
    ends.update(pose, measured, REACH, ERROR);
    ends.hidden(pose, measured, ERROR).collect()
}

#[test]
fn an_end_that_goes_out_of_sight_is_where_it_was() {
    let mut ends = WallEnds::default();
    assert_eq!(hidden(&mut ends, &Pose::default(), &wall_and_background()), []);
    let moved = Pose::new(0.02, 0.01, 0.3);
    let hidden = hidden(&mut ends, &moved, &background());
    assert_eq!(hidden.len(), 1, "{hidden:?}");
    assert!((moved.to_world(hidden[0]) - Point::new(0.1, 0.0)).norm() < 1e-9, "{hidden:?}");
}

#[test]
fn what_is_seen_again_is_not_hidden() {
    let mut ends = WallEnds::default();
    for measured in [wall_and_background(), background(), wall_and_background()] {
        let count = hidden(&mut ends, &Pose::default(), &measured).len();
        assert_eq!(count, usize::from(measured.len() == background().len()));
    }
}

#[test]
fn an_end_that_a_filter_has_moved_is_where_it_was_measured() {
    let mut ends = WallEnds::default();
    ends.update(&Pose::default(), &wall_and_background(), REACH, ERROR);
    let seen = wall_and_background().split_off(1);
    let hidden: Vec<Point> = ends.hidden(&Pose::default(), &seen, ERROR).collect();
    assert_eq!(hidden, [Point::new(0.1, 0.0)]);
}

#[test]
fn ends_are_forgotten_with_time_and_with_distance() {
    let mut ends = WallEnds::default();
    hidden(&mut ends, &Pose::default(), &wall_and_background());
    for step in 1..=MEMORY + 1 {
        let count = hidden(&mut ends, &Pose::default(), &background()).len();
        assert_eq!(count, usize::from(step <= MEMORY), "{step}");
    }
    hidden(&mut ends, &Pose::default(), &wall_and_background());
    assert_eq!(hidden(&mut ends, &Pose::new(-0.3, 0.0, 0.0), &[]), []);
}

/// A wall from (0.1, 0.004) straight away from the robot, at a slant of a few degrees, in beams at
/// intervals of one degree.
#[test]
fn a_wall_seen_at_a_slant_may_end_before_the_next_beam() {
    let (end, along) = (Point::new(0.1, 0.004), Vector::new(1.0, 0.2));
    let hit = |degree: i32| {
        let beam = direction(from_deg(f64::from(degree)));
        // On the line, and on the beam.
        let t = cross(end.coords, beam) / cross(beam, along);
        (t >= 0.0).then(|| end + along * t)
    };
    let seen: Vec<Point> = (0..11).filter_map(hit).chain(background()).collect();
    let nearest = seen[0];
    assert!((nearest - end).norm() > ERROR, "{nearest}");
    let places: Vec<Point> = overhangs(&seen, REACH, ERROR).collect();
    assert_eq!(places.len(), 1, "{places:?}");
    let (before_end, on_line) = (places[0].x < end.x, cross(along, places[0] - end).abs());
    assert!(before_end && on_line < 1e-4, "{places:?}");
}

#[test]
fn a_wall_seen_from_the_front_has_no_overhang() {
    let seen: Vec<Point> =
        (0..40).map(|i| Point::new(0.1, 0.002 * f64::from(i))).chain(background()).collect();
    assert_eq!(overhangs(&seen, REACH, ERROR).count(), 0);
    assert_eq!(overhangs(&[], REACH, ERROR).count(), 0);
}
