//! Barred areas: slanted stripes beside the edge line of the own lane.

use super::element::{Detection, RoadElementKind};
use super::view::{CELL, ROWS, RoadView, column, columns};
use crate::vision::lane_markings::RoadAhead;

/// Strip inside the edge line that every barred area covers, as it is at least 150 mm wide by the rules (m).
const STRIP: (f64, f64) = (0.035, 0.125);
/// Length of a window: about a period of the stripes, 150 mm along the edge by the rules (cells).
const WINDOW: usize = 15;
/// Least brightness of paint, between floor and paint.
const BRIGHT: f64 = 0.45;
/// Largest brightness of the floor between stripes, between floor and paint: their gaps are 30 mm wide, and a
/// metre ahead a third as bright as paint.
const DARK: f64 = 0.38;
/// Least share of bright cells in a window: stripes cover 56 % of it.
const STRIPED: f64 = 0.25;
/// Least share of dark cells in a window, between stripes.
const BETWEEN: f64 = 0.12;
/// Largest share of bright cells in the other lane: crosswalks have stripes there as well.
const OTHER: f64 = 0.10;
/// Shortest run of such rows (cells): more than a line across the lane, or the end of a box.
const LONG: usize = 25;
/// Longest run of bright cells along the road in the strip: a stripe is 84 mm long there, and blurred. Boxes
/// and patches of light are longer.
const STRIPE: usize = 14;
/// Largest length of ground that a pixel covers along the road (cells) where stripes are told apart: half of
/// the gap between them, 66 mm along the edge.
const RESOLVED: f64 = 3.3;
/// Share of bright cells along the road below which a column is no part of an area.
const EMPTY: f64 = 0.12;
/// Number of such columns that end an area.
const EMPTY_COLUMNS: usize = 3;

/// Bright and dark cells of a row in a strip, and all that are in view.
#[derive(Debug, Clone, Copy, Default)]
struct Count {
    bright: usize,
    dark: usize,
    all: usize,
}

impl Count {
    fn of(view: &RoadView, row: usize, strip: (f64, f64)) -> Self {
        let mut count = Self::default();
        for column in columns(strip.0.min(strip.1), strip.0.max(strip.1)) {
            if view.sees(row, column) {
                let brightness = view.brightness(row, column);
                count.bright += usize::from(brightness > BRIGHT);
                count.dark += usize::from(brightness < DARK);
                count.all += 1;
            }
        }
        count
    }

    fn sum(counts: &[Self]) -> Self {
        counts.iter().fold(Self::default(), |sum, it| Self {
            bright: sum.bright + it.bright,
            dark: sum.dark + it.dark,
            all: sum.all + it.all,
        })
    }

    fn share(of: usize, all: usize) -> f64 {
        of as f64 / all.max(1) as f64
    }
}

/// Whether something is a box in the other lane.
pub(super) fn is_in_other_lane(road: &RoadAhead, kind: RoadElementKind) -> bool {
    matches!(kind, RoadElementKind::Obstacle { right, left }
        if road.middle * (0.5 * (right + left) + road.middle) < 0.0)
}

/// Finds the barred area in the own lane: where it begins, how long it is, and how far it reaches to the
/// left. A box in the other lane is as bright as a crosswalk, whose stripes are in both lanes.
pub(super) fn barred(view: &RoadView, road: &RoadAhead, has_box: bool, found: &mut Vec<Detection>) {
    // The edge of the own lane is on the side of its centre.
    let side = road.middle.signum();
    let strip = |side: f64| (side * (road.edge - STRIP.0), side * (road.edge - STRIP.1));
    let counts =
        |side: f64| -> Vec<Count> { (0..ROWS).map(|row| Count::of(view, row, strip(side))).collect() };
    let (own, other) = (counts(side), counts(-side));
    let is_barred = |row: usize| {
        let from = row.saturating_sub(WINDOW / 2);
        let window = from..(from + WINDOW).min(ROWS);
        let (own, other) = (Count::sum(&own[window.clone()]), Count::sum(&other[window]));
        Count::share(own.bright, own.all) > STRIPED
            && Count::share(own.dark, own.all) > BETWEEN
            && (has_box || Count::share(other.bright, other.all) < OTHER)
    };
    let resolved = (0..ROWS).take_while(|&row| view.depth(row) <= RESOLVED).count();
    let mut row = 0;
    while row < ROWS {
        if !is_barred(row) {
            row += 1;
            continue;
        }
        let from = row;
        while row < ROWS && is_barred(row) {
            row += 1;
        }
        let clear = from..row.min(resolved);
        if clear.len() >= LONG && longest(view, strip(side), clear) <= STRIPE {
            let inner = inner_side(view, road, side, from..row);
            let (right, left) = (inner.min(side * road.edge), inner.max(side * road.edge));
            let kind = RoadElementKind::Barred {
                right: right - road.middle,
                left: left - road.middle,
                length: CELL * (row - from) as f64,
            };
            found.push(Detection::new(kind, view.ahead(from)));
            return;
        }
    }
}

/// Longest run of bright cells along the road in a strip between rows.
fn longest(view: &RoadView, strip: (f64, f64), rows: std::ops::Range<usize>) -> usize {
    let run_in = |column: usize| {
        let mut run = 0;
        let lengths = rows.clone().map(|row| {
            run = if view.brightness(row, column) > BRIGHT { run + 1 } else { 0 };
            run
        });
        lengths.max().unwrap_or(0)
    };
    columns(strip.0.min(strip.1), strip.0.max(strip.1)).map(run_in).max().unwrap_or(0)
}

/// Inner side of an area between rows, to the left of the road's centre line (m).
fn inner_side(view: &RoadView, road: &RoadAhead, side: f64, rows: std::ops::Range<usize>) -> f64 {
    let is_empty = |left: f64| {
        let column = column(left);
        let cells = rows.clone().filter(|&row| view.sees(row, column));
        let (bright, all) = cells.fold((0, 0), |(bright, all), row| {
            (bright + usize::from(view.brightness(row, column) > BRIGHT), all + 1)
        });
        Count::share(bright, all) < EMPTY
    };
    let place = |cells: usize| side * (road.edge - STRIP.1 - CELL * cells as f64);
    let most = ((2.0 * road.edge - STRIP.1) / CELL) as usize;
    let end = (0..most).find(|&cells| (cells..cells + EMPTY_COLUMNS).all(|cells| is_empty(place(cells))));
    place(end.unwrap_or(most))
}
