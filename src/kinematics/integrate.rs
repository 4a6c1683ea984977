use crate::geometry::{Pose, math, normalize_angle};

/// Motion along an arc: that of a robot without sideways slip whose wheels turn at constant speeds.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Displacement {
    /// Arc length, negative backwards (m).
    pub length: f64,
    /// Change of the heading, counter-clockwise (rad).
    pub angle: f64,
}

/// Pose after a motion along an arc, in closed form (book, chapter 7).
///
/// ```
/// use roverlab::geometry::Pose;
/// use roverlab::kinematics::{Displacement, advance};
/// use std::f64::consts::{FRAC_PI_2, PI};
/// // A quarter circle with a radius of 1 m.
/// let end = advance(Pose::default(), Displacement { length: FRAC_PI_2, angle: FRAC_PI_2 });
/// assert!((end.x - 1.0).abs() < 1e-12 && (end.y - 1.0).abs() < 1e-12 && (end.heading - PI / 2.0).abs() < 1e-12);
/// ```
pub fn advance(pose: Pose, motion: Displacement) -> Pose {
    let half = 0.5 * motion.angle;
    let chord = motion.length * sinc(half);
    let (sin, cos) = math::sin_cos(pose.heading + half);
    Pose::new(pose.x + chord * cos, pose.y + chord * sin, normalize_angle(pose.heading + motion.angle))
}

/// `sin(x) / x`, by its series where the quotient loses digits.
pub(super) fn sinc(x: f64) -> f64 {
    if x.abs() < 1e-2 {
        let squared = x * x;
        // The next term, x^6 / 5040, is below 2e-16.
        1.0 - squared / 6.0 * (1.0 - squared / 20.0)
    } else {
        math::sin(x) / x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn two_halves_make_a_whole(
            x in -5.0..5.0f64, heading in -3.0..3.0f64, length in -2.0..2.0f64, angle in -3.0..3.0f64,
        ) {
            let start = Pose::new(x, 1.0, heading);
            let half = Displacement { length: 0.5 * length, angle: 0.5 * angle };
            let whole = advance(start, Displacement { length, angle });
            let twice = advance(advance(start, half), half);
            prop_assert!((whole.position() - twice.position()).norm() < 1e-12);
        }

        #[test]
        fn going_back_returns_to_the_start(length in -2.0..2.0f64, angle in -6.0..6.0f64) {
            let there = advance(Pose::default(), Displacement { length, angle });
            let back = advance(there, Displacement { length: -length, angle: -angle });
            prop_assert!(back.position().coords.norm() < 1e-12 && back.heading.abs() < 1e-12);
        }

        #[test]
        fn fine_integration_agrees(length in -1.0..1.0f64, angle in -3.0..3.0f64) {
            let exact = advance(Pose::default(), Displacement { length, angle });
            let steps = 1000;
            let (mut x, mut y) = (0.0, 0.0);
            for i in 0..steps {
                // Simpson's rule.
                for (at, weight) in [(0.0, 1.0), (0.5, 4.0), (1.0, 1.0)] {
                    let (sin, cos) = math::sin_cos(angle * (f64::from(i) + at) / f64::from(steps));
                    let part = weight * length / (6.0 * f64::from(steps));
                    x += part * cos;
                    y += part * sin;
                }
            }
            prop_assert!(math::hypot(x - exact.x, y - exact.y) < 1e-9);
        }
    }
}
