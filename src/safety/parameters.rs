use super::health::HealthLimits;
use super::{Deadline, SafetyState, SignalLimits, SignalMonitor, SpeedError, StoppingModel};
use crate::ParameterError;
use crate::geometry::Point;
use crate::parameter::{require, require_finite, require_not_negative, require_positive};

/// What a vehicle is supervised by.
#[derive(Debug, Clone, PartialEq)]
pub struct SupervisedParameters {
    /// Seconds between two looks at everything, 0.1 ms at least.
    pub period: f64,
    /// Seconds without a heartbeat of the base station that are allowed.
    pub heartbeat: f64,
    /// Seconds that are allowed without a command of the driving program, or, while the vehicle is told to stand, or drives a way
    /// that has an end, without any call of it.
    pub watchdog: f64,
    /// Corners of the area that must not be left, in the frame of odometry: none, or at least three.
    pub fence: Vec<Point>,
    /// Looks in a row outside before it counts.
    pub fence_debounce: u16,
    /// How far a pedal has to be pressed, or how hard the wheel has to be held, before the driver has taken over.
    pub override_threshold: f64,
    /// The deceleration of a safe stop, in m/s²; an emergency stop takes all that there is.
    pub gentle: f64,
    /// Metres per second, and radians per second, below which the vehicle stands.
    pub standing: [f64; 2],
    /// How well the speed is measured, which says how far a stop may go.
    pub speed_error: SpeedError,
    /// What sensors may do.
    pub health: HealthLimits,
}

/// The shortest control period, in seconds: a wait is no more looks than can be made.
const SHORTEST: f64 = 1e-4;

impl Default for SupervisedParameters {
    fn default() -> Self {
        Self {
            period: 0.02,
            heartbeat: 0.5,
            watchdog: 0.4,
            fence: Vec::new(),
            fence_debounce: 3,
            override_threshold: 0.1,
            gentle: 3.0,
            standing: [0.01, 0.02],
            speed_error: SpeedError::default(),
            health: HealthLimits::default(),
        }
    }
}

impl SupervisedParameters {
    /// How a vehicle comes to a safe stop that follows speeds with a lag in seconds and a greatest deceleration in m/s²: it reacts
    /// within one control period, and brakes as gently as is allowed from the speed that it measures. A stop that becomes an
    /// emergency on its way is shorter.
    pub fn stopping(&self, lag: f64, deceleration: f64) -> StoppingModel {
        let deceleration = deceleration.min(self.gentle);
        StoppingModel { reaction: 2.0 * self.period, lag, deceleration, error: self.speed_error }
    }

    /// How the same vehicle comes to an emergency stop: with all the deceleration that there is, and whatever speed it measures, as
    /// it is told to stand at once.
    pub fn emergency_stopping(&self, lag: f64, deceleration: f64) -> StoppingModel {
        StoppingModel { reaction: 2.0 * self.period, lag, deceleration, error: SpeedError::NONE }
    }

    /// How it stops in a state: [`stopping`](Self::stopping), or [`emergency_stopping`](Self::emergency_stopping).
    pub fn stopping_in(&self, state: SafetyState, lag: f64, deceleration: f64) -> StoppingModel {
        match state {
            SafetyState::EmergencyStop => self.emergency_stopping(lag, deceleration),
            _ => self.stopping(lag, deceleration),
        }
    }

    pub(super) fn validate(&self) -> std::result::Result<(), ParameterError> {
        for (name, value) in [
            ("control period", self.period),
            ("heartbeat", self.heartbeat),
            ("watchdog", self.watchdog),
            ("threshold of the override", self.override_threshold),
            ("gentle deceleration", self.gentle),
        ] {
            require_positive(name, value)?;
        }
        require("control period", self.period, self.period >= SHORTEST, "at least 0.0001 s")?;
        let [linear, angular] = self.standing;
        for (name, value) in [
            ("speed of standing", linear),
            ("turning speed of standing", angular),
            ("greatest acceleration", self.health.acceleration),
            ("step of the speed", self.health.speed_step),
            ("age of readings", self.health.age),
            ("repeats: equal readings in a row", f64::from(self.health.repeats)),
        ] {
            require_positive(name, value)?;
        }
        for (name, value) in
            [("speed error: share", self.speed_error.share), ("speed error: offset", self.speed_error.offset)]
        {
            require_not_negative(name, value)?;
        }
        if matches!(self.fence.len(), 1 | 2) {
            let corners = self.fence.len() as f64;
            return Err(ParameterError::new("corners of the fence", corners, "none, or at least 3"));
        }
        let mut coordinates = self.fence.iter().flat_map(|corner| [corner.x, corner.y]);
        coordinates.try_for_each(|metres| require_finite("corner of the fence", metres))
    }
}

impl Deadline {
    /// Over when nothing has happened for so many seconds. Fails unless that is a positive, finite number.
    pub fn new(limit: f64) -> std::result::Result<Self, ParameterError> {
        require_positive("limit of a deadline", limit)?;
        Ok(Self::checked(limit))
    }
}

impl SignalMonitor {
    /// A monitor that has not seen a reading: lost, until one comes. Fails with the name of the limit that is out of range.
    pub fn new(limits: SignalLimits) -> std::result::Result<Self, ParameterError> {
        require_positive("age of readings", limits.age)?;
        require_not_negative("rate of the signal", limits.rate)?;
        require_not_negative("step of the signal", limits.step)?;
        require_positive("repeats: equal readings in a row", f64::from(limits.repeats))?;
        Ok(Self::checked(limits))
    }
}
