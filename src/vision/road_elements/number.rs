//! Numbers of speed limits on the own lane, those that are struck out, and turn arrows.

use super::element::{Detection, RoadElementKind};
use super::view::{CELL, COLUMNS, ROWS, RoadView, column};
use crate::geometry::Vector;
use crate::vision::lane_markings::RoadAhead;

/// Height of a digit, by the rules' drawing (cells).
const HIGH: f64 = 40.0;
/// Half the width of a digit, by the rules' drawing (cells).
const HALF: f64 = 3.0;
/// Distance of a digit's middle from that of the number, by the rules' drawing (cells).
const ASIDE: f64 = 4.5;
/// Width of a digit's strokes (cells).
const WIDE: f64 = 1.5;
/// Strokes of the digits: top, upper right, lower right, bottom, lower left, upper left, middle, from the
/// lowest bit upwards.
const DIGITS: [u8; 10] = [0x3f, 0x06, 0x5b, 0x4f, 0x66, 0x6d, 0x7d, 0x07, 0x7f, 0x6f];
/// The line that strikes a number out, by the rules' drawing: how far it begins before the digits, its
/// distance from the lane's middle at both ends, and its width (cells).
const STRIKE: (usize, f64, f64) = (5, 10.0, 2.0);
/// A turn arrow, by the rules' drawing: length and width of its shaft, and reach of its branch to the side
/// (cells). The branch leaves the shaft half its width before its end.
const ARROW: (f64, f64, f64) = (35.0, 3.5, 11.2);
/// Rows of a pattern, from where the line that strikes it out begins to where that ends.
const LONG: usize = 50;
/// Columns of a pattern to each side of its middle.
const SIDE: usize = 12;
/// Columns of a pattern.
const ACROSS: usize = 2 * SIDE + 1;
/// Half the width of a strip that is free before a number (cells).
const STRIP: usize = 8;
/// Length of what is free there (cells).
const FREE: usize = 6;
/// Brightness, between floor and paint, of what is not free.
const BRIGHT: f64 = 0.5;
/// Error of the lane's middle and of a number's begin that is searched (cells).
const SEARCH: usize = 4;
/// Errors of distances along the road that are searched: the camera pitches.
const STRETCHES: [f64; 3] = [0.95, 1.0, 1.05];
/// Least correlation of a number with its pattern; the right one has 0.9 and more.
const LIKE: f32 = 0.75;
/// Least lead of a number over each other one, of at most a half.
const CLEAR: f32 = 0.12;

/// The patterns of all numbers.
#[derive(Debug, Clone)]
pub(super) struct Numbers {
    patterns: Vec<Pattern>,
    arrows: [Pattern; 2],
}

/// The share of each cell that is painted, row by row away from the camera.
#[derive(Debug, Clone)]
struct Pattern {
    kind: RoadElementKind,
    cells: Vec<f32>,
}

impl Numbers {
    /// The numbers of the rules, in steps of ten, with and without the line that strikes them out.
    pub(super) fn new() -> Self {
        let plain = (1..10).map(|tens| Pattern::drawn(RoadElementKind::SpeedLimit(10 * tens), tens, false));
        let struck = (1..10).map(|tens| Pattern::drawn(RoadElementKind::SpeedLimitEnd, tens, true));
        let arrows = [true, false].map(Pattern::arrow);
        Self { patterns: plain.chain(struck).collect(), arrows }
    }

    /// Finds the nearest number or turn arrow on the own lane.
    pub(super) fn find(&self, view: &RoadView, road: &RoadAhead) -> Option<Detection> {
        let middle = column(road.middle);
        if middle < STRIP || middle + STRIP >= COLUMNS {
            return None;
        }
        let begin = begin(view, middle)?;
        let patches = STRETCHES.map(|stretch| Patch::cut(view, road, begin, stretch));
        let blur = view.depth(begin);
        let read = self.read(patches.iter().flatten(), blur);
        let (kind, row) = read.or_else(|| self.read_arrow(&patches.iter().flatten(), blur))?;
        // The line that strikes a number out begins before it.
        let struck = if kind == RoadElementKind::SpeedLimitEnd { STRIKE.0 } else { 0 };
        Some(Detection::new(kind, view.ahead(begin + row) - CELL * (SEARCH + struck) as f64))
    }

