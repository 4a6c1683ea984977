use std::f64::consts::SQRT_2;

use super::{SpeedError, StoppingModel};
use crate::ParameterError;
use crate::geometry::units::GRAVITY;
use crate::parameter::{require, require_not_negative, require_positive};
use crate::world::{PsdSpec, RobotSpec};

/// Parameters of a [`CliffGuard`](super::CliffGuard).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CliffGuardParameters {
    /// Depth below the plane of the robot's ground at which ground counts as missing (m).
    pub drop: f64,
    /// Maximum speed of any place of the outline (m/s).
    pub speed: f64,
    /// Maximum speed near an edge (m/s).
    pub creep: f64,
    /// Time from one look at the ground to the next (s).
    pub period: f64,
    /// How the robot stops.
    pub stopping: StoppingModel,
}

/// Drop that counts as an edge (m): five standard deviations of a vertical reading at noise 1 (10 mm).
const DROP: f64 = 0.05;
/// Speed of the book's programs (m/s).
const SPEED: f64 = 0.3;
/// Speed from which the robot stops within 20 mm (m/s).
const CREEP: f64 = 0.05;
/// Time from one look to the next (s): two ticks of the simulator.
const PERIOD: f64 = 0.02;
/// Number of periods from the loss of the ground to the command: one look may just have missed it.
const LATE: f64 = 2.0;
/// Error of the speed over a whole stop: five standard deviations of the wheel diameter, and 1 mm of slip in
/// a stop of 0.2 s.
const ERROR: SpeedError = SpeedError { share: 0.056, offset: 0.005 };

impl CliffGuardParameters {
    /// Parameters for a robot, from its motors and its friction.
    pub fn of(spec: &RobotSpec) -> Self {
        let stopping = StoppingModel {
            reaction: LATE * PERIOD,
            lag: spec.motor.time_constant,
            deceleration: spec.motor.max_acceleration.min(spec.friction * GRAVITY),
            error: ERROR,
        };
        Self { drop: DROP, speed: SPEED, creep: CREEP, period: PERIOD, stopping }
    }

    /// Distance beyond a corner, along both axes, at which its inner sensor looks (m): that of a stop from
    /// [`creep`](Self::creep).
    pub fn near(&self) -> f64 {
        self.stopping.distance(self.creep)
    }

    /// Distance beyond a corner, along both axes, at which its outer sensor looks (m).
    pub fn far(&self) -> f64 {
        SQRT_2 * self.near() + self.stopping.distance(self.speed)
    }

    /// Fails for a parameter out of range; the error names it.
    pub fn validate(&self) -> Result<(), ParameterError> {
        require_positive("drop", self.drop)?;
        require_positive("control period", self.period)?;
        require_positive("speed", self.speed)?;
        require_positive("creep", self.creep)?;
        require("creep", self.creep, self.creep <= self.speed, "at most the maximum speed")?;
        let StoppingModel { reaction, lag, deceleration, error } = self.stopping;
        let late = LATE * self.period;
        require_not_negative("reaction time", reaction)?;
        require("control period", self.period, late <= reaction, "at most half the reaction time")?;
        require_not_negative("lag", lag)?;
        require_positive("deceleration", deceleration)?;
        require_not_negative("share of the speed error", error.share)?;
        require_not_negative("offset of the speed error", error.offset)?;
        let seen = SQRT_2 * self.far() < PsdSpec::DEFAULT_MAX_RANGE;
        require("speed", self.speed, seen, "slow enough to stop within the range of distance sensors")
    }
}
