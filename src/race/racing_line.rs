use super::banded::CyclicBand;
use super::box_qp::BoxSolver;
use super::corridor::{Corridor, CrossSection};
use super::error::LineError;
use crate::ParameterError;
use crate::geometry::{Point, cross};
use crate::parameter::{require_finite, require_not_negative, require_positive};

/// Parameters of the racing line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RacingLineParameters {
    /// Distance from both edges (m): half the car's width, plus a reserve for control errors.
    pub margin: f64,
    /// Maximum number of quadratic programs.
    pub iterations: usize,
    /// Displacement of all points below which the search ends (m).
    pub tolerance: f64,
}

impl Default for RacingLineParameters {
    fn default() -> Self {
        Self { margin: 1.0, iterations: 30, tolerance: 0.01 }
    }
}

impl RacingLineParameters {
    /// Checks the parameters.
    ///
    /// # Errors
    ///
    /// If one is out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        require_not_negative("margin", self.margin)?;
        require_positive("tolerance", self.tolerance)
    }
}

/// A closed line within a corridor.
#[derive(Debug, Clone, PartialEq)]
pub struct RacingLine {
    /// One point per station.
    pub points: Vec<Point>,
    /// Offset of each point from the centre line, positive to the left (m).
    pub offsets: Vec<f64>,
    /// Bending energy: integral of the squared curvature (1/m).
    pub bending_energy: f64,
    /// Number of quadratic programs solved.
    pub iterations: usize,
}

/// Minimum-curvature line within a closed corridor: the one with the least integral of the squared curvature.
///
/// The variables are the offsets from the centre line. The curvature at each point, that of the circle
/// through it and its neighbours, is linearised about the present line; the resulting quadratic program with
/// bounds takes O(n). Its solution is the next line, or as much of the step as improves the line. The method
/// follows F. Braghin et al., "Race driver model", 2008, and A. Heilmeier et al., "Minimum curvature
/// trajectory planning and control for an autonomous race car", 2020, with the exact curvature instead of
/// that of a spline.
///
/// ```
/// use roverlab::race::{Corridor, RacingLineParameters, minimum_curvature};
/// use roverlab::geometry::{Point, direction};
/// // On a ring, the best line is its outer edge.
/// let ring: Vec<_> =
///     (0..90).map(|i| (Point::origin() + direction(f64::from(i) * 0.0698) * 20.0, 2.0, 3.0)).collect();
/// let line = minimum_curvature(&Corridor::closed(&ring)?, &RacingLineParameters::default())?;
/// assert!(line.offsets.iter().all(|offset| (offset + 2.0).abs() < 0.05));
/// # Ok::<(), roverlab::race::LineError>(())
/// ```
///
/// # Errors
///
/// If the corridor is open, has fewer than five stations, or is narrower than two margins.
pub fn minimum_curvature(
    corridor: &Corridor,
    parameters: &RacingLineParameters,
) -> Result<RacingLine, LineError> {
    LineSolver::default().solve(corridor, parameters)
}

/// Computes racing lines one after another, reusing its buffers.
#[derive(Debug, Clone, Default)]
pub struct LineSolver {
    qp: BoxSolver,
}

impl LineSolver {
    /// As [`minimum_curvature`].
    ///
    /// # Errors
    ///
    /// As for [`minimum_curvature`].
    pub fn solve(
        &mut self,
        corridor: &Corridor,
        parameters: &RacingLineParameters,
    ) -> Result<RacingLine, LineError> {
        parameters.validate()?;
        check(corridor)?;
        Ok(self.solve_within(corridor, &corridor.free(parameters.margin)?, parameters))
    }

