use crate::geometry::{Point, Pose, Vector, direction, normalize_angle};
use crate::kinematics::{PlanarMotion, advance_planar};

/// A pose that moves tick by tick, with the unit vector of its heading.
///
/// Rotating the vector by a small angle costs a tenth of a sine and cosine. It is recomputed from the heading
/// regularly, which keeps rounding errors below 1e-14.
#[derive(Debug, Clone, Copy)]
pub(super) struct Course {
    pose: Pose,
    forward: Vector,
    /// Small turns since the vector was last recomputed.
    turns: u32,
}

/// Largest half turn that is computed by series (rad).
const SMALL: f64 = 0.1;
/// Small turns until the vector is recomputed.
const RENEWAL: u32 = 64;

impl Course {
    pub(super) fn new(pose: Pose) -> Self {
        Self { pose, forward: direction(pose.heading), turns: 0 }
    }

    pub(super) fn pose(&self) -> Pose {
        self.pose
    }

    /// A vector of the pose's frame in the world's frame.
    pub(super) fn turned(&self, own: Vector) -> Vector {
        let f = self.forward;
        Vector::new(f.x * own.x - f.y * own.y, f.y * own.x + f.x * own.y)
    }

    /// Moves along one arc: [`advance_planar`] without its sine and cosine for small turns.
    pub(super) fn advance(&mut self, motion: PlanarMotion) {
        let half = 0.5 * motion.angle;
        if half.abs() > SMALL || self.turns >= RENEWAL {
            *self = Self::new(advance_planar(self.pose, motion));
            return;
        }
        let (sinc, cos) = small_sinc_cos(half);
        let turn = Vector::new(cos, half * sinc);
        let middle = self.turned(turn);
        let (forward, left) = (motion.forward * sinc, motion.left * sinc);
        self.pose.x += forward * middle.x - left * middle.y;
        self.pose.y += forward * middle.y + left * middle.x;
        if half != 0.0 {
            self.pose.heading = normalize_angle(self.pose.heading + motion.angle);
            self.forward = Self { forward: middle, ..*self }.turned(turn);
            self.turns += 1;
        }
    }

    /// Pose in the world of a device mounted at a pose in this frame.
    pub(super) fn mounted(&self, mount: &Pose) -> Pose {
        let place = self.pose.position() + self.turned(mount.position().coords);
        Pose::new(place.x, place.y, normalize_angle(self.pose.heading + mount.heading))
    }

    /// Changes the position and keeps the heading.
    pub(super) fn move_to(&mut self, place: Point) {
        self.pose.x = place.x;
        self.pose.y = place.y;
    }
}

/// `sin(x) / x` and cosine of a small angle, accurate to the last bit or two.
fn small_sinc_cos(x: f64) -> (f64, f64) {
    let s = x * x;
    // The omitted terms are below 3e-17 for |x| up to 0.1. Products are several times as fast as quotients.
    let sinc = 1.0
        - s * (1.0 / 6.0) * (1.0 - s * (1.0 / 20.0) * (1.0 - s * (1.0 / 42.0) * (1.0 - s * (1.0 / 72.0))));
    let cos = 1.0
        - s * (1.0 / 2.0) * (1.0 - s * (1.0 / 12.0) * (1.0 - s * (1.0 / 30.0) * (1.0 - s * (1.0 / 56.0))));
    (sinc, cos)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{angle_difference, math};
    use crate::random::Stream;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn small_angles_are_exact(x in -SMALL..=SMALL) {
            let (sinc, cos) = small_sinc_cos(x);
            prop_assert!((x * sinc - math::sin(x)).abs() <= 2e-17 + 2e-16 * x.abs());
            prop_assert!((cos - math::cos(x)).abs() <= 2.3e-16);
        }
    }

    #[test]
    fn a_long_way_ends_where_sines_and_cosines_say() {
        let mut stream = Stream::new(1);
        let start = Pose::new(1.0, 2.0, 3.0);
        let (mut course, mut expected) = (Course::new(start), start);
        for step in 0..20_000 {
            let widest = if step % 100 == 0 { 0.5 } else { 0.02 };
            let angle = if step % 7 == 0 { 0.0 } else { stream.between(-widest, widest) };
            let left = if step % 3 == 0 { stream.between(-0.01, 0.01) } else { 0.0 };
            let motion = PlanarMotion { forward: stream.between(-0.01, 0.02), left, angle };
            course.advance(motion);
            expected = advance_planar(expected, motion);
            let heading = course.turned(Vector::x());
            assert!((heading - direction(course.pose().heading)).norm() < 1e-14, "step {step}");
        }
        let end = course.pose();
        assert!((end.position() - expected.position()).norm() < 1e-12, "{end:?} {expected:?}");
        assert!(angle_difference(end.heading, expected.heading).abs() < 1e-12);
    }
}
