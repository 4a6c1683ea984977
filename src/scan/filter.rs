use std::f64::consts::TAU;

use crate::geometry::{Point, Pose, direction, math};
use crate::io::{Error, LidarScan, Result};
use crate::kinematics::OUTLIER;

/// Removes noise from consecutive lidar scans of a moving robot.
///
/// Each beam carries an estimate of its range. With every scan, the estimates are moved by the robot's own
/// motion, which between two scans is known far better than a single range, and then averaged with the new
/// readings. A reading that does not fit its prediction, because something came into view or left it,
/// restarts its beam. After some scans the noise is a fraction of the sensor's, without the blur of an
/// average over time or neighbours.
///
/// ```
/// use roverlab::geometry::Pose;
/// use roverlab::io::LidarScan;
/// use roverlab::scan::ScanFilter;
/// let mut scan = LidarScan { range_max: 5.0, angle_increment: 1_f64.to_radians(), ..LidarScan::default() };
/// let mut filter = ScanFilter::new();
/// for turn in 0..50 {
///     // A round room of 2 m radius, measured 1 cm too long and 1 cm too short in turns.
///     scan.ranges = vec![if turn % 2 == 0 { 2.01 } else { 1.99 }; 360];
///     filter.update(Pose::default(), &scan)?;
/// }
/// assert!(filter.ranges().all(|range| (range - 2.0).abs() < 0.008));
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct ScanFilter {
    beams: Vec<Beam>,
    predicted: Vec<Beam>,
    directions: Vec<(f64, f64)>,
    angle_min: f64,
    angle_increment: f64,
    mount: Pose,
    pose: Pose,
    noise: f64,
    scratch: Vec<f64>,
}

/// Estimate of one beam.
#[derive(Debug, Clone, Copy)]
struct Beam {
    range: f64,
    /// Number of readings in the estimate; 0 if there is none.
    weight: f64,
}

/// The standard deviation of a range, in metres, that is expected before anything was measured: that of an
/// EyeBot's lidar.
pub(super) const RANGE_ERROR: f64 = 0.010;
/// A beam without a return.
const UNKNOWN: Beam = Beam { range: f64::INFINITY, weight: 0.0 };
/// Maximum weight of an estimate, so that it follows small changes.
const MAX_WEIGHT: f64 = 20.0;
/// Minimum angle between beam and wall at which a beam locates the wall (rad).
pub(super) const GRAZING: f64 = 0.2;
/// Beams next to each other whose ranges differ by less than this part of the range see one surface.
pub(super) const SURFACE_STEP: f64 = 0.1;
/// Distance between hits up to which beams see the same piece of surface (m); on an oblique surface,
/// consecutive hits are this far apart.
const SMOOTHING_ARC: f64 = 0.015;
/// Maximum number of averaged neighbours on either side.
const MAX_SMOOTHING: usize = 10;

impl Default for ScanFilter {
    fn default() -> Self {
        Self::new()
    }
}

impl ScanFilter {
    /// A filter without scans. It estimates the sensor's noise itself.
    pub fn new() -> Self {
        Self {
            beams: Vec::new(),
            predicted: Vec::new(),
            directions: Vec::new(),
            angle_min: 0.0,
            angle_increment: 0.0,
            mount: Pose::default(),
            pose: Pose::default(),
            noise: RANGE_ERROR,
            scratch: Vec::new(),
        }
    }

    /// Takes a scan made at `pose`, by odometry or better. A change of the number of beams restarts the
    /// filter.
    ///
    /// # Errors
    ///
    /// If the scan does not cover a full turn with at least 36 beams.
    pub fn update(&mut self, pose: Pose, scan: &LidarScan) -> Result<()> {
        check(scan)?;
        if self.beams.len() == scan.ranges.len() {
            self.predict(pose);
        } else {
            self.restart(scan);
        }
        self.pose = pose;
        self.correct(&scan.ranges);
        Ok(())
    }

    /// Estimated range of every beam (m), infinite without an echo.
    pub fn ranges(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        (0..self.beams.len()).map(|i| self.smoothed(i))
    }