    /// The number in one of some patches that are blurred along the road, and the row where its pattern
    /// begins.
    fn read<'a>(
        &self,
        patches: impl Iterator<Item = &'a Patch>,
        blur: f64,
    ) -> Option<(RoadElementKind, usize)> {
        let seen: Vec<Seen> = self.patterns.iter().map(|pattern| pattern.seen(blur)).collect();
        // With all strokes, eighty is somewhat like each number.
        let eighty = seen.get(7)?;
        let likes = patches.map(|patch| (patch.like(eighty, Place::all()), patch));
        let ((_, about), patch) = likes.max_by(|a, b| a.0.0.total_cmp(&b.0.0))?;
        let likes = seen.iter().map(|pattern| (patch.like(pattern, about.near()), pattern));
        let ((like, place), best) = likes.max_by(|a, b| a.0.0.total_cmp(&b.0.0))?;
        let mut others = seen.iter().filter(|other| other.kind != best.kind);
        let is_clear = like > LIKE && others.all(|other| patch.lead(best, other, place) > CLEAR);
        is_clear.then_some((best.kind, place.row))
    }

    /// The turn arrow in one of some patches that are blurred along the road, and the row where its pattern
    /// begins.
    fn read_arrow<'a>(
        &self,
        patches: &(impl Iterator<Item = &'a Patch> + Clone),
        blur: f64,
    ) -> Option<(RoadElementKind, usize)> {
        let [left, right] = [0, 1].map(|index| self.arrows[index].seen(blur));
        let best = |pattern: &Seen| {
            let likes = patches.clone().map(|patch| (patch.like(pattern, Place::all()), patch));
            likes.max_by(|a, b| a.0.0.total_cmp(&b.0.0))
        };
        let (((a, at_left), on_left), ((b, at_right), on_right)) = (best(&left)?, best(&right)?);
        let (like, place, patch, one, other) =
            if a > b { (a, at_left, on_left, &left, &right) } else { (b, at_right, on_right, &right, &left) };
        (like > LIKE && patch.lead(one, other, place) > CLEAR).then_some((one.kind, place.row))
    }
}

/// First row of what stands on the lane, if the lane is free before it.
fn begin(view: &RoadView, middle: usize) -> Option<usize> {
    let strip = middle - STRIP..=middle + STRIP;
    let is_seen = |row: usize| strip.clone().all(|column| view.sees(row, column));
    let is_free = |row: usize| strip.clone().all(|column| view.brightness(row, column) < BRIGHT);
    let begin = (0..ROWS).find(|&row| is_seen(row) && !is_free(row))?;
    (begin >= FREE && (begin - FREE..begin).all(|row| is_seen(row) && is_free(row))).then_some(begin)
}

impl Pattern {
    fn drawn(kind: RoadElementKind, tens: u8, struck: bool) -> Self {
        let mut strokes = digit(tens, ASIDE);
        strokes.extend(digit(0, -ASIDE));
        if struck {
            let (before, aside, wide) = STRIKE;
            let from = -(before as f64);
            strokes.push(Stroke { from: (from, aside), to: (from + LONG as f64, -aside), wide });
        }
        let cells = (0..LONG * ACROSS).map(|at| painted(&strokes, at / ACROSS, at % ACROSS)).collect();
        Self { kind, cells }
    }

    fn arrow(left: bool) -> Self {
        let (long, wide, reach) = ARROW;
        let (bend, side) = (long - 0.5 * wide, if left { reach } else { -reach });
        let shaft = Stroke { from: (0.0, 0.0), to: (long, 0.0), wide };
        let branch = Stroke { from: (bend, 0.0), to: (bend, side), wide };
        let strokes = [shaft, branch];
        let cells = (0..LONG * ACROSS).map(|at| painted(&strokes, at / ACROSS, at % ACROSS)).collect();
        Self { kind: RoadElementKind::TurnArrow { left }, cells }
    }

