use std::f64::consts::TAU;

use crate::geometry::{Point, Vector, direction, math, normalize_angle};

/// How far a disc can move in every direction: a scan from the perspective of a disc-shaped robot.
///
/// Distant points are enlarged by what may hide between two beams.
#[derive(Debug, Clone)]
pub(super) struct Panorama {
    units: Vec<Vector>,
    free: Vec<f64>,
}

/// An end of an obstacle: a jump of the free range between neighbouring directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Edge {
    /// Direction along its free side (rad), counter-clockwise from the robot's heading.
    pub(super) bearing: f64,
    /// Distance (m).
    pub(super) distance: f64,
    /// Side of that direction on which the obstacle lies: +1 counter-clockwise, -1 clockwise.
    pub(super) obstacle: f64,
}

/// Number of directions: one per degree, as of an EyeBot's lidar.
const DIRECTIONS: usize = 360;
/// Distance between them (rad). At a distance of one metre, an obstacle of this size may be missed.
const SPACING: f64 = TAU / DIRECTIONS as f64;

impl Default for Panorama {
    fn default() -> Self {
        let units = (0..DIRECTIONS).map(|i| direction(SPACING * i as f64)).collect();
        Self { units, free: vec![f64::INFINITY; DIRECTIONS] }
    }
}

impl Panorama {
    /// Computes the free ranges among points in the robot's frame. A radius larger than the current clearance
    /// is reduced to it.
    pub(super) fn look(&mut self, points: &[Point], radius: f64) {
        let nearest = points.iter().map(|p| p.coords.norm_squared()).fold(f64::INFINITY, f64::min).sqrt();
        let radius = radius.min(nearest - 1e-3);
        self.free.fill(f64::INFINITY);
        for point in points {
            self.take_in(point, radius);
        }
    }

    /// Shortens the free ranges blocked by one point.
    fn take_in(&mut self, point: &Point, radius: f64) {
        let away = point.coords.norm();
        let radius = (radius + SPACING * away).min(away - 1e-3);
        if radius <= 0.0 {
            return;
        }
        let half_width = math::asin(radius / away);
        let bearing = math::atan2(point.y, point.x);
        let first = ((bearing - half_width) / SPACING).ceil() as i64;
        let last = ((bearing + half_width) / SPACING).floor() as i64;
        for k in first..=last {
            let i = k.rem_euclid(DIRECTIONS as i64) as usize;
            let along = point.coords.dot(&self.units[i]);
            let across = point.coords.norm_squared() - along * along;
            let free = (along - (radius * radius - across).max(0.0).sqrt()).max(0.0);
            self.free[i] = self.free[i].min(free);
        }
    }

