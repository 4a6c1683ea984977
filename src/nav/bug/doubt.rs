/// The share of a free range that is not relied upon. Gaps between beams, and errors of the pose, grow with the distance; a
/// range that has led a robot less near to its goal than it promised makes it doubt more from then on, so that it cannot go
/// back and forth for ever because of errors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Doubt(f64);

/// The share at first: twice what hides between two of 360 beams.
const FIRST: f64 = 0.02;
/// The share at most.
const MOST: f64 = 0.3;

impl Default for Doubt {
    fn default() -> Self {
        Self(FIRST)
    }
}

impl Doubt {
    /// The share that is relied upon.
    pub(super) fn trust(self) -> f64 {
        1.0 - self.0
    }

    /// A range was less than it promised.
    pub(super) fn grow(&mut self) {
        self.0 = (2.0 * self.0).min(MOST);
    }
}
