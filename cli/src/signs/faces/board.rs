//! Boards beside a road: chevrons before bends, and landmarks.

use super::{BLACK, Colour, Place, RED, WHITE};

/// A red chevron that points to the right. Another one is to its right, where the board goes on beyond 1.
pub(super) fn chevron((x, y): Place) -> Colour {
    let along = x.rem_euclid(1.0) + 0.5 * (2.0 * y - 1.0).abs();
    if (0.45..0.95).contains(&along) { RED } else { WHITE }
}

/// Squares on a side of a landmark's code, and of the white border around it.
const SQUARES: usize = 21;
const BORDER: usize = 2;
/// Squares on a side of the patterns in three of its corners.
const CORNER: usize = 7;

/// A block pattern like that of a QR code, but without a text.
pub(super) fn landmark((x, y): Place) -> Colour {
    let square = |part: f64| ((part * (SQUARES + 2 * BORDER) as f64) as usize).checked_sub(BORDER);
    match (square(x), square(y)) {
        (Some(column), Some(row)) if column < SQUARES && row < SQUARES && is_dark(column, row) => BLACK,
        _ => WHITE,
    }
}

fn is_dark(column: usize, row: usize) -> bool {
    // From the nearest border, for the corner patterns; the lower right corner has none.
    let (across, down) = (column.min(SQUARES - 1 - column), row.min(SQUARES - 1 - row));
    let is_corner = across <= CORNER && down <= CORNER && (column < SQUARES / 2 || row < SQUARES / 2);
    if is_corner {
        // A dark square in a white ring in a dark ring; a white line beside them.
        let out = across.abs_diff(CORNER / 2).max(down.abs_diff(CORNER / 2));
        out <= 1 || out == 3
    } else {
        is_scattered(column, row)
    }
}

/// Whether a square of no pattern is dark: about half of them, in no order that one sees.
fn is_scattered(column: usize, row: usize) -> bool {
    let mixed = ((column * SQUARES + row + 1) as u32).wrapping_mul(0x9e37_79b1);
    (mixed ^ (mixed >> 15)).wrapping_mul(0x85eb_ca6b) >> 13 & 1 == 1
}
