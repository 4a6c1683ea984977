use super::error::{PlanError, positive};
use super::tyres::Tyres;

/// What the tyres of a car give at most.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Hold {
    /// A friction ellipse, whatever the car.
    Ellipse {
        /// The greatest acceleration across, straight on, in m/s².
        across: f64,
        /// The share of it that is lost for a curvature of 1/m: wheels that are turned push backwards as well.
        turned: f64,
        /// The greatest acceleration along the way, in m/s².
        along: f64,
    },
    /// That of the bicycle model in balance.
    Balance(Tyres),
}

impl Hold {
    pub(super) fn check(&self) -> Result<(), PlanError> {
        match *self {
            Self::Ellipse { across, turned, along } => {
                positive("grip across", across)?;
                positive("grip along", along)?;
                if (0.0..=1.0).contains(&turned) {
                    return Ok(());
                }
                let expected = "0 to 1";
                Err(PlanError::Parameter { name: "grip lost by turned wheels", value: turned, expected })
            }
            Self::Balance(tyres) => {
                positive("grip", tyres.grip)?;
                positive("grip of the front tyres", tyres.front)?;
                if tyres.stiffness > 0.0 { Ok(()) } else { positive("stiffness", tyres.stiffness) }
            }
        }
    }

    /// The greatest acceleration across at a curvature, in m/s², at which a car with such motors keeps its speed.
    pub fn across(&self, curvature: f64, drive: f64) -> f64 {
        match *self {
            // Never less than a fifth: so tightly no car turns.
            Self::Ellipse { across, turned, .. } => across * (1.0 - turned * curvature.abs()).max(0.2),
            Self::Balance(tyres) => {
                let keeps =
                    |across| tyres.forwards(curvature, across, drive).is_some_and(|along| along >= 0.0);
                let (mut least, mut most) = (0.0, tyres.grip);
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (least + most);
                    if keeps(middle) { least = middle } else { most = middle }
                }
                least
            }
        }
    }

    /// The greatest acceleration along the way, in m/s², at a curvature and an acceleration across, by motors that give so much.
    pub fn forwards(&self, curvature: f64, across: f64, drive: f64) -> f64 {
        match self {
            Self::Ellipse { .. } => self.left_along(curvature, across).min(drive),
            Self::Balance(tyres) => tyres.forwards(curvature, across.abs(), drive).unwrap_or(0.0).max(0.0),
        }
    }

    /// The greatest deceleration, by brakes that give so much.
    pub fn backwards(&self, curvature: f64, across: f64, brake: f64) -> f64 {
        match self {
            Self::Ellipse { .. } => self.left_along(curvature, across).min(brake),
            Self::Balance(tyres) => tyres.backwards(curvature, across.abs(), brake).unwrap_or(0.0).max(0.0),
        }
    }

    fn left_along(&self, curvature: f64, across: f64) -> f64 {
        let Self::Ellipse { along, .. } = self else { return 0.0 };
        let share = across / self.across(curvature, 0.0);
        along * (1.0 - share * share).max(0.0).sqrt()
    }
}

/// Halvings of the range in which an acceleration is looked for.
const HALVINGS: usize = 14;
