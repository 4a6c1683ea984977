use crate::ParameterError;
use crate::geometry::{Pose, Twist, angle_difference, math};
use crate::maze::Trajectory;
use crate::parameter::{require_not_negative, require_positive};

/// Gains of the trajectory tracker.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrajectoryTrackerParameters {
    /// Speed per longitudinal error (1/s).
    pub along: f64,
    /// Distance in which a lateral error is corrected (m).
    pub reach: f64,
    /// Maximum angular velocity per heading error (1/s).
    pub heading: f64,
    /// Control period (s).
    pub period: f64,
}

impl TrajectoryTrackerParameters {
    /// A micromouse.
    pub const MICROMOUSE: Self = Self { along: 8.0, reach: 0.06, heading: 14.0, period: 0.010 };

    /// An EyeBot in the book's larger maze.
    pub const EYEBOT: Self = Self { along: 3.0, reach: 0.12, heading: 6.0, period: 0.010 };

    /// Checks the parameters.
    ///
    /// # Errors
    ///
    /// If one is out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        require_not_negative("along", self.along)?;
        require_positive("reach", self.reach)?;
        require_positive("heading", self.heading)?;
        require_positive("control period", self.period)
    }
}

/// Tracks a trajectory: its velocity, corrected by the pose error, commanded such that lagging motors reach
/// it in time.
///
/// ```
/// use roverlab::geometry::{Pose, Twist};
/// use roverlab::maze::{RunLimits, Trajectory, TrajectoryTracker, TrajectoryTrackerParameters};
/// let turn = Trajectory::pivot(Pose::default(), 1.5, &RunLimits::MICROMOUSE);
/// let duration = turn.duration();
/// let tracker = TrajectoryTracker::new(turn, TrajectoryTrackerParameters::MICROMOUSE, 0.02)?;
/// let begin = tracker.step(0.0, Pose::default(), Twist::STOP).expect("the trajectory has just begun");
/// assert!(begin.angular > 0.0 && begin.linear.abs() < 1e-9);
/// assert_eq!(tracker.step(duration + 0.1, Pose::new(0.0, 0.0, 1.5), Twist::STOP), None, "the trajectory is over");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct TrajectoryTracker {
    trajectory: Trajectory,
    parameters: TrajectoryTrackerParameters,
    /// Fraction of a speed difference that the motors' lag leaves after one period.
    decay: f64,
}

impl TrajectoryTracker {
    /// A tracker for motors with a time constant `lag` (s).
    ///
    /// # Errors
    ///
    /// If a parameter is out of range.
    pub fn new(
        trajectory: Trajectory,
        parameters: TrajectoryTrackerParameters,
        lag: f64,
    ) -> Result<Self, ParameterError> {
        parameters.validate()?;
        require_not_negative("lag", lag)?;
        let decay = if lag > 0.0 { math::exp(-parameters.period / lag) } else { 0.0 };
        Ok(Self { trajectory, parameters, decay })
    }

    /// The trajectory.
    pub fn trajectory(&self) -> &Trajectory {
        &self.trajectory
    }

    /// Command at a time since the start (s), for a pose and a velocity; `None` once the trajectory is over
    /// and the robot stands.
    pub fn step(&self, time: f64, pose: Pose, speed: Twist) -> Option<Twist> {
        /// Speeds below which the robot counts as standing (m/s, rad/s).
        const STANDING: [f64; 2] = [2e-3, 2e-2];
        if time >= self.trajectory.duration() {
            let stands = speed.linear.abs() < STANDING[0] && speed.angular.abs() < STANDING[1];
            return (!stands).then(|| self.ahead_of_lag(Twist::STOP, speed));
        }
        let wish = self.wish(time, pose);
        Some(self.ahead_of_lag(wish, speed))
    }

    /// Desired velocity after the next period.
    fn wish(&self, time: f64, pose: Pose) -> Twist {
        let p = &self.parameters;
        let now = self.trajectory.at(time);
        let next = self.trajectory.at(time + p.period).twist;
        let off = pose.to_local(now.pose.position());
        let turn = angle_difference(now.pose.heading, pose.heading);
        let pace = next.linear.abs();
        // Critically damped: within `reach` at low speed, no faster than `heading` at high speed.
        let gain = (2.0 * pace / p.reach).min(p.heading);
        let aside = if pace > 0.02 { 0.25 * gain * gain / pace } else { 0.0 };
        let gain = if pace > 0.02 { gain } else { p.heading };
        // At rest before and after a turn on the spot, creeping gains nothing.
        let along = if pace > 0.02 { p.along * off.x } else { 0.0 };
        Twist::new(next.linear * math::cos(turn) + along, next.angular + gain * turn + aside * off.y)
    }

    /// Command with which lagging motors reach a velocity within one period.
    fn ahead_of_lag(&self, wish: Twist, speed: Twist) -> Twist {
        let lead = |wish: f64, speed: f64| (wish - speed * self.decay) / (1.0 - self.decay);
        Twist::new(lead(wish.linear, speed.linear), lead(wish.angular, speed.angular))
    }
}