    /// Estimated hits in the robot frame.
    pub fn points(&self) -> impl Iterator<Item = Point> + '_ {
        let origin = self.mount.position();
        self.ranges()
            .zip(&self.directions)
            .filter(|(range, _)| range.is_finite())
            .map(move |(range, &(cos, sin))| Point::new(origin.x + range * cos, origin.y + range * sin))
    }

    /// Estimated standard deviation of the sensor's ranges (m).
    pub fn noise(&self) -> f64 {
        self.noise
    }

    fn restart(&mut self, scan: &LidarScan) {
        self.angle_min = scan.angle_min;
        self.angle_increment = scan.angle_increment;
        self.mount = scan.mount;
        self.beams = vec![UNKNOWN; scan.ranges.len()];
        self.directions = (0..scan.ranges.len())
            .map(|i| {
                let d = direction(scan.mount.heading + scan.angle(i));
                (d.x, d.y)
            })
            .collect();
    }

    /// Moves the estimates to the new pose.
    fn predict(&mut self, pose: Pose) {
        let before = self.pose.compose(&self.mount);
        let now = pose.compose(&self.mount);
        let motion = now.inverse().compose(&before);
        let (sin, cos) = math::sin_cos(motion.heading);
        self.predicted.clear();
        self.predicted.resize(self.beams.len(), UNKNOWN);
        for i in 0..self.beams.len() {
            let Beam { range, weight } = self.beams[i];
            if weight == 0.0 || !range.is_finite() {
                continue;
            }
            let (along, across) = self.local_direction(i);
            let x = motion.x + range * (cos * along - sin * across);
            let y = motion.y + range * (sin * along + cos * across);
            let seen = math::hypot(x, y);
            let bearing = (math::atan2(y, x) - self.angle_min) / self.angle_increment;
            let bearing = within_turn(bearing, self.beams.len() as f64);
            // Rounded half up; `round` may be a function call on generic processors.
            let whole = bearing as usize;
            let nearest = whole + usize::from(bearing - whole as f64 >= 0.5);
            let target = if nearest < self.beams.len() { nearest } else { 0 };
            // Correct for the moved point missing the beam's direction by up to half a beam.
            let range = seen + self.slope(i) * (nearest as f64 - bearing);
            self.predicted[target] = merge(self.predicted[target], Beam { range, weight });
        }
        std::mem::swap(&mut self.beams, &mut self.predicted);
        self.fill_gaps();
    }

    /// The beam `steps` before another one; at most a full turn.
    fn before(&self, index: usize, steps: usize) -> Beam {
        self.beams[if index >= steps { index - steps } else { index + self.beams.len() - steps }]
    }

    /// The beam `steps` after another one; at most a full turn.
    fn after(&self, index: usize, steps: usize) -> Beam {
        let (to, n) = (index + steps, self.beams.len());
        self.beams[if to < n { to } else { to - n }]
    }

    /// Fills single gaps: an approaching surface spreads over more beams.
    fn fill_gaps(&mut self) {
        let n = self.beams.len();
        for i in 0..n {
            let (before, after) = (self.before(i, 1), self.after(i, 1));
            let apart = (after.range - before.range).abs();
            if self.beams[i].weight == 0.0 && before.weight > 0.0 && apart < SURFACE_STEP * before.range {
                let weight = before.weight.min(after.weight);
                self.beams[i] = Beam { range: 0.5 * (before.range + after.range), weight };
            }
        }
    }

    /// Direction of a beam in the sensor frame.
    fn local_direction(&self, index: usize) -> (f64, f64) {
        let (x, y) = self.directions[index];
        if self.mount.heading == 0.0 {
            return (x, y);
        }
        let (sin, cos) = math::sin_cos(self.mount.heading);
        (cos * x + sin * y, cos * y - sin * x)
    }

    /// Change of the range per beam on the surface that a beam sees.
    fn slope(&self, index: usize) -> f64 {
        let (before, after) = (self.before(index, 1).range, self.after(index, 1).range);
        let slope = 0.5 * (after - before);
        let here = self.beams[index].range;
        // No slope across an edge between surfaces.
        if slope.abs() < 0.1 * here && (before + after - 2.0 * here).abs() < 0.05 * here {
            slope
        } else {
            0.0
        }
    }

    fn correct(&mut self, ranges: &[f64]) {
        let gate = (OUTLIER * self.noise).max(SMOOTHING_ARC);
        self.scratch.clear();
        for (beam, &reading) in self.beams.iter_mut().zip(ranges) {
            let surprise = reading - beam.range;
            if beam.weight == 0.0 || surprise.is_nan() || surprise.abs() > gate {
                let weight = if reading.is_finite() { 1.0 } else { 0.0 };
                *beam = Beam { range: if reading.is_nan() { f64::INFINITY } else { reading }, weight };
                continue;
            }
            // A prediction from many readings is nearly exact, so the innovation is the reading's noise.
            if beam.weight >= 4.0 {
                self.scratch.push(surprise.abs());
            }
            beam.weight = (beam.weight + 1.0).min(MAX_WEIGHT);
            beam.range += surprise / beam.weight;
        }
        self.learn_noise();
    }

    /// Updates the estimate of the sensor's noise by this scan.
    fn learn_noise(&mut self) {
        let n = self.scratch.len();
        if n < 20 {
            return;
        }
        let (_, median, _) = self.scratch.select_nth_unstable_by(n / 2, f64::total_cmp);
        // The median absolute deviation of a normal distribution is 0.6745 standard deviations.
        let observed = *median / 0.6745;
        self.noise += 0.1 * (observed - self.noise);
    }

    /// Estimate of a beam, averaged with neighbours on the same piece of surface.
    fn smoothed(&self, index: usize) -> f64 {
        let here = self.beams[index];
        let arc = here.range * self.angle_increment;
        if arc.is_infinite() {
            return here.range;
        }
        let reach = ((SMOOTHING_ARC / arc) as usize).min(MAX_SMOOTHING);
        let gate = (2.0 * self.noise).max(0.005) + 2.0 * SMOOTHING_ARC;
        let mut means = [Mean::default(); MAX_SMOOTHING + 1];
        means[0] = Mean { sum: here.range * here.weight, weight: here.weight };
        let mut pairs = 0;
        while pairs < reach {
            // Neighbours in pairs, so that the slope of the surface cancels.
            let (before, after) = (self.before(index, pairs + 1), self.after(index, pairs + 1));
            let farther = (before.range - here.range).abs().max((after.range - here.range).abs());
            if farther.is_nan() || farther >= gate {
                break;
            }
            let weight = before.weight.min(after.weight);
            means[pairs + 1] = means[pairs].with(weight * (before.range + after.range), 2.0 * weight);
            pairs += 1;
        }
        self.straight_part(&means[..=pairs]).value()
    }

    /// The mean over the widest neighbourhood whose outer half agrees with its inner one. This keeps corners
    /// sharp: a mean across a corner would lie behind it or in front of it.
    fn straight_part(&self, means: &[Mean]) -> Mean {
        let mut reach = means.len() - 1;
        while reach > 0 {
            let (inner, whole) = (means[reach / 2], means[reach]);
            let outer = Mean { sum: whole.sum - inner.sum, weight: whole.weight - inner.weight };
            let bend = (outer.value() - inner.value()).abs();
            let error = self.noise * (1.0 / inner.weight + 1.0 / outer.weight).sqrt();
            if bend <= OUTLIER * error {
                break;
            }
            reach /= 2;
        }
        means[reach]
    }
}

