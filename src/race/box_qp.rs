//! Quadratic programs with a banded matrix and box constraints.

use super::banded::{CyclicBand, Factors};

/// Buffers reused between programs.
#[derive(Debug, Clone, Default)]
pub(super) struct BoxSolver {
    factors: Factors,
    diagonal: Vec<f64>,
    gradient: Vec<f64>,
    step: Vec<f64>,
    lower: Vec<f64>,
    upper: Vec<f64>,
}

/// Maximum number of iterations.
const ITERATIONS: usize = 40;

impl BoxSolver {
    /// Minimises `½ xᵀHx + gᵀx` for `x` between `low` and `high`, by a primal-dual interior point method (S.
    /// Mehrotra, "On the implementation of a primal-dual interior point method", 1992). O(n) per iteration,
    /// typically ten to twenty iterations. Requires `low[i] < high[i]` and a positive definite `H`.
    pub(super) fn solve(&mut self, h: &CyclicBand, g: &[f64], low: &[f64], high: &[f64], x: &mut [f64]) {
        let n = x.len();
        let scale = g.iter().fold(1e-12_f64, |most, g| most.max(g.abs()));
        for (i, value) in x.iter_mut().enumerate() {
            *value = 0.5 * (low[i] + high[i]);
        }
        for list in [&mut self.diagonal, &mut self.gradient, &mut self.step] {
            list.clear();
            list.resize(n, 0.0);
        }
        for list in [&mut self.lower, &mut self.upper] {
            list.clear();
            list.resize(n, scale);
        }
        let mut centring = 0.1;
        for _ in 0..ITERATIONS {
            h.multiply(x, &mut self.gradient);
            let mut gap = 0.0;
            let mut residual = 0.0_f64;
            for i in 0..n {
                self.gradient[i] += g[i];
                gap += self.lower[i] * (x[i] - low[i]) + self.upper[i] * (high[i] - x[i]);
                residual = residual.max((self.gradient[i] - self.lower[i] + self.upper[i]).abs());
            }
            let mean = gap / (2 * n) as f64;
            if mean < 1e-9 * scale && residual < 1e-7 * scale {
                break;
            }
            let target = centring * mean;
            for i in 0..n {
                let (below, above) = (x[i] - low[i], high[i] - x[i]);
                self.diagonal[i] = self.lower[i] / below + self.upper[i] / above;
                self.step[i] = -self.gradient[i] + target / below - target / above;
            }
            self.factors.refactor(h, Some(&self.diagonal));
            self.factors.solve_in_place(&mut self.step);
            let longest = self.advance(low, high, x, target);
            // After a shortened step, centre more.
            centring = if longest > 0.9 {
                0.05
            } else if longest > 0.5 {
                0.2
            } else {
                0.5
            };
        }
    }

    /// Moves along the step while all variables stay positive. Returns the step length, 0 to 1.
    fn advance(&mut self, low: &[f64], high: &[f64], x: &mut [f64], target: f64) -> f64 {
        /// Fraction of the step to the boundary that is taken, so that all variables stay positive.
        const NEARLY: f64 = 0.995;
        let (mut primal, mut dual) = (1.0_f64, 1.0_f64);
        let moved =
            |multiplier: f64, room: f64, change: f64| target / room - multiplier - multiplier * change / room;
        for i in 0..x.len() {
            let (step, below, above) = (self.step[i], x[i] - low[i], high[i] - x[i]);
            if step < 0.0 {
                primal = primal.min(-NEARLY * below / step);
            } else if step > 0.0 {
                primal = primal.min(NEARLY * above / step);
            }
            for (multiplier, change) in [
                (self.lower[i], moved(self.lower[i], below, step)),
                (self.upper[i], moved(self.upper[i], above, -step)),
            ] {
                if change < 0.0 {
                    dual = dual.min(-NEARLY * multiplier / change);
                }
            }
        }
        for i in 0..x.len() {
            let (step, below, above) = (self.step[i], x[i] - low[i], high[i] - x[i]);
            self.lower[i] += dual * moved(self.lower[i], below, step);
            self.upper[i] += dual * moved(self.upper[i], above, -step);
            // Rounding must not put it onto a bound.
            let margin = 1e-12 * (high[i] - low[i]);
            x[i] = (x[i] + primal * step).clamp(low[i] + margin, high[i] - margin);
        }
        primal.min(dual)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        /// Karush-Kuhn-Tucker conditions: the gradient is zero inside, and points outwards at a bound.
        #[test]
        fn nothing_better_is_near(
            rows in prop::collection::vec((-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64, -2.0..2.0f64, 0.05..3.0f64), 5..60),
        ) {
            let n = rows.len();
            let mut h = CyclicBand::zeros(n);
            for (i, row) in rows.iter().enumerate() {
                h.add(i, i, 0.01);
                let entries = [(i, row.0), ((i + 1) % n, row.1), ((i + 2) % n, row.2)];
                for (k, &(a, left)) in entries.iter().enumerate() {
                    for &(b, right) in &entries[k..] {
                        h.add(a, b, left * right);
                    }
                }
            }
            let g: Vec<f64> = rows.iter().map(|row| row.3).collect();
            let high: Vec<f64> = rows.iter().map(|row| row.4).collect();
            let low: Vec<f64> = rows.iter().map(|row| -1.5 * row.4).collect();
            let mut x = vec![0.0; n];
            BoxSolver::default().solve(&h, &g, &low, &high, &mut x);
            let mut gradient = vec![0.0; n];
            h.multiply(&x, &mut gradient);
            for i in 0..n {
                let slope = gradient[i] + g[i];
                prop_assert!(x[i] >= low[i] && x[i] <= high[i]);
                let (below, above) = (x[i] - low[i], high[i] - x[i]);
                prop_assert!(slope * below < 1e-6, "{i}: {slope} at {} in {}..{}", x[i], low[i], high[i]);
                prop_assert!(-slope * above < 1e-6, "{i}: {slope} at {} in {}..{}", x[i], low[i], high[i]);
            }
        }
    }
}