    /// The pattern as seen by pixels that cover some cells along the road.
    fn seen(&self, blur: f64) -> Seen {
        let half = (0.5 * (blur - 1.0)).round().max(0.0) as usize;
        let long = vec![1.0; 2 * half.min(LONG / 4) + 1];
        // Between the middles of pixels, and between those of cells, brightness is interpolated.
        let between = [0.5, 1.0, 0.5];
        let along = smoothed(&smoothed(&self.cells, ACROSS, &long), ACROSS, &between);
        let mut cells = smoothed(&along, 1, &between);
        let mean = cells.iter().sum::<f32>() / cells.len() as f32;
        for cell in &mut cells {
            *cell -= mean;
        }
        let square = cells.iter().map(|cell| cell * cell).sum();
        Seen { kind: self.kind, cells, square }
    }
}

/// A pattern as it is seen, with mean 0, and the sum of its squares.
struct Seen {
    kind: RoadElementKind,
    cells: Vec<f32>,
    square: f32,
}

/// Sums of cells that are some places apart, by weights.
fn smoothed(cells: &[f32], apart: usize, weights: &[f32]) -> Vec<f32> {
    let mut sums = vec![0.0; cells.len()];
    let half = weights.len() / 2;
    for (k, weight) in weights.iter().enumerate() {
        let (to, from) = ((half.saturating_sub(k)) * apart, (k.saturating_sub(half)) * apart);
        sums[to..].iter_mut().zip(&cells[from..]).for_each(|(sum, cell)| *sum += weight * cell);
    }
    sums
}

/// A straight stroke of paint: its ends, along the road from the begin of the digits and to the left of their
/// middle, and its width (cells).
struct Stroke {
    from: (f64, f64),
    to: (f64, f64),
    wide: f64,
}

/// The strokes of a digit about a place to the left of the number's middle.
fn digit(digit: u8, middle: f64) -> Vec<Stroke> {
    let (left, right) = (middle + HALF, middle - HALF);
    let ends = [
        [(HIGH, left), (HIGH, right)],
        [(HIGH, right), (0.5 * HIGH, right)],
        [(0.5 * HIGH, right), (0.0, right)],
        [(0.0, left), (0.0, right)],
        [(0.5 * HIGH, left), (0.0, left)],
        [(HIGH, left), (0.5 * HIGH, left)],
        [(0.5 * HIGH, left), (0.5 * HIGH, right)],
    ];
    let lit = ends.into_iter().enumerate().filter(|(bit, _)| DIGITS[usize::from(digit)] >> bit & 1 == 1);
    lit.map(|(_, [from, to])| Stroke { from, to, wide: WIDE }).collect()
}

/// Share of a cell of a pattern that strokes cover, by sixteen points.
fn painted(strokes: &[Stroke], row: usize, column: usize) -> f32 {
    let (before, ..) = STRIKE;
    let points = (0..16).map(|i| {
        let inside = |k: usize| (k as f64 + 0.5) / 4.0 - 0.5;
        let along = row as f64 - before as f64 + inside(i / 4);
        (along, column as f64 - SIDE as f64 + inside(i % 4))
    });
    let is_painted = |point: &(f64, f64)| strokes.iter().any(|stroke| stroke.covers(*point));
    points.filter(is_painted).count() as f32 / 16.0
}

impl Stroke {
    fn covers(&self, (x, y): (f64, f64)) -> bool {
        let (dx, dy) = (self.to.0 - self.from.0, self.to.1 - self.from.1);
        let (x, y) = (x - self.from.0, y - self.from.1);
        let length = (dx * dx + dy * dy).sqrt();
        let (along, across) = ((x * dx + y * dy) / length, (x * dy - y * dx) / length);
        (0.0..=length).contains(&along) && across.abs() <= 0.5 * self.wide
    }
}

