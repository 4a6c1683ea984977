use super::turn::TurnKind;
use crate::geometry::Pose;
use crate::maze::Route;

/// A piece of a fast run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Piece {
    /// A turn on the spot.
    Pivot {
        /// Angle to the left (rad).
        angle: f64,
    },
    /// A straight.
    Straight {
        /// Length (m).
        length: f64,
        /// Speed at its start (m/s).
        entry: f64,
        /// Speed at its end (m/s).
        exit: f64,
        /// Whether it runs along a diagonal.
        diagonal: bool,
    },
    /// A smooth turn at constant speed.
    Turn {
        /// Its shape and speed.
        kind: TurnKind,
        /// Whether it turns left.
        left: bool,
    },
}

/// A fast run through a maze.
#[derive(Debug, Clone, PartialEq)]
pub struct FastPlan {
    /// Duration from standstill to standstill (s).
    pub time: f64,
    /// Cells that it passes.
    pub route: Route,
    /// Start pose; the origin is the lower left corner of the maze.
    pub start: Pose,
    /// Its pieces.
    pub pieces: Vec<Piece>,
}
