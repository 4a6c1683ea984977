use std::ops::RangeInclusive;

use crate::geometry::{Aabb, Point, direction};
use crate::world::{BitGrid, Footprint};

/// The cells at whose centres a robot with a fixed heading touches no blocked cell.
///
/// Cells are `resolution` metres wide, columns along x and rows along y, as in an
/// [`OccupancyGrid`](crate::world::OccupancyGrid) without rotation. Without a heading the robot may turn on
/// the spot: its outline is then its bounding circle. Everything outside the map is blocked. Edges may touch.
/// No cell is free for an outline, in cells, that is not finite.
///
/// Works on 64 cells at a time: for each row of cells that the outline covers, the map's rows are shifted and
/// combined, in a number of steps logarithmic in the outline's width.
///
/// ```
/// use roverlab::nav::grid::inflated;
/// use roverlab::world::{BitGrid, Footprint, GridCell};
/// let grid = BitGrid::from_fn(9, 9, |x, y| (x, y) != (4, 4))?;
/// let free = inflated(&grid, 0.1, &Footprint::Disc { radius: 0.12 }, None);
/// assert!(free.is_free(GridCell::new(2, 4)) && !free.is_free(GridCell::new(3, 4)));
/// // Diagonally, the next cell but one is far enough; the border is blocked.
/// assert!(free.is_free(GridCell::new(2, 2)) && !free.is_free(GridCell::new(0, 0)));
/// # Ok::<(), roverlab::world::BitGridError>(())
/// ```
pub fn inflated(grid: &BitGrid, resolution: f64, footprint: &Footprint, heading: Option<f64>) -> BitGrid {
    let outline = Outline::new(footprint, resolution, heading);
    let Some([columns, rows]) = outline.spans(grid.width(), grid.height()) else {
        return BitGrid::blocked(grid.width(), grid.height())
            .unwrap_or_else(|_| unreachable!("as large as the first"));
    };
    let mut blocked = vec![vec![0u64; grid.width().div_ceil(64)]; grid.height()];
    let solid = grid.inverted();
    let mut line = Line::new(grid.width());
    for dy in rows {
        let Some((first, last)) = outline.columns(dy, &columns) else { continue };
        for (row, blocked) in blocked.iter_mut().enumerate() {
            let source = row as i64 + dy;
            if source < 0 || source >= grid.height() as i64 {
                line.fill();
            } else {
                line.take(solid.row(source as usize));
            }
            line.spread(first, last);
            line.join(blocked);
        }
    }
    let free = |column: usize, row: usize| {
        grid.is_free(crate::world::GridCell::new(column, row))
            && blocked[row][column / 64] >> (column % 64) & 1 == 0
    };
    BitGrid::from_fn(grid.width(), grid.height(), free)
        .unwrap_or_else(|_| unreachable!("as large as the first"))
}

/// A robot's outline about the centre of a cell, in cells.
enum Outline {
    Disc(f64),
    /// A rectangle along its own axes, and the direction of the first one.
    Rectangle(Aabb, Point),
}

impl Outline {
    fn new(footprint: &Footprint, resolution: f64, heading: Option<f64>) -> Self {
        match (footprint, heading) {
            (Footprint::Rectangle(sides), Some(heading)) if heading.is_finite() => {
                let scaled = Aabb::new(
                    Point::from(sides.min.coords / resolution),
                    Point::from(sides.max.coords / resolution),
                );
                Self::Rectangle(scaled, Point::from(direction(heading)))
            }
            _ => Self::Disc(footprint.bounding_radius() / resolution),
        }
    }

    /// The columns and the rows that it may meet, by their offsets. `None` if wherever it is, it reaches
    /// beyond a map of this size, and if it is not finite.
    fn spans(&self, width: usize, height: usize) -> Option<[RangeInclusive<i64>; 2]> {
        let span = |(middle, half): (f64, f64), size: usize| {
            let fits = middle.abs() + half <= size as f64;
            fits.then(|| (middle - half).floor() as i64 - 1..=(middle + half).ceil() as i64 + 1)
        };
        let [x, y] = self.extents();
        Some([span(x, width)?, span(y, height)?])
    }

