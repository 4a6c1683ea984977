use super::parameters::NavigatorParameters;
use super::sweep::Sweep;
use crate::geometry::{Point, Twist, direction, math};
use crate::nav::surroundings::Surroundings;

/// Steering past visible obstacles.
#[derive(Debug)]
pub(super) struct Steering<'a> {
    pub(super) parameters: &'a NavigatorParameters,
    pub(super) surroundings: &'a Surroundings,
    /// Points near the robot, in its frame.
    pub(super) points: &'a [Point],
    /// Clearance of the plan (m).
    pub(super) clearance: f64,
}

/// Time in which the robot stops, with the lag of its motors and a margin (s).
const STOPPING_TIME: f64 = 0.5;
/// Maximum angle between a step and the direction to its target (rad).
const ASIDE: f64 = 1.2;
/// Increment of that angle (rad).
const TURN: f64 = 0.08;

impl Steering<'_> {
    /// The twist for a target in the robot's frame, on the way to a goal at a distance of `rest` metres.
    pub(super) fn towards(&self, target: Point, rest: f64, speed: Twist) -> Twist {
        let bearing = math::atan2(target.y, target.x);
        let heading = self.past_obstacles(bearing, target.coords.norm());
        let limit = self.parameters.turn_rate;
        // Proportional to the error and damped by the turn rate: the motors' lag would cause oscillation
        // otherwise.
        let angular = (8.0 * heading - 1.5 * speed.angular).clamp(-limit, limit);
        let ahead = math::cos(heading).max(0.0);
        let wished = self.parameters.cruise_speed * ahead * ahead * ahead;
        let linear = wished.min((rest / STOPPING_TIME).max(0.02));
        self.safe(Twist::new(linear, angular))
    }

    /// The direction nearest to a bearing in which a step keeps the plan's clearance, or else the least one.
    fn past_obstacles(&self, bearing: f64, length: f64) -> f64 {
        let radius = self.parameters.radius();
        let offsets = (0..=(ASIDE / TURN) as i32).flat_map(|step| {
            let aside = TURN * f64::from(step);
            [bearing + aside, bearing - aside]
        });
        for clearance in [0.7 * self.clearance, 0.5 * self.parameters.least_clearance] {
            let keeps = |heading: &f64| {
                self.surroundings.step_clearance(direction(*heading), length).0 >= radius + clearance
            };
            if let Some(heading) = offsets.clone().find(keeps) {
                return heading;
            }
        }
        bearing
    }

    /// The twist, slowed down so that the robot can stop before its outline touches anything.
    pub(super) fn safe(&self, twist: Twist) -> Twist {
        let slower = |twist: Twist| (self.time_to_contact(twist) / STOPPING_TIME).min(1.0);
        // A robot that turns with a delay drives straight on at first.
        let straight = Twist::new(twist.linear, 0.0);
        let linear = twist.linear * slower(twist).min(slower(straight));
        let slowed = Twist::new(linear, twist.angular * slower(Twist::new(0.0, twist.angular)));
        // Slowing down linear and angular speed differently changes the arc.
        let rest = slower(slowed);
        Twist::new(slowed.linear * rest, slowed.angular * rest)
    }

    /// Time until the outline, with half of the least clearance around it, touches something (s).
    fn time_to_contact(&self, twist: Twist) -> f64 {
        let margin = 0.5 * self.parameters.least_clearance;
        Sweep::new(&self.parameters.footprint, margin, twist).time_to_contact(self.points)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Aabb;
    use crate::world::Footprint;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        /// Whatever is wished, the outline touches nothing visible before the robot can stop.
        #[test]
        fn what_is_told_can_be_stopped(
            places in prop::collection::vec((0.12..0.6f64, -3.1..3.1f64), 0..30),
            linear in -0.3..0.3f64, angular in -3.0..3.0f64, long in any::<bool>(),
        ) {
            let sides = Aabb::new(Point::new(-0.05, -0.04), Point::new(0.09, 0.06));
            let footprint = if long { Footprint::Rectangle(sides) } else { Footprint::Disc { radius: 0.06 } };
            let parameters = NavigatorParameters::for_footprint(footprint);
            let margin = 0.5 * parameters.least_clearance;
            let points: Vec<Point> = places.iter().map(|&(r, a)| Point::origin() + direction(a) * r).collect();
            let steering = Steering {
                parameters: &parameters,
                surroundings: &Surroundings::default(),
                points: &points,
                clearance: parameters.clearance,
            };
            let wished = Twist::new(linear, angular);
            let told = steering.safe(wished);
            let time = Sweep::new(&footprint, margin, told).time_to_contact(&points);
            prop_assert!(time >= STOPPING_TIME - 1e-6, "{told:?}: {time}");
            prop_assert!(told.linear * linear >= 0.0 && told.linear.abs() <= linear.abs());
            prop_assert!(told.angular * angular >= 0.0 && told.angular.abs() <= angular.abs());
        }
    }
}
