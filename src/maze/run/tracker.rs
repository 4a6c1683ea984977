use crate::ParameterError;
use crate::geometry::{Pose, Twist, angle_difference, math};
use crate::maze::Trajectory;
use crate::parameter::{require_not_negative, require_positive};

/// The gains with which a robot is kept on a trajectory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrajectoryTrackerParameters {
    /// Speed for a metre behind, in 1/s.
    pub along: f64,
    /// Metres of way in which an error aside is taken back.
    pub reach: f64,
    /// The largest turning speed for a radian of heading error, in 1/s.
    pub heading: f64,
    /// Seconds from one step to the next.
    pub period: f64,
}

impl TrajectoryTrackerParameters {
    /// For a micromouse.
    pub const MICROMOUSE: Self = Self { along: 8.0, reach: 0.06, heading: 14.0, period: 0.010 };

    /// For an EyeBot in the book's larger maze.
    pub const EYEBOT: Self = Self { along: 3.0, reach: 0.12, heading: 6.0, period: 0.010 };

    /// Fails with the name of the parameter that is out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        require_not_negative("along", self.along)?;
        require_positive("reach", self.reach)?;
        require_positive("heading", self.heading)?;
        require_positive("control period", self.period)
    }
}

/// Keeps a robot on a trajectory: the speeds that it asks for, corrected for where the robot is, and commanded so that lagging
/// motors reach them in time.
///
/// ```
/// use roverlab::geometry::{Pose, Twist};
/// use roverlab::maze::{RunLimits, Trajectory, TrajectoryTracker, TrajectoryTrackerParameters};
/// let turn = Trajectory::pivot(Pose::default(), 1.5, &RunLimits::MICROMOUSE);
/// let duration = turn.duration();
/// let tracker = TrajectoryTracker::new(turn, TrajectoryTrackerParameters::MICROMOUSE, 0.02)?;
/// let begin = tracker.step(0.0, Pose::default(), Twist::STOP).expect("it has just begun");
/// assert!(begin.angular > 0.0 && begin.linear.abs() < 1e-9);
/// assert_eq!(tracker.step(duration + 0.1, Pose::new(0.0, 0.0, 1.5), Twist::STOP), None, "it is over");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct TrajectoryTracker {
    trajectory: Trajectory,
    parameters: TrajectoryTrackerParameters,
    /// The part of a difference in speed that the motors' lag leaves after a period.
    decay: f64,
}

impl TrajectoryTracker {
    /// A tracker for motors that lag by a time constant, in seconds.
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

    /// The command at a time since the beginning, for a robot at a pose that moves at a speed; `None` once the trajectory is
    /// over and the robot stands.
    pub fn step(&self, time: f64, pose: Pose, speed: Twist) -> Option<Twist> {
        /// Speeds, in m/s and rad/s, below which a robot stands.
        const STANDING: [f64; 2] = [2e-3, 2e-2];
        if time >= self.trajectory.duration() {
            let stands = speed.linear.abs() < STANDING[0] && speed.angular.abs() < STANDING[1];
            return (!stands).then(|| self.ahead_of_lag(Twist::STOP, speed));
        }
        let wish = self.wish(time, pose);
        Some(self.ahead_of_lag(wish, speed))
    }

    /// The speed to have after the next period.
    fn wish(&self, time: f64, pose: Pose) -> Twist {
        let p = &self.parameters;
        let now = self.trajectory.at(time);
        let next = self.trajectory.at(time + p.period).twist;
        let off = pose.to_local(now.pose.position());
        let turn = angle_difference(now.pose.heading, pose.heading);
        let pace = next.linear.abs();
        // Critically damped, in the way `reach` at low speed and no faster than `heading` at high speed.
        let gain = (2.0 * pace / p.reach).min(p.heading);
        let aside = if pace > 0.02 { 0.25 * gain * gain / pace } else { 0.0 };
        let gain = if pace > 0.02 { gain } else { p.heading };
        // At rest before and after a turn on the spot nothing is to be gained by creeping.
        let along = if pace > 0.02 { p.along * off.x } else { 0.0 };
        Twist::new(next.linear * math::cos(turn) + along, next.angular + gain * turn + aside * off.y)
    }

    /// The command that makes lagging motors reach a speed within a period.
    fn ahead_of_lag(&self, wish: Twist, speed: Twist) -> Twist {
        let lead = |wish: f64, speed: f64| (wish - speed * self.decay) / (1.0 - self.decay);
        Twist::new(lead(wish.linear, speed.linear), lead(wish.angular, speed.angular))
    }
}
