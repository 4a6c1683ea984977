use std::f64::consts::TAU;

use crate::geometry::{Point, Pose, direction, math};
use crate::io::{Error, LidarScan, Result};
use crate::kinematics::OUTLIER;

/// Takes the noise out of consecutive lidar scans of a moving robot.
///
/// Each beam carries an estimate of its range. With every scan the estimates are moved along with the robot's own
/// motion, which is known far better between two scans than a single range, and then averaged with the new
/// readings. A reading that does not fit its prediction, because something came into view or went out of it, starts
/// its beam anew. After some scans the noise is a fraction of the sensor's, without the blur that a plain average
/// over time or over neighbours would have.
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

/// The estimate of one beam.
#[derive(Debug, Clone, Copy)]
struct Beam {
    range: f64,
    /// How many readings the estimate rests on; 0 when there is none.
    weight: f64,
}

/// The standard deviation of a range, in metres, that is expected before anything was measured: that of an EyeBot's lidar.
pub(super) const RANGE_ERROR: f64 = 0.010;
/// A beam that has met nothing.
const UNKNOWN: Beam = Beam { range: f64::INFINITY, weight: 0.0 };
/// The most readings that an estimate counts for, so that it still follows small changes.
const MAX_WEIGHT: f64 = 20.0;
/// Beams next to each other whose ranges differ by less than this part of the range see one surface.
pub(super) const SURFACE_STEP: f64 = 0.1;
/// Beams whose hits lie closer together than this, in metres, see the same piece of surface; seen at a slant, it moves by as much
/// between them.
const SMOOTHING_ARC: f64 = 0.015;
/// Neighbours on either side that are averaged at most.
const MAX_SMOOTHING: usize = 10;

impl Default for ScanFilter {
    fn default() -> Self {
        Self::new()
    }
}

impl ScanFilter {
    /// A filter without a scan. It finds the noise of the sensor by itself.
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

    /// Takes in a scan that was made at `pose`, by odometry or better. The scan must cover a full turn; a change of
    /// the number of beams starts the filter anew.
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

    /// The estimated range of every beam in metres, +infinity where nothing is seen.
    pub fn ranges(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        (0..self.beams.len()).map(|i| self.smoothed(i))
    }

    /// The estimated hits in the robot's frame.
    pub fn points(&self) -> impl Iterator<Item = Point> + '_ {
        let origin = self.mount.position();
        self.ranges()
            .zip(&self.directions)
            .filter(|(range, _)| range.is_finite())
            .map(move |(range, &(cos, sin))| Point::new(origin.x + range * cos, origin.y + range * sin))
    }

    /// The standard deviation of the sensor's ranges as found so far, in metres.
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

    /// Moves the estimates to where they are seen from the new pose.
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
            // Rounded half up; `round` is a call where the processor is not known to have it.
            let whole = bearing as usize;
            let nearest = whole + usize::from(bearing - whole as f64 >= 0.5);
            let target = if nearest < self.beams.len() { nearest } else { 0 };
            // The estimate is for the beam's own direction, which the moved point misses by up to half a beam.
            let range = seen + self.slope(i) * (nearest as f64 - bearing);
            self.predicted[target] = merge(self.predicted[target], Beam { range, weight });
        }
        std::mem::swap(&mut self.beams, &mut self.predicted);
        self.fill_gaps();
    }

    /// The beam that comes so many, at most a full turn, before another one.
    fn before(&self, index: usize, steps: usize) -> Beam {
        self.beams[if index >= steps { index - steps } else { index + self.beams.len() - steps }]
    }

    /// The beam that comes so many, at most a full turn, after another one.
    fn after(&self, index: usize, steps: usize) -> Beam {
        let (to, n) = (index + steps, self.beams.len());
        self.beams[if to < n { to } else { to - n }]
    }

    /// A surface that comes nearer spreads over more beams: one between two that see it sees it too.
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

    /// A beam's direction in the sensor's frame.
    fn local_direction(&self, index: usize) -> (f64, f64) {
        let (x, y) = self.directions[index];
        if self.mount.heading == 0.0 {
            return (x, y);
        }
        let (sin, cos) = math::sin_cos(self.mount.heading);
        (cos * x + sin * y, cos * y - sin * x)
    }

    /// How much the range changes from one beam to the next on the surface that a beam sees.
    fn slope(&self, index: usize) -> f64 {
        let (before, after) = (self.before(index, 1).range, self.after(index, 1).range);
        let slope = 0.5 * (after - before);
        let here = self.beams[index].range;
        // Across an edge between surfaces there is no slope.
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
            // A prediction that rests on many readings is nearly exact, so its surprise is the reading's noise.
            if beam.weight >= 4.0 {
                self.scratch.push(surprise.abs());
            }
            beam.weight = (beam.weight + 1.0).min(MAX_WEIGHT);
            beam.range += surprise / beam.weight;
        }
        self.learn_noise();
    }

    /// Moves the estimate of the sensor's noise towards what this scan showed.
    fn learn_noise(&mut self) {
        let n = self.scratch.len();
        if n < 20 {
            return;
        }
        let (_, median, _) = self.scratch.select_nth_unstable_by(n / 2, f64::total_cmp);
        // The median of absolute normal deviations is 0.6745 of their standard deviation.
        let observed = *median / 0.6745;
        self.noise += 0.1 * (observed - self.noise);
    }

    /// A beam's estimate, averaged with neighbours that see the same piece of surface.
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
            // Neighbours come in pairs, so that the slope of the surface cancels.
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

    /// The widest of the means over ever more neighbours whose outer half agrees with its inner one. A corner stays
    /// sharp thereby: the mean over both its sides lies behind it when it points at the robot, and before it when it
    /// points away.
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

/// A weighted mean in the making.
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

/// A bearing in beams, brought into one turn of them. The remainder of a division is slow, and seldom needed.
fn within_turn(bearing: f64, beams: f64) -> f64 {
    if (0.0..beams).contains(&bearing) {
        bearing
    } else if (-beams..0.0).contains(&bearing) {
        bearing + beams
    } else {
        bearing.rem_euclid(beams)
    }
}

/// Two estimates that come to lie on one beam: their average if they are of one surface, or else the nearer one.
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

/// Fails unless a scan covers a full turn.
/// Fails for odometry that is no place, and for a scan without a single number.
pub(crate) fn check_measured(odometry: &Pose, scan: &LidarScan) -> Result<()> {
    if !odometry.is_finite() {
        let Pose { x, y, heading } = odometry;
        let found = format!("{x} m, {y} m, {heading} rad");
        return Err(Error::invalid_input("odometry", found, "finite numbers"));
    }
    if !scan.ranges.is_empty() && scan.ranges.iter().all(|range| range.is_nan()) {
        let expected = "metres or +infinity";
        return Err(Error::invalid_input("every range of the lidar scan", f64::NAN, expected));
    }
    Ok(())
}

fn check(scan: &LidarScan) -> Result<()> {
    let covered = scan.angle_increment * scan.ranges.len() as f64;
    if scan.ranges.len() < 36 || (covered - TAU).abs() > 0.02 * TAU {
        let found = format!("{} beams over {:.2} rad", scan.ranges.len(), covered);
        return Err(Error::invalid_input("lidar scan", found, "at least 36 beams over a full turn"));
    }
    Ok(())
}
