//! Where a road comes back to itself.

use super::course::{Course, CourseError};
use crate::geometry::Point;

/// Metres between the outer edges of the markings of neighbouring parts of a road, at least.
const APART: f64 = 0.05;
/// Metres along the road from one place that is looked at to the next.
const STRIDE: f64 = 0.10;
/// Metres from the middle of a crossing within which the road may be near itself.
const AROUND: f64 = 2.0;
/// Metres between the middles of a crossing as its two ways see them.
const TOGETHER: f64 = 0.15;

/// Fails where a road crosses itself at no crossing, or nearly does.
pub(super) fn check(course: &Course) -> Result<(), CourseError> {
    let line = &course.line;
    let size = course.size;
    let count = (line.length() / (STRIDE * size)).ceil() as usize;
    let stride = line.length() / count as f64;
    let places: Vec<Point> = (0..count).map(|i| line.at(stride * i as f64).pose.position()).collect();
    let width = 2.0 * course.edge() + course.line_width;
    let near = width + APART * size;
    // Along a bend, the road is as near to itself as half the way around: that is no crossing.
    let apart = ((1.6 * near / stride).ceil() as usize).max(1);
    let shared = shared_crossings(course);
    for first in 0..count {
        for second in first + apart..count.min(count + first + 1 - apart) {
            // A stride's slack: between two places the road may be nearer.
            if (places[first] - places[second]).norm() >= near - 0.02 * size {
                continue;
            }
            let (first, second) = (stride * first as f64, stride * second as f64);
            let around = |a: f64, b: f64| {
                let way = (a - b).abs();
                way.min(line.length() - way) < AROUND * size
            };
            let joins = |&(a, b): &(f64, f64)| {
                (around(first, a) && around(second, b)) || (around(first, b) && around(second, a))
            };
            if !shared.iter().any(joins) {
                return Err(CourseError::CrossesItself { first, second, apart: APART * size });
            }
        }
    }
    Ok(())
}

/// The pairs of crossings that are one.
pub(super) fn shared_crossings(course: &Course) -> Vec<(f64, f64)> {
    let middles: Vec<(f64, Point)> =
        course.crossings().map(|(at, _)| (at, course.line.at(at).pose.position())).collect();
    let mut pairs = Vec::new();
    for (i, (first, here)) in middles.iter().enumerate() {
        for (second, there) in &middles[i + 1..] {
            if (here - there).norm() < TOGETHER * course.size {
                pairs.push((*first, *second));
            }
        }
    }
    pairs
}
