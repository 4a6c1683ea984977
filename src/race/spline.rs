use super::banded::CyclicBand;
use super::error::LineError;
use crate::geometry::{Point, Vector, cross};

/// A closed cubic spline through points, parametrised by chord length, with continuous curvature.
///
/// ```
/// use roverlab::race::ClosedSpline;
/// use roverlab::geometry::{Point, direction};
/// let circle: Vec<_> = (0..40).map(|i| Point::origin() + direction(f64::from(i) * std::f64::consts::TAU / 40.0) * 10.0).collect();
/// let spline = ClosedSpline::through(&circle).unwrap();
/// assert!((spline.bending_energy() - std::f64::consts::TAU / 10.0).abs() < 1e-3);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ClosedSpline {
    points: Vec<Point>,
    /// Second derivatives at the points.
    second: Vec<Vector>,
    /// Chord lengths, from each point to the next (m).
    chords: Vec<f64>,
}

/// A point on a spline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SplinePoint {
    /// Position (m).
    pub position: Point,
    /// First derivative; its length is close to 1.
    pub tangent: Vector,
    /// Curvature, positive to the left (1/m).
    pub curvature: f64,
}

/// Maximum number of equidistant points.
const MOST: usize = 1_000_000;

impl ClosedSpline {
    /// The spline through at least four points; the last one is joined to the first. O(n).
    ///
    /// # Errors
    ///
    /// If there are fewer than four points, or adjacent ones coincide.
    pub fn through(points: &[Point]) -> Result<Self, LineError> {
        let n = points.len();
        if n < 4 {
            return Err(LineError::TooFew { found: n, needed: 4 });
        }
        let chords: Vec<f64> = (0..n).map(|i| (points[(i + 1) % n] - points[i]).norm()).collect();
        if let Some(index) = chords.iter().position(|&chord| !(chord > 1e-9 && chord.is_finite())) {
            return Err(LineError::Degenerate { index });
        }
        let mut system = CyclicBand::zeros(n);
        let mut right = vec![[0.0; 2]; n];
        for i in 0..n {
            let (before, after) = ((i + n - 1) % n, (i + 1) % n);
            let (h0, h1) = (chords[before], chords[i]);
            system.add(i, i, (h0 + h1) / 3.0);
            system.add(i, after, h1 / 6.0);
            let bend = (points[after] - points[i]) / h1 - (points[i] - points[before]) / h0;
            right[i] = [bend.x, bend.y];
        }
        let factors = system.factor();
        let solve = |axis: usize| factors.solve(&right.iter().map(|r| r[axis]).collect::<Vec<_>>());
        let (x, y) = (solve(0), solve(1));
        let second = x.into_iter().zip(y).map(|(x, y)| Vector::new(x, y)).collect();
        Ok(Self { points: points.to_vec(), second, chords })
    }

    /// Number of pieces between points.
    pub fn pieces(&self) -> usize {
        self.points.len()
    }

    /// The point at a fraction (0 to 1) of a piece.
    pub fn at(&self, piece: usize, share: f64) -> SplinePoint {
        let n = self.points.len();
        let (i, j) = (piece % n, (piece % n + 1) % n);
        let (h, b) = (self.chords[i], share);
        let a = 1.0 - b;
        let (p, q, m, k) = (self.points[i], self.points[j], self.second[i], self.second[j]);
        let bow = m * ((a * a * a - a) * h * h / 6.0) + k * ((b * b * b - b) * h * h / 6.0);
        let tangent = (q - p) / h - m * ((3.0 * a * a - 1.0) * h / 6.0) + k * ((3.0 * b * b - 1.0) * h / 6.0);
        let bend = m * a + k * b;
        let speed = tangent.norm();
        let position = p + (q - p) * b + bow;
        SplinePoint { position, tangent, curvature: cross(tangent, bend) / (speed * speed * speed) }
    }

    /// Points at equal distances of about `step` metres along the whole loop, equal up to the error of
    /// Simpson's rule; at least 4 and at most a million.
    pub fn resample(&self, step: f64) -> Vec<SplinePoint> {
        self.even(step).map(|(piece, share)| self.at(piece, share)).collect()
    }

    /// The same, as pieces, fractions and positions.
    pub(super) fn resample_with_pieces(&self, step: f64) -> Vec<(usize, f64, Point)> {
        self.even(step).map(|(piece, share)| (piece, share, self.at(piece, share).position)).collect()
    }

