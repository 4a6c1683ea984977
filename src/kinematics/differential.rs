use super::Displacement;
use crate::geometry::Twist;

/// Rim speeds of the two driven wheels (m/s).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct WheelSpeeds {
    /// Left wheel.
    pub left: f64,
    /// Right wheel.
    pub right: f64,
}

/// Kinematics of a drive with two wheels side by side (book, section 7.1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Differential {
    /// Distance between the wheels' contact points (m).
    pub track: f64,
}

impl Differential {
    /// Forward kinematics.
    pub fn forward(&self, wheels: WheelSpeeds) -> Twist {
        let Displacement { length, angle } = self.displacement(wheels.left, wheels.right);
        Twist::new(length, angle)
    }

    /// Inverse kinematics.
    pub fn inverse(&self, twist: Twist) -> WheelSpeeds {
        let half = 0.5 * self.track * twist.angular;
        WheelSpeeds { left: twist.linear - half, right: twist.linear + half }
    }

    /// Motion while the wheels roll `left` and `right` metres at constant speeds.
    pub fn displacement(&self, left: f64, right: f64) -> Displacement {
        Displacement { length: 0.5 * (left + right), angle: (right - left) / self.track }
    }

    /// Inverse kinematics within a limit: both rim speeds are scaled down where one would exceed `limit`
    /// (m/s), which preserves the curvature.
    pub fn inverse_limited(&self, twist: Twist, limit: f64) -> WheelSpeeds {
        let wheels = self.inverse(twist);
        let fastest = wheels.left.abs().max(wheels.right.abs());
        if fastest <= limit {
            return wheels;
        }
        let scale = limit / fastest;
        WheelSpeeds { left: wheels.left * scale, right: wheels.right * scale }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn forward_undoes_inverse(v in -2.0..2.0f64, w in -6.0..6.0f64, track in 0.05..1.0f64) {
            let drive = Differential { track };
            let twist = drive.forward(drive.inverse(Twist::new(v, w)));
            prop_assert!((twist.linear - v).abs() < 1e-12 && (twist.angular - w).abs() < 1e-12);
        }

        #[test]
        fn limits_keep_the_curvature(v in 0.1..2.0f64, w in -6.0..6.0f64, limit in 0.05..1.0f64) {
            let drive = Differential { track: 0.09 };
            let wheels = drive.inverse_limited(Twist::new(v, w), limit);
            prop_assert!(wheels.left.abs() <= limit + 1e-12 && wheels.right.abs() <= limit + 1e-12);
            let twist = drive.forward(wheels);
            prop_assert!((twist.angular * v - w * twist.linear).abs() < 1e-9);
        }
    }
}
