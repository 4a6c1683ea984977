//! Lines across a lane, and crosswalks.

use std::f64::consts::TAU;

use super::element::{Detection, RoadElementKind};
use super::view::{COLUMNS, ROWS, RoadView, columns, left};
use crate::geometry::math;
use crate::vision::lane_markings::RoadAhead;

/// Width of stop and give-way lines, by the rules (m).
const BROAD: f64 = 0.038;
/// Period across the road of the dashes of give-way lines, by the rules (m).
const GIVE_WAY: f64 = 0.140;
/// Period across the road of the stripes of crosswalks, by the rules (m).
const STRIPES: f64 = 0.078;
/// The same of the chequers of a start line, which is about 50 mm long (m).
const CHEQUERS: f64 = 0.050;
/// Length of a crosswalk's stripes, by the rules (m).
const ZEBRA: f64 = 0.40;
/// Distance from a lane's lines to what is examined (m): the lines' own width and the error of the lane.
const MARGIN: f64 = 0.035;
/// Share of a lane that has to be in view.
const VISIBLE: f64 = 0.7;
/// Least mean contrast of a stop line, half of which may be worn or blurred.
const SOLID: f64 = 0.55;
/// Least mean contrast of a give-way line, of which four sevenths are painted.
const DASHED: f64 = 0.22;
/// Least mean contrast of a line across the other lane.
const OTHER: f64 = 0.20;
/// Least amplitude at the period of dashes as a share of the mean. That of dashes is 0.54 and of worn ones
/// about 0.5, that of the digits of a number 0.31, and that of a solid line across a lane at most 0.15.
const PERIODIC: f64 = 0.45;
/// Least amplitude of a row of a crosswalk. That of fresh paint is 0.32.
const STRIPED: f64 = 0.13;
/// Rows before a crosswalk from which its edge is seen: 40 mm, as stripes are blurred.
const BEFORE: usize = 4;
/// Least amplitude of a row of chequers. That of fresh paint is 0.32.
const CHEQUERED: f64 = 0.12;

/// A wave across the road, sampled at each column.
#[derive(Debug, Clone)]
struct Tone(Vec<(f64, f64)>);

impl Tone {
    fn new(period: f64) -> Self {
        Self((0..COLUMNS).map(|column| math::sin_cos(TAU * left(column) / period)).collect())
    }
}

/// The periods of markings across the road.
#[derive(Debug, Clone)]
pub(super) struct Tones {
    give_way: Tone,
    stripes: Tone,
    chequers: Tone,
}

impl Tones {
    pub(super) fn new() -> Self {
        Self { give_way: Tone::new(GIVE_WAY), stripes: Tone::new(STRIPES), chequers: Tone::new(CHEQUERS) }
    }
}

/// Mean of a signal across a lane, and its amplitude at a period.
#[derive(Debug, Clone, Copy, Default)]
struct Spectrum {
    mean: f64,
    amplitude: f64,
    visible: f64,
}

impl Spectrum {
    /// Of a signal between two distances to the left of the road's centre line.
    fn of(range: (f64, f64), tone: &Tone, signal: impl Fn(usize) -> Option<f64>) -> Self {
        let columns = columns(range.0, range.1);
        let all = columns.len() as f64;
        let (mut count, mut sum, mut real, mut imaginary) = (0.0, 0.0, 0.0, 0.0);
        for column in columns {
            let Some(value) = signal(column) else { continue };
            let (sin, cos) = tone.0[column];
            count += 1.0;
            sum += value;
            real += value * cos;
            imaginary += value * sin;
        }
        if count == 0.0 {
            return Self::default();
        }
        Self { mean: sum / count, amplitude: math::hypot(real, imaginary) / count, visible: count / all }
    }
}

/// Inner parts of the left lane and of the right one, in a road with edge lines at a distance from its centre
/// line (m).
fn inner(edge: f64) -> [(f64, f64); 2] {
    let (near, far) = (MARGIN, edge - MARGIN);
    [(near, far), (-far, -near)]
}