/// Where a pattern begins in a patch.
#[derive(Debug, Clone, Copy, Default)]
struct Place {
    row: usize,
    column: usize,
}

impl Place {
    fn all() -> impl Iterator<Item = Self> {
        Self { row: SEARCH, column: SEARCH }.within(SEARCH)
    }

    fn near(self) -> impl Iterator<Item = Self> {
        self.within(1)
    }

    fn within(self, most: usize) -> impl Iterator<Item = Self> {
        let range = move |middle: usize| middle.saturating_sub(most)..=(middle + most).min(2 * SEARCH);
        range(self.row).flat_map(move |row| range(self.column).map(move |column| Self { row, column }))
    }
}

/// The part of the road in which a number may be, as flat as it is painted: not bent with the road.
struct Patch {
    cells: Vec<f32>,
}

impl Patch {
    const ROWS: usize = LONG + 2 * SEARCH;
    const COLUMNS: usize = ACROSS + 2 * SEARCH;

    /// Cuts out the patch about a number that begins at a row, with distances along the road that are
    /// stretched by a factor; `None` where the view ends before it.
    fn cut(view: &RoadView, road: &RoadAhead, begin: usize, stretch: f64) -> Option<Self> {
        let (centre, aside) = road.at(view.ahead(begin));
        let (base, along) = (centre + aside * road.middle, Vector::new(aside.y, -aside.x));
        let cell = |row: usize, column: usize| {
            let way = stretch * CELL * (row as f64 - (STRIKE.0 + SEARCH) as f64);
            let left = CELL * (column as f64 - (SIDE + SEARCH) as f64);
            let ahead = view.ahead(begin) + way;
            view.brightness_at(road, base + along * way + aside * left, ahead).map(|it| it as f32)
        };
        let line = |row: usize| (0..Self::COLUMNS).map(move |column| cell(row, column));
        let cells: Option<Vec<f32>> = (0..Self::ROWS).flat_map(line).collect();
        cells.map(|cells| Self { cells })
    }

    /// Largest correlation with a pattern at some places, and the place.
    fn like(&self, pattern: &Seen, places: impl Iterator<Item = Place>) -> (f32, Place) {
        let likes = places.map(|place| (self.correlation(pattern, place), place));
        likes.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or_default()
    }

    fn correlation(&self, pattern: &Seen, place: Place) -> f32 {
        let cells = || self.lines(place).flatten();
        let (sum, squares) =
            cells().fold((0.0, 0.0), |(sum, squares), cell| (sum + cell, squares + cell * cell));
        let spread = squares - sum * sum / (LONG * ACROSS) as f32;
        self.product(pattern, place) / (spread * pattern.square).max(1e-6).sqrt()
    }

    /// How much more what is seen is like one pattern than like another: a half if it is the one, minus a
    /// half if it is the other. Only the strokes in which they differ count.
    fn lead(&self, one: &Seen, other: &Seen, place: Place) -> f32 {
        let products = [one, other].map(|pattern| self.product(pattern, place));
        let gain = products[0] / one.square;
        let apart = one.cells.iter().zip(&other.cells).map(|(a, b)| (a - b) * (a - b)).sum::<f32>();
        ((products[0] - products[1]) / gain - 0.5 * (one.square - other.square)) / apart
    }

    fn product(&self, pattern: &Seen, place: Place) -> f32 {
        let products = self.lines(place).zip(pattern.cells.chunks_exact(ACROSS));
        products.map(|(line, painted)| line.iter().zip(painted).map(|(a, b)| a * b).sum::<f32>()).sum()
    }

    /// The lines of what a pattern at a place covers.
    fn lines(&self, Place { row, column }: Place) -> impl Iterator<Item = &[f32]> {
        let lines = self.cells.chunks_exact(Self::COLUMNS).skip(row).take(LONG);
        lines.map(move |line| &line[column..][..ACROSS])
    }
}
