//! Parking areas beside the road.

use super::element::{Detection, RoadElementKind};
use super::view::{ROWS, RoadView, column};
use crate::vision::lane_markings::RoadAhead;

/// Distance from the edge line to the outer line of parallel spots on the right, and of perpendicular ones on
/// the left, by the rules (m).
const DEPTHS: [(f64, f64); 2] = [(-1.0, 0.30), (1.0, 0.50)];
/// Least contrast of the line.
const LINE: f64 = 0.35;
/// Least length of the line (cells).
const LONG: usize = 30;
/// Longest gap in the line (cells).
const GAP: usize = 4;

/// Finds parking areas: where their outer lines begin.
pub(super) fn parking(view: &RoadView, road: &RoadAhead, found: &mut Vec<Detection>) {
    for (side, depth) in DEPTHS {
        let line = column(side * (road.edge + depth));
        let is_line = |row: usize| view.along(row, line).is_some_and(|contrast| contrast > LINE);
        let mut row = 0;
        while row < ROWS {
            if !is_line(row) {
                row += 1;
                continue;
            }
            let (from, mut last) = (row, row);
            while row < ROWS && row <= last + GAP {
                if is_line(row) {
                    last = row;
                }
                row += 1;
            }
            if last - from >= LONG {
                let kind = RoadElementKind::Parking { left: side > 0.0 };
                found.push(Detection::new(kind, view.ahead(from)));
            }
        }
    }
}
