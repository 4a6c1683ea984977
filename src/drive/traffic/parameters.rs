use crate::ParameterError;
use crate::drive::lane_keeping::LaneKeeperParameters;
use crate::parameter::{require_not_negative, require_positive};

/// Parameters of a [`TrafficDriver`](super::TrafficDriver).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrafficParameters {
    /// Those of lane keeping; its speed is that on a free road.
    pub lane: LaneKeeperParameters,
    /// Maximum speed while a standing obstacle is passed, and while a moving one is (m/s).
    pub passing: [f64; 2],
    /// Maximum speed on a crosswalk and before one (m/s).
    pub crosswalk: f64,
    /// Distance from the car's front to a line at which it stops (m).
    pub gap: f64,
    /// Distance behind an obstacle that is not passed (m).
    pub following: f64,
    /// Deceleration before lines, crosswalks and obstacles (m/s²).
    pub brake: f64,
    /// Time to stand at stop lines and crosswalks, and at give-way lines (s).
    pub halts: [f64; 2],
    /// Distance to the side of obstacles (m).
    pub clearance: f64,
    /// Front of the car ahead of its origin, and half of its width (m).
    pub body: [f64; 2],
}

impl Default for TrafficParameters {
    /// For [`RobotSpec::road_car`](crate::world::RobotSpec::road_car) by the rules of 2025, which ask for
    /// halts of 3 s and 1 s at most 150 mm before a line, and for 300 mm behind an obstacle. At give-way
    /// lines the car looks for longer: traffic may come into its view more than a second after it has stopped.
    fn default() -> Self {
        Self {
            lane: LaneKeeperParameters { speed: 0.9, ..LaneKeeperParameters::default() },
            passing: [0.7, 1.4],
            crosswalk: 0.6,
            gap: 0.07,
            following: 0.45,
            brake: 1.2,
            halts: [3.2, 1.7],
            clearance: 0.07,
            body: [0.35, 0.095],
        }
    }
}

impl TrafficParameters {
    pub(super) fn validate(&self) -> Result<(), ParameterError> {
        require_positive("passing a standing obstacle", self.passing[0])?;
        require_positive("passing a moving obstacle", self.passing[1])?;
        require_positive("speed on a crosswalk", self.crosswalk)?;
        require_not_negative("gap", self.gap)?;
        require_not_negative("following", self.following)?;
        require_positive("brake before lines", self.brake)?;
        require_not_negative("halt at stop lines", self.halts[0])?;
        require_not_negative("halt at give-way lines", self.halts[1])?;
        require_not_negative("clearance", self.clearance)?;
        require_not_negative("front", self.body[0])?;
        require_not_negative("half width", self.body[1])
    }
}
