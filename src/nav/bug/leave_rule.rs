use std::fmt::Debug;

use super::strategy::Sight;
use crate::geometry::{Point, cross};

/// Where an obstacle may be left.
pub(super) trait LeaveRule: Debug + Clone + Default {
    /// Takes in that an obstacle has been met.
    fn meet(&mut self, meeting: &Sight);

    /// Whether the obstacle may be left here. `goal` is that of the run, which began at the origin.
    fn allows(&mut self, goal: Point, sight: &Sight) -> bool;
}

/// Where the way to the goal is open, and the robot is nearer to the goal than at those places before where it was not.
/// With `EVER` all of the run count, else those along the present obstacle's boundary up to where the way opens first:
/// the hit point alone.
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

    fn allows(&mut self, _goal: Point, sight: &Sight) -> bool {
        if sight.is_open() {
            return sight.distance <= self.nearest - sight.step;
        }
        if EVER {
            self.nearest = self.nearest.min(sight.distance);
        }
        false
    }
}

/// On the M-line, the straight line from start to goal, nearer to the goal than at the hit point, or with `EVER` than at
/// any place of that line where the robot has been, if the way along it is open.
#[derive(Debug, Clone)]
pub(super) struct OnMainLine<const EVER: bool> {
    nearest: f64,
    /// Metres that the robot was to the left of the line at the last step.
    offset: f64,
}

/// Metres to either side that still count as on the line.
const LINE_WIDTH: f64 = 0.005;
/// The free range along the line, in robot radii, from which on it is open even at a slant into the wall.
const OPEN_LINE: f64 = 2.5;

impl<const EVER: bool> Default for OnMainLine<EVER> {
    fn default() -> Self {
        Self { nearest: f64::INFINITY, offset: 0.0 }
    }
}

impl<const EVER: bool> LeaveRule for OnMainLine<EVER> {
    fn meet(&mut self, meeting: &Sight) {
        self.nearest = if EVER { self.nearest.min(meeting.distance) } else { meeting.distance };
        self.offset = 0.0;
    }

    fn allows(&mut self, goal: Point, sight: &Sight) -> bool {
        let before = self.offset;
        self.offset = cross(goal.coords, sight.place.point.coords) / goal.coords.norm();
        let on_line = self.offset.abs() < LINE_WIDTH || self.offset * before < 0.0;
        if !on_line {
            return false;
        }
        let open = sight.is_open() || sight.free >= OPEN_LINE * sight.radius;
        if open && sight.distance <= self.nearest - sight.step {
            return true;
        }
        if EVER && !open {
            self.nearest = self.nearest.min(sight.distance);
        }
        false
    }
}