    /// The middle and half of its extent along columns, and along rows (cells).
    fn extents(&self) -> [(f64, f64); 2] {
        match self {
            Self::Disc(radius) => [(0.0, radius.abs()); 2],
            Self::Rectangle(sides, axis) => {
                let (x, y) = (0.5 * (sides.min.x + sides.max.x), 0.5 * (sides.min.y + sides.max.y));
                let half = 0.5 * (sides.max - sides.min).abs();
                let (c, s) = (axis.x.abs(), axis.y.abs());
                [
                    (x * axis.x - y * axis.y, half.x * c + half.y * s),
                    (x * axis.y + y * axis.x, half.x * s + half.y * c),
                ]
            }
        }
    }

    /// The cells of the row at offset `dy` whose interiors it meets: without gaps, as it is convex.
    fn columns(&self, dy: i64, span: &RangeInclusive<i64>) -> Option<(i64, i64)> {
        let first = span.clone().find(|&dx| self.meets(dx, dy))?;
        let last = span.clone().rev().find(|&dx| self.meets(dx, dy))?;
        Some((first, last))
    }

    fn meets(&self, dx: i64, dy: i64) -> bool {
        let (x, y) = (dx as f64, dy as f64);
        match self {
            Self::Disc(radius) => {
                let (x, y) = ((x.abs() - 0.5).max(0.0), (y.abs() - 0.5).max(0.0));
                x * x + y * y < radius * radius
            }
            Self::Rectangle(sides, axis) => {
                let middle = Point::new(0.5 * (sides.min.x + sides.max.x), 0.5 * (sides.min.y + sides.max.y));
                let half = (0.5 * (sides.max.x - sides.min.x), 0.5 * (sides.max.y - sides.min.y));
                let (c, s) = (axis.x, axis.y);
                // The vector from the rectangle's centre to the cell's, along the axes of the grid and of the
                // rectangle.
                let across = (x - (middle.x * c - middle.y * s), y - (middle.x * s + middle.y * c));
                let along = (across.0 * c + across.1 * s, -across.0 * s + across.1 * c);
                let (c, s) = (c.abs(), s.abs());
                let apart = [
                    across.0.abs() - 0.5 - half.0 * c - half.1 * s,
                    across.1.abs() - 0.5 - half.0 * s - half.1 * c,
                    along.0.abs() - half.0 - 0.5 * (c + s),
                    along.1.abs() - half.1 - 0.5 * (c + s),
                ];
                // Rounding must not make touching edges overlap.
                apart.into_iter().all(|gap| gap < -1e-9)
            }
        }
    }
}

/// A row of bits with room on both sides, blocked outside the map.
struct Line {
    width: usize,
    bits: Vec<u64>,
    spare: Vec<u64>,
}

/// Words before the first cell.
const MARGIN: usize = 1;

impl Line {
    fn new(width: usize) -> Self {
        let words = width.div_ceil(64) + 2 * MARGIN;
        Self { width, bits: vec![0; words], spare: vec![0; words] }
    }

    fn fill(&mut self) {
        self.bits.fill(u64::MAX);
    }

    fn take(&mut self, row: &[u64]) {
        self.bits.fill(u64::MAX);
        self.bits[MARGIN..][..row.len()].copy_from_slice(row);
        if !self.width.is_multiple_of(64) {
            self.bits[MARGIN + self.width / 64] |= u64::MAX << (self.width % 64);
        }
    }

    /// Sets each bit that has a set bit `first` to `last` places after it.
    fn spread(&mut self, first: i64, last: i64) {
        let mut covered = 1;
        let count = last - first + 1;
        while covered < count {
            let step = covered.min(count - covered);
            self.join_moved(step);
            covered += step;
        }
        self.shift(first);
    }

    /// Combines the bits with those `step` places after them.
    fn join_moved(&mut self, step: i64) {
        self.spare.clone_from(&self.bits);
        self.shift(step);
        for (bit, old) in self.bits.iter_mut().zip(&self.spare) {
            *bit |= old;
        }
    }

    /// Takes each bit from `by` places after it; beyond the ends all are set.
    fn shift(&mut self, by: i64) {
        let (words, bits) = (by.div_euclid(64), by.rem_euclid(64) as u32);
        let at = |line: &[u64], index: i64| {
            usize::try_from(index).ok().and_then(|index| line.get(index)).copied().unwrap_or(u64::MAX)
        };
        let old = self.bits.clone();
        for (index, word) in self.bits.iter_mut().enumerate() {
            let low = at(&old, index as i64 + words);
            let high = at(&old, index as i64 + words + 1);
            *word = if bits == 0 { low } else { low >> bits | high << (64 - bits) };
        }
    }

