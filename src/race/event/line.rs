//! Reference lines of the events, in the frame of their layout.

use std::f64::consts::TAU;

use super::layout::EventShape;
use crate::geometry::{Point, Vector, direction};

/// Approximate distance between points of a straight (m).
const STEP: f64 = 0.25;
/// Number of points on a lap of a circle.
const ROUND: u32 = 224;
/// Laps of each circle.
pub(super) const LAPS: u32 = 2;
/// Length of the transition between circles: standard deviation of the Gaussian that smooths it (m).
const PASSES: f64 = 2.0;

/// A straight line along x.
pub(super) fn straight(from: f64, to: f64) -> Vec<Point> {
    let parts = ((to - from) / STEP).ceil().max(2.0);
    (0..=parts as u32).map(|k| Point::new(from + (to - from) * f64::from(k) / parts, 0.0)).collect()
}

/// Path of a skidpad: in along x, two laps clockwise around the right centre, two counter-clockwise around
/// the left one, and out along x.
pub(super) fn eight(apart: f64, radius: f64, [from, to]: [f64; 2]) -> Vec<Point> {
    let mut points = straight(from, 0.0);
    points.pop();
    for side in [-1.0, 1.0] {
        let centre = Point::new(0.0, side * apart);
        points.extend((0..LAPS * ROUND).map(|k| {
            let arm = direction(TAU * f64::from(k) / f64::from(ROUND));
            // From the origin's side of the circle on, forwards.
            centre + Vector::new(arm.y, -side * arm.x) * radius
        }));
    }
    points.extend(straight(0.0, to));
    points
}

/// The same with laps at `radius` and smooth transitions. The number of points is independent of the layout.
pub(super) fn smooth_eight(apart: f64, radius: f64, ends: [f64; 2]) -> Vec<Point> {
    // Smoothing shrinks circles.
    let loss = 0.5 * (PASSES / radius) * (PASSES / radius);
    let mut points = eight(apart, radius * (1.0 + loss), ends);
    let passes = (2.0 * PASSES * PASSES / (STEP * STEP)).round() as usize;
    let n = points.len();
    for _ in 0..passes {
        let mut before = points[0];
        for i in 1..n - 1 {
            let here = points[i];
            points[i] = Point::from(0.25 * before.coords + 0.5 * here.coords + 0.25 * points[i + 1].coords);
            before = here;
        }
    }
    points
}

/// Indices at which the line crosses the origin of a skidpad: before the first lap, and after each one.
pub(super) fn crossings(ends: [f64; 2]) -> Vec<usize> {
    let first = straight(ends[0], 0.0).len() - 1;
    (0..=2 * LAPS).map(|lap| first + (lap * ROUND) as usize).collect()
}

/// Radius of the driven circle: `room` outside the inner cones, but at most midway between both circles.
pub(super) fn radius(shape: EventShape, room: f64) -> f64 {
    match shape {
        EventShape::Strip { .. } => f64::INFINITY,
        EventShape::Eight { inner, outer, .. } => (inner + room).min(0.5 * (inner + outer)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::race::{CarLimits, SpeedProfile};

    #[test]
    fn the_way_of_a_skidpad_bends_softly() {
        let ends = [-26.0, 14.0];
        let (round, smooth) = (eight(9.125, 8.8, ends), smooth_eight(9.125, 8.8, ends));
        assert_eq!(round.len(), smooth.len());
        let profile =
            SpeedProfile::open(&smooth, &CarLimits::circle(9.0, 8.0, 10.0, 30.0), 30.0, 0.0).unwrap();
        let sharpest = profile.curvatures.iter().fold(0.0_f64, |most, bend| most.max(bend.abs()));
        assert!(sharpest < 1.05 / 8.8, "{sharpest}");
        let crossings = crossings(ends);
        // Halfway through each lap it is on the far side of its circle.
        for (lap, side) in [(0, -1.0), (1, -1.0), (2, 1.0), (3, 1.0)] {
            let far = smooth[usize::midpoint(crossings[lap], crossings[lap + 1])];
            assert!((far - Point::new(0.0, side * (9.125 + 8.8))).norm() < 0.03, "{lap}: {far:?}");
        }
        // To the right first, and forwards.
        assert!(profile.curvatures[crossings[0] + 40] < 0.0 && smooth[crossings[0] + 8].x > 1.0);
        let steps = smooth.windows(2).map(|pair| (pair[1] - pair[0]).norm());
        assert!(steps.clone().fold(0.0, f64::max) < 0.3 && steps.fold(1.0, f64::min) > 0.15);
    }
}
