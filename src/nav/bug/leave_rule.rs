use std::fmt::Debug;

use super::strategy::Sight;
use crate::geometry::{Point, cross};

/// Condition for leaving an obstacle.
pub(super) trait LeaveRule: Debug + Clone + Default {
    /// Records that an obstacle has been met.
    fn meet(&mut self, meeting: &Sight);

    /// Whether the obstacle may be left here.
    fn allows(&mut self, sight: &Sight) -> bool;
}

/// Leaves where the way to the goal is open and the robot is nearer to the goal than at earlier blocked
/// points. With `EVER` all points of the run count, otherwise only those of the current boundary until the
/// way first opens: in effect the hit point.
#[derive(Debug, Clone)]
pub(super) struct Nearer<const EVER: bool> {
    nearest: f64,
}

impl<const EVER: bool> Default for Nearer<EVER> {
    fn default() -> Self {
        Self { nearest: f64::INFINITY }
    }
}

impl<const EVER: bool> LeaveRule for Nearer<EVER> {
    fn meet(&mut self, meeting: &Sight) {
        self.nearest = if EVER { self.nearest.min(meeting.distance) } else { meeting.distance };
    }

    fn allows(&mut self, sight: &Sight) -> bool {
        if sight.is_open() {
            return sight.distance <= self.nearest - sight.step;
        }
        if EVER {
            self.nearest = self.nearest.min(sight.distance);
        }
        false
    }
}

/// Leaves on the M-line, the straight line to the goal, where the way along it is open and the robot is
/// nearer to the goal than at the hit point; with `EVER`, nearer than at any earlier point of the line.
///
/// A robot that leaves an obstacle rolls on across the line for some centimetres and drives to the goal from
/// there. An obstacle that just crosses the one line may miss the other, so the line is drawn anew at every
/// hit point.
#[derive(Debug, Clone)]
pub(super) struct OnMainLine<const EVER: bool> {
    nearest: f64,
    /// Start of the line.
    hit: Point,
    /// Offset to the left of the line at the previous step (m).
    offset: f64,
}

/// Distance to either side that still counts as on the line (m).
const LINE_WIDTH: f64 = 0.005;
/// Robot radii beyond which a place is left behind, and a free range along the line from which on it is open
/// even at a slant into the wall.
pub(super) const OPEN: f64 = 2.5;

impl<const EVER: bool> Default for OnMainLine<EVER> {
    fn default() -> Self {
        Self { nearest: f64::INFINITY, hit: Point::origin(), offset: 0.0 }
    }
}

impl<const EVER: bool> LeaveRule for OnMainLine<EVER> {
    fn meet(&mut self, meeting: &Sight) {
        self.nearest = if EVER { self.nearest.min(meeting.distance) } else { meeting.distance };
        (self.hit, self.offset) = (meeting.place.point, 0.0);
    }

    fn allows(&mut self, sight: &Sight) -> bool {
        let (before, line) = (self.offset, sight.goal - self.hit);
        self.offset = cross(line, sight.place.point - self.hit) / line.norm();
        let on_line = self.offset.abs() < LINE_WIDTH || self.offset * before < 0.0;
        // The line ends at the goal.
        if !on_line || line.dot(&(sight.goal - sight.place.point)) < 0.0 {
            return false;
        }
        let open = sight.is_open() || sight.free >= OPEN * sight.radius;
        if open && sight.distance <= self.nearest - sight.step {
            return true;
        }
        if EVER && !open {
            self.nearest = self.nearest.min(sight.distance);
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::WallSide;
    use crate::nav::bug::strategy::Place;

    const GOAL: Point = Point::new(3.0, 0.0);

    fn sight(x: f64, y: f64) -> Sight {
        let point = Point::new(x, y);
        Sight {
            place: Place { point, wall: 0.0 },
            side: WallSide::Left,
            goal: GOAL,
            distance: (GOAL - point).norm(),
            free: 9.0,
            into_wall: -1.0,
            at_boundary: false,
            in_line: true,
            travelled: 0.0,
            margin: 0.04,
            step: 0.015,
            radius: 0.06,
        }
    }

    /// The line starts at the hit point, slightly beside the line from the start, and ends at the goal.
    #[test]
    fn the_main_line_leads_from_the_hit_point_to_the_goal() {
        let mut rule = OnMainLine::<false>::default();
        rule.meet(&sight(1.0, 0.04));
        assert!(!rule.allows(&sight(1.0, 0.04)) && !rule.allows(&sight(2.0, -0.1)));
        assert!(rule.allows(&sight(2.0, 0.1)));
        rule.meet(&sight(1.0, 0.04));
        assert!(!rule.allows(&sight(2.0, 0.0)) && rule.allows(&sight(2.0, 0.018)));
        // Farther than the hit point, and beyond the goal.
        rule.meet(&sight(1.0, 0.04));
        assert!(!rule.allows(&sight(0.5, -0.1)) && !rule.allows(&sight(0.5, 0.2)));
        assert!(!rule.allows(&sight(3.5, 0.1)) && !rule.allows(&sight(3.5, -0.1)));
    }
}
