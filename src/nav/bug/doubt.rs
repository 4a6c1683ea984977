use super::strategy::Sight;
use crate::geometry::{Point, cross};

/// The fraction of a free range that is not trusted. Gaps between beams and pose errors grow with distance.
/// Each range that leads the robot less near to its goal than predicted increases the doubt, so errors cannot
/// make it shuttle for ever. Where ranges go on to mislead it, as through a passage that beams see as wide
/// enough, the way counts as closed at the place where it ended.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Doubt {
    share: f64,
    closed: Vec<Point>,
}

/// Initial fraction: twice what two of 360 beams may miss between them.
const FIRST: f64 = 0.02;
/// Maximum fraction.
const MOST: f64 = 0.3;

impl Default for Doubt {
    fn default() -> Self {
        Self { share: FIRST, closed: Vec::new() }
    }
}

impl Doubt {
    /// The trusted fraction.
    pub(super) fn trust(&self) -> f64 {
        1.0 - self.share
    }

    /// The share of the spare room that a way must have on either side: none at first, all of it at the
    /// maximum doubt.
    pub(super) fn caution(&self) -> f64 {
        (self.share - FIRST) / (MOST - FIRST)
    }

    /// Increases the doubt after a range proved too long: the robot was stopped at a place.
    pub(super) fn grow(&mut self, place: Point) {
        if self.share >= MOST {
            self.closed.push(place);
        }
        self.share = (2.0 * self.share).min(MOST);
    }

    /// How far the robot can be trusted to get on its way to the goal (m).
    pub(super) fn trusted(&self, sight: &Sight) -> f64 {
        let free = sight.free.min(sight.distance) * self.trust();
        let Some(way) = (sight.goal - sight.place.point).try_normalize(0.0) else { return free };
        let ends = self.closed.iter().filter_map(|place| {
            let to = place - sight.place.point;
            let (ahead, aside) = (to.dot(&way), cross(way, to).abs());
            (ahead > -sight.radius && aside < sight.radius).then_some(ahead.max(0.0))
        });
        ends.fold(free, f64::min)
    }
}
