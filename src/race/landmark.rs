//! A cone of a map, with its observations.

use super::cone::ConeColour;
use super::sight::ConeSighting;
use crate::geometry::Point;

/// Maximum count of detections of a cone in one colour, or without colour.
const MOST_COLOURS: u16 = 1000;
/// Number of camera detections without colour after which a cone counts as colourless.
const PALE: u16 = 4;
/// Votes for an edge by which a cone belongs to it.
pub(super) const SURE: i16 = 6;
/// Maximum number of votes.
const MOST_VOTES: i16 = 30;
/// Number of detections after which the position of a cone is averaged no longer.
const MEMORY: u32 = 80;

/// A cone of the map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Landmark {
    pub(super) position: Point,
    pub(super) seen: u32,
    pub(super) missed: u32,
    /// Number of detections in blue, yellow and orange.
    colours: [u16; 3],
    /// Number of times that a camera showed no colour there.
    pale: u16,
    /// Votes for the left edge minus votes for the right edge.
    side: i16,
    /// Distance driven at the first, last and mean detection (m).
    pub(super) first: f64,
    pub(super) last: f64,
    pub(super) mean: f64,
}

impl Landmark {
    /// Its most frequent colour, or else that of its edge, if the votes are conclusive.
    pub(super) fn colour(&self) -> ConeColour {
        match self.painted() {
            ConeColour::Unknown if self.side >= SURE => ConeColour::Blue,
            ConeColour::Unknown if self.side <= -SURE => ConeColour::Yellow,
            painted => painted,
        }
    }

    pub(super) fn painted(&self) -> ConeColour {
        let [blue, yellow, orange] = self.colours;
        let most = blue.max(yellow).max(orange);
        if most < 3 || blue + yellow + orange >= 2 * most {
            ConeColour::Unknown
        } else if most == blue {
            ConeColour::Blue
        } else if most == yellow {
            ConeColour::Yellow
        } else {
            ConeColour::Orange
        }
    }

    /// Whether a camera shows that it is not a coloured cone.
    pub(super) fn is_pale(&self) -> bool {
        self.painted() == ConeColour::Unknown
            && self.pale >= PALE
            && self.pale > 2 * self.colours.iter().sum::<u16>()
    }

    fn vote(&mut self, sighting: &ConeSighting) {
        let index = match sighting.colour {
            ConeColour::Blue => 0,
            ConeColour::Yellow => 1,
            ConeColour::Orange | ConeColour::BigOrange => 2,
            ConeColour::Unknown => {
                self.pale += u16::from(sighting.confidence <= 0.0 && self.pale < MOST_COLOURS);
                return;
            }
        };
        // Halve before overflow, so that late votes count as well.
        if self.colours[index] >= MOST_COLOURS {
            self.colours = self.colours.map(|count| count / 2);
        }
        self.colours[index] += 1;
    }

    /// A newly detected cone.
    pub(super) fn new(position: Point, sighting: &ConeSighting, way: f64) -> Self {
        let mut new = Self {
            position,
            seen: 1,
            missed: 0,
            colours: [0; 3],
            pale: 0,
            side: 0,
            first: way,
            last: way,
            mean: way,
        };
        new.vote(sighting);
        new
    }

    /// Records a further detection.
    pub(super) fn see(&mut self, place: Point, sighting: &ConeSighting, way: f64) {
        self.seen = (self.seen + 1).min(MEMORY);
        self.missed = 0;
        self.vote(sighting);
        let share = 1.0 / f64::from(self.seen);
        self.position += (place - self.position) * share;
        self.mean += (way - self.mean) * share;
        self.last = way;
    }

    /// Merges an entry that was taken for another cone.
    pub(super) fn join(&mut self, other: &Self) {
        let share = f64::from(other.seen) / f64::from(self.seen + other.seen);
        self.position += (other.position - self.position) * share;
        self.seen = (self.seen + other.seen).min(MEMORY);
        self.missed = self.missed.min(other.missed);
        for (mine, theirs) in self.colours.iter_mut().zip(other.colours) {
            *mine = (*mine + theirs).min(MOST_COLOURS);
        }
        self.pale = (self.pale + other.pale).min(MOST_COLOURS);
        self.side = (self.side + other.side).clamp(-MOST_VOTES, MOST_VOTES);
        self.last = self.last.max(other.last);
    }

    /// Votes for an edge: 1 for the left one, -1 for the right one.
    pub(super) fn vote_side(&mut self, side: i16) {
        self.side = (self.side + side).clamp(-MOST_VOTES, MOST_VOTES);
    }
}
