use super::banded::CyclicBand;
use super::box_qp::BoxSolver;
use super::corridor::{Corridor, CrossSection};
use super::error::LineError;
use crate::ParameterError;
use crate::geometry::{Point, cross};
use crate::parameter::{require_finite, require_not_negative, require_positive};

/// How a racing line is found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RacingLineParameters {
    /// Metres that the line keeps from both edges: half the car's width, and what its controller needs.
    pub margin: f64,
    /// Quadratic programs that are solved at most.
    pub iterations: usize,
    /// The search ends when no point moves farther than so many metres.
    pub tolerance: f64,
}

impl Default for RacingLineParameters {
    fn default() -> Self {
        Self { margin: 1.0, iterations: 30, tolerance: 0.01 }
    }
}

impl RacingLineParameters {
    /// Fails with the name of the parameter that is out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        require_not_negative("margin", self.margin)?;
        require_positive("tolerance", self.tolerance)
    }
}

/// A closed line within a corridor.
#[derive(Debug, Clone, PartialEq)]
pub struct RacingLine {
    /// One point for each station.
    pub points: Vec<Point>,
    /// Metres from the centre line to the point, positive to the left.
    pub offsets: Vec<f64>,
    /// The sum of squared curvature times length, in 1/m.
    pub bending_energy: f64,
    /// Quadratic programs that were solved.
    pub iterations: usize,
}

/// The line of least curvature within a closed corridor: that with the least integral of the squared curvature over its
/// length.
///
/// The offsets from the centre line are the variables. The curvature at each point, that of the circle through it and its
/// neighbours, is made linear around the present line; what results is a quadratic program with bounds, which is solved
/// with O(n) work; its answer is the next line, or as much of the way to it as makes the line better (the method is that
/// of F. Braghin et al., "Race driver model", 2008, and A. Heilmeier et al., "Minimum curvature trajectory planning and
/// control for an autonomous race car", 2020, with the exact curvature in the place of that of a spline).
///
/// Fails where the corridor is narrower than two margins.
///
/// ```
/// use roverlab::race::{Corridor, RacingLineParameters, minimum_curvature};
/// use roverlab::geometry::{Point, direction};
/// // On a ring the best line is its outer edge.
/// let ring: Vec<_> =
///     (0..90).map(|i| (Point::origin() + direction(f64::from(i) * 0.0698) * 20.0, 2.0, 3.0)).collect();
/// let line = minimum_curvature(&Corridor::closed(&ring)?, &RacingLineParameters::default())?;
/// assert!(line.offsets.iter().all(|offset| (offset + 2.0).abs() < 0.05));
/// # Ok::<(), roverlab::race::LineError>(())
/// ```
pub fn minimum_curvature(
    corridor: &Corridor,
    parameters: &RacingLineParameters,
) -> Result<RacingLine, LineError> {
    LineSolver::default().solve(corridor, parameters)
}

/// Solves for one racing line after the other with the same memory.
#[derive(Debug, Clone, Default)]
pub struct LineSolver {
    qp: BoxSolver,
}

impl LineSolver {
    /// What [`minimum_curvature`] answers.
    pub fn solve(
        &mut self,
        corridor: &Corridor,
        parameters: &RacingLineParameters,
    ) -> Result<RacingLine, LineError> {
        parameters.validate()?;
        check(corridor)?;
        Ok(self.solve_within(corridor, &corridor.free(parameters.margin)?, parameters))
    }

    /// The line for a car of some outline: in a bend, its nose needs more room outside, and its tail inside. Where a track is too
    /// narrow, the car goes through in the middle.
    pub(super) fn solve_for(
        &mut self,
        corridor: &Corridor,
        outline: &CarOutline,
        parameters: &RacingLineParameters,
    ) -> Result<RacingLine, LineError> {
        check(corridor)?;
        let n = corridor.stations().len();
        let mut margins = vec![outline.sides(0.0); n];
        for _ in 0..BENDS {
            let rough = self.solve_within(corridor, &corridor.room(&margins), parameters);
            let bends = bends(&rough.points);
            margins = bends.iter().map(|bend| outline.sides(*bend)).collect();
        }
        Ok(self.solve_within(corridor, &corridor.room(&margins), parameters))
    }

    fn solve_within(
        &mut self,
        corridor: &Corridor,
        free: &[[f64; 2]],
        parameters: &RacingLineParameters,
    ) -> RacingLine {
        let stations = corridor.stations();
        let n = stations.len();
        let mut offsets: Vec<f64> = free.iter().map(|[low, high]| 0.0_f64.clamp(*low, *high)).collect();
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

    /// The change of the offsets that is best for the linear model.
    fn linear_step(
        &mut self,
        stations: &[CrossSection],
        offsets: &[f64],
        free: &[[f64; 2]],
        step: &mut [f64],
    ) {
        /// The step of a central difference.
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
        // The energy is in 1/m and the entries are near 1/m³: so little that it decides only where nothing else does.
        for i in 0..n {
            matrix.add(i, i, 1e-9);
        }
        let room = |i: usize, bound: usize| free[i][bound] - offsets[i];
        let low: Vec<f64> = (0..n).map(|i| room(i, 0).min(-1e-9)).collect();
        let high: Vec<f64> = (0..n).map(|i| room(i, 1).max(1e-9)).collect();
        self.qp.solve(&matrix, &gradient, &low, &high, step);
    }
}

/// Rounds of lines and of the margins that a car needs along them.
const BENDS: usize = 2;

fn check(corridor: &Corridor) -> Result<(), LineError> {
    let n = if corridor.is_closed() { corridor.stations().len() } else { 0 };
    if n < 5 { Err(LineError::TooFew { found: n, needed: 5 }) } else { Ok(()) }
}

/// The curvature at each point of a loop, in the mean with its neighbours.
fn bends(points: &[Point]) -> Vec<f64> {
    let n = points.len();
    let own: Vec<f64> =
        (0..n).map(|i| curvature([points[(i + n - 1) % n], points[i], points[(i + 1) % n]])).collect();
    (0..n).map(|i| (own[(i + n - 1) % n] + own[i] + own[(i + 1) % n]) / 3.0).collect()
}

/// The outline of a car around the point of it that is kept on a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CarOutline {
    /// Half its width, in metres.
    pub half_width: f64,
    /// Metres from the rear axle to its nose.
    pub nose: f64,
    /// Metres from the rear axle to the point on the line.
    pub ahead: f64,
    /// Metres to the middle of cones that are left over beside it: half the foot of a cone, and what controller and map are wrong
    /// by.
    pub room: f64,
}

impl CarOutline {
    /// Fails with the name of the number that is out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        require_positive("half width", self.half_width)?;
        require_finite("nose", self.nose)?;
        require_finite("ahead", self.ahead)?;
        require_not_negative("room", self.room)
    }

    /// Metres that it needs to the right and to the left of its line, for a curvature of that.
    ///
    /// Its rear axle rolls on a smaller circle than the point ahead of it, its nose on a larger one.
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

/// Goes along a step as far as the energy falls: all the way, or a half, a quarter, ... The share; `None` if nowhere.
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

/// The curvature of the circle through three points, positive to the left.
pub(super) fn curvature([a, b, c]: [Point; 3]) -> f64 {
    let (p, q, r) = (b - a, c - b, c - a);
    2.0 * cross(p, q) / (p.norm_squared() * q.norm_squared() * r.norm_squared()).sqrt()
}

/// The curvature times the root of the length that it stands for.
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
