use super::Displacement;
use super::integrate::sinc;
use crate::geometry::{Pose, Twist, angle_difference, math, normalize_angle};

/// A velocity in the plane with a sideways part, as robots on Mecanum wheels have it; in the robot's own frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PlanarTwist {
    /// Metres per second forward.
    pub forward: f64,
    /// Metres per second to the left.
    pub left: f64,
    /// Radians per second counter-clockwise.
    pub angular: f64,
}

impl PlanarTwist {
    /// Standing still.
    pub const STOP: Self = Self { forward: 0.0, left: 0.0, angular: 0.0 };

    /// A twist from metres per second and radians per second.
    pub const fn new(forward: f64, left: f64, angular: f64) -> Self {
        Self { forward, left, angular }
    }

    /// Everything times a factor: the same direction of motion, faster or slower.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self::new(self.forward * factor, self.left * factor, self.angular * factor)
    }

    /// The motion that it amounts to when it lasts for some seconds.
    pub fn during(self, seconds: f64) -> PlanarMotion {
        PlanarMotion {
            forward: self.forward * seconds,
            left: self.left * seconds,
            angle: self.angular * seconds,
        }
    }
}

impl From<Twist> for PlanarTwist {
    fn from(twist: Twist) -> Self {
        Self::new(twist.linear, 0.0, twist.angular)
    }
}

/// What a robot does while its velocity, in its own frame, stays the same: an arc, driven under a constant angle to the
/// heading.
///
/// ```
/// use roverlab::geometry::Pose;
/// use roverlab::kinematics::{PlanarMotion, advance_planar};
/// let (start, end) = (Pose::new(1.0, 2.0, 0.5), Pose::new(1.2, 2.3, 0.1));
/// let motion = PlanarMotion::between(start, end);
/// assert!(advance_planar(start, motion).distance_to(end.position()) < 1e-12);
/// let halfway = advance_planar(start, motion.scaled(0.5));
/// assert!((halfway.heading - 0.3).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PlanarMotion {
    /// Metres along the robot's own forward axis, which turns with it.
    pub forward: f64,
    /// Metres along its own axis to the left.
    pub left: f64,
    /// Radians that the heading changes, counter-clockwise.
    pub angle: f64,
}

impl PlanarMotion {
    /// The motion that leads from one pose to another, turning by less than a half turn.
    pub fn between(start: Pose, end: Pose) -> Self {
        let angle = angle_difference(end.heading, start.heading);
        let half = 0.5 * angle;
        let (sin, cos) = math::sin_cos(start.heading + half);
        let (x, y) = (end.x - start.x, end.y - start.y);
        let scale = 1.0 / sinc(half);
        Self { forward: (x * cos + y * sin) * scale, left: (y * cos - x * sin) * scale, angle }
    }

    /// Metres along the path.
    pub fn length(&self) -> f64 {
        if self.left == 0.0 { self.forward.abs() } else { math::hypot(self.forward, self.left) }
    }

    /// A part of the motion, or several times the motion.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self { forward: self.forward * factor, left: self.left * factor, angle: self.angle * factor }
    }
}

impl From<Displacement> for PlanarMotion {
    fn from(motion: Displacement) -> Self {
        Self { forward: motion.length, left: 0.0, angle: motion.angle }
    }
}

/// The pose after a motion with a sideways part, in closed form; [`advance`](super::advance) for robots without one.
///
/// ```
/// use roverlab::geometry::Pose;
/// use roverlab::kinematics::{PlanarTwist, advance_planar};
/// // Sideways to the left, without turning.
/// let end = advance_planar(Pose::default(), PlanarTwist::new(0.0, 0.2, 0.0).during(5.0));
/// assert_eq!(end, Pose::new(0.0, 1.0, 0.0));
/// ```
pub fn advance_planar(pose: Pose, motion: PlanarMotion) -> Pose {
    let half = 0.5 * motion.angle;
    let scale = sinc(half);
    let (sin, cos) = math::sin_cos(pose.heading + half);
    let (forward, left) = (motion.forward * scale, motion.left * scale);
    Pose::new(
        pose.x + forward * cos - left * sin,
        pose.y + forward * sin + left * cos,
        normalize_angle(pose.heading + motion.angle),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinematics::advance;
    use proptest::prelude::*;

    /// One component's sum over the fine steps of Simpson's rule.
    fn simpson(steps: i32, f: impl Fn(f64) -> f64) -> f64 {
        let h = 1.0 / f64::from(steps);
        let step = |i: i32| {
            let t = f64::from(i) * h;
            (f(t) + 4.0 * f(t + 0.5 * h) + f(t + h)) * (h / 6.0)
        };
        (0..steps).map(step).sum()
    }

    fn motion() -> impl Strategy<Value = PlanarMotion> {
        (-1.0..1.0f64, -1.0..1.0f64, -6.0..6.0f64).prop_map(|(forward, left, angle)| PlanarMotion {
            forward,
            left,
            angle,
        })
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn fine_integration_agrees(start in -3.0..3.0f64, m in motion()) {
            let exact = advance_planar(Pose::new(0.3, -0.2, start), m);
            let heading = |t: f64| math::sin_cos(start + t * m.angle);
            let x = 0.3 + simpson(400, |t| { let (s, c) = heading(t); m.forward * c - m.left * s });
            let y = -0.2 + simpson(400, |t| { let (s, c) = heading(t); m.forward * s + m.left * c });
            prop_assert!(math::hypot(x - exact.x, y - exact.y) < 1e-9);
        }

        #[test]
        fn without_a_sideways_part_it_is_an_arc(length in -2.0..2.0f64, angle in -3.0..3.0f64) {
            let motion = Displacement { length, angle };
            let start = Pose::new(1.0, 2.0, 0.5);
            prop_assert_eq!(advance_planar(start, motion.into()), advance(start, motion));
        }

        #[test]
        fn two_halves_make_a_whole(m in motion()) {
            let whole = advance_planar(Pose::default(), m);
            let twice = advance_planar(advance_planar(Pose::default(), m.scaled(0.5)), m.scaled(0.5));
            prop_assert!((whole.position() - twice.position()).norm() < 1e-12);
        }
    }
}
