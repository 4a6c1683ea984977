use super::generate::LONGEST;
use crate::ParameterError;
use crate::parameter::{require, require_up_to};

/// What the way between cones is expected to look like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CentreLineParameters {
    /// Metres from edge to edge, from least to most.
    pub width: [f64; 2],
    /// Metres from cone to cone along an edge at most, where none is missing.
    pub spacing: f64,
    /// Metres between stations of the corridor.
    pub step: f64,
    /// What a cone of the wrong colour costs; 0 to be colour-blind. Infinity where colours are certain: no
    /// cone is passed on the wrong side, and none whose colour is known is taken for a false one.
    pub colour: f64,
    /// Metres of the shortest loop; infinity where a way must not close.
    pub shortest_loop: f64,
    /// Metres that the way is followed at most where it does not close.
    pub horizon: f64,
}

impl Default for CentreLineParameters {
    fn default() -> Self {
        Self { width: [2.5, 6.5], spacing: 5.6, step: 1.0, colour: 4.0, shortest_loop: 15.0, horizon: 40.0 }
    }
}

impl CentreLineParameters {
    /// Fails with the name of the parameter that is out of range.
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

/// Indices of a left and a right cone with the way between them.
pub(super) type Pair = [usize; 2];

/// A way between cones.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Way {
    pub(super) pairs: Vec<Pair>,
    pub(super) closed: bool,
}
