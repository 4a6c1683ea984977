//! Detects faulty sensors.
//!
//! On most robots, readings carry no time stamps. Lateness still shows in two ways: the call takes too long,
//! or earlier readings come again, as they do while a delay builds up. A delay that has existed from the
//! start is not detected. Only odometry is checked for jumps, because ranges and images jump at every edge.

use super::{SignalHealth, SignalLimits, SignalMonitor};
use crate::geometry::{Pose, Twist, units};

/// Monitors odometry: readings are finite, do not jump, and change while the vehicle moves.
#[derive(Debug, Clone)]
pub(super) struct OdometryHealth {
    last: Option<(f64, Pose, Twist)>,
    /// Monitors the speed: its rate of change, and the age of the last reading.
    speed: SignalMonitor,
    frozen: u16,
    /// Distance that the vehicle should have covered since the pose last changed, rotation included (m).
    missing: f64,
}

/// Missing distance (m) above which an unchanged pose counts as frozen; allows for the resolution of the
/// encoders.
const MISSING: f64 = 0.01;

/// Maximum difference between the pose and the integrated speed (m, rad).
const STEP: (f64, f64) = (0.05, 0.08);
/// Further difference allowed, as a fraction of the distance covered.
const SHARE: f64 = 0.5;

impl OdometryHealth {
    pub(super) fn new(limits: &HealthLimits) -> Self {
        // A constant speed is plausible; the frozen check uses the pose instead.
        let signal = SignalLimits {
            age: limits.age,
            rate: limits.acceleration,
            step: limits.speed_step,
            repeats: u16::MAX,
        };
        Self { last: None, speed: SignalMonitor::checked(signal), frozen: 0, missing: 0.0 }
    }

    /// Takes a reading and returns whether it is plausible.
    pub(super) fn read(&mut self, now: f64, pose: Pose, speed: Twist, limits: &HealthLimits) -> bool {
        if !(pose.is_finite() && speed.linear.is_finite() && speed.angular.is_finite()) {
            return false;
        }
        let late = self.last.is_some() && self.speed.health(now) == SignalHealth::Lost;
        self.speed.read(now, speed.linear, false);
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
            || self.speed.health(now) != SignalHealth::Good;
        // A pose that is bit-identical although the wheels turn counts as frozen.
        if pose == before {
            self.frozen = self.frozen.saturating_add(1);
            self.missing += (speed.linear.abs() + units::ARM * speed.angular.abs()) * passed;
        } else {
            (self.frozen, self.missing) = (0, 0.0);
        }
        let frozen = self.frozen >= limits.repeats && self.missing > MISSING;
        !(jumps || frozen || late)
    }

    /// Somebody confirms the sensor: earlier faults are forgotten.
    pub(super) fn trust(&mut self) {
        (self.frozen, self.missing) = (0, 0.0);
    }

    /// The program set the pose: later readings are compared with the new one. Speed and time of the last
    /// reading stay.
    pub(super) fn move_to(&mut self, pose: Pose) {
        if let Some((_, before, _)) = &mut self.last {
            *before = pose;
        }
    }
}

/// Whether the sensors are trusted. A fault ends the trust until somebody confirms the sensors.
#[derive(Debug, Clone, Copy)]
pub(super) struct Trust {
    lost: bool,
    /// Level of the confirmation in the last period.
    vouched: bool,
}

impl Default for Trust {
    /// A confirmation that is already active in the first period does not count: the button may be stuck.
    fn default() -> Self {
        Self { lost: false, vouched: true }
    }
}

impl Trust {
    /// Takes the level of the confirmation and returns whether it has just risen.
    pub(super) fn begins(&mut self, vouches: bool) -> bool {
        let begins = vouches && !self.vouched;
        self.vouched = vouches;
        self.lost &= !begins;
        begins
    }

    /// Takes whether a sensor is faulty now and returns whether trust is lost.
    pub(super) fn is_lost(&mut self, fault: bool) -> bool {
        self.lost |= fault;
        self.lost
    }
}

/// Limits of plausible sensor readings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HealthLimits {
    /// Maximum acceleration that odometry may report (m/s²).
    pub acceleration: f64,
    /// Speed change that noise may add to that (m/s).
    pub speed_step: f64,
    /// Number of equal readings in a row, while the vehicle moves, after which a sensor counts as frozen.
    /// Also the number of repeated earlier readings after which it counts as late.
    pub repeats: u16,
    /// Maximum time between two odometry readings, and maximum duration of any sensor call (s).
    pub age: f64,
}

impl Default for HealthLimits {
    fn default() -> Self {
        Self { acceleration: 15.0, speed_step: 0.3, repeats: 4, age: 0.25 }
    }
}

/// Monitors a noisy sensor: its readings must be numbers, must change while the vehicle moves, and must not
/// repeat earlier ones.
#[derive(Debug, Clone, Default)]
pub(super) struct ReadingHealth {
    last: Option<u64>,
    at: Option<Pose>,
    frozen: u16,
    echo: Echo,
}

