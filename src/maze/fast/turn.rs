use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// A smooth turn of a fast run. Straights run along rows and columns, through the middles of cells, or along diagonals,
/// through the middles of their edges; a turn leads from one such line to another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum TurnKind {
    /// A quarter turn within one cell.
    Short90,
    /// A quarter turn that takes in half of the cells before and after it.
    Wide90,
    /// A half turn into the next row or column.
    UTurn,
    /// From a row or column into a diagonal.
    In45,
    /// From a diagonal into a row or column.
    Out45,
    /// As `In45`, in half the length: from standstill or just behind another turn.
    TightIn45,
    /// As `Out45`, in half the length.
    TightOut45,
    /// From a row or column back into a diagonal.
    In135,
    /// From a diagonal back into a row or column.
    Out135,
    /// A quarter turn from one diagonal into another.
    Diagonal90,
}

impl TurnKind {
    /// All of them.
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

    /// The angle by which it turns, in radians.
    pub const fn angle(self) -> f64 {
        match self {
            Self::Short90 | Self::Wide90 | Self::Diagonal90 => FRAC_PI_2,
            Self::UTurn => PI,
            Self::In45 | Self::Out45 | Self::TightIn45 | Self::TightOut45 => FRAC_PI_4,
            Self::In135 | Self::Out135 => 3.0 * FRAC_PI_4,
        }
    }

    /// From the corner where the two lines meet to either end of the curve, in cells; for a half turn from the middle of the
    /// cell. The lengths leave a disc of a fifth of a cell in radius free of the walls.
    pub(super) const fn tangent(self) -> f64 {
        match self {
            Self::Short90 | Self::In45 | Self::Out45 => 0.5,
            Self::TightIn45 | Self::TightOut45 => 0.25,
            Self::Wide90 | Self::In135 | Self::Out135 => 0.95,
            Self::UTurn => 0.693,
            Self::Diagonal90 => 0.6,
        }
    }

    /// Whether it ends on a diagonal.
    pub const fn ends_diagonally(self) -> bool {
        matches!(self, Self::In45 | Self::TightIn45 | Self::In135 | Self::Diagonal90)
    }
}
