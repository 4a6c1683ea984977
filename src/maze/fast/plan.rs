use super::turn::TurnKind;
use crate::geometry::Pose;
use crate::maze::Route;

/// A piece of a fast run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Piece {
    /// A turn on the spot.
    Pivot {
        /// Radians to the left.
        angle: f64,
    },
    /// A straight.
    Straight {
        /// Metres.
        length: f64,
        /// The speed at its beginning, in m/s.
        entry: f64,
        /// The speed at its end, in m/s.
        exit: f64,
        /// Whether it runs along a diagonal.
        diagonal: bool,
    },
    /// A smooth turn, at constant speed.
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
    /// Seconds from standstill to standstill.
    pub time: f64,
    /// The cells that it passes.
    pub route: Route,
    /// Where it begins, in the frame whose origin is the lower left corner of the maze.
    pub start: Pose,
    /// What it is made of.
    pub pieces: Vec<Piece>,
}
