use crate::ParameterError;
use crate::parameter::debug_as_sentence;

/// Why no line could be planned.
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LineError {
    /// Too few points for a line.
    #[error("{found} points; expected at least {needed}")]
    TooFew {
        /// How many there are.
        found: usize,
        /// How many it takes.
        needed: usize,
    },
    /// Two neighbours are the same point, or one is no number.
    #[error("point {index} is no number or the same as its neighbour; expected distinct points")]
    Degenerate {
        /// Which one, from 0.
        index: usize,
    },
    /// A car of this width does not fit through.
    #[error("{free} m are free at station {index}; expected {needed} m")]
    TooNarrow {
        /// Which station, from 0.
        index: usize,
        /// Metres between the edges.
        free: f64,
        /// Metres that the car takes.
        needed: f64,
    },
    /// No way between cones leads on from where the car is.
    #[error("no way between cones leads on from the car")]
    NoWay,
    /// A parameter is out of range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
}

debug_as_sentence!(LineError);
