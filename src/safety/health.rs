//! Whether sensors are to be trusted.
//!
//! Readings have no time stamps on most robots. That one is late shows all the same in two ways: the call takes too long, or what was
//! read before is read again, as a line of readings that is held up is as it gets late. Sensors that have always been late do not
//! show. A jump is told for odometry alone: what a range or an image shows jumps at every edge.

use super::{SignalHealth, SignalLimits, SignalMonitor};
use crate::geometry::{Pose, Twist, units};

/// Watches odometry: that it reads numbers, does not jump, and moves when the vehicle does.
#[derive(Debug, Clone)]
pub(super) struct OdometryHealth {
    last: Option<(f64, Pose, Twist)>,
    /// The speed, whose change is bounded, and which may not be missing for long.
    speed: SignalMonitor,
    frozen: u16,
    /// Metres that it should have gone since the pose stays, turning included.
    missing: f64,
}

/// Metres that have to be missing before a pose that stays is odd: encoders count in steps.
const MISSING: f64 = 0.01;

/// Metres, and radians, by which a pose may differ from what the speeds give.
const STEP: (f64, f64) = (0.05, 0.08);
/// The share of the way by which it may differ beside that.
const SHARE: f64 = 0.5;

impl OdometryHealth {
    pub(super) fn new(limits: &HealthLimits) -> Self {
        // A speed may well stay as it is: that the pose does says more.
        let signal = SignalLimits {
            age: limits.age,
            rate: limits.acceleration,
            step: limits.speed_step,
            repeats: u16::MAX,
        };
        Self { last: None, speed: SignalMonitor::checked(signal), frozen: 0, missing: 0.0 }
    }

    /// Takes in a reading. Whether it is to be trusted.
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
        // A pose that stays to the bit while wheels turn.
        if pose == before {
            self.frozen = self.frozen.saturating_add(1);
            self.missing += (speed.linear.abs() + units::ARM * speed.angular.abs()) * passed;
        } else {
            (self.frozen, self.missing) = (0, 0.0);
        }
        let frozen = self.frozen >= limits.repeats && self.missing > MISSING;
        !(jumps || frozen || late)
    }

    /// Somebody vouches for it: what it did before is no more held against it.
    pub(super) fn trust(&mut self) {
        (self.frozen, self.missing) = (0, 0.0);
    }

    /// The pose was set: what comes next is measured against that. How fast it was is known as before, and since when.
    pub(super) fn move_to(&mut self, pose: Pose) {
        if let Some((_, before, _)) = &mut self.last {
            *before = pose;
        }
    }
}

/// Whether the sensors are trusted: not from a fault on until somebody vouches for them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Trust {
    lost: bool,
    /// Whether somebody vouched at the last look.
    vouched: bool,
}

impl Default for Trust {
    /// Who vouches at the first look has not begun to: the button may be stuck.
    fn default() -> Self {
        Self { lost: false, vouched: true }
    }
}

impl Trust {
    /// Takes in whether somebody vouches for them. Whether they begin to be trusted by that.
    pub(super) fn begins(&mut self, vouches: bool) -> bool {
        let begins = vouches && !self.vouched;
        self.vouched = vouches;
        self.lost &= !begins;
        begins
    }

    /// Takes in whether one is at fault now. Whether they are not trusted.
    pub(super) fn is_lost(&mut self, fault: bool) -> bool {
        self.lost |= fault;
        self.lost
    }
}

/// What readings may do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HealthLimits {
    /// The greatest acceleration that odometry may measure, in m/s².
    pub acceleration: f64,
    /// What its speed may change beside that, in m/s.
    pub speed_step: f64,
    /// Equal readings in a row, while the vehicle moves, after which a sensor counts as frozen; and readings in a row that were all
    /// there before, after which it counts as late.
    pub repeats: u16,
    /// Seconds between two readings of odometry, and those that a call for any reading may take.
    pub age: f64,
}

impl Default for HealthLimits {
    fn default() -> Self {
        Self { acceleration: 15.0, speed_step: 0.3, repeats: 4, age: 0.25 }
    }
}

/// Watches a sensor whose readings have noise: that they are numbers, and differ while the vehicle moves, from those long ago as well.
#[derive(Debug, Clone, Default)]
pub(super) struct ReadingHealth {
    last: Option<u64>,
    at: Option<Pose>,
    frozen: u16,
    echo: Echo,
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
        // What stays as it is repeats nothing.
        let late = !equal && self.echo.hears(digest, limits.repeats);
        self.last = digest;
        self.frozen < limits.repeats && !late
    }

    /// Somebody vouches for it: that it stays as it is counts from now on, and only while the vehicle moves.
    pub(super) fn trust(&mut self) {
        self.frozen = 0;
        self.echo.runs = [0; REMEMBERED];
    }
}

/// How many readings are remembered.
const REMEMBERED: usize = 64;

/// Hears that readings repeat earlier ones in their order: they come late from now on.
#[derive(Debug, Clone)]
struct Echo {
    /// Digests of changed readings, the last one before `count`, round and round.
    past: [Option<u64>; REMEMBERED],
    count: usize,
    /// For each number of readings back: how many in a row were those of so many before.
    runs: [u16; REMEMBERED],
}

impl Default for Echo {
    fn default() -> Self {
        Self { past: [None; REMEMBERED], count: 0, runs: [0; REMEMBERED] }
    }
}

impl Echo {
    /// Takes in a reading that differs from the one before. Whether so many in a row were there before.
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

/// FNV-1a over numbers.
pub(super) fn digest(values: impl Iterator<Item = u64>) -> u64 {
    values.fold(0xcbf2_9ce4_8422_2325, |hash, value| (hash ^ value).wrapping_mul(0x0000_0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Readings at poses 0.1 m apart: whether each is to be trusted.
    fn read(digests: impl IntoIterator<Item = u64>) -> Vec<bool> {
        let (mut health, limits) = (ReadingHealth::default(), HealthLimits::default());
        let places = (0..).map(|k| Pose::new(0.1 * f64::from(k), 0.0, 0.0));
        digests.into_iter().zip(places).map(|(digest, at)| health.read(Some(digest), at, &limits)).collect()
    }

    #[test]
    fn readings_that_come_again_are_late() {
        let good = read((0..30).chain(20..40));
        assert_eq!(good.iter().position(|good| !good), Some(33), "the fourth one of those that come again");
        assert!(read(0..500).iter().all(|good| *good));
        // Whole millimetres are often those of a while ago, but not in their order.
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
        assert!(!odometry.read(0.04, Pose::new(0.4, 0.2, 0.0), speed, &limits), "it has jumped since");
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
