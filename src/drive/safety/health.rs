use crate::geometry::{Pose, Twist};

/// Watches odometry: that it reads numbers, does not jump, and moves when the vehicle does.
#[derive(Debug, Clone)]
pub(super) struct OdometryHealth {
    last: Option<(f64, Pose, Twist)>,
    frozen: u16,
    /// Metres that it should have gone since the pose stays, turning included.
    missing: f64,
}

/// Metres that have to be missing before a pose that stays is odd: encoders count in steps.
const MISSING: f64 = 0.01;
/// Metres that a turn of one radian counts as.
const ARM: f64 = 0.1;

/// Metres, and radians, by which a pose may differ from what the speeds give, beside a share of the way.
const STEP: (f64, f64) = (0.05, 0.08);
const SHARE: f64 = 0.5;

impl OdometryHealth {
    pub(super) fn new() -> Self {
        Self { last: None, frozen: 0, missing: 0.0 }
    }

    /// Takes in a reading. Whether it is to be trusted.
    pub(super) fn read(&mut self, now: f64, pose: Pose, speed: Twist, limits: &HealthLimits) -> bool {
        if !(pose.is_finite() && speed.linear.is_finite() && speed.angular.is_finite()) {
            return false;
        }
        let Some((time, before, slower)) = self.last.replace((now, pose, speed)) else { return true };
        let passed = (now - time).max(0.0);
        if passed == 0.0 {
            return true;
        }
        let fastest = speed.linear.abs().max(slower.linear.abs());
        let turning = speed.angular.abs().max(slower.angular.abs());
        let way = (pose.position() - before.position()).norm();
        let turned = crate::geometry::angle_difference(pose.heading, before.heading).abs();
        let jumps = way > fastest * passed * (1.0 + SHARE) + STEP.0
            || turned > turning * passed * (1.0 + SHARE) + STEP.1
            || (speed.linear - slower.linear).abs() > limits.acceleration * passed + limits.speed_step;
        // A pose that stays to the bit while wheels turn.
        if pose == before {
            self.frozen = self.frozen.saturating_add(1);
            self.missing += (speed.linear.abs() + ARM * speed.angular.abs()) * passed;
        } else {
            (self.frozen, self.missing) = (0, 0.0);
        }
        let frozen = self.frozen >= limits.repeats && self.missing > MISSING;
        !(jumps || frozen)
    }

    /// Forgets where it was: the pose was set.
    pub(super) fn forget(&mut self) {
        self.last = None;
    }
}

/// What readings may do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HealthLimits {
    /// The greatest acceleration that odometry may measure, in m/s².
    pub acceleration: f64,
    /// What its speed may change beside that, in m/s.
    pub speed_step: f64,
    /// Equal readings in a row, while the vehicle moves, after which a sensor counts as frozen.
    pub repeats: u16,
}

impl Default for HealthLimits {
    fn default() -> Self {
        Self { acceleration: 15.0, speed_step: 0.3, repeats: 4 }
    }
}

/// Watches a sensor whose readings have noise: that they are numbers, and differ while the vehicle moves.
#[derive(Debug, Clone, Default)]
pub(super) struct ReadingHealth {
    last: Option<u64>,
    at: Option<Pose>,
    frozen: u16,
}

/// Metres, and radians, that a vehicle has to move before equal readings are odd.
const MOVED: (f64, f64) = (0.01, 0.01);

impl ReadingHealth {
    /// Takes in a digest of a reading, `None` for one that may repeat itself, as of a scan that shows nothing, made at a pose.
    /// Whether it is to be trusted.
    pub(super) fn read(&mut self, digest: Option<u64>, pose: Pose, limits: &HealthLimits) -> bool {
        let moved = self.at.is_none_or(|at| {
            (pose.position() - at.position()).norm() > MOVED.0
                || crate::geometry::angle_difference(pose.heading, at.heading).abs() > MOVED.1
        });
        let equal = digest.is_some() && digest == self.last;
        if !equal {
            self.frozen = 0;
        } else if moved {
            self.frozen = self.frozen.saturating_add(1);
        }
        if moved || !equal {
            self.at = Some(pose);
        }
        self.last = digest;
        self.frozen < limits.repeats
    }
}

/// FNV-1a over numbers.
pub(super) fn digest(values: impl Iterator<Item = u64>) -> u64 {
    values.fold(0xcbf2_9ce4_8422_2325, |hash, value| (hash ^ value).wrapping_mul(0x0000_0100_0000_01b3))
}