/// Motion after which equal readings are suspicious (m, rad).
const MOVED: (f64, f64) = (0.01, 0.01);

impl ReadingHealth {
    /// Takes the digest of a reading and the pose at which it was made, and returns whether the reading is
    /// plausible. The digest is `None` for readings that may repeat, such as a scan without any echo.
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
        // An unchanged reading is not an echo of an earlier one.
        let late = !equal && self.echo.hears(digest, limits.repeats);
        self.last = digest;
        self.frozen < limits.repeats && !late
    }

    /// Somebody confirms the sensor: the count of equal readings starts again.
    pub(super) fn trust(&mut self) {
        self.frozen = 0;
        self.echo.runs = [0; REMEMBERED];
    }
}

/// Number of stored readings.
const REMEMBERED: usize = 64;

/// Detects that readings repeat earlier ones in the same order, as they do when they become late.
#[derive(Debug, Clone)]
struct Echo {
    /// Ring buffer of the digests of changed readings; the newest is at `count - 1`.
    past: [Option<u64>; REMEMBERED],
    count: usize,
    /// For each lag `k`, the number of consecutive readings equal to the one `k` readings before.
    runs: [u16; REMEMBERED],
}

impl Default for Echo {
    fn default() -> Self {
        Self { past: [None; REMEMBERED], count: 0, runs: [0; REMEMBERED] }
    }
}

impl Echo {
    /// Takes a reading that differs from the previous one. Returns whether `repeats` readings in a row came
    /// again.
    fn hears(&mut self, digest: Option<u64>, repeats: u16) -> bool {
        let mut heard = false;
        for back in 1..=REMEMBERED.min(self.count) {
            let before = self.past[(self.count - back) % REMEMBERED];
            let run = &mut self.runs[back - 1];
            *run = if digest.is_some() && digest == before { run.saturating_add(1) } else { 0 };
            heard |= *run >= repeats;
        }
        self.past[self.count % REMEMBERED] = digest;
        self.count += 1;
        heard
    }
}

/// FNV-1a hash of a sequence of numbers.
pub(super) fn digest(values: impl Iterator<Item = u64>) -> u64 {
    values.fold(0xcbf2_9ce4_8422_2325, |hash, value| (hash ^ value).wrapping_mul(0x0000_0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reads the digests at poses 0.1 m apart and returns which readings were accepted.
    fn read(digests: impl IntoIterator<Item = u64>) -> Vec<bool> {
        let (mut health, limits) = (ReadingHealth::default(), HealthLimits::default());
        let places = (0..).map(|k| Pose::new(0.1 * f64::from(k), 0.0, 0.0));
        digests.into_iter().zip(places).map(|(digest, at)| health.read(Some(digest), at, &limits)).collect()
    }

    #[test]
    fn readings_that_come_again_are_late() {
        let good = read((0..30).chain(20..40));
        assert_eq!(good.iter().position(|good| !good), Some(33), "the fourth repeated reading");
        assert!(read(0..500).iter().all(|good| *good));
        // Ranges rounded to millimetres often equal earlier ones, but not in the same order.
        let mut random = crate::random::Stream::new(3);
        let rounded: Vec<u64> =
            (0..20_000).map(|_| (200.0 + 10.0 * random.normal()).round() as u64).collect();
        let wrong = read(rounded).iter().filter(|good| !**good).count();
        assert!(wrong < 10, "{wrong}");
    }

    #[test]
    fn a_pose_that_is_set_is_what_the_next_one_is_measured_by() {
        let limits = HealthLimits::default();
        let mut odometry = OdometryHealth::new(&limits);
        let speed = Twist::new(0.5, 0.0);
        assert!(odometry.read(0.0, Pose::default(), speed, &limits));
        odometry.move_to(Pose::new(5.0, 0.0, 0.0));
        assert!(odometry.read(0.02, Pose::new(5.01, 0.0, 0.0), speed, &limits));
        odometry.move_to(Pose::default());
        assert!(
            !odometry.read(0.04, Pose::new(0.4, 0.2, 0.0), speed, &limits),
            "a jump after the pose was set"
        );
    }

    #[test]
    fn odometry_that_is_missing_for_long_is_late() {
        let limits = HealthLimits::default();
        let mut odometry = OdometryHealth::new(&limits);
        let at = |time: f64| Pose::new(0.5 * time, 0.0, 0.0);
        assert!(odometry.read(0.0, at(0.0), Twist::new(0.5, 0.0), &limits));
        assert!(odometry.read(0.2, at(0.2), Twist::new(0.5, 0.0), &limits));
        assert!(!odometry.read(0.5, at(0.5), Twist::new(0.5, 0.0), &limits));
        assert!(odometry.read(0.6, at(0.6), Twist::new(0.5, 0.0), &limits));
    }
}