    /// The room that a car with an outline needs to the right and to the left of its line: in a bend, its
    /// nose needs more outside, its tail inside.
    pub(super) fn margins_for(
        &mut self,
        corridor: &Corridor,
        outline: &CarOutline,
        parameters: &RacingLineParameters,
    ) -> Result<Vec<[f64; 2]>, LineError> {
        check(corridor)?;
        let n = corridor.stations().len();
        let mut margins = vec![outline.sides(0.0); n];
        for _ in 0..BENDS {
            let rough = self.solve_within(corridor, &corridor.room(&margins), parameters);
            let bends = bends(&rough.points);
            margins = bends.iter().map(|bend| outline.sides(*bend)).collect();
        }
        Ok(margins)
    }

    /// The line within ranges of offsets.
    pub(super) fn solve_within(
        &mut self,
        corridor: &Corridor,
        free: &[[f64; 2]],
        parameters: &RacingLineParameters,
    ) -> RacingLine {
        self.solve_from(corridor, free, &vec![0.0; free.len()], parameters)
    }

    /// The same, searched from other offsets than those of the centre line.
    pub(super) fn solve_from(
        &mut self,
        corridor: &Corridor,
        free: &[[f64; 2]],
        first: &[f64],
        parameters: &RacingLineParameters,
    ) -> RacingLine {
        let stations = corridor.stations();
        let n = stations.len();
        let bounded = first.iter().zip(free);
        let mut offsets: Vec<f64> = bounded.map(|(first, [low, high])| first.clamp(*low, *high)).collect();
        let mut energy = energy(stations, &offsets);
        let (mut wanted, mut trial) = (vec![0.0; n], vec![0.0; n]);
        let mut iterations = 0;
        for _ in 0..parameters.iterations {
            iterations += 1;
            self.linear_step(stations, &offsets, free, &mut wanted);
            let Some(share) = improve(stations, free, &mut offsets, &wanted, &mut trial, &mut energy) else {
                break;
            };
            let moved = wanted.iter().fold(0.0_f64, |most, step| most.max(step.abs()));
            if moved * share < parameters.tolerance {
                break;
            }
        }
        let points = stations.iter().zip(&offsets).map(|(station, &offset)| station.aside(offset)).collect();
        RacingLine { points, offsets, bending_energy: energy, iterations }
    }

    /// Solves the linearised problem for the change of the offsets.
    fn linear_step(
        &mut self,
        stations: &[CrossSection],
        offsets: &[f64],
        free: &[[f64; 2]],
        step: &mut [f64],
    ) {
        /// Step of a central difference.
        const H: f64 = 1e-4;
        let n = stations.len();
        let mut matrix = CyclicBand::zeros(n);
        let mut gradient = vec![0.0; n];
        for i in 0..n {
            let places = [(i + n - 1) % n, i, (i + 1) % n];
            let points = places.map(|k| stations[k].aside(offsets[k]));
            let here = residual(points);
            let slopes: [f64; 3] = std::array::from_fn(|k| {
                let [mut up, mut down] = [points; 2];
                up[k] += stations[places[k]].normal * H;
                down[k] -= stations[places[k]].normal * H;
                (residual(up) - residual(down)) / (2.0 * H)
            });
            for (k, &row) in places.iter().enumerate() {
                gradient[row] += slopes[k] * here;
                for (&column, slope) in places[k..].iter().zip(&slopes[k..]) {
                    matrix.add(row, column, slopes[k] * slope);
                }
            }
        }
        // A tiny regularisation that matters only where nothing else decides.
        for i in 0..n {
            matrix.add(i, i, 1e-9);
        }
        let room = |i: usize, bound: usize| free[i][bound] - offsets[i];
        let low: Vec<f64> = (0..n).map(|i| room(i, 0).min(-1e-9)).collect();
        let high: Vec<f64> = (0..n).map(|i| room(i, 1).max(1e-9)).collect();
        self.qp.solve(&matrix, &gradient, &low, &high, step);
    }
}

/// Number of rounds of lines, each with the margins that the car needs along the previous one.
const BENDS: usize = 2;

