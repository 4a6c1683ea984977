use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// A smooth turn of a fast run. Straights run along rows and columns through cell centres, or along diagonals
/// through the centres of cell edges; a turn joins two such lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum TurnKind {
    /// Quarter turn within one cell.
    Short90,
    /// Quarter turn that extends into half of the cells before and after it.
    Wide90,
    /// Half turn into the adjacent row or column.
    UTurn,
    /// From a row or column into a diagonal.
    In45,
    /// From a diagonal into a row or column.
    Out45,
    /// As `In45`, at half the length: from rest or right after another turn.
    TightIn45,
    /// As `Out45`, at half the length.
    TightOut45,
    /// From a row or column back into a diagonal.
    In135,
    /// From a diagonal back into a row or column.
    Out135,
    /// Quarter turn from one diagonal into another.
    Diagonal90,
}

impl TurnKind {
    /// All kinds.
    pub const ALL: [Self; 10] = [
        Self::Short90,
        Self::Wide90,
        Self::UTurn,
        Self::In45,
        Self::Out45,
        Self::TightIn45,
        Self::TightOut45,
        Self::In135,
        Self::Out135,
        Self::Diagonal90,
    ];

    /// Angle of the turn (rad).
    pub const fn angle(self) -> f64 {
        match self {
            Self::Short90 | Self::Wide90 | Self::Diagonal90 => FRAC_PI_2,
            Self::UTurn => PI,
            Self::In45 | Self::Out45 | Self::TightIn45 | Self::TightOut45 => FRAC_PI_4,
            Self::In135 | Self::Out135 => 3.0 * FRAC_PI_4,
        }
    }

    /// Distance from the corner of the two lines to either end of the curve (cells); for a half turn, from
    /// the cell centre. It keeps a disc with a radius of 0.2 cells clear of the walls.
    pub(super) const fn tangent(self) -> f64 {
        match self {
            Self::Short90 | Self::In45 | Self::Out45 => 0.5,
            Self::TightIn45 | Self::TightOut45 => 0.25,
            Self::Wide90 | Self::In135 | Self::Out135 => 0.95,
            Self::UTurn => 0.693,
            Self::Diagonal90 => 0.6,
        }
    }
}
