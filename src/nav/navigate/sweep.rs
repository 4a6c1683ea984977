use std::f64::consts::TAU;

use crate::geometry::units::NEGLIGIBLE;
use crate::geometry::{Aabb, Point, Twist, math};
use crate::world::Footprint;

/// Computes when an outline moving with a constant twist touches a point; exact, without sampling.
///
/// Relative to the robot, a point moves along an arc around the robot's own centre of rotation.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sweep {
    outline: Footprint,
    twist: Twist,
}

impl Sweep {
    /// The outline inflated by `margin` metres; a rectangle keeps its corners.
    pub(super) fn new(footprint: &Footprint, margin: f64, twist: Twist) -> Self {
        let outline = match footprint {
            Footprint::Disc { radius } => Footprint::Disc { radius: radius + margin },
            Footprint::Rectangle(sides) => Footprint::Rectangle(sides.inflated(margin)),
        };
        Self { outline, twist }
    }

    /// Time until the outline touches one of the points in the robot's frame (s); infinite if it never does.
    ///
    /// A point already inside counts as touched at once, unless the outline moves away from it.
    pub(super) fn time_to_contact(&self, points: &[Point]) -> f64 {
        points.iter().map(|&point| self.time_to(point)).fold(f64::INFINITY, f64::min)
    }

    fn time_to(&self, point: Point) -> f64 {
        if self.is_inside(point) {
            return if self.moves_off(point) { f64::INFINITY } else { 0.0 };
        }
        if self.twist.angular.abs() < NEGLIGIBLE { self.straight(point) } else { self.turning(point) }
    }

    fn is_inside(&self, point: Point) -> bool {
        match &self.outline {
            Footprint::Disc { radius } => point.coords.norm_squared() < radius * radius,
            Footprint::Rectangle(sides) => sides.contains(point),
        }
    }

    /// Whether a point gets farther from the outline's centre.
    fn moves_off(&self, point: Point) -> bool {
        let middle = match &self.outline {
            Footprint::Disc { .. } => Point::origin(),
            Footprint::Rectangle(sides) => sides.min + sides.size() * 0.5,
        };
        let Twist { linear, angular } = self.twist;
        let (vx, vy) = (-linear + angular * point.y, -angular * point.x);
        let away = point - middle;
        away.x * vx + away.y * vy >= 0.0
    }

    fn straight(&self, point: Point) -> f64 {
        let speed = self.twist.linear;
        if speed == 0.0 {
            return f64::INFINITY;
        }
        // Front and back of the outline at the point's y coordinate.
        let (back, front) = match &self.outline {
            Footprint::Disc { radius } => {
                let depth = radius * radius - point.y * point.y;
                if depth <= 0.0 {
                    return f64::INFINITY;
                }
                (-depth.sqrt(), depth.sqrt())
            }
            Footprint::Rectangle(sides) => {
                if !(sides.min.y < point.y && point.y < sides.max.y) {
                    return f64::INFINITY;
                }
                (sides.min.x, sides.max.x)
            }
        };
        let gap = if speed > 0.0 { point.x - front } else { back - point.x };
        if gap >= 0.0 { gap / speed.abs() } else { f64::INFINITY }
    }

    fn turning(&self, point: Point) -> f64 {
        let centre = Point::new(0.0, self.twist.linear / self.twist.angular);
        let radius = (point - centre).norm();
        match &self.outline {
            Footprint::Disc { radius: disc } => self.until_disc(point, centre, radius, *disc),
            Footprint::Rectangle(sides) => self.until_rectangle(point, centre, radius, sides),
        }
    }

