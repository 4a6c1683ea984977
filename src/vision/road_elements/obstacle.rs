//! White boxes on the road, by their feet.

use std::ops::Range;

use super::element::{Detection, RoadElementKind};
use super::view::{CELL, COLUMNS, ROWS, RoadView, columns, left};
use crate::vision::lane_markings::RoadAhead;

/// Least brightness of a box between floor and paint; the side that no light meets is at about half.
const WHITE: f64 = 0.30;
/// Least step of brightness at its foot.
const STEP: f64 = 0.30;
/// Largest brightness beside it, relative to its own, and the distance within which it is that dark (cells):
/// a patch of light fades by a third at most in its middle, and on its fringe in half of that distance.
const DIMMER: f64 = 0.6;
const BESIDE: isize = 6;
const SHARP: isize = 3;
/// Least brightness of a column of a box's front, relative to the brightest one: between the strokes of
/// numbers on the road, blurred by distance, it is half as bright or less.
const EVEN: f64 = 0.6;
/// Length of ground that the front of the lowest box covers (cells), as it stands in the way of the ground
/// behind it.
const TALL: usize = 14;
/// Least width (m). By the rules it is 100 mm; paint is at most 60 mm wide.
const WIDE: f64 = 0.075;
/// The same on the road (m), where numbers stand: from afar, they are blurred.
const WIDE_ON_ROAD: f64 = 0.085;
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
            && is_even(view, &feet, front.clone())
            && ends_there(view, &feet, front.start, -1)
            && ends_there(view, &feet, front.end - 1, 1)
        {
            let near = front.clone().filter_map(|column| feet[column]).min().unwrap_or(0);
            let is_on_road = left(front.start) < road.edge && left(front.end - 1) > -road.edge;
            let is_wide = front.len() as f64 * CELL >= WIDE_ON_ROAD;
            if !(is_on_road && is_wide || waiting(view.ahead(near))) {
                continue;
            }
            let own = |column: usize| left(column) - road.middle;
            let kind = RoadElementKind::Obstacle { right: own(front.start), left: own(front.end - 1) };
            let sees = |column: usize| column < COLUMNS && view.sees(near, column);
            let is_whole = front.start.checked_sub(1).is_some_and(sees) && sees(front.end);
            found.push(Detection { kind, ahead: view.ahead(near), is_whole });
        }
    }
}

/// Whether there is a surface that is wider and deeper than any paint and ends sharply, between two distances
/// ahead (m), within distances to the right and to the left of the road's centre line (m). It also covers the
/// ground behind paint of a length (m), along the camera's rays: it rises from the ground.
pub(super) fn is_occupied(
    view: &RoadView,
    [right, left]: [f64; 2],
    (from, to): (f64, f64),
    paint: f64,
) -> bool {
    let wide = (WIDE / CELL).ceil() as usize;
    let road = columns(-right, left);
    let long = (paint / CELL).round() as usize;
    let is_bright =
        |row: usize, column: usize| view.sees(row, column) && view.brightness(row, column) >= WHITE;
    let rises = |row: usize, column: usize| {
        (row..(row + long).min(ROWS)).all(|other| is_bright(other, view.on_ray(row, column, other)))
    };
    let mut deep = vec![0; COLUMNS];
    let (first, last) = (view.row(from), view.row(to));
    (first..ROWS).any(|row| {
        // Column where the surface begins, which may be further to the right than what is asked about.
        let mut start = 0;
        let least = deep_at(view, row);
        for (column, deep) in deep.iter_mut().enumerate().take(road.end) {
            *deep = if is_bright(row, column) { *deep + 1 } else { 0 };
            let is_deep = *deep >= least && row + 1 - *deep <= last;
            if !is_deep {
                start = column + 1;
            }
            let run = (column + 1).saturating_sub(start.max(road.start));
            if run >= wide
                && dims_beyond(view, row, start, -1)
                && dims_beyond(view, row, column, 1)
                && rises(row, column - run / 2)
            {
                return true;
            }
        }
        false
    })
}

