//! Crossings of a road with itself.

use super::course::{CourseError, RoadCourse};
use crate::geometry::Point;

/// Smallest distance between the outer edges of adjacent parts of a road (m).
const APART: f64 = 0.05;
/// Distance between checked places along the road (m).
const STRIDE: f64 = 0.10;
/// Distance from the middle of a crossing within which the road may be near itself (m).
const AROUND: f64 = 2.0;
/// Largest distance between the middles of a crossing on its two ways (m).
const TOGETHER: f64 = 0.15;

impl RoadCourse {
    /// Crossings of the road with itself: both places along the line, the earlier one first (m).
    ///
    /// ```
    /// use roverlab::world::formats::course;
    /// let pass = "straight 3000\ncrossing 90 none\nstraight 3000\narc 3000";
    /// let eight = course::parse(&format!("course 1\n{pass} 270\n{pass} -270\n"), "eight")?;
    /// let [(first, second)] = eight.own_crossings()[..] else { panic!("it crosses itself once") };
    /// assert!(first == 3.0 && (second - first - 20.14).abs() < 0.01);
    /// # Ok::<(), roverlab::world::formats::FormatError>(())
    /// ```
    pub fn own_crossings(&self) -> Vec<(f64, f64)> {
        let pairs = shared_crossings(self);
        pairs.into_iter().map(|(a, b)| (a.min(b), a.max(b))).collect()
    }
}

/// Fails where a road crosses or nearly crosses itself without a crossing.
pub(super) fn check(course: &RoadCourse) -> Result<(), CourseError> {
    let line = &course.line;
    let size = course.size;
    let count = (line.length() / (STRIDE * size)).ceil() as usize;
    let stride = line.length() / count as f64;
    let places: Vec<Point> = (0..count).map(|i| line.at(stride * i as f64).pose.position()).collect();
    let width = 2.0 * course.edge() + course.line_width;
    let near = width + APART * size;
    // In a bend, the road is as near to itself as half a turn of it; that is not a crossing.
    let apart = ((1.6 * near / stride).ceil() as usize).max(1);
    let shared = shared_crossings(course);
    for first in 0..count {
        for second in first + apart..count.min(count + first + 1 - apart) {
            // A tolerance of a stride, because the road may be nearer between two places.
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

/// Pairs of crossing marks that are the same crossing.
pub(super) fn shared_crossings(course: &RoadCourse) -> Vec<(f64, f64)> {
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
