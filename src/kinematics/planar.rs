use super::Displacement;
use super::integrate::sinc;
use crate::geometry::{Pose, Twist, angle_difference, math, normalize_angle};

/// Velocity in the plane with a sideways component, in the robot frame.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PlanarTwist {
    /// Forward speed (m/s).
    pub forward: f64,
    /// Speed to the left (m/s).
    pub left: f64,
    /// Angular velocity, counter-clockwise (rad/s).
    pub angular: f64,
}

impl PlanarTwist {
    /// Zero velocity.
    pub const STOP: Self = Self { forward: 0.0, left: 0.0, angular: 0.0 };

    /// A twist from m/s and rad/s.
    pub const fn new(forward: f64, left: f64, angular: f64) -> Self {
        Self { forward, left, angular }
    }

    /// All components times a factor.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self::new(self.forward * factor, self.left * factor, self.angular * factor)
    }

    /// Motion at this velocity for `seconds`.
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

/// Motion at a constant velocity in the robot frame: an arc, driven at a constant angle to the heading.
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
    /// Distance along the robot's forward axis, which turns with it (m).
    pub forward: f64,
    /// Distance along its left axis (m).
    pub left: f64,
    /// Change of the heading, counter-clockwise (rad).
    pub angle: f64,
}

impl PlanarMotion {
    /// Motion from one pose to another, turning by less than half a turn.
    pub fn between(start: Pose, end: Pose) -> Self {
        let angle = angle_difference(end.heading, start.heading);
        let half = 0.5 * angle;
        let (sin, cos) = math::sin_cos(start.heading + half);
        let (x, y) = (end.x - start.x, end.y - start.y);
        let scale = 1.0 / sinc(half);
        Self { forward: (x * cos + y * sin) * scale, left: (y * cos - x * sin) * scale, angle }
    }

    /// Path length (m).
    pub fn length(&self) -> f64 {
        if self.left == 0.0 { self.forward.abs() } else { math::hypot(self.forward, self.left) }
    }

    /// The motion times a factor.
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

/// Pose after a motion with a sideways component, in closed form; see [`advance`](super::advance) for arcs.
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

    /// Integral over 0 to 1 by Simpson's rule.
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
