use crate::ParameterError;
use crate::parameter::debug_as_sentence;

/// Reason why no line could be planned.
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LineError {
    /// Too few points for a line.
    #[error("{found} points; expected at least {needed}")]
    TooFew {
        /// Number of points.
        found: usize,
        /// Minimum number of points.
        needed: usize,
    },
    /// Two adjacent points coincide, or a coordinate is not finite.
    #[error("point {index} is no number or the same as its neighbour; expected distinct points")]
    Degenerate {
        /// Index of the point, from 0.
        index: usize,
    },
    /// The corridor is too narrow for the car.
    #[error("{free} m are free at station {index}; expected {needed} m")]
    TooNarrow {
        /// Index of the station, from 0.
        index: usize,
        /// Distance between the edges (m).
        free: f64,
        /// Width required by the car (m).
        needed: f64,
    },
    /// No track between cones leads on from the car.
    #[error("no way between cones leads on from the car")]
    NoWay,
    /// The track between cones is not a loop.
    #[error("a way of {length} m that does not close; expected a loop")]
    Open {
        /// Length of the track (m).
        length: f64,
    },
    /// The loop leaves out cones: it is a loop of a part of the track.
    #[error("a loop that passes {passed} of {all} cones; expected one that passes nearly all")]
    Passes {
        /// Number of cones at its edges.
        passed: u32,
        /// Number of coloured cones, and of those without a colour if they are more.
        all: u32,
    },
    /// Cones of the loop are on the wrong side.
    #[error(
        "a loop with {right} of {all} cones on their side; expected blue ones left and yellow ones right of it"
    )]
    WrongSide {
        /// Number of cones on the right side.
        right: usize,
        /// Number of cones passed.
        all: u32,
    },
    /// The car starts against the direction of the loop.
    #[error("a start that heads against the loop; expected blue cones on the car's left")]
    Against,
    /// The loop turns back on itself.
    #[error("a loop that turns back at ({x}, {y}) m; expected one that a car can drive")]
    TurnsBack {
        /// x coordinate (m).
        x: f64,
        /// y coordinate (m).
        y: f64,
    },
    /// The loop crosses itself.
    #[error("a loop that crosses itself at ({x}, {y}) m; expected one that does not")]
    Crosses {
        /// x coordinate (m).
        x: f64,
        /// y coordinate (m).
        y: f64,
    },
    /// A parameter is out of range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
}

debug_as_sentence!(LineError);
