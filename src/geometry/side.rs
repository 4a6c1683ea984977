/// Side on which the robot has the wall or obstacle that it follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum WallSide {
    /// On the left: it circles an obstacle clockwise.
    Left,
    /// On the right: it circles an obstacle counter-clockwise.
    Right,
}

impl WallSide {
    /// The opposite side.
    #[must_use]
    pub fn other(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }

    /// Direction in which headings are scanned, away from the obstacle: +1 counter-clockwise, -1 clockwise.
    #[cfg(feature = "nav")]
    pub(crate) fn sense(self) -> f64 {
        match self {
            Self::Left => -1.0,
            Self::Right => 1.0,
        }
    }
}
