//! Crossings: edge lines that end where a line leaves the road.

use std::ops::Range;

use super::element::{Detection, RoadElementKind};
use super::view::{CELL, ROWS, RoadView, column, columns, left};
use crate::geometry::math;
use crate::vision::lane_markings::RoadAhead;

/// Width of the line of an arm (m).
const LINE: f64 = 0.02;
/// Strip beside the road where the line of an arm is looked for: least distance from the edge line, and width
/// (m).
const STRIP: (f64, f64) = (0.04, 0.15);
/// Number of angles between road and arm that are tried to each side of the right angle. A line that looks
/// clearest at the last one is more slanted than the lines of arms.
const SLOPES: i32 = 8;
/// Difference of their cotangents: the others together reach from 70 to 110 degrees, by the rules.
const SLOPE: f64 = 0.058;
/// Least mean contrast of an arm's line, relative to what the pixels leave of a line of its width.
const LEAVES: f64 = 0.33;
/// Least mean contrast of an edge line.
const EDGE: f64 = 0.35;
/// Centre of a bright line beside that of an edge line (cells): halfway to that of a stop line, 29 mm.
const OUTER: f64 = 1.5;
/// Length before and behind a crossing's middle without edge line (m): lanes are at least 350 mm wide.
const OPEN: f64 = 0.30;
/// Most of this length on which an edge line may seem to be, on the half where cars leave the road and on the
/// other one. There they stop, and a stop line that is not parallel to the road meets its edge.
const MOST: [f64; 2] = [0.25, 0.75];
/// Least part of the half where cars leave the road in view (m).
const VISIBLE: f64 = 0.12;
/// Length of edge line that has to precede (m).
const BEFORE: f64 = 0.20;

/// Contrast of a line across the road at each cell beside it on one side, where the lines of arms leave.
struct Strip {
    columns: Range<usize>,
    contrast: Vec<Option<f64>>,
}

impl Strip {
    fn new(view: &RoadView, edge: f64, side: f64) -> Self {
        let far = begin(edge, SLOPE * f64::from(SLOPES)) + STRIP.1;
        let (a, b) = (side * edge, side * far);
        let columns = columns(a.min(b), a.max(b));
        let mut contrast = Vec::with_capacity(ROWS * columns.len());
        for row in 0..ROWS {
            // A pixel that is longer than the line is wide is darker.
            let share = (LINE / view.length(row)).min(1.0);
            let across = view.across(row, LINE);
            contrast.extend(columns.clone().map(|column| across(column).map(|it| it / share)));
        }
        Self { columns, contrast }
    }

    /// Whether a line may leave at each row: some cell within reach of the slopes is bright enough. On a free
    /// road there is none, and nothing else is to be examined.
    fn may_leave(&self) -> Vec<bool> {
        let reach = (SLOPE * f64::from(SLOPES) * self.columns.len() as f64).ceil() as usize;
        let is_bright = |cell: &Option<f64>| cell.is_some_and(|contrast| contrast >= LEAVES);
        let bright: Vec<bool> =
            self.contrast.chunks(self.columns.len()).map(|row| row.iter().any(is_bright)).collect();
        let near = |row: usize| row.saturating_sub(reach)..(row + reach + 1).min(ROWS);
        (0..ROWS).map(|row| bright[near(row)].contains(&true)).collect()
    }

    fn at(&self, row: usize, column: usize) -> Option<f64> {
        self.contrast[row * self.columns.len() + column - self.columns.start]
    }
}

/// Distance from the road's centre line at which the line of an arm begins: where the arm is as far from the
/// crossing's middle as the edge line (m).
fn begin(edge: f64, slope: f64) -> f64 {
    let cosine = slope / math::hypot(1.0, slope);
    edge + STRIP.0.max(edge * cosine + 0.02)
}

