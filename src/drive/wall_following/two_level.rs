use super::{FollowsWalls, WallObservation, WallSide};
use crate::ParameterError;
use crate::geometry::{Twist, units};
use crate::io::Result;
use crate::parameter::require_positive;

/// The book's own wall follower (program 6.1), for comparison: along a wall on the left it steers slightly
/// left or right, depending on whether the left range is below a limit, and turns right on the spot when the
/// front range is.
///
/// ```
/// use roverlab::drive::{TwoLevelWallFollower, WallObservation};
/// use roverlab::geometry::Pose;
/// let mut follower = TwoLevelWallFollower::new(0.2, 0.2)?;
/// let seen = |front, left| WallObservation { pose: Pose::default(), front, left, right: f64::INFINITY };
/// assert!(follower.step(&seen(1.0, 0.1)).angular < 0.0, "too near: to the right");
/// assert!(follower.step(&seen(1.0, 0.3)).angular > 0.0, "too far: to the left");
/// assert_eq!(follower.step(&seen(0.1, 0.2)).linear, 0.0, "a wall ahead: on the spot");
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TwoLevelWallFollower {
    /// Range limit (m).
    pub safe: f64,
    /// Speed along the wall (m/s).
    pub speed: f64,
    /// Turn rate along the wall, to either side (rad/s).
    pub bend: f64,
    /// Turn rate on the spot (rad/s).
    pub turn_rate: f64,
    /// Control period (s).
    pub period: f64,
    turning: bool,
    /// Whether a wall has been met.
    met: bool,
}

impl Default for TwoLevelWallFollower {
    /// The book's values.
    fn default() -> Self {
        Self {
            safe: 0.25,
            speed: 0.2,
            bend: units::from_deg(3.0),
            turn_rate: units::from_deg(100.0),
            period: 0.05,
            turning: false,
            met: false,
        }
    }
}

impl TwoLevelWallFollower {
    /// The book's program with its own limit (m) and speed (m/s). Fails unless both are positive and finite.
    pub fn new(safe: f64, speed: f64) -> std::result::Result<Self, ParameterError> {
        require_positive("safe distance", safe)?;
        require_positive("speed", speed)?;
        Ok(Self { safe, speed, ..Self::default() })
    }

    /// The next velocity. Without a range ahead and one to the left, infinite or not, the robot stands.
    pub fn step(&mut self, observation: &WallObservation) -> Twist {
        let WallObservation { front, left, .. } = *observation;
        if front.is_nan() || left.is_nan() {
            return Twist::STOP;
        }
        self.turning = if self.turning { front < 2.0 * left } else { front <= self.safe };
        if self.turning {
            self.met = true;
            return Twist::new(0.0, -self.turn_rate);
        }
        Twist::new(self.speed, if left < self.safe { -self.bend } else { self.bend })
    }
}

impl FollowsWalls for TwoLevelWallFollower {
    type Observation = WallObservation;

    fn steer(&mut self, seen: &WallObservation, _seconds: f64) -> Result<Twist> {
        seen.check()?;
        Ok(self.step(seen))
    }

    fn period(&self) -> f64 {
        self.period
    }

    fn is_beside_wall(&self) -> bool {
        self.met && !self.turning
    }

    fn wall_side(&self) -> Option<WallSide> {
        Some(WallSide::Left)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;

    #[test]
    fn it_does_what_the_book_prints() {
        let mut follower = TwoLevelWallFollower::default();
        let mut step =
            |front, left| follower.step(&WallObservation { pose: Pose::default(), front, left, right: 9.0 });
        assert!(step(1.0, 0.2).angular < 0.0 && step(1.0, 0.3).angular > 0.0);
        // At a corner it turns until the way ahead is twice as long as the side range.
        assert_eq!(step(0.24, 0.3).linear, 0.0);
        assert_eq!(step(0.5, 0.3).linear, 0.0);
        assert!(step(0.7, 0.3).linear > 0.0);
    }
}
