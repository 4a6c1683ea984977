use std::f64::consts::FRAC_PI_2;

use crate::ParameterError;
use crate::geometry::math;
use crate::parameter::{require, require_not_negative, require_positive};
use crate::world::{DriveSpec, RobotSpec};

/// Ground on which a robot can stand and turn in any direction.
///
/// ```
/// use roverlab::nav::elevation::Climber;
/// use roverlab::world::RobotSpec;
///
/// // Belts hold on steeper ground than a robot on two wheels and a castor, which tips over.
/// let (belts, wheels) = (Climber::of(&RobotSpec::blizzard()), Climber::of(&RobotSpec::labbot()));
/// assert!(belts.slope > wheels.slope && belts.slope < 0.5);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Climber {
    /// Maximum slope, measured over the robot's size (rad).
    pub slope: f64,
    /// Maximum height of a step under the robot (m).
    pub step: f64,
    /// Radius around the robot's centre that counts as under it (m).
    pub radius: f64,
}

/// The share of the slope on which it would slip or tip that a robot is trusted with.
const TRUSTED: f64 = 0.7;
/// The share of a wheel's radius that it climbs as a step.
const CLIMBED: f64 = 0.6;
/// Height of the centre of mass as a fraction of the robot's, as in the simulator.
const MIDDLE: f64 = 0.4;
/// Place of the centre of mass as a fraction of the way from axle to castor, as in the simulator.
const BETWEEN: f64 = 0.3;

fn wheel_diameter(spec: &RobotSpec) -> f64 {
    match spec.drive {
        DriveSpec::Differential { wheel_diameter, .. }
        | DriveSpec::Tracked { wheel_diameter, .. }
        | DriveSpec::Ackermann { wheel_diameter, .. }
        | DriveSpec::Omni { wheel_diameter, .. } => wheel_diameter,
        DriveSpec::Craft(_) => 0.0,
    }
}

impl Climber {
    /// The limits of a robot, from its friction, its wheels or belts and the height of its centre of mass:
    /// seven tenths of the slope on which it would slip or tip over.
    pub fn of(spec: &RobotSpec) -> Self {
        let step = 0.5 * CLIMBED * wheel_diameter(spec);
        Self { slope: TRUSTED * Self::steepest(spec), step, radius: spec.footprint.bounding_radius() }
    }

    /// The slope in radians on which a robot slips or tips over.
    pub fn steepest(spec: &RobotSpec) -> f64 {
        let reach = spec.footprint.bounding_radius();
        let support = match spec.drive {
            DriveSpec::Differential { track, .. } => (BETWEEN * reach).min(0.5 * track),
            DriveSpec::Tracked { track, length, .. } => 0.5 * track.min(length),
            DriveSpec::Ackermann { track, wheelbase, .. } | DriveSpec::Omni { track, wheelbase, .. } => {
                0.5 * track.min(wheelbase)
            }
            // Craft climb nothing.
            DriveSpec::Craft(_) => 0.0,
        };
        math::atan2(support, MIDDLE * spec.height).min(math::atan(spec.friction))
    }

    /// The same limits with another maximum slope (rad).
    #[must_use]
    pub fn with_slope(self, slope: f64) -> Self {
        Self { slope, ..self }
    }

    /// Checks every parameter; the error names the one out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        let steep = self.slope > 0.0 && self.slope < FRAC_PI_2;
        require("slope", self.slope, steep, "more than 0 and less than a right angle")?;
        require_not_negative("step", self.step)?;
        require_positive("radius", self.radius)
    }
}
