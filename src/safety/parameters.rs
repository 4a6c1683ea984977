use super::health::HealthLimits;
use super::{Deadline, SafetyState, SignalLimits, SignalMonitor, SpeedError, StoppingModel};
use crate::ParameterError;
use crate::geometry::Point;
use crate::parameter::{require, require_finite, require_not_negative, require_positive};

/// Parameters of [`Supervised`](super::Supervised).
#[derive(Debug, Clone, PartialEq)]
pub struct SupervisedParameters {
    /// Control period (s), at least 0.1 ms.
    pub period: f64,
    /// Maximum time without a heartbeat of the base station (s).
    pub heartbeat: f64,
    /// Maximum time without a command of the program (s). While the last command was to stand, or a manoeuvre
    /// with an end, any call of the program counts.
    pub watchdog: f64,
    /// Corners of the allowed area in the odometry frame: none, or at least three.
    pub fence: Vec<Point>,
    /// Number of periods in a row outside the fence before it counts.
    pub fence_debounce: u16,
    /// Pedal position, or steering force, above which the driver takes over.
    pub override_threshold: f64,
    /// Deceleration of a safe stop (m/s²). An emergency stop uses the full brake.
    pub gentle: f64,
    /// Speeds below which the vehicle counts as standing (m/s, rad/s).
    pub standing: [f64; 2],
    /// Error of the measured speed; enters the stopping distance.
    pub speed_error: SpeedError,
    /// Limits of plausible sensor readings.
    pub health: HealthLimits,
}

/// Shortest control period (s); it bounds the number of checks during a wait.
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
    /// Stopping model of a safe stop, for a vehicle with a speed lag (s) and a maximum deceleration (m/s²).
    /// The reaction takes two control periods; the vehicle then brakes gently, starting from its measured
    /// speed. A safe stop that turns into an emergency stop is shorter.
    pub fn stopping(&self, lag: f64, deceleration: f64) -> StoppingModel {
        let deceleration = deceleration.min(self.gentle);
        StoppingModel { reaction: 2.0 * self.period, lag, deceleration, error: self.speed_error }
    }

    /// Stopping model of an emergency stop, for the same vehicle: the full deceleration, and no speed error
    /// because the command is zero at once.
    pub fn emergency_stopping(&self, lag: f64, deceleration: f64) -> StoppingModel {
        StoppingModel { reaction: 2.0 * self.period, lag, deceleration, error: SpeedError::NONE }
    }

    /// Stopping model for a state: [`stopping`](Self::stopping) or
    /// [`emergency_stopping`](Self::emergency_stopping).
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
    /// A deadline that expires `limit` seconds after the last event.
    ///
    /// # Errors
    ///
    /// If `limit` is not positive and finite.
    pub fn new(limit: f64) -> std::result::Result<Self, ParameterError> {
        require_positive("limit of a deadline", limit)?;
        Ok(Self::checked(limit))
    }
}

impl SignalMonitor {
    /// A monitor without a reading yet: its state is `SignalHealth::Lost`.
    ///
    /// # Errors
    ///
    /// If a limit is out of range.
    pub fn new(limits: SignalLimits) -> std::result::Result<Self, ParameterError> {
        require_positive("age of readings", limits.age)?;
        require_not_negative("rate of the signal", limits.rate)?;
        require_not_negative("step of the signal", limits.step)?;
        require_positive("repeats: equal readings in a row", f64::from(limits.repeats))?;
        Ok(Self::checked(limits))
    }
}
