use crate::geometry::{Point, Vector, cross, free_distance, math};

/// Visible points around a disc-shaped robot, in its own frame, and the free space between them.
///
/// All lengths are measured from the robot's centre: a *clearance* equal to its radius means contact.
#[derive(Debug, Clone, Default)]
pub(super) struct Surroundings {
    points: Vec<Point>,
    /// Points near enough to matter for the next step.
    near: Vec<Point>,
    clearance: f64,
}

/// Minimum gain in distance per metre driven, for a robot that is closer to an obstacle than it should be.
const RECEDING_SLOPE: f64 = 0.25;

impl Surroundings {
    /// Replaces the visible points. Those within `reach` of the robot count for its next step.
    pub(super) fn update(&mut self, points: impl Iterator<Item = Point>, reach: f64) {
        self.points.clear();
        self.points.extend(points);
        self.near.clear();
        self.near.extend(self.points.iter().filter(|p| p.coords.norm_squared() < reach * reach));
        let nearest = self.near.iter().map(|p| p.coords.norm_squared()).fold(reach * reach, f64::min);
        self.clearance = nearest.sqrt();
    }

    /// All visible points.
    pub(super) fn points(&self) -> &[Point] {
        &self.points
    }

    /// Distance between the robot's centre and the nearest point on a straight step of `length` metres in a
    /// direction, and that point.
    ///
    /// Points that the step leaves behind, or moves away from fast enough, do not count: a robot too close to
    /// a wall may still drive away from it.
    pub(super) fn step_clearance(&self, unit: Vector, length: f64) -> (f64, Option<Point>) {
        let mut least = (f64::INFINITY, None);
        for point in &self.near {
            if let Some(distance) = self.passing_distance(point, unit, length).filter(|&d| d < least.0) {
                least = (distance, Some(*point));
            }
        }
        least
    }

    /// Whether a step keeps a clearance; stops at the first point that violates it.
    pub(super) fn is_step_free(&self, unit: Vector, length: f64, clearance: f64) -> bool {
        let keeps = |point| self.passing_distance(point, unit, length).is_none_or(|d| d >= clearance);
        self.near.iter().all(keeps)
    }

    /// Distance between the robot's centre and a point on a step, if the point counts.
    fn passing_distance(&self, point: &Point, unit: Vector, length: f64) -> Option<f64> {
        let along = point.coords.dot(&unit);
        if along <= 0.0 {
            return None;
        }
        let across = cross(unit, point.coords).abs();
        let distance = if along <= length { across } else { math::hypot(across, along - length) };
        let receding = distance >= self.clearance + RECEDING_SLOPE * along.min(length);
        (!receding).then_some(distance)
    }

    /// Distance a disc of radius `radius` can move in a direction before it touches something, and the point
    /// it touches.
    ///
    /// A radius larger than the current clearance is reduced to it.
    pub(super) fn free_distance(&self, unit: Vector, radius: f64) -> (f64, Option<Point>) {
        free_distance(&self.points, unit, radius.min(self.clearance - 1e-3))
    }

    /// Adds a point known to exist though it is currently hidden.
    pub(super) fn remember(&mut self, point: Point) {
        self.near.push(point);
        self.clearance = self.clearance.min(point.coords.norm());
    }

    /// The visible point nearest to a place.
    pub(super) fn nearest_to(&self, place: Point) -> Option<Point> {
        self.near
            .iter()
            .min_by(|a, b| (*a - place).norm_squared().total_cmp(&(*b - place).norm_squared()))
            .copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::direction;
    use proptest::prelude::*;

    fn seeing(points: Vec<Point>) -> Surroundings {
        let mut surroundings = Surroundings::default();
        surroundings.update(points.into_iter(), 1.0);
        surroundings
    }

    fn points() -> impl Strategy<Value = Vec<Point>> {
        let around = (0.15..0.9f64, -3.1..3.1f64);
        prop::collection::vec(around.prop_map(|(r, a)| Point::origin() + direction(a) * r), 1..30)
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn a_disc_moved_by_its_free_distance_just_touches(points in points(), angle in -3.1..3.1f64) {
            let (radius, unit) = (0.1, direction(angle));
            let (free, touched) = seeing(points.clone()).free_distance(unit, radius);
            let gap = |at: Vector| points.iter().map(|p| (p.coords - at).norm()).fold(f64::INFINITY, f64::min);
            match touched {
                Some(_) => prop_assert!((gap(unit * free) - radius).abs() < 1e-9),
                None => prop_assert!(gap(unit * 0.5) >= radius - 1e-9),
            }
        }

        #[test]
        fn a_step_with_enough_clearance_is_free(points in points(), angle in -3.1..3.1f64) {
            let surroundings = seeing(points);
            let (radius, length, unit) = (0.1, 0.2, direction(angle));
            let (clearance, _) = surroundings.step_clearance(unit, length);
            let (free, _) = surroundings.free_distance(unit, radius);
            prop_assert_eq!(surroundings.is_step_free(unit, length, radius), clearance >= radius);
            if clearance >= radius {
                prop_assert!(free >= length - 1e-9, "{clearance} {free}");
            }
        }
    }

    #[test]
    fn a_robot_too_near_to_a_wall_may_drive_off_but_not_along() {
        let wall = (-40..40).map(|i| Point::new(0.01 * f64::from(i), -0.05)).collect();
        let surroundings = seeing(wall);
        assert!(surroundings.step_clearance(direction(0.0), 0.1).0 < 0.07);
        assert_eq!(surroundings.step_clearance(direction(0.8), 0.1).0, f64::INFINITY);
    }
}