    /// The point's circle meets the disc where the two centres and the point form a triangle of known sides.
    fn until_disc(&self, point: Point, centre: Point, radius: f64, disc: f64) -> f64 {
        let apart = centre.coords.norm();
        let product = 2.0 * apart * radius;
        if product == 0.0 {
            return f64::INFINITY;
        }
        let cosine = (apart * apart + radius * radius - disc * disc) / product;
        if cosine.abs() > 1.0 {
            return f64::INFINITY;
        }
        let half = math::acos(cosine);
        let towards = Point::origin() - centre;
        let heading = math::atan2(towards.y, towards.x);
        [half, -half]
            .map(|side| self.until_angle(point, centre, heading + side))
            .into_iter()
            .fold(f64::INFINITY, f64::min)
    }

    fn until_rectangle(&self, point: Point, centre: Point, radius: f64, sides: &Aabb) -> f64 {
        let mut least = f64::INFINITY;
        let mut meet = |x: f64, y: f64| {
            if sides.inflated(1e-12).contains(Point::new(x, y)) {
                least = least.min(self.until_angle(point, centre, math::atan2(y - centre.y, x - centre.x)));
            }
        };
        let other = |offset: f64| {
            let squared = radius * radius - offset * offset;
            (squared >= 0.0).then(|| squared.sqrt())
        };
        for x in [sides.min.x, sides.max.x] {
            if let Some(dy) = other(x - centre.x) {
                meet(x, centre.y + dy);
                meet(x, centre.y - dy);
            }
        }
        for y in [sides.min.y, sides.max.y] {
            if let Some(dx) = other(y - centre.y) {
                meet(centre.x + dx, y);
                meet(centre.x - dx, y);
            }
        }
        least
    }

    /// Time until a point reaches an angle about the centre (s), moving against the robot's own rotation.
    fn until_angle(&self, point: Point, centre: Point, angle: f64) -> f64 {
        let from = point - centre;
        let now = math::atan2(from.y, from.x);
        let sense = -self.twist.angular.signum();
        ((angle - now) * sense).rem_euclid(TAU) / self.twist.angular.abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::kinematics::{Displacement, advance};
    use proptest::prelude::*;

    fn outlines() -> [Footprint; 2] {
        let sides = Aabb::new(Point::new(-0.05, -0.04), Point::new(0.09, 0.06));
        [Footprint::Disc { radius: 0.06 }, Footprint::Rectangle(sides)]
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        /// Moved step by step, the outline is free until the predicted time and touches then.
        #[test]
        fn contact_is_when_it_is_told(
            x in -0.5..0.5f64, y in -0.5..0.5f64, linear in -0.3..0.3f64, angular in -2.0..2.0f64, straight in any::<bool>()
        ) {
            let twist = Twist::new(linear, if straight { 0.0 } else { angular });
            for outline in outlines() {
                let sweep = Sweep::new(&outline, 0.0, twist);
                let point = Point::new(x, y);
                prop_assume!(!sweep.is_inside(point));
                let time = sweep.time_to_contact(&[point]);
                let seen_at = |time: f64| {
                    let moved = Displacement { length: time * twist.linear, angle: time * twist.angular };
                    advance(Pose::default(), moved).to_local(point)
                };
                for step in 0..400 {
                    let at = 0.01 * f64::from(step);
                    if at < time - 1e-6 {
                        prop_assert!(!sweep.is_inside(seen_at(at)), "{outline:?} {at} of {time}");
                    }
                }
                if time.is_finite() {
                    let grown = Sweep::new(&outline, 1e-6, twist);
                    prop_assert!(grown.is_inside(seen_at(time)), "{outline:?} {time}");
                }
            }
        }
    }

    #[test]
    fn what_is_touched_may_be_left_but_not_pressed() {
        let [disc, _] = outlines();
        let point = [Point::new(0.05, 0.0)];
        assert_eq!(Sweep::new(&disc, 0.0, Twist::new(0.1, 0.0)).time_to_contact(&point), 0.0);
        assert_eq!(Sweep::new(&disc, 0.0, Twist::new(-0.1, 0.0)).time_to_contact(&point), f64::INFINITY);
        assert_eq!(
            Sweep::new(&disc, 0.0, Twist::STOP).time_to_contact(&[Point::new(1.0, 0.0)]),
            f64::INFINITY
        );
    }
}
