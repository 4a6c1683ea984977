//! Intersections of lines with grids.

use crate::geometry::units::NEGLIGIBLE;
use crate::geometry::{Point, Vector};
use crate::world::{BitGrid, GridCell};

/// The first blocked or outside cell whose interior a segment enters.
pub(super) fn entered(grid: &BitGrid, a: Point, b: Point) -> Option<GridCell> {
    let bounds = |a: f64, b: f64, cells: usize| {
        let low = (a.min(b) - 1.0).floor().max(0.0) as usize;
        low..((a.max(b) + 1.0).ceil() as usize).min(cells)
    };
    let outside = |p: Point| {
        !(0.0..=grid.width() as f64).contains(&p.x) || !(0.0..=grid.height() as f64).contains(&p.y)
    };
    if outside(a) || outside(b) {
        return Some(GridCell::new(grid.width(), grid.height()));
    }
    let rows = bounds(a.y, b.y, grid.height());
    let cells =
        rows.flat_map(|row| bounds(a.x, b.x, grid.width()).map(move |column| GridCell::new(column, row)));
    cells.into_iter().find(|&cell| !grid.is_free(cell) && meets(a, b, cell))
}

/// Whether a part of a segment lies in the interior of a cell.
fn meets(a: Point, b: Point, cell: GridCell) -> bool {
    let (mut first, mut last) = (0.0f64, 1.0f64);
    for (from, d, low) in [(a.x, b.x - a.x, cell.column as f64), (a.y, b.y - a.y, cell.row as f64)] {
        let (low, high) = (low + NEGLIGIBLE, low + 1.0 - NEGLIGIBLE);
        if d == 0.0 {
            if from <= low || from >= high {
                return false;
            }
            continue;
        }
        let (one, other) = ((low - from) / d, (high - from) / d);
        (first, last) = (first.max(one.min(other)), last.min(one.max(other)));
    }
    first < last
}

/// Whether a segment runs along a grid line with blocked cells on both sides.
pub(super) fn between_walls(grid: &BitGrid, a: Point, b: Point) -> bool {
    let along_line = |at: f64, d: f64| d.abs() < NEGLIGIBLE && (at - at.round()).abs() < NEGLIGIBLE;
    let stretch = |a: f64, b: f64| {
        let (low, high) = (a.min(b) + NEGLIGIBLE, a.max(b) - NEGLIGIBLE);
        (low.floor() as isize)..(high.ceil() as isize)
    };
    let d = b - a;
    if along_line(a.x, d.x) {
        let x = a.x.round() as isize;
        return stretch(a.y, b.y).any(|y| !is_free(grid, x - 1, y) && !is_free(grid, x, y));
    }
    if along_line(a.y, d.y) {
        let y = a.y.round() as isize;
        return stretch(a.x, b.x).any(|x| !is_free(grid, x, y - 1) && !is_free(grid, x, y));
    }
    false
}

/// A point at which two blocked cells touch and a path passes between the two free cells there.
pub(super) fn squeezed(grid: &BitGrid, path: &[Point]) -> Option<Point> {
    path.windows(2).enumerate().find_map(|(i, pair)| {
        let is_squeeze = |&corner: &Point| {
            if corner_is_on(corner, pair[0], pair[1]) {
                return passes(grid, corner, pair[0], pair[1]);
            }
            // Where the path turns.
            let turns = (corner - pair[1]).norm() < NEGLIGIBLE;
            turns && path.get(i + 2).is_some_and(|&next| passes(grid, corner, pair[0], next))
        };
        corners_near(grid, pair[0], pair[1]).find(is_squeeze)
    })
}

/// Grid points in the bounding box of a segment.
fn corners_near(grid: &BitGrid, a: Point, b: Point) -> impl Iterator<Item = Point> + use<> {
    let range = |a: f64, b: f64, cells: usize| {
        let (low, high) = ((a.min(b) - NEGLIGIBLE).ceil().max(0.0), (a.max(b) + NEGLIGIBLE).floor());
        low as usize..=(high.max(0.0) as usize).min(cells)
    };
    let (columns, rows) = (range(a.x, b.x, grid.width()), range(a.y, b.y, grid.height()));
    rows.flat_map(move |y| columns.clone().map(move |x| Point::new(x as f64, y as f64)))
}

/// Whether a point lies in the interior of a segment.
fn corner_is_on(corner: Point, a: Point, b: Point) -> bool {
    let (d, way) = (b - a, corner - a);
    let along = way.dot(&d) / d.norm();
    let aside = crate::geometry::cross(d, way).abs() / d.norm();
    aside < NEGLIGIBLE && along > NEGLIGIBLE && along < d.norm() - NEGLIGIBLE
}

/// Whether two of the four cells at a point are diagonally blocked, and no free one contains both the way
/// from `a` and that to `b`.
fn passes(grid: &BitGrid, corner: Point, a: Point, b: Point) -> bool {
    let (x, y) = (corner.x as isize, corner.y as isize);
    let free = |dx: isize, dy: isize| is_free(grid, x + dx.min(0), y + dy.min(0));
    let quadrants = [(1, 1), (-1, 1), (-1, -1), (1, -1)];
    let [here, left, across, right] = quadrants.map(|(dx, dy)| free(dx, dy));
    if here != across || left != right || here == left {
        return false;
    }
    let within =
        |d: Vector, (dx, dy): (isize, isize)| d.x * dx as f64 > -NEGLIGIBLE && d.y * dy as f64 > -NEGLIGIBLE;
    !quadrants
        .iter()
        .any(|&side| free(side.0, side.1) && within(a - corner, side) && within(b - corner, side))
}

fn is_free(grid: &BitGrid, column: isize, row: isize) -> bool {
    let cell = usize::try_from(column).ok().zip(usize::try_from(row).ok());
    cell.is_some_and(|(column, row)| grid.is_free(GridCell::new(column, row)))
}