/// Rows that only a box covers as far as a row (cells): a pixel blurs a line before and behind it.
fn deep_at(view: &RoadView, row: usize) -> usize {
    DEEP + (2.0 * view.depth(row)) as usize
}

/// Whether the surface around a column ends sharply to one side. Its outermost columns are not as deep as a
/// box, because the camera sees a box that stands aside at a slant.
fn dims_beyond(view: &RoadView, row: usize, column: usize, out: isize) -> bool {
    let is_bright = |&column: &usize| view.sees(row, column) && view.brightness(row, column) >= WHITE;
    let next = |column: &usize| column.checked_add_signed(out).filter(|&next| next < COLUMNS);
    let last = std::iter::successors(Some(column), next).take_while(is_bright).last().unwrap_or(column);
    dims(view, row, last, out, SHARP)
}

/// Columns of the nearest front in a run of columns that is wide enough for a box. Narrower ones are paint, a
/// dash of the centre line for instance, above which the box behind it appears.
fn front(feet: &[Option<usize>], columns: Range<usize>) -> Option<Range<usize>> {
    let mut rest = vec![columns];
    loop {
        let nearest = |it: &Range<usize>| feet[it.clone()].iter().flatten().min().copied().unwrap_or(ROWS);
        let (index, _) = rest.iter().enumerate().min_by_key(|(_, it)| nearest(it))?;
        let columns = rest.swap_remove(index);
        let front = nearest_front(feet, columns.clone())?;
        if front.len() as f64 * CELL >= WIDE {
            return Some(front);
        }
        rest.extend(
            [columns.start..front.start, front.end..columns.end].into_iter().filter(|it| !it.is_empty()),
        );
    }
}

/// Columns whose feet are about as near as the nearest one. The others belong to a box's sides, and to what
/// it hides.
fn nearest_front(feet: &[Option<usize>], columns: Range<usize>) -> Option<Range<usize>> {
    let (nearest, near) =
        columns.clone().filter_map(|column| Some((column, feet[column]?))).min_by_key(|&(_, foot)| foot)?;
    let is_front = |&column: &usize| feet[column].is_some_and(|foot| foot <= near + ASKEW);
    let end = (nearest..columns.end).take_while(is_front).last()? + 1;
    let start = (columns.start..=nearest).rev().take_while(is_front).last()?;
    Some(start..end)
}

/// Whether a front is about as bright everywhere, as one surface is; its outermost columns may be half
/// covered.
fn is_even(view: &RoadView, feet: &[Option<usize>], front: Range<usize>) -> bool {
    let inner = front.start + 1..front.end - 1;
    let bright = inner.filter_map(|column| {
        let foot = feet[column]?;
        Some(view.mean_brightness(foot + 1..foot + TALL, column))
    });
    let (least, most) =
        bright.fold((f64::INFINITY, 0.0), |(least, most), it| (f64::min(least, it), f64::max(most, it)));
    least >= EVEN * most
}

/// Nearest row of a column where a bright surface begins.
fn foot(view: &RoadView, column: usize) -> Option<usize> {
    (0..ROWS - TALL).find(|&row| {
        let blur = view.blur(row);
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
    feet[column].is_some_and(|foot| dims(view, (foot + 1).min(ROWS - 1), column, out, BESIDE))
}

/// Whether a row is much darker beside a column within some cells. Out of view, it cannot be told.
fn dims(view: &RoadView, row: usize, column: usize, out: isize, within: isize) -> bool {
    let inside = view.brightness(row, column);
    (1..=within).any(|step| {
        let beyond = column.checked_add_signed(out * step).filter(|&beyond| beyond < COLUMNS);
        beyond.is_none_or(|beyond| !view.sees(row, beyond) || view.brightness(row, beyond) <= DIMMER * inside)
    })
}
