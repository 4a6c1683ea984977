//! Numbers of speed limits on the own lane, and those that are struck out.

use super::element::{Detection, RoadElementKind};
use super::view::{CELL, COLUMNS, ROWS, RoadView, column};
use crate::vision::lane_markings::RoadAhead;

/// Height of a digit, distance from its middle to the middles of the strokes at its sides, and distance of a
/// digit's middle from that of the number, by the rules' drawing (cells).
const HIGH: usize = 40;
const HALF: i32 = 3;
const ASIDE: f64 = 4.5;
/// Strokes of the digits: top, upper right, lower right, bottom, lower left, upper left, middle, from the lowest
/// bit upwards.
const DIGITS: [u8; 10] = [0x3f, 0x06, 0x5b, 0x4f, 0x66, 0x6d, 0x7d, 0x07, 0x7f, 0x6f];
/// The line that strikes a number out, by the rules' drawing: how far it begins before the digits, its length
/// along the road, and its distance from the lane's middle at both ends (cells).
const STRIKE: (usize, usize, f64) = (5, 50, 10.0);
/// Share of that line that has to be bright, and the brightness of a stroke, between floor and paint.
const STRUCK: f64 = 0.85;
const BRIGHT: f64 = 0.5;
/// Least difference of every stroke's brightness from that.
const CLEAR: f64 = 0.08;
/// Half the width of a strip that is free before a number, and the length of what is free there (cells).
const STRIP: usize = 8;
const FREE: usize = 6;
/// Most cells that a pixel covers along the road at the far end of a number that is read.
const SHARP: usize = 3;

/// Finds the nearest number on the own lane.
pub(super) fn number(view: &RoadView, road: &RoadAhead, found: &mut Vec<Detection>) {
    let middle = column(road.middle);
    if middle < 2 * STRIP || middle + 2 * STRIP >= COLUMNS {
        return;
    }
    let strip = middle - STRIP..=middle + STRIP;
    let is_seen = |row: usize| strip.clone().all(|column| view.sees(row, column));
    let is_free = |row: usize| strip.clone().all(|column| view.brightness(row, column) < BRIGHT);
    let Some(begin) = (0..ROWS).find(|&row| is_seen(row) && !is_free(row)) else { return };
    let is_sharp = begin + HIGH + 2 < ROWS && view.blur(begin + HIGH) <= SHARP && begin >= FREE;
    if !is_sharp || !(begin - FREE..begin).all(|row| is_seen(row) && is_free(row)) {
        return;
    }
    let (before, ..) = STRIKE;
    if is_struck(view, middle, begin) {
        found.push(Detection::new(RoadElementKind::SpeedLimitEnd, view.ahead(begin) - CELL * before as f64));
    } else if let Some(value) = value(view, middle, begin) {
        found.push(Detection::new(RoadElementKind::SpeedLimit(value), view.ahead(begin)));
    }
}

/// Brightness of the brightest of some cells.
fn brightest(cells: impl Iterator<Item = (usize, usize)>, view: &RoadView) -> f64 {
    cells.map(|(row, column)| view.brightness(row, column)).fold(0.0, f64::max)
}

fn is_struck(view: &RoadView, middle: usize, begin: usize) -> bool {
    let (before, long, aside) = STRIKE;
    let is_bright = |step: &usize| {
        let left = aside * (1.0 - 2.0 * *step as f64 / long as f64);
        let at = (middle as f64 + left).round() as usize;
        let row = begin + step - before;
        row < ROWS && brightest((at - 1..=at + 1).map(|column| (row, column)), view) > BRIGHT
    };
    let count = (before..long).filter(is_bright).count();
    count as f64 > STRUCK * (long - before) as f64
}

/// The number that begins about a row, in steps of ten by the rules. The lane's middle and the row are known to
/// within two cells.
fn value(view: &RoadView, middle: usize, begin: usize) -> Option<u8> {
    let places = (-2..=2).flat_map(|aside: i32| (0..=2).map(move |row| (aside, begin + row)));
    let readings = places.filter_map(|(aside, row)| {
        let at = |side: f64| (middle as f64 + f64::from(aside) + side * ASIDE).round() as i32;
        let (tens, clear) = digit(view, at(1.0), row)?;
        let (ones, also_clear) = digit(view, at(-1.0), row)?;
        Some((clear.min(also_clear), 10 * tens + ones))
    });
    let (_, value) = readings.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (value % 10 == 0 && value > 0).then_some(value)
}

/// The digit about a column that begins at a row, and the least difference of a stroke's brightness from the
/// threshold.
fn digit(view: &RoadView, middle: i32, begin: usize) -> Option<(u8, f64)> {
    let cell = |row: usize, aside: i32| (row, (middle + aside) as usize);
    let upright = |side: i32, from: usize| {
        let rows = from + 4..from + HIGH / 2 - 3;
        let count = rows.len() as f64;
        let row = |row: usize| brightest((-1..=1).map(|aside| cell(row, side * HALF + aside)), view);
        rows.map(|at| row(begin + at)).sum::<f64>() / count
    };
    let across = |at: usize| {
        let row = begin + at;
        let column =
            |aside: i32| brightest((row.saturating_sub(2)..=row + 2).map(|row| cell(row, aside)), view);
        (-1..=1).map(column).sum::<f64>() / 3.0
    };
    let half = HIGH / 2;
    let strokes = [
        across(HIGH),
        upright(-1, half),
        upright(-1, 0),
        across(0),
        upright(1, 0),
        upright(1, half),
        across(half),
    ];
    let code = strokes.iter().enumerate().fold(0, |code, (bit, it)| code | u8::from(*it > BRIGHT) << bit);
    let clear = strokes.iter().map(|it| (it - BRIGHT).abs()).fold(f64::INFINITY, f64::min);
    let value = DIGITS.iter().position(|digit| *digit == code)?;
    (clear > CLEAR).then_some((value as u8, clear))
}
