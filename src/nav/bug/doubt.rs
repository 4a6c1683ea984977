/// The fraction of a free range that is not trusted. Gaps between beams and pose errors grow with distance.
/// Each range that leads the robot less near to its goal than predicted increases the doubt, so errors cannot
/// make it shuttle for ever.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Doubt(f64);

/// Initial fraction: twice what two of 360 beams may miss between them.
const FIRST: f64 = 0.02;
/// Maximum fraction.
const MOST: f64 = 0.3;

impl Default for Doubt {
    fn default() -> Self {
        Self(FIRST)
    }
}

impl Doubt {
    /// The trusted fraction.
    pub(super) fn trust(self) -> f64 {
        1.0 - self.0
    }

    /// The share of the spare room that a way must have on either side: none at first, all of it at the
    /// maximum doubt.
    pub(super) fn caution(self) -> f64 {
        (self.0 - FIRST) / (MOST - FIRST)
    }

    /// Increases the doubt after a range proved too long.
    pub(super) fn grow(&mut self) {
        self.0 = (2.0 * self.0).min(MOST);
    }
}
