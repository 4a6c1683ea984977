use crate::world::{BitGrid, GridCell};

/// Distance of every cell's centre from the nearest edge of a blocked cell, in cells. Everything outside the
/// map is blocked.
///
/// Exact. Columns first, then rows by the lower envelope of the columns' distances (A. Meijster, J. Roerdink,
/// W. Hesselink, *A General Algorithm for Computing Distance Transforms in Linear Time*, 2000; P.
/// Felzenszwalb, D. Huttenlocher, *Distance Transforms of Sampled Functions*, 2012). Time O(n log w) for n
/// cells in rows of w; 4 bytes per cell.
///
/// ```
/// use roverlab::nav::grid::DistanceField;
/// use roverlab::world::{BitGrid, GridCell};
/// let field = DistanceField::new(&BitGrid::from_text(".....\n.....\n..#..\n.....\n.....")?);
/// assert_eq!(field.at(GridCell::new(2, 1)), 0.5);
/// assert_eq!(field.at(GridCell::new(2, 2)), 0.0);
/// // One cell away diagonally.
/// assert_eq!(field.at(GridCell::new(1, 1)), 0.5f64.sqrt());
/// # Ok::<(), roverlab::world::BitGridError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct DistanceField {
    width: usize,
    height: usize,
    /// Squared distances in half cells; 0 at blocked cells.
    squares: Vec<u32>,
}

/// Squared distance in half cells between a centre and the nearest edge of a cell `apart` cells away.
fn square(apart: u32) -> u32 {
    let halves = (2 * apart).saturating_sub(1);
    halves.saturating_mul(halves)
}

impl DistanceField {
    /// Computes the distances of a grid.
    pub fn new(grid: &BitGrid) -> Self {
        let (width, height) = (grid.width(), grid.height());
        let mut field = Self { width, height, squares: vec![0; width * height] };
        field.columns(grid);
        let mut row = vec![0; width];
        let mut envelope = Vec::new();
        for y in 0..height {
            let cells = &mut field.squares[y * width..][..width];
            row.copy_from_slice(cells);
            lower_envelope(&row, &mut envelope, cells);
        }
        field
    }

    /// Distance at a cell, in cells; 0 outside the map.
    pub fn at(&self, cell: GridCell) -> f64 {
        let inside = cell.column < self.width && cell.row < self.height;
        if inside { 0.5 * f64::from(self.squares[cell.row * self.width + cell.column]).sqrt() } else { 0.0 }
    }

    /// The cells where a disc of this radius (cells) at the centre overlaps no blocked cell; it may touch.
    pub fn grid(&self, radius: f64) -> BitGrid {
        let free = |column, row| {
            let distance = self.at(GridCell::new(column, row));
            distance > 0.0 && distance >= radius
        };
        BitGrid::from_fn(self.width, self.height, free)
            .unwrap_or_else(|_| unreachable!("as large as the first"))
    }

    /// Distances along columns, down and up. The border counts as a blocked cell before the first and after
    /// the last.
    fn columns(&mut self, grid: &BitGrid) {
        let mut steps = vec![0u32; self.width];
        for y in 0..self.height {
            for (x, step) in steps.iter_mut().enumerate() {
                *step = if grid.is_free(GridCell::new(x, y)) { *step + 1 } else { 0 };
                self.squares[y * self.width + x] = *step;
            }
        }
        steps.fill(0);
        for y in (0..self.height).rev() {
            for (x, step) in steps.iter_mut().enumerate() {
                let cell = &mut self.squares[y * self.width + x];
                *step = if *cell == 0 { 0 } else { *step + 1 };
                *cell = square((*cell).min(*step));
            }
        }
    }
}

/// For each position of a row, the minimum over the columns of the column's value plus the squared distance
/// to the column.
///
/// Of two columns, the left one is better up to some position and the right one from there on, because the
/// squares grow ever faster; `envelope` holds the columns that are best somewhere, each with its first
/// position.
fn lower_envelope(row: &[u32], envelope: &mut Vec<(usize, usize)>, out: &mut [u32]) {
    let value = |column: usize, at: usize| row[column].saturating_add(square(column.abs_diff(at) as u32));
    envelope.clear();
    for column in 0..row.len() {
        let mut first = 0;
        while let Some(&(best, from)) = envelope.last() {
            if value(column, from) < value(best, from) {
                envelope.pop();
                continue;
            }
            // The first position at which the new column is better.
            let (mut low, mut high) = (from, row.len());
            while low + 1 < high {
                let middle = usize::midpoint(low, high);
                if value(column, middle) < value(best, middle) { high = middle } else { low = middle }
            }
            first = high;
            break;
        }
        if first < row.len() {
            envelope.push((column, first));
        }
    }
    let mut index = 0;
    for (at, cell) in out.iter_mut().enumerate() {
        while envelope.get(index + 1).is_some_and(|next| next.1 <= at) {
            index += 1;
        }
        let border = square((at + 1).min(row.len() - at) as u32);
        *cell = value(envelope[index].0, at).min(border);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        /// The distance is the minimum over all blocked cells, including those around the map.
        #[test]
        fn distances_are_the_least(width in 1..30usize, height in 1..30usize, share in 0.5..1.0f64, seed in any::<u64>()) {
            let mut stream = Stream::new(seed);
            let grid = BitGrid::from_fn(width, height, |_, _| stream.chance(share)).unwrap();
            let field = DistanceField::new(&grid);
            for y in 0..height as isize {
                for x in 0..width as isize {
                    let mut least = f64::INFINITY;
                    for v in -1..=height as isize {
                        for u in -1..=width as isize {
                            let inside = u >= 0 && v >= 0;
                            if !(inside && grid.is_free(GridCell::new(u as usize, v as usize))) {
                                let (dx, dy) = ((x - u).abs() as f64, (y - v).abs() as f64);
                                let (dx, dy) = ((dx - 0.5).max(0.0), (dy - 0.5).max(0.0));
                                least = least.min((dx * dx + dy * dy).sqrt());
                            }
                        }
                    }
                    let cell = GridCell::new(x as usize, y as usize);
                    prop_assert!((field.at(cell) - least).abs() < 1e-9, "{} for {} at {} of {:?}", field.at(cell), least, cell, grid);
                }
            }
            prop_assert_eq!(field.grid(0.0), grid);
        }
    }

    #[test]
    fn empty_maps_and_places_outside() {
        let field = DistanceField::new(&BitGrid::blocked(0, 0).unwrap());
        assert_eq!(field.at(GridCell::new(0, 0)), 0.0);
        assert_eq!(field.grid(1.0).count_free(), 0);
    }
}