/// Inner parts of the own lane and of the other one.
fn lanes(road: &RoadAhead) -> [(f64, f64); 2] {
    let [left, right] = inner(road.edge);
    if road.middle > 0.0 { [left, right] } else { [right, left] }
}

/// Finds lines across the own lane.
pub(super) fn lines(view: &RoadView, tones: &Tones, road: &RoadAhead, found: &mut Vec<Detection>) {
    let [own, other] = lanes(road);
    let spectrum = |row: usize, lane| Spectrum::of(lane, &tones.give_way, view.across(row, BROAD));
    let chequers = |row: usize| brightness(view, row, own, &tones.chequers).amplitude;
    let rows: Vec<Spectrum> = (0..ROWS).map(|row| spectrum(row, own)).collect();
    for row in 1..ROWS - 1 {
        let here = rows[row];
        let is_peak = here.mean > rows[row - 1].mean && here.mean >= rows[row + 1].mean;
        if here.visible < VISIBLE || here.mean < DASHED || !is_peak {
            continue;
        }
        let beyond = spectrum(row, other);
        let is_chequered = [row - 1, row + 1].iter().any(|&row| chequers(row) > CHEQUERED);
        let stripes = || Spectrum::of(own, &tones.stripes, view.across(row, BROAD)).amplitude;
        let kind = if here.amplitude > PERIODIC * here.mean && here.amplitude > stripes() {
            RoadElementKind::GiveWayLine
        } else if is_chequered || (beyond.visible > 0.5 && beyond.mean > OTHER) {
            RoadElementKind::StartLine
        } else if here.mean > SOLID {
            RoadElementKind::StopLine
        } else {
            continue;
        };
        found.push(Detection::new(kind, view.ahead(row) - 0.5 * BROAD));
    }
}

fn brightness(view: &RoadView, row: usize, range: (f64, f64), tone: &Tone) -> Spectrum {
    Spectrum::of(range, tone, |column| view.sees(row, column).then(|| view.brightness(row, column)))
}

/// Finds crosswalks: their near edges.
pub(super) fn zebras(view: &RoadView, tones: &Tones, road: &RoadAhead, found: &mut Vec<Detection>) {
    // Of each lane alone, because over both, stripes that are a little too near to each other would cancel.
    let lanes = lanes(road);
    let striped = |row: usize| {
        let [own, other] = lanes.map(|lane| brightness(view, row, lane, &tones.stripes));
        let visible = own.visible + other.visible;
        let amplitude = own.visible * own.amplitude + other.visible * other.amplitude;
        visible > 1.0 && amplitude > STRIPED * visible
    };
    let mut row = 0;
    while row < ROWS {
        if !striped(row) {
            row += 1;
            continue;
        }
        let from = row;
        while row < ROWS && striped(row) {
            row += 1;
        }
        // Blur lengthens it, and the limits of the view cut it.
        let long = view.ahead(row.min(ROWS - 1)) - view.ahead(from);
        if (0.3 * ZEBRA..1.5 * ZEBRA).contains(&long) && begins_in_view(view, road.edge, from) {
            found.push(Detection::new(RoadElementKind::Zebra, view.ahead(from)));
        }
    }
}

/// Whether a crosswalk that begins at a row is found there: more than half of both lanes is in view just
/// before it. Where less is, the end of the view looks like its edge.
pub(super) fn begins_in_view(view: &RoadView, edge: f64, row: usize) -> bool {
    let before = row.saturating_sub(BEFORE);
    let inner = inner(edge).map(|(from, to)| columns(from, to));
    let all: usize = inner.iter().map(ExactSizeIterator::len).sum();
    let seen = inner.into_iter().flatten().filter(|&column| view.sees(before, column)).count();
    row >= BEFORE && 2 * seen > all
}
