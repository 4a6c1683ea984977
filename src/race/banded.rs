//! Symmetric cyclic band matrices with two bands on either side of the diagonal.

/// A symmetric matrix whose entries lie at most two places from the diagonal, counted cyclically.
#[derive(Debug, Clone, Default)]
pub(super) struct CyclicBand {
    /// `bands[k][i]` is the entry at row `i`, column `i + k`, modulo the size.
    bands: [Vec<f64>; 3],
}

impl CyclicBand {
    /// The zero matrix; at least four rows.
    pub(super) fn zeros(n: usize) -> Self {
        debug_assert!(n >= 4);
        Self { bands: std::array::from_fn(|_| vec![0.0; n]) }
    }

    pub(super) fn size(&self) -> usize {
        self.bands[0].len()
    }

    /// Adds to the entries `(i, j)` and `(j, i)`, which are at most two places apart, counted cyclically.
    pub(super) fn add(&mut self, i: usize, j: usize, value: f64) {
        let n = self.size();
        let ahead = (j + n - i) % n;
        if ahead <= 2 {
            self.bands[ahead][i] += value;
        } else {
            self.bands[n - ahead][j] += value;
        }
    }

    pub(super) fn multiply(&self, x: &[f64], out: &mut [f64]) {
        let n = self.size();
        for i in 0..n {
            out[i] = self.bands[0][i] * x[i];
        }
        for k in 1..=2 {
            for i in 0..n {
                let j = if i + k < n { i + k } else { i + k - n };
                out[i] += self.bands[k][i] * x[j];
                out[j] += self.bands[k][i] * x[i];
            }
        }
    }

    /// Factorises this matrix, which must be positive definite.
    pub(super) fn factor(&self) -> Factors {
        let mut factors = Factors::default();
        factors.refactor(self, None);
        factors
    }
}

/// Factorisation of a cyclic band matrix: a plain band, bordered by the last two rows.
#[derive(Debug, Clone, Default)]
pub(super) struct Factors {
    /// The two bands of the unit lower triangle, and the inverse of the diagonal.
    one: Vec<f64>,
    two: Vec<f64>,
    inverse: Vec<f64>,
    /// Columns of the border, solved by the band; `raw` holds them unsolved.
    border: [Vec<f64>; 2],
    raw: [Vec<f64>; 2],
    /// Inverse of the Schur complement of the corner: entries (0,0), (0,1) and (1,1).
    corner: [f64; 3],
}

impl Factors {
    /// Factorises a matrix, with optional additions to its diagonal. O(n).
    pub(super) fn refactor(&mut self, matrix: &CyclicBand, more: Option<&[f64]>) {
        let diagonal = |i: usize| matrix.bands[0][i] + more.map_or(0.0, |more| more[i]);
        self.factor_band(matrix, diagonal);
        self.solve_border(matrix);
        self.factor_corner(matrix, diagonal);
    }

    /// Factorises the plain band.
    fn factor_band(&mut self, matrix: &CyclicBand, diagonal: impl Fn(usize) -> f64) {
        let m = matrix.size() - 2;
        let [_, first, second] = &matrix.bands;
        for list in [&mut self.one, &mut self.two, &mut self.inverse] {
            list.clear();
            list.resize(m, 0.0);
        }
        let mut pivots = [0.0; 2];
        for i in 0..m {
            // Row i of the triangle, from the two rows above it.
            let mut pivot = diagonal(i);
            if i >= 2 {
                self.two[i] = second[i - 2] * self.inverse[i - 2];
                pivot -= self.two[i] * self.two[i] * pivots[i % 2];
            }
            if i >= 1 {
                let shared = if i >= 2 { self.two[i] * pivots[i % 2] * self.one[i - 1] } else { 0.0 };
                self.one[i] = (first[i - 1] - shared) * self.inverse[i - 1];
                pivot -= self.one[i] * self.one[i] * pivots[(i + 1) % 2];
            }
            self.inverse[i] = 1.0 / pivot;
            pivots[i % 2] = pivot;
        }
    }

