use std::collections::VecDeque;

use nalgebra::{Matrix3, Vector3};

use crate::geometry::{FittedLine, Point, Vector};

/// The points of walls around a craft that its distance sensors have hit lately, and how the wall at its side
/// goes on.
#[derive(Debug, Clone, Default)]
pub(super) struct WallMemory {
    side: VecDeque<Point>,
    ahead: VecDeque<Point>,
    /// At the other side.
    far: VecDeque<Point>,
    /// How many of the newest points at the side follow each other without a gap.
    run: usize,
    /// Where the wall at the side goes on.
    onward: Vec<Point>,
    /// Radians in a metre by which it bends there, positive to the left of its way.
    bend: f64,
}

/// Number of points that are kept of each sensor.
const KEPT: usize = 120;
/// Distance within which points are kept (m).
const NEAR: f64 = 4.0;
/// Metres between two hits that are on different walls.
const GAP: f64 = 0.3;
/// Lengths of wall (m) by which it is continued: the longest that it fits.
const WINDOWS: [f64; 5] = [1.8, 1.2, 0.8, 0.5, 0.3];
/// The root mean square of what a wall's points are off (m): sensors' errors are less.
const FITS: f64 = 0.03;
/// Number of newest points that show whether a wall begins to bend.
const LAST: usize = 4;
/// Largest mean deviation of these from the wall (m).
const DRIFT: f64 = 0.008;
/// Length by which a wall is continued (m).
const ONWARD: f64 = 1.3;
/// Distance between the points of a continuation (m).
const SPACING: f64 = 0.1;

impl WallMemory {
    /// Takes notice of what the sensors have hit from a place: the one at the side, and those ahead and at
    /// the other side.
    pub(super) fn add(&mut self, place: Point, side: Option<Point>, [ahead, far]: [Option<Point>; 2]) {
        let near = |point: &Point| (point - place).norm() < NEAR;
        let continues =
            side.zip(self.side.back()).is_some_and(|(point, before)| (point - before).norm() < GAP);
        self.run = if continues { self.run + 1 } else { usize::from(side.is_some()) };
        self.side.extend(side);
        self.ahead.extend(ahead.filter(near));
        self.far.extend(far.filter(near));
        for points in [&mut self.side, &mut self.ahead, &mut self.far] {
            points.retain(near);
            points.drain(..points.len().saturating_sub(KEPT));
        }
        self.run = self.run.min(self.side.len());
        (self.onward, self.bend) =
            WINDOWS.iter().find_map(|&length| self.continued(length)).unwrap_or_default();
    }

    /// The nearest place of a wall that is known or goes on.
    pub(super) fn nearest(&self, place: Point) -> Option<Point> {
        let points = self.side.iter().chain(&self.ahead).chain(&self.far).chain(&self.onward).copied();
        points.min_by(|a, b| (a - place).norm_squared().total_cmp(&(b - place).norm_squared()))
    }

    /// How much the wall at the side bends (rad/m), positive to the left; 0 where it has ended.
    pub(super) fn bend(&self) -> f64 {
        self.bend
    }

    /// Metres from a place to the nearest wall; infinite if none is known.
    pub(super) fn clearance(&self, place: Point) -> f64 {
        self.nearest(place).map_or(f64::INFINITY, |point| (point - place).norm())
    }

    /// How the wall goes on after its last so many metres; `None` if these are of no one wall.
    fn continued(&self, length: f64) -> Option<(Vec<Point>, f64)> {
        let newest = *self.side.back()?;
        let run = self.side.iter().rev().take(self.run);
        let run: Vec<Point> = run.take_while(|point| (*point - newest).norm() <= length).copied().collect();
        let line = FittedLine::through(run.iter().rev().copied())?;
        if line.length < 0.8 * length {
            return None;
        }
        let across = Vector::new(-line.direction.y, line.direction.x);
        let local = |point: &Point| {
            let off = point - line.middle;
            Vector::new(off.dot(&line.direction), off.dot(&across))
        };
        let points: Vec<Vector> = run.iter().map(local).collect();
        let bend = if length >= 0.8 { parabola(&points)? } else { Vector3::zeros() };
        let height = |along: f64| bend.dot(&Vector3::new(1.0, along, along * along));
        let squares: f64 =
            points.iter().map(|point| (point.y - height(point.x)) * (point.y - height(point.x))).sum();
        let last = &points[..points.len().min(LAST)];
        let drift = last.iter().map(|point| point.y - height(point.x)).sum::<f64>() / last.len() as f64;
        if (squares / points.len() as f64).sqrt() > FITS || drift.abs() > DRIFT {
            return None;
        }
        let begin = points[0].x;
        let steps = 1..=(ONWARD / SPACING) as usize;
        let on = steps.map(|step| begin + SPACING * step as f64);
        let on = on.map(|along| line.middle + line.direction * along + across * height(along));
        Some((on.collect(), 2.0 * bend.z))
    }
}

/// The coefficients of the parabola through points by least squares.
fn parabola(points: &[Vector]) -> Option<Vector3<f64>> {
    let (mut square, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for point in points {
        let powers = Vector3::new(1.0, point.x, point.x * point.x);
        square += powers * powers.transpose();
        right += powers * point.y;
    }
    Some(square.try_inverse()? * right)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::direction;

    #[test]
    fn a_round_wall_goes_on_round() {
        let mut memory = WallMemory::default();
        let at = |angle: f64| Point::origin() + direction(angle) * 3.0;
        for i in 0..60 {
            let angle = 0.01 * f64::from(i);
            memory.add(Point::origin() + direction(angle) * 2.2, Some(at(angle)), [None; 2]);
        }
        // 0.8 m beyond the last point, the wall itself and not its tangent.
        let beyond = at(0.59 + 0.8 / 3.0);
        assert!(memory.clearance(beyond) < 0.06, "{}", memory.clearance(beyond));
        assert!(memory.clearance(at(0.59 + 1.9 / 3.0)) > 0.4);
    }

    #[test]
    fn a_wall_that_ends_does_not_go_on() {
        let mut memory = WallMemory::default();
        for i in 0..40 {
            memory.add(
                Point::new(0.03 * f64::from(i), 0.0),
                Some(Point::new(0.03 * f64::from(i), 0.8)),
                [None; 2],
            );
        }
        let on = Point::new(1.9, 0.8);
        assert!(memory.clearance(on) < 0.06);
        memory.add(Point::new(1.2, 0.0), Some(Point::new(1.2, 3.5)), [None; 2]);
        assert!(memory.clearance(on) > 0.6);
        memory.add(Point::new(1.23, 0.0), None, [None; 2]);
        assert!(memory.clearance(on) > 0.6);
    }
}