/// Accumulator of a weighted mean.
#[derive(Debug, Clone, Copy, Default)]
struct Mean {
    sum: f64,
    weight: f64,
}

impl Mean {
    fn with(self, sum: f64, weight: f64) -> Self {
        Self { sum: self.sum + sum, weight: self.weight + weight }
    }

    fn value(self) -> f64 {
        self.sum / self.weight
    }
}

/// Brings a bearing (in beams) into one turn. The remainder of a division is slow and rarely needed.
fn within_turn(bearing: f64, beams: f64) -> f64 {
    if (0.0..beams).contains(&bearing) {
        bearing
    } else if (-beams..0.0).contains(&bearing) {
        bearing + beams
    } else {
        bearing.rem_euclid(beams)
    }
}

/// Merges two estimates on one beam: their average if they belong to one surface, otherwise the nearer one.
fn merge(a: Beam, b: Beam) -> Beam {
    if a.weight == 0.0 {
        return b;
    }
    if (a.range - b.range).abs() < SURFACE_STEP * a.range {
        let weight = a.weight + b.weight;
        let range = (a.range * a.weight + b.range * b.weight) / weight;
        return Beam { range, weight: weight.min(MAX_WEIGHT) };
    }
    if a.range < b.range { a } else { b }
}

/// Rejects scans that do not cover a full turn.
fn check(scan: &LidarScan) -> Result<()> {
    let covered = scan.angle_increment * scan.ranges.len() as f64;
    if scan.ranges.len() < 36 || (covered - TAU).abs() > 0.02 * TAU {
        let found = format!("{} beams over {:.2} rad", scan.ranges.len(), covered);
        return Err(Error::invalid_input("lidar scan", found, "at least 36 beams over a full turn"));
    }
    Ok(())
}
