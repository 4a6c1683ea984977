use crate::ParameterError;
use crate::parameter::require_positive;
use crate::race::grip::GripLimit;
use crate::race::lane_model::LaneParameters;
use crate::race::map::ConeMapParameters;
use crate::race::pair::CentreLineParameters;
use crate::race::profile::CarLimits;
use crate::race::racing_line::CarOutline;
use crate::race::tracker::LineTrackerParameters;
use crate::race::tyres::Tyres;

/// Parameters of [`Racer`](super::Racer).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RacerParameters {
    /// Number of laps; the first one is for mapping.
    pub laps: usize,
    /// Limits of tyres and motors.
    pub limits: CarLimits,
    /// Limits while the track is unknown; the top speed is that of the first lap.
    pub first_lap: CarLimits,
    /// Outline of the car, for the clearance from cones.
    pub outline: CarOutline,
    /// Parameters of the centre line.
    pub centre_line: CentreLineParameters,
    /// Parameters of the map.
    pub map: ConeMapParameters,
    /// Parameters of the lane search in the first lap.
    pub lane: LaneParameters,
    /// Parameters of the line tracker.
    pub tracker: LineTrackerParameters,
    /// Control period (s).
    pub period: f64,
}

impl Default for RacerParameters {
    fn default() -> Self {
        Self {
            laps: 10,
            limits: CarLimits {
                // A thirtieth of the grip and a fifteenth of the steering are reserved for control errors.
                grip: GripLimit::Balance(Tyres { grip: 11.6, lock: 0.58, ..Tyres::default() }),
                drive: 8.0,
                brake: 9.5,
                top_speed: 30.0,
                turning: 1.2,
            },
            // Slow in tight bends, which are seen late and where the car also responds late.
            first_lap: CarLimits {
                grip: GripLimit::Ellipse { across: 5.0, turned: 1.0, along: 5.0 },
                ..CarLimits::circle(5.0, 3.0, 5.0, 6.0)
            },
            outline: CarOutline { half_width: 0.7, nose: 2.15, ahead: 0.9, room: 0.5 },
            centre_line: CentreLineParameters::default(),
            map: ConeMapParameters::default(),
            lane: LaneParameters::default(),
            tracker: LineTrackerParameters::default(),
            period: 0.05,
        }
    }
}

impl RacerParameters {
    /// Checks the parameters.
    ///
    /// # Errors
    ///
    /// If one is out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        self.limits.validate().map_err(|error| error.of("limits"))?;
        self.first_lap.validate().map_err(|error| error.of("first lap"))?;
        self.outline.validate().map_err(|error| error.of("outline"))?;
        self.centre_line.validate().map_err(|error| error.of("centre line"))?;
        self.map.validate().map_err(|error| error.of("map"))?;
        self.lane.validate().map_err(|error| error.of("lane"))?;
        self.tracker.validate().map_err(|error| error.of("tracker"))?;
        require_positive("control period", self.period)
    }

    /// Parameters for a car whose tyres do not slip.
    pub fn rolling() -> Self {
        Self { tracker: LineTrackerParameters::rolling(), ..Self::default() }
    }
}