    fn join(&self, row: &mut [u64]) {
        for (word, more) in row.iter_mut().zip(&self.bits[MARGIN..]) {
            *word |= more;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nav::grid::DistanceField;
    use crate::random::Stream;
    use crate::world::GridCell;
    use proptest::prelude::*;

    fn random_grid(width: usize, height: usize, seed: u64) -> BitGrid {
        let mut stream = Stream::new(seed);
        BitGrid::from_fn(width, height, |_, _| stream.chance(0.97)).unwrap()
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        /// Two methods agree: shifted bits and exact distances.
        #[test]
        fn discs_keep_their_distance(width in 1..150usize, height in 1..40usize, radius in 0.0..9.0f64, seed in any::<u64>()) {
            let grid = random_grid(width, height, seed);
            let free = inflated(&grid, 0.05, &Footprint::Disc { radius: 0.05 * radius }, None);
            prop_assert_eq!(free, DistanceField::new(&grid).grid(radius));
        }

        /// In a free cell the robot's rectangle meets no blocked cell; in other cells it does.
        #[test]
        fn rectangles_cover_what_they_meet(
            width in 1..40usize, height in 1..40usize, heading in -3.0..3.0f64, seed in any::<u64>(),
            back in 0.1..3.0f64, front in 0.1..6.0f64, side in 0.1..3.0f64,
        ) {
            let grid = random_grid(width, height, seed);
            let sides = Aabb::new(Point::new(-back, -side), Point::new(front, side));
            let free = inflated(&grid, 1.0, &Footprint::Rectangle(sides), Some(heading));
            let axis = direction(heading);
            for cell in grid.free_cells() {
                // Points spread over the rectangle, and the maximum distance of blocked cells beyond its
                // edge.
                let meets = |slack: f64| (0..=40).any(|i| (0..=40).any(|j| {
                    let x = (-back - slack) + (front + back + 2.0 * slack) * f64::from(i) / 40.0;
                    let y = (-side - slack) + 2.0 * (side + slack) * f64::from(j) / 40.0;
                    let at = cell.centre() + axis * x + crate::geometry::Vector::new(-axis.y, axis.x) * y;
                    !GridCell::at(at).is_some_and(|cell| grid.is_free(cell))
                }));
                if free.is_free(cell) {
                    prop_assert!(!meets(-1e-6), "{} of {:?}", cell, grid);
                } else {
                    prop_assert!(meets(0.3), "{} of {:?}", cell, grid);
                }
            }
        }
    }

    #[test]
    fn a_robot_larger_than_the_map_has_no_place() {
        let grid = BitGrid::from_fn(20, 10, |_, _| true).unwrap();
        for radius in [5.1, 100.0, 1e30] {
            let free = inflated(&grid, 1.0, &Footprint::Disc { radius }, None);
            assert_eq!(free.count_free(), 0, "{radius}");
        }
        assert_eq!(inflated(&grid, 1.0, &Footprint::Disc { radius: 5.0 }, None).count_free(), 0);
        assert_eq!(inflated(&grid, 1.0, &Footprint::Disc { radius: 4.5 }, None).count_free(), 24);
    }

    #[test]
    fn a_robot_beyond_the_map_or_without_an_outline_has_no_place() {
        let grid = BitGrid::from_fn(3, 100_000, |_, _| true).unwrap();
        let beside = Footprint::Rectangle(Aabb::new(Point::new(50.0, 0.0), Point::new(51.0, 1.0)));
        assert_eq!(inflated(&grid, 1.0, &beside, Some(0.0)).count_free(), 0);
        let far = Footprint::Disc { radius: 40_000.0 };
        assert_eq!(inflated(&grid, 1.0, &far, None).count_free(), 0, "at once");
        for resolution in [f64::NAN, 0.0, -0.0] {
            assert_eq!(inflated(&grid, resolution, &beside, Some(0.0)).count_free(), 0, "{resolution}");
        }
    }
}
