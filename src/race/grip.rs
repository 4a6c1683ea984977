use super::tyres::Tyres;
use crate::ParameterError;
use crate::parameter::{require, require_positive};

/// Grip limit of a car's tyres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum GripLimit {
    /// A friction ellipse, independent of the car.
    Ellipse {
        /// Maximum lateral acceleration on a straight (m/s²).
        across: f64,
        /// Fraction of it lost per 1/m of curvature: turned wheels also push backwards.
        turned: f64,
        /// Maximum longitudinal acceleration (m/s²).
        along: f64,
    },
    /// The bicycle model in steady state.
    Balance(Tyres),
}

impl GripLimit {
    pub(super) fn validate(&self) -> Result<(), ParameterError> {
        match *self {
            Self::Ellipse { across, turned, along } => {
                require_positive("grip across", across)?;
                require_positive("grip along", along)?;
                require("grip lost by turned wheels", turned, (0.0..=1.0).contains(&turned), "0 to 1")
            }
            Self::Balance(tyres) => tyres.validate(),
        }
    }

    /// Maximum lateral acceleration at a curvature (m/s²) at which a car with motors of acceleration `drive`
    /// keeps its speed.
    pub fn across(&self, curvature: f64, drive: f64) -> f64 {
        let curvature = curvature.abs();
        match *self {
            // At least a fifth: no car turns more tightly.
            Self::Ellipse { across, turned, .. } => across * (1.0 - turned * curvature).max(0.2),
            Self::Balance(tyres) => {
                let keeps = |across| {
                    tyres.turns(curvature, across)
                        && tyres.forwards(curvature, across, drive).is_some_and(|along| along >= 0.0)
                };
                let (mut least, mut most) = (0.0, tyres.grip);
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (least + most);
                    if keeps(middle) { least = middle } else { most = middle }
                }
                // Where the wheels do not turn far enough, the car only crawls.
                least.max(CRAWLS * tyres.grip)
            }
        }
    }

    /// Maximum longitudinal acceleration (m/s²) at a curvature and a lateral acceleration, limited by the
    /// motors.
    pub fn forwards(&self, curvature: f64, across: f64, drive: f64) -> f64 {
        match self {
            Self::Ellipse { .. } => self.left_along(curvature, across).min(drive),
            Self::Balance(tyres) => {
                tyres.forwards(curvature.abs(), across.abs(), drive).unwrap_or(0.0).max(0.0)
            }
        }
    }

    /// Maximum deceleration (m/s²), limited by the brakes.
    pub fn backwards(&self, curvature: f64, across: f64, brake: f64) -> f64 {
        match self {
            Self::Ellipse { .. } => self.left_along(curvature, across).min(brake),
            Self::Balance(tyres) => {
                tyres.backwards(curvature.abs(), across.abs(), brake).unwrap_or(0.0).max(0.0)
            }
        }
    }

    fn left_along(&self, curvature: f64, across: f64) -> f64 {
        let Self::Ellipse { along, .. } = self else { return 0.0 };
        let share = across / self.across(curvature, 0.0);
        along * (1.0 - share * share).max(0.0).sqrt()
    }
}

/// Fraction of the grip that remains in bends that are too tight.
const CRAWLS: f64 = 0.05;
/// Number of bisections in the search for an acceleration.
const HALVINGS: usize = 14;

#[cfg(test)]
mod tests;
