//! The marking between the lanes: whether cars may cross it from the own lane.

use super::view::{CELL, RoadView, column};
use crate::vision::lane_markings::RoadAhead;

/// Least brightness of a line between floor and paint.
const BRIGHT: f64 = 0.55;
/// Distance to the own side of the road's centre line within which a dashed line, or the nearer line of a
/// pair, is looked for (cells): the lines of a pair end 30 mm from the middle by the rules.
const OWN_SIDE: i32 = 3;
/// Shortest run of a solid line: longer than a dash of 200 mm with the blur of the farthest rows (cells).
const SOLID: usize = 32;
/// Lengths of the gaps of a dashed line: 200 mm by the rules, less or more by that blur (cells). Longer ones
/// may be of any line.
const OPEN: std::ops::Range<usize> = 12..27;
/// Longest gap of worn paint in a run (cells).
const WORN: usize = 4;
/// Distances ahead of the camera between which the line is examined (m): where a car that begins to change
/// lanes crosses it.
const WINDOW: (f64, f64) = (0.30, 1.15);

/// Whether the line on the own side of the centre marking is dashed, before a distance ahead (m), behind
/// which something hides it. `None` if too little of it is in view.
pub(super) fn is_dashed(view: &RoadView, road: &RoadAhead, hidden: f64) -> Option<bool> {
    let side = road.middle.signum();
    let cells = || (0..=OWN_SIDE).map(|out| column(side * CELL * f64::from(out)));
    let is_line = |row: usize| cells().any(|cell| view.brightness(row, cell) > BRIGHT);
    let (from, to) = (view.from() + WINDOW.0, (view.from() + WINDOW.1).min(hidden));
    let in_view = |row: &usize| cells().all(|cell| view.sees(*row, cell));
    // Lengths of the run of the line, and of the gap behind it.
    let (mut solid, mut open, mut is_open) = (0, 0, false);
    for row in (view.row(from)..=view.row(to)).filter(in_view) {
        if !is_line(row) {
            open += 1;
            continue;
        }
        is_open |= solid > 0 && OPEN.contains(&open);
        // A run goes on behind worn paint.
        solid = if open <= WORN { solid + open + 1 } else { 1 };
        open = 0;
        if solid >= SOLID {
            return Some(false);
        }
    }
    is_open.then_some(true)
}