    fn even(&self, step: f64) -> impl Iterator<Item = (usize, f64)> {
        let lengths: Vec<f64> = (0..self.pieces()).map(|piece| self.length_to(piece, 1.0)).collect();
        let total: f64 = lengths.iter().sum();
        let count = ((total / step).round() as usize).clamp(4, MOST);
        let spacing = total / count as f64;
        let (mut piece, mut passed) = (0, 0.0);
        (0..count).map(move |index| {
            let wanted = spacing * index as f64;
            while piece + 1 < lengths.len() && passed + lengths[piece] <= wanted {
                passed += lengths[piece];
                piece += 1;
            }
            (piece, self.share_at(piece, wanted - passed))
        })
    }

    /// Length of the loop (m).
    pub fn length(&self) -> f64 {
        (0..self.pieces()).map(|piece| self.length_to(piece, 1.0)).sum()
    }

    /// Bending energy: integral of the squared curvature (1/m), by Simpson's rule with eight intervals per
    /// piece.
    pub fn bending_energy(&self) -> f64 {
        const PARTS: usize = 8;
        let integrand = |piece, share| {
            let place = self.at(piece, share);
            place.curvature * place.curvature * place.tangent.norm()
        };
        (0..self.pieces())
            .map(|piece| {
                let sum: f64 = (0..=PARTS)
                    .map(|k| {
                        let weight =
                            if k == 0 || k == PARTS { 1.0 } else { f64::from(2 + 2 * (k as u32 % 2)) };
                        weight * integrand(piece, k as f64 / PARTS as f64)
                    })
                    .sum();
                sum * self.chords[piece] / (3.0 * PARTS as f64)
            })
            .sum()
    }

    /// Arc length from the start of a piece to a fraction of it (m).
    fn length_to(&self, piece: usize, share: f64) -> f64 {
        const PARTS: usize = 4;
        let speed = |k: usize| self.at(piece, share * k as f64 / PARTS as f64).tangent.norm();
        let sum = speed(0) + 4.0 * (speed(1) + speed(3)) + 2.0 * speed(2) + speed(4);
        sum * self.chords[piece] * share / (3.0 * PARTS as f64)
    }

    /// The fraction of a piece at an arc length.
    fn share_at(&self, piece: usize, length: f64) -> f64 {
        let mut share = length / self.chords[piece];
        for _ in 0..4 {
            let speed = self.at(piece, share).tangent.norm() * self.chords[piece];
            share -= (self.length_to(piece, share) - length) / speed;
        }
        share.clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::direction;
    use proptest::prelude::*;
    use std::f64::consts::TAU;

    fn ellipse(n: u32, a: f64, b: f64) -> Vec<Point> {
        (0..n)
            .map(|i| {
                let unit = direction(TAU * f64::from(i) / f64::from(n));
                Point::new(a * unit.x, b * unit.y)
            })
            .collect()
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn it_goes_through_its_points_smoothly(a in 5.0..50.0f64, b in 5.0..50.0f64, n in 8_u32..40) {
            let points = ellipse(n, a, b);
            let spline = ClosedSpline::through(&points).unwrap();
            for (i, point) in points.iter().enumerate() {
                let (end, begin) = (spline.at((i + points.len() - 1) % points.len(), 1.0), spline.at(i, 0.0));
                prop_assert!((begin.position - point).norm() < 1e-9 && (end.position - point).norm() < 1e-9);
                prop_assert!((begin.tangent - end.tangent).norm() < 1e-9);
                prop_assert!((begin.curvature - end.curvature).abs() < 1e-9);
            }
        }

        #[test]
        fn even_steps_are_even(a in 10.0..40.0f64, b in 10.0..40.0f64) {
            let spline = ClosedSpline::through(&ellipse(60, a, b)).unwrap();
            let places = spline.resample(0.1);
            let gaps: Vec<f64> =
                (0..places.len()).map(|i| (places[(i + 1) % places.len()].position - places[i].position).norm()).collect();
            let mean = spline.length() / gaps.len() as f64;
            prop_assert!(gaps.iter().all(|gap| (gap / mean - 1.0).abs() < 1e-3), "{gaps:?}");
        }
    }

    #[test]
    fn the_energy_of_a_circle() {
        for radius in [3.0, 25.0] {
            let spline = ClosedSpline::through(&ellipse(100, radius, radius)).unwrap();
            assert!((spline.bending_energy() * radius / TAU - 1.0).abs() < 1e-6);
            assert!((spline.length() / (TAU * radius) - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn points_that_are_none() {
        let mut points = ellipse(10, 3.0, 3.0);
        points[3] = points[2];
        assert_eq!(ClosedSpline::through(&points), Err(LineError::Degenerate { index: 2 }));
        points[3] = Point::new(f64::NAN, 0.0);
        assert_eq!(ClosedSpline::through(&points), Err(LineError::Degenerate { index: 2 }));
        assert_eq!(ClosedSpline::through(&points[..3]), Err(LineError::TooFew { found: 3, needed: 4 }));
    }
}
