/// A side of the robot: where the wall or the obstacle is that it follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WallSide {
    /// To the left: an obstacle is gone round clockwise.
    Left,
    /// To the right: an obstacle is gone round counter-clockwise.
    Right,
}

impl WallSide {
    /// The other side.
    #[must_use]
    pub fn other(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }

    /// The sense in which headings are tried from the obstacle outwards: +1 counter-clockwise, -1 clockwise.
    #[cfg(feature = "nav")]
    pub(crate) fn sense(self) -> f64 {
        match self {
            Self::Left => -1.0,
            Self::Right => 1.0,
        }
    }
}
