use super::generate::LONGEST;
use crate::ParameterError;
use crate::parameter::{require, require_up_to};

/// Expectations about the track between cones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CentreLineParameters {
    /// Minimum and maximum track width (m).
    pub width: [f64; 2],
    /// Maximum distance between adjacent cones of an edge (m).
    pub spacing: f64,
    /// Distance between stations of the corridor (m).
    pub step: f64,
    /// Cost of a cone of the wrong colour; 0 for colour-blind planning. Infinity if colours are certain: no
    /// cone is passed on the wrong side, and none of known colour is taken for a false one.
    pub colour: f64,
    /// Minimum length of a loop (m); infinity for tracks that must not close.
    pub shortest_loop: f64,
    /// Maximum length of an open track (m).
    pub horizon: f64,
}

impl Default for CentreLineParameters {
    fn default() -> Self {
        Self { width: [2.5, 6.5], spacing: 5.6, step: 1.0, colour: 4.0, shortest_loop: 15.0, horizon: 40.0 }
    }
}

impl CentreLineParameters {
    /// Checks the parameters.
    ///
    /// # Errors
    ///
    /// If one is out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        let [least, most] = self.width;
        require_up_to("width", least, LONGEST)?;
        require_up_to("width", most, LONGEST)?;
        require("width", least, least <= most, "the least before the greatest")?;
        require_up_to("spacing", self.spacing, LONGEST)?;
        require("step", self.step, (0.01..=1e3).contains(&self.step), "0.01 to 1000 m")?;
        require("colour", self.colour, self.colour >= 0.0, "a number of at least 0, or infinity")?;
        let shortest = self.shortest_loop;
        require("shortest loop", shortest, shortest >= 0.0, "a number of at least 0, or infinity")?;
        require_up_to("horizon", self.horizon, LONGEST)
    }
}

/// Indices of a left and a right cone of the track.
pub(super) type Pair = [usize; 2];

/// A track between cones.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Way {
    pub(super) pairs: Vec<Pair>,
    pub(super) closed: bool,
}