/// Finds the middle of the nearest crossing on one side of the road: 1 to the left, -1 to the right. Returns
/// the angle from the direction of the road to that of its arm (rad).
pub(super) fn on_side(
    view: &RoadView,
    road: &RoadAhead,
    side: f64,
    found: &mut Vec<Detection>,
) -> Option<f64> {
    let strip = Strip::new(view, road.edge, side);
    let may_leave = strip.may_leave();
    let leaves = |row: usize| if may_leave[row] { leaving(&strip, road.edge, side, row) } else { (0.0, 0.0) };
    let best: Vec<(f64, f64)> = (0..ROWS).map(leaves).collect();
    for row in 2..ROWS - 2 {
        let (contrast, slope) = best[row];
        let is_peak = (row - 2..=row + 2).all(|other| best[other].0 <= contrast);
        let is_slanted = slope.abs() > SLOPE * (f64::from(SLOPES) - 0.5);
        if contrast < LEAVES || !is_peak || is_slanted {
            continue;
        }
        // Half the angle between the road and the arm: the near line meets the edge so far before the middle.
        let angle = math::atan2(1.0, slope);
        let middle = view.ahead(row) + road.edge * math::tan(0.5 * angle);
        if is_open(view, road, side, middle) && has_edge_before(view, road.edge, side, middle) {
            let kind = RoadElementKind::Crossing { left: side > 0.0, right: side < 0.0 };
            found.push(Detection::new(kind, middle));
            // Next come the arm's other lines.
            return Some(angle);
        }
    }
    None
}

/// Contrast of the clearest line that leaves the road from its edge at a row, and its slope: distance along
/// the road per distance from the edge.
fn leaving(strip: &Strip, edge: f64, side: f64, row: usize) -> (f64, f64) {
    let mut best = (0.0, 0.0);
    for step in -SLOPES..=SLOPES {
        let slope = SLOPE * f64::from(step);
        let from = begin(edge, slope);
        let (a, b) = (side * from, side * (from + STRIP.1));
        let columns = columns(a.min(b), a.max(b));
        let (mut count, mut sum) = (0, 0.0);
        for column in columns.clone() {
            let out = (side * left(column) - edge) / CELL;
            let at = row as f64 + slope * out;
            if at < 0.0 || at >= ROWS as f64 {
                continue;
            }
            if let Some(contrast) = strip.at(at as usize, column) {
                count += 1;
                sum += contrast;
            }
        }
        let mean = sum / f64::from(count.max(1));
        if 4 * count as usize >= 3 * columns.len() && mean > best.0 {
            best = (mean, slope);
        }
    }
    best
}

/// Share of rows with an edge line between two distances ahead, and the number of rows in view.
fn edge_line(view: &RoadView, edge: f64, side: f64, (from, to): (f64, f64)) -> (f64, usize) {
    let (mut seen, mut present) = (0, 0);
    for row in view.row(from)..=view.row(to) {
        if let Some(is_present) = is_edge(view, edge, side, row) {
            seen += 1;
            present += usize::from(is_present);
        }
    }
    (present as f64 / seen.max(1) as f64, seen)
}

/// Whether there is an edge line at a row, rather than a line at which the traffic of an arm stops: that is
/// next to where the edge line would be, on the outer side. `None` out of view.
fn is_edge(view: &RoadView, edge: f64, side: f64, row: usize) -> Option<bool> {
    let cell = |out: i32| column(side * (edge + CELL * f64::from(out)));
    let cells = -4..=7;
    if !view.sees(row, cell(*cells.start())) || !view.sees(row, cell(*cells.end())) {
        return None;
    }
    let bright = |out: i32| view.brightness(row, cell(out));
    let darkest = cells.clone().map(bright).fold(1.0, f64::min);
    let brightest = cells.clone().map(bright).fold(0.0, f64::max);
    let half = 0.5 * (darkest + brightest);
    let (mut weight, mut moment) = (0.0, 0.0);
    for out in cells {
        let above = (bright(out) - half).max(0.0);
        weight += above;
        moment += above * f64::from(out);
    }
    Some(brightest - darkest > EDGE && moment / weight < OUTER)
}

/// Whether there is no edge line beside a crossing's middle.
fn is_open(view: &RoadView, road: &RoadAhead, side: f64, middle: f64) -> bool {
    let halves = [(middle - OPEN, middle), (middle, middle + OPEN)];
    let [near, far] = halves.map(|half| edge_line(view, road.edge, side, half));
    // Traffic that keeps to the right leaves the road to the right before the middle.
    let [leaves, stops] = if side == road.middle.signum() { [near, far] } else { [far, near] };
    leaves.1 as f64 * CELL >= VISIBLE && leaves.0 <= MOST[0] && stops.0 <= MOST[1]
}

/// Whether there is an edge line before a crossing. Without it, a line that leaves the road may be the arm's
/// second one.
fn has_edge_before(view: &RoadView, edge: f64, side: f64, middle: f64) -> bool {
    let end = middle - edge - 0.10;
    let (present, seen) = edge_line(view, edge, side, (end - BEFORE, end));
    seen as f64 * CELL >= 0.5 * BEFORE && present > 0.4
}