    /// Extracts the columns of the border, and solves them by the band.
    fn solve_border(&mut self, matrix: &CyclicBand) {
        let n = matrix.size();
        let m = n - 2;
        let [_, first, second] = &matrix.bands;
        for (k, raw) in self.raw.iter_mut().enumerate() {
            raw.clear();
            raw.resize(m, 0.0);
            let row = m + k;
            for (band, list) in [(1, first), (2, second)] {
                // Entries above the row, and those that wrap around.
                if let Some(above) = row.checked_sub(band)
                    && above < m
                {
                    raw[above] += list[above];
                }
                let around = row + band;
                if around >= n && around - n < m {
                    raw[around - n] += list[row];
                }
            }
        }
        for k in 0..2 {
            let mut column = std::mem::take(&mut self.border[k]);
            column.clear();
            column.extend_from_slice(&self.raw[k]);
            self.solve_band(&mut column);
            self.border[k] = column;
        }
    }

    /// Inverts the Schur complement of the corner.
    fn factor_corner(&mut self, matrix: &CyclicBand, diagonal: impl Fn(usize) -> f64) {
        let m = matrix.size() - 2;
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let a = diagonal(m) - product(&self.raw[0], &self.border[0]);
        let b = matrix.bands[1][m] - product(&self.raw[0], &self.border[1]);
        let c = diagonal(m + 1) - product(&self.raw[1], &self.border[1]);
        let determinant = a * c - b * b;
        self.corner = [c / determinant, -b / determinant, a / determinant];
    }

    /// Solves for a right-hand side.
    pub(super) fn solve(&self, right: &[f64]) -> Vec<f64> {
        let mut x = right.to_vec();
        self.solve_in_place(&mut x);
        x
    }

    pub(super) fn solve_in_place(&self, x: &mut [f64]) {
        let m = self.inverse.len();
        let (band, tail) = x.split_at_mut(m);
        self.solve_band(band);
        let product = |a: &[f64]| a.iter().zip(band.iter()).map(|(a, b)| a * b).sum::<f64>();
        let rest = [tail[0] - product(&self.raw[0]), tail[1] - product(&self.raw[1])];
        let [a, b, c] = self.corner;
        tail[0] = a * rest[0] + b * rest[1];
        tail[1] = b * rest[0] + c * rest[1];
        for (i, value) in band.iter_mut().enumerate() {
            *value -= self.border[0][i] * tail[0] + self.border[1][i] * tail[1];
        }
    }

    fn solve_band(&self, x: &mut [f64]) {
        let m = x.len();
        for i in 1..m {
            x[i] -= self.one[i] * x[i - 1];
            if i >= 2 {
                x[i] -= self.two[i] * x[i - 2];
            }
        }
        for (value, inverse) in x.iter_mut().zip(&self.inverse) {
            *value *= inverse;
        }
        for i in (0..m).rev() {
            if i + 1 < m {
                x[i] -= self.one[i + 1] * x[i + 1];
            }
            if i + 2 < m {
                x[i] -= self.two[i + 2] * x[i + 2];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn a_solution_solves(
            rows in prop::collection::vec((0.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64), 4..30),
        ) {
            let n = rows.len();
            let mut matrix = CyclicBand::zeros(n);
            // Sums of squares of rows with three entries, as in least squares.
            for (i, &(weight, a, b, c)) in rows.iter().enumerate() {
                matrix.add(i, i, 0.1 + weight);
                let entries = [(i, a), ((i + 1) % n, b), ((i + 2) % n, c)];
                for (k, &(row, left)) in entries.iter().enumerate() {
                    for &(column, right) in &entries[k..] {
                        matrix.add(row, column, left * right);
                    }
                }
            }
            let right: Vec<f64> = rows.iter().map(|row| row.1 + row.3).collect();
            let x = matrix.factor().solve(&right);
            let mut back = vec![0.0; n];
            matrix.multiply(&x, &mut back);
            for (a, b) in back.iter().zip(&right) {
                prop_assert!((a - b).abs() < 1e-8, "{back:?} {right:?}");
            }
        }
    }
}
