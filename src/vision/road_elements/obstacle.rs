//! White boxes on the road, by their feet.

use std::ops::Range;

use super::element::{Detection, RoadElementKind};
use super::view::{CELL, COLUMNS, ROWS, RoadView, columns, left};
use crate::vision::lane_markings::RoadAhead;

/// Least brightness of a box between floor and paint; the side that no light meets is at about half.
const WHITE: f64 = 0.30;
/// Least step of brightness at its foot.
const STEP: f64 = 0.30;
/// Largest brightness beside it within 60 mm, relative to its own; a patch of light fades by a third at most.
const DIMMER: f64 = 0.6;
/// Length of ground that the front of the lowest box covers (cells), as it stands in the way of the ground
/// behind it.
const TALL: usize = 14;
/// Least width (m). By the rules it is 100 mm; paint is at most 60 mm wide.
const WIDE: f64 = 0.075;
/// Rows that a box covers at least (cells); lines across the road cover four.
const DEEP: usize = 9;
/// Largest distance along the road between the feet of a box's front (cells): it may stand askew.
const ASKEW: usize = 8;

/// Finds boxes on the road, and beside it where pedestrians wait: their feet and their sides.
pub(super) fn boxes(
    view: &RoadView,
    road: &RoadAhead,
    waiting: impl Fn(f64) -> bool,
    found: &mut Vec<Detection>,
) {
    let feet: Vec<Option<usize>> = (0..COLUMNS).map(|column| foot(view, column)).collect();
    let mut column = 0;
    while column < COLUMNS {
        if feet[column].is_none() {
            column += 1;
            continue;
        }
        let from = column;
        while column < COLUMNS && feet[column].is_some() {
            column += 1;
        }
        if let Some(front) = front(&feet, from..column)
            && ends_there(view, &feet, front.start, -1)
            && ends_there(view, &feet, front.end - 1, 1)
        {
            let near = front.clone().filter_map(|column| feet[column]).min().unwrap_or(0);
            let is_on_road = left(front.start) < road.edge && left(front.end - 1) > -road.edge;
            if !is_on_road && !waiting(view.ahead(near)) {
                continue;
            }
            let own = |column: usize| left(column) - road.middle;
            let kind = RoadElementKind::Obstacle { right: own(front.start), left: own(front.end - 1) };
            found.push(Detection { kind, ahead: view.ahead(near) });
        }
    }
}

/// Whether there is a surface on the road that is wider than any paint, between two distances ahead (m).
pub(super) fn is_occupied(view: &RoadView, edge: f64, (from, to): (f64, f64)) -> bool {
    let wide = (WIDE / CELL).ceil() as usize;
    let is_wide = |&row: &usize| {
        let mut run = 0;
        columns(-edge + 0.02, edge - 0.02).any(|column| {
            let is_bright = view.sees(row, column) && view.brightness(row, column) >= WHITE;
            run = if is_bright { run + 1 } else { 0 };
            run >= wide
        })
    };
    (view.row(from)..=view.row(to)).filter(is_wide).count() >= DEEP
}

/// Columns of a box's front: those whose feet are about as near as the nearest one. The others belong to its
/// sides, and to what the box hides.
fn front(feet: &[Option<usize>], columns: Range<usize>) -> Option<Range<usize>> {
    let (nearest, near) =
        columns.clone().filter_map(|column| Some((column, feet[column]?))).min_by_key(|&(_, foot)| foot)?;
    let is_front = |&column: &usize| feet[column].is_some_and(|foot| foot <= near + ASKEW);
    let end = (nearest..columns.end).take_while(is_front).last()? + 1;
    let start = (columns.start..=nearest).rev().take_while(is_front).last()?;
    ((end - start) as f64 * CELL >= WIDE).then_some(start..end)
}

/// Nearest row of a column where a bright surface begins.
fn foot(view: &RoadView, column: usize) -> Option<usize> {
    (0..ROWS - TALL).find(|&row| {
        let blur = (view.depth(row) / CELL).ceil() as usize;
        let before = row.saturating_sub(blur + 3);
        if row < blur + 3 || !view.sees(before, column) || !view.sees(row + TALL - 1, column) {
            return false;
        }
        let step =
            view.mean_brightness(row..row + 2, column) - view.mean_brightness(before..before + 3, column);
        step >= STEP && (row..row + TALL).all(|row| view.brightness(row, column) >= WHITE)
    })
}

/// Whether a surface ends sharply beside a column, as no patch of light does.
fn ends_there(view: &RoadView, feet: &[Option<usize>], column: usize, out: isize) -> bool {
    let Some(row) = feet[column].map(|foot| (foot + 1).min(ROWS - 1)) else { return false };
    let inside = view.brightness(row, column);
    let beyond = (1..=6).filter_map(|step| column.checked_add_signed(out * step));
    // Out of view, it cannot be told.
    beyond
        .take_while(|&beyond| beyond < COLUMNS)
        .any(|beyond| !view.sees(row, beyond) || view.brightness(row, beyond) <= DIMMER * inside)
}