fn check(corridor: &Corridor) -> Result<(), LineError> {
    let n = if corridor.is_closed() { corridor.stations().len() } else { 0 };
    if n < 5 { Err(LineError::TooFew { found: n, needed: 5 }) } else { Ok(()) }
}

/// Curvature at each point of a loop, averaged with its neighbours.
fn bends(points: &[Point]) -> Vec<f64> {
    let n = points.len();
    let own: Vec<f64> =
        (0..n).map(|i| curvature([points[(i + n - 1) % n], points[i], points[(i + 1) % n]])).collect();
    (0..n).map(|i| (own[(i + n - 1) % n] + own[i] + own[(i + 1) % n]) / 3.0).collect()
}

/// Outline of a car relative to the point that is kept on the line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CarOutline {
    /// Half its width (m).
    pub half_width: f64,
    /// Distance from the rear axle to the nose (m).
    pub nose: f64,
    /// Distance from the rear axle to the point on the line (m).
    pub ahead: f64,
    /// Lateral clearance to the centre of cones (m): half the foot of a cone, plus errors of control and map.
    pub room: f64,
}

impl CarOutline {
    /// Checks the outline.
    ///
    /// # Errors
    ///
    /// If a number is out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        require_positive("half width", self.half_width)?;
        require_finite("nose", self.nose)?;
        require_finite("ahead", self.ahead)?;
        require_not_negative("room", self.room)
    }

    /// Room required to the right and to the left of the line at a curvature (m).
    ///
    /// The rear axle runs on a smaller circle than the point ahead of it, the nose on a larger one.
    fn sides(&self, curvature: f64) -> [f64; 2] {
        let bend = curvature.abs();
        let straight = self.half_width + self.room;
        if bend < 1e-3 {
            return [straight; 2];
        }
        let radius = (1.0 / bend).max(self.ahead + self.half_width);
        let rear = (radius * radius - self.ahead * self.ahead).sqrt();
        let inner = radius - rear + straight;
        let outer = crate::geometry::math::hypot(rear + self.half_width, self.nose) - radius + self.room;
        if curvature > 0.0 { [outer, inner] } else { [inner, outer] }
    }
}

/// Backtracking line search: applies the step, or a half, a quarter, ... of it. Returns the fraction; `None`
/// if none improves the energy.
fn improve(
    stations: &[CrossSection],
    free: &[[f64; 2]],
    offsets: &mut [f64],
    step: &[f64],
    trial: &mut [f64],
    best: &mut f64,
) -> Option<f64> {
    let mut share = 1.0;
    for _ in 0..8 {
        for (i, value) in trial.iter_mut().enumerate() {
            *value = (offsets[i] + share * step[i]).clamp(free[i][0], free[i][1]);
        }
        let energy = energy(stations, trial);
        if energy < *best {
            *best = energy;
            offsets.copy_from_slice(trial);
            return Some(share);
        }
        share *= 0.5;
    }
    None
}

/// Curvature of the circle through three points, positive to the left (1/m).
pub(super) fn curvature([a, b, c]: [Point; 3]) -> f64 {
    let (p, q, r) = (b - a, c - b, c - a);
    2.0 * cross(p, q) / (p.norm_squared() * q.norm_squared() * r.norm_squared()).sqrt()
}

/// Curvature times the square root of its length element.
fn residual(points: [Point; 3]) -> f64 {
    let [a, b, c] = points;
    let length = 0.5 * ((b - a).norm() + (c - b).norm());
    curvature(points) * length.sqrt()
}

fn energy(stations: &[CrossSection], offsets: &[f64]) -> f64 {
    let n = stations.len();
    let at = |i: usize| stations[i % n].aside(offsets[i % n]);
    let sum = |i: usize| residual([at(i + n - 1), at(i), at(i + 1)]);
    (0..n).map(|i| sum(i) * sum(i)).sum()
}

#[cfg(test)]
mod tests;
