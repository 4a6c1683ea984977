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
    /// The way between cones does not close to a loop.
    #[error("a way of {length} m that does not close; expected a loop")]
    Open {
        /// Metres.
        length: f64,
    },
    /// A loop that leaves out cones: it is that of a part of the track.
    #[error("a loop that passes {passed} of {all} coloured cones; expected one that passes nearly all")]
    Passes {
        /// Those that stand at its edges.
        passed: u32,
        /// All.
        all: u32,
    },
    /// A loop with cones on the wrong side.
    #[error(
        "a loop with {right} of {all} cones on their side; expected blue ones left and yellow ones right of it"
    )]
    WrongSide {
        /// Those on their side.
        right: usize,
        /// All that it passes.
        all: u32,
    },
    /// A loop that turns back on itself.
    #[error("a loop that turns back at ({x}, {y}) m; expected one that a car can drive")]
    TurnsBack {
        /// Where.
        x: f64,
        /// Where.
        y: f64,
    },
    /// A loop that crosses itself.
    #[error("a loop that crosses itself at ({x}, {y}) m; expected one that does not")]
    Crosses {
        /// Where.
        x: f64,
        /// Where.
        y: f64,
    },
    /// A parameter is out of range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
}

debug_as_sentence!(LineError);
