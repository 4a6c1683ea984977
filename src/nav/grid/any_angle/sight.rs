//! Line-of-sight checks in integers.

use super::field::{Field, HalfPoint};

/// Whether a straight line connects two points: it may touch corners and run along walls, but not pass
/// between two blocked cells that touch at a corner.
pub(in crate::nav::grid) fn in_sight(field: &Field, a: HalfPoint, b: HalfPoint) -> bool {
    let (a, b) = if a.y <= b.y { (a, b) } else { (b, a) };
    if a.y == b.y {
        return along_row(field, a, b);
    }
    if a.x == b.x && a.x % 2 == 0 {
        return along_line(a.y, b.y, |row| (field.is_free(a.x / 2 - 1, row), field.is_free(a.x / 2, row)));
    }
    across_rows(field, a, b)
}

fn along_row(field: &Field, a: HalfPoint, b: HalfPoint) -> bool {
    let (first, last) = (a.x.min(b.x), a.x.max(b.x));
    if a.y % 2 == 0 {
        let sides = |column| (field.is_free(column, a.y / 2 - 1), field.is_free(column, a.y / 2));
        return along_line(first, last, sides);
    }
    all_free(field, a.y.div_euclid(2), first.div_euclid(2), last)
}

/// Whether the cells of a row are free from column `first` up to those that begin before `end` (half cells).
fn all_free(field: &Field, row: i32, first: i32, end: i32) -> bool {
    2 * field.next_blocked(row, first) >= end
}

/// Along a grid line: each cell-long stretch has a free cell on one side, and the line changes sides only
/// where both are free.
fn along_line(first: i32, last: i32, sides: impl Fn(i32) -> (bool, bool)) -> bool {
    let mut on = (true, true);
    for cell in first.div_euclid(2)..(last + 1).div_euclid(2) {
        let free = sides(cell);
        on = (on.0 && free.0, on.1 && free.1);
        if on == (false, false) {
            return false;
        }
        if free == (true, true) {
            on = free;
        }
    }
    true
}

/// Across rows: the cells that the line crosses are free, and at each grid point on the line one of the cells
/// beside it is free too.
fn across_rows(field: &Field, a: HalfPoint, b: HalfPoint) -> bool {
    let (dx, dy) = (i64::from(b.x - a.x), i64::from(b.y - a.y));
    // x times dy at a given y.
    let at = |y: i32| i64::from(a.x) * dy + i64::from(y - a.y) * dx;
    let cell = 2 * dy;
    let mut row = a.y.div_euclid(2);
    let mut y = a.y;
    while y < b.y {
        let next = (2 * (row + 1)).min(b.y);
        let (from, to) = (at(y), at(next));
        let (low, high) = (from.min(to), from.max(to));
        let first = low.div_euclid(cell) as i32;
        let end = -(-high).div_euclid(cell) as i32;
        if first < 0 || !field.is_free(first, row) || field.next_blocked(row, first) < end {
            return false;
        }
        if next < b.y && to.rem_euclid(cell) == 0 {
            let x = (to / cell) as i32;
            let (before, after) = if dx > 0 { (x, x - 1) } else { (x - 1, x) };
            if dx != 0 && !field.is_free(before, row) && !field.is_free(after, row + 1) {
                return false;
            }
        }
        (row, y) = (row + 1, next);
    }
    true
}