    /// The ends of obstacles with more than `depth` metres of free space behind them.
    pub(super) fn edges(&self, depth: f64) -> impl Iterator<Item = Edge> + '_ {
        (0..DIRECTIONS).filter_map(move |i| {
            let next = (i + 1) % DIRECTIONS;
            let (here, there) = (self.free[i], self.free[next]);
            let edge = |index: usize, distance: f64, obstacle: f64| Edge {
                bearing: normalize_angle(SPACING * index as f64),
                distance,
                obstacle,
            };
            if there > here + depth {
                Some(edge(next, here, -1.0))
            } else if here > there + depth {
                Some(edge(i, there, 1.0))
            } else {
                None
            }
        })
    }

    /// The positions where the disc would touch the obstacle in a direction, as far as it appears connected:
    /// neighbouring positions are at most `link` metres apart.
    pub(super) fn obstacle(&self, bearing: f64, link: f64) -> impl Iterator<Item = Point> + '_ {
        let begin = (bearing / SPACING).round() as i64;
        let end = move |k: i64| {
            let i = k.rem_euclid(DIRECTIONS as i64) as usize;
            Point::origin() + self.units[i] * self.free[i]
        };
        let linked = move |k: i64, sense: i64| {
            // A position at infinity gives NaN and is linked to nothing.
            (end(begin + sense * k) - end(begin + sense * (k - 1))).norm() <= link
        };
        let to_side = move |sense: i64| {
            (1..DIRECTIONS as i64 / 2)
                .take_while(move |&k| linked(k, sense))
                .map(move |k| end(begin + sense * k))
        };
        to_side(1).chain(to_side(-1))
    }

    /// The position nearest to `goal` reachable by a straight move of at most `reach` metres and the fraction
    /// `trust` of the free range.
    pub(super) fn nearest_to(&self, goal: Point, reach: f64, trust: f64) -> Point {
        let ends = self.units.iter().zip(&self.free).map(|(unit, free)| {
            let along = goal.coords.dot(unit).clamp(0.0, (free * trust).min(reach));
            Point::origin() + unit * along
        });
        ends.min_by(|a, b| (a - goal).norm_squared().total_cmp(&(b - goal).norm_squared()))
            .unwrap_or(Point::origin())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nav::surroundings::Surroundings;
    use proptest::prelude::*;

    fn looking(points: &[Point], radius: f64) -> Panorama {
        let mut panorama = Panorama::default();
        panorama.look(points, radius);
        panorama
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn free_ranges_are_those_of_single_directions_less_what_may_hide(
            places in prop::collection::vec((0.15..2.0f64, -3.1..3.1f64), 1..40), index in 0usize..360,
        ) {
            let points: Vec<Point> = places.iter().map(|&(r, a)| Point::origin() + direction(a) * r).collect();
            let panorama = looking(&points, 0.1);
            let mut surroundings = Surroundings::default();
            surroundings.update(points.iter().copied(), 3.0);
            let unit = direction(SPACING * index as f64);
            let wide = surroundings.free_distance(unit, 0.1 + 2.0 * SPACING).0;
            let narrow = surroundings.free_distance(unit, 0.1).0;
            let found = panorama.free[index];
            // A larger disc is stopped earlier. The clearance limits the wide one, so the bound below is
            // loose.
            prop_assert!(found <= narrow + 1e-9, "{found} {narrow}");
            prop_assert!(wide.is_finite() || found > 0.0);
        }

        #[test]
        fn the_nearest_place_is_free_and_no_farther_than_the_robot(
            places in prop::collection::vec((0.15..2.0f64, -3.1..3.1f64), 1..40),
            x in -2.0..2.0f64, y in -2.0..2.0f64,
        ) {
            let points: Vec<Point> = places.iter().map(|&(r, a)| Point::origin() + direction(a) * r).collect();
            let goal = Point::new(x, y);
            let place = looking(&points, 0.1).nearest_to(goal, 1.5, 1.0);
            prop_assert!((place - goal).norm() <= goal.coords.norm() + 1e-9);
            let clear = points.iter().map(|p| (p - place).norm()).fold(f64::INFINITY, f64::min);
            prop_assert!(clear >= 0.1 - 1e-6, "{clear}");
        }
    }

    #[test]
    fn a_wall_has_two_ends() {
        let wall: Vec<Point> = (-30..=30).map(|i| Point::new(0.8, 0.01 * f64::from(i))).collect();
        let panorama = looking(&wall, 0.1);
        let edges: Vec<Edge> = panorama.edges(0.2).collect();
        assert_eq!(edges.len(), 2, "{edges:?}");
        for edge in edges {
            // The tangent to the disc around the wall's end at (0.8, 0.3), with what may hide at 0.85 m.
            let expected = math::atan2(0.3, 0.8) + math::asin((0.1 + SPACING * 0.854) / 0.854);
            assert!((edge.bearing.abs() - expected).abs() < 1.1 * SPACING, "{edge:?}");
            assert_eq!(edge.obstacle, -edge.bearing.signum());
        }
        assert!((panorama.free[0] - (0.7 - 0.8 * SPACING)).abs() < 1e-3);
        let seen: Vec<Point> = panorama.obstacle(0.0, 0.12).collect();
        assert!(seen.len() > 40 && seen.iter().all(|p| p.x < 0.8), "{seen:?}");
    }
}
