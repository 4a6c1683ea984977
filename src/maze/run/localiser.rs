use std::f64::consts::FRAC_PI_4;

use nalgebra::{SMatrix, SVector};

use super::rig::{Rig, RigSensor};
use super::sight::{Crossing, Crossings};
use crate::geometry::{Point, Pose, Vector, angle_difference, direction, math, normalize_angle};
use crate::kinematics::{LEAST_RANGE_ERROR, OUTLIER};
use crate::maze::{Cell, Direction, Maze, Scale, WallState};

/// Localisation in a partly known maze, from odometry and three distance sensors.
///
/// An extended Kalman filter estimates the pose and the systematic errors of odometry: scale of distances,
/// scale of turns, and drift to one side. Each reading is compared with the known wall that it should come
/// from; this centres the robot between walls and gives the distance to a wall ahead. Where a wall beside the
/// robot ends, the change of the reading gives the longitudinal position (*wall-edge correction*). Isolated
/// posts are the only landmarks on diagonals of open areas.
///
/// ```
/// use roverlab::geometry::Pose;
/// use roverlab::kinematics::OdometryErrors;
/// use roverlab::maze::{MazeLocaliser, Rig, Scale, files, mouse};
/// let maze = files::parse(b"o---o---o\n| S     |\no---o---o\n", "a corridor")?.maze;
/// let errors = OdometryErrors { wheel_scale: 0.02, ..OdometryErrors::default() };
/// let (rig, scale) = (Rig::new(&mouse(), errors, 0.002)?, Scale::MICROMOUSE);
/// let front = rig.sensors[0];
/// let start = Pose::new(scale.centre(maze.start()).x, scale.centre(maze.start()).y, 0.0);
/// let mut localiser = MazeLocaliser::new(rig, scale, start, Pose::default());
/// // Odometry is 3 mm too large; the wall ahead gives the true position.
/// localiser.predict(Pose::new(0.103, 0.0, 0.0));
/// let wall = 2.0 * scale.cell - 0.5 * scale.wall;
/// localiser.correct(&maze, &front, wall - (start.x + 0.1 + front.mount.x));
/// assert!((localiser.pose().x - start.x - 0.1).abs() < 0.002);
/// assert!(localiser.calibration().distance < 1.0, "odometry overestimates");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct MazeLocaliser {
    rig: Rig,
    scale: Scale,
    /// x, y, heading, and the three components of [`Calibration`].
    state: SVector<f64, 6>,
    covariance: SMatrix<f64, 6, 6>,
    odometry: Pose,
    /// Last observation of each sensor.
    seen: [Option<Seen>; 3],
}

/// Whether a sensor saw a wall on the nearest line of walls, and where along it.
#[derive(Debug, Clone, Copy)]
struct Seen {
    upright: bool,
    line: i64,
    along: f64,
    near: bool,
}

/// Systematic errors of a robot's odometry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Calibration {
    /// True distance per distance by odometry.
    pub distance: f64,
    /// True angle per angle by odometry, at a `distance` of 1.
    pub angle: f64,
    /// True angle per distance by odometry on a straight (rad/m).
    pub bend: f64,
}

/// Index of the heading (rad).
const HEADING: usize = 2;
/// Index of the distance scale.
const DISTANCE: usize = 3;
/// Index of the angle scale.
const ANGLE: usize = 4;
/// Index of the drift (rad/m).
const BEND: usize = 5;

/// Initial standard deviations (m, rad).
const START: [f64; 2] = [1e-3, 4e-3];
/// Maximum position error of a robot without better information (cells): what it detects is then the nearest
/// possible.
const NEAREST: f64 = 0.45;
/// Cosine of the angle of incidence up to which a beam counts (14 degrees): more oblique beams may see what
/// is behind an opening beside the wall.
const SQUARE: f64 = 0.97;
/// Sharpness of an edge as seen by a beam (m).
const EDGE: f64 = 0.004;

impl MazeLocaliser {
    /// A robot at rest at a known pose in the maze, whose odometry reads `odometry`.
    pub fn new(rig: Rig, scale: Scale, pose: Pose, odometry: Pose) -> Self {
        let e = rig.errors;
        let [place, heading] = START;
        let deviations = [place, place, heading, e.wheel_scale, e.track, e.wheel_mismatch / rig.track]
            .map(|d| d * d + 1e-14);
        Self {
            rig,
            scale,
            state: SVector::from([pose.x, pose.y, pose.heading, 1.0, 1.0, 0.0]),
            covariance: SMatrix::from_diagonal(&SVector::from(deviations)),
            odometry,
            seen: [None; 3],
        }
    }

    /// Estimated pose.
    pub fn pose(&self) -> Pose {
        Pose::new(self.state[0], self.state[1], normalize_angle(self.state[HEADING]))
    }

    /// Estimated systematic errors.
    pub fn calibration(&self) -> Calibration {
        Calibration { distance: self.state[DISTANCE], angle: self.state[ANGLE], bend: self.state[BEND] }
    }

    /// Standard deviations of the position (m, worse axis) and of the heading (rad).
    pub fn deviations(&self) -> (f64, f64) {
        let (xx, yy) = (self.covariance[(0, 0)], self.covariance[(1, 1)]);
        (xx.max(yy).sqrt(), self.covariance[(HEADING, HEADING)].sqrt())
    }

    /// Prediction step, to a new pose by odometry.
    pub fn predict(&mut self, odometry: Pose) {
        let moved = odometry.position() - self.odometry.position();
        let turned = angle_difference(odometry.heading, self.odometry.heading);
        let middle = self.odometry.heading + 0.5 * turned;
        let length = moved.dot(&direction(middle));
        self.odometry = odometry;
        if length != 0.0 || turned != 0.0 {
            self.advance(length, turned);
        }
    }

    fn advance(&mut self, length: f64, turned: f64) {
        let s = &mut self.state;
        let (real_length, angle) = (s[DISTANCE] * length, s[DISTANCE] * s[ANGLE] * turned + s[BEND] * length);
        let middle = s[HEADING] + 0.5 * angle;
        let (sin, cos) = math::sin_cos(middle);
        let mut jacobian = SMatrix::<f64, 6, 6>::identity();
        // Derivatives of the heading by the calibration; the position depends on half of that.
        let slopes = [(DISTANCE, s[ANGLE] * turned), (ANGLE, s[DISTANCE] * turned), (BEND, length)];
        for (index, slope) in slopes {
            jacobian[(HEADING, index)] = slope;
            jacobian[(0, index)] = -0.5 * real_length * sin * slope;
            jacobian[(1, index)] = 0.5 * real_length * cos * slope;
        }
        jacobian[(0, DISTANCE)] += length * cos;
        jacobian[(1, DISTANCE)] += length * sin;
        jacobian[(0, HEADING)] = -real_length * sin;
        jacobian[(1, HEADING)] = real_length * cos;
        s[0] += real_length * cos;
        s[1] += real_length * sin;
        s[HEADING] += angle;
        self.covariance = jacobian * self.covariance * jacobian.transpose();
        self.add_slip(length, turned, (sin, cos));
    }

    /// Adds the slip of both wheels, which grows with the square root of the distance.
    fn add_slip(&mut self, length: f64, turned: f64, (sin, cos): (f64, f64)) {
        let aside = 0.5 * self.rig.track * turned;
        let slip = self.rig.errors.slip * self.rig.errors.slip + 1e-8;
        let wheels = [length - aside, length + aside].map(|way| slip * way.abs());
        let along = 0.25 * (wheels[0] + wheels[1]);
        let around = (wheels[0] + wheels[1]) / (self.rig.track * self.rig.track);
        self.covariance[(0, 0)] += along * cos * cos;
        self.covariance[(1, 1)] += along * sin * sin;
        self.covariance[(0, 1)] += along * sin * cos;
        self.covariance[(1, 0)] += along * sin * cos;
        self.covariance[(HEADING, HEADING)] += around;
    }

    /// Correction step, with a reading of one of the rig's sensors (m), infinite without an echo.
    pub fn correct(&mut self, maze: &Maze, sensor: &RigSensor, reading: f64) {
        let pose = self.pose();
        let yaw = pose.heading + sensor.mount.yaw;
        let (sin, cos) = math::sin_cos(pose.heading);
        let (x, y) = (sensor.mount.x, sensor.mount.y);
        let offset = Vector::new(x * cos - y * sin, x * sin + y * cos);
        let ray = direction(yaw);
        let deviation = self.rig.range_error.max(LEAST_RANGE_ERROR);
        if ray.x.abs().max(ray.y.abs()) <= SQUARE && self.notice_post(maze, offset, ray, reading) {
            return;
        }
        for (passed, crossing) in Crossings::new(maze, self.scale, pose.position() + offset, ray).enumerate()
        {
            // At a shallow angle to the wall, a reading says little about the position.
            let straight_on = if crossing.upright { ray.x } else { ray.y };
            if crossing.distance > sensor.max_range || straight_on.abs() < 0.5 {
                return;
            }
            let model = Model { crossing, offset, ray };
            let square = straight_on.abs() > SQUARE;
            if passed == 0 && square {
                self.notice_edge(sensor, &model, reading);
            }
            let slack = OUTLIER * (deviation + self.deviation(&model.range_slope()));
            let agrees = (reading - crossing.distance).abs() < slack.min(NEAREST * self.scale.cell);
            // How far along the wall the ray may be from where it seems to be.
            let margin = OUTLIER * EDGE + 2.0 * self.deviation(&model.along_slope());
            let post = margin + 0.5 * self.scale.wall;
            let differs = reading - crossing.distance;
            match crossing.wall {
                WallState::Unknown => {
                    // An echo from a possible wall comes from it, or from a post in line with it.
                    if agrees && square {
                        self.update(&model.range_slope(), differs, deviation * deviation);
                    }
                    let through = reading > crossing.distance && crossing.corner_distance() > post;
                    if agrees || !square || !through {
                        return;
                    }
                }
                WallState::Absent => {
                    // A post may be in the way.
                    if agrees && square && crossing.corner_distance() < post {
                        self.update(&model.range_slope(), differs, deviation * deviation);
                    }
                    if crossing.corner_distance() < post {
                        return;
                    }
                }
                WallState::Present => {
                    let firm = crossing.beyond == WallState::Present || crossing.corner_distance() > margin;
                    if agrees && firm {
                        self.update(&model.range_slope(), differs, deviation * deviation);
                    }
                    return;
                }
            }
        }
    }

    /// Compares the observation on the nearest line of walls with the previous one. A change marks the end of
    /// a wall or post, at a corner of the maze.
    fn notice_edge(&mut self, sensor: &RigSensor, model: &Model, reading: f64) {
        let Some(index) = self.rig.sensors.iter().position(|other| other.id == sensor.id) else { return };
        let Crossing { upright, line, along, distance, corner, .. } = model.crossing;
        let near = reading < distance + 0.35 * self.scale.cell;
        let last = self.seen[index].replace(Seen { upright, line, along, near });
        let Some(last) = last.filter(|last| (last.upright, last.line) == (upright, line)) else { return };
        let step = along - last.along;
        if near == last.near || step.abs() < 1e-5 || step.abs() > 0.3 * self.scale.cell {
            return;
        }
        // In the direction of travel, a wall ends behind the corner and begins before it.
        let side = if near { -step.signum() } else { step.signum() };
        let edge = corner + side * 0.5 * self.scale.wall;
        // The change happened at some time since the last reading.
        let innovation = edge - (along - 0.5 * step);
        let variance = step * step / 12.0 + EDGE * EDGE;
        let slack = OUTLIER * (EDGE + self.deviation(&model.along_slope()));
        if innovation.abs() < slack.clamp(0.3 * self.scale.cell, NEAREST * self.scale.cell) {
            self.update(&model.along_slope(), innovation, variance);
        }
    }

    /// Correction by a bare post that a slanted beam hits. Returns whether the reading matches one.
    fn notice_post(&mut self, maze: &Maze, offset: Vector, ray: Vector, reading: f64) -> bool {
        if !reading.is_finite() {
            return false;
        }
        let (cell, half) = (self.scale.cell, 0.5 * self.scale.wall);
        let sensor = self.pose().position() + offset;
        // A post is met a little before its middle.
        let met = sensor + ray * (reading + FRAC_PI_4 * half);
        let [x, y] = [met.x, met.y].map(|place| (place / cell).round());
        let post = Point::new(x * cell, y * cell);
        if (post - met).norm() > NEAREST * cell || !is_bare(maze, x as i64, y as i64) {
            return false;
        }
        let aside = Vector::new(-ray.y, ray.x);
        let moved = Vector::new(-offset.y, offset.x);
        let range = self.rig.range_error.max(LEAST_RANGE_ERROR);
        for (towards, expected, variance) in
            [(ray, reading + FRAC_PI_4 * half, range * range + 0.25 * half * half), (aside, 0.0, half * half)]
        {
            let view = post - (self.pose().position() + offset);
            // Derivative of the position of the post along a direction by x, y and heading.
            let turned = view.dot(&Vector::new(-towards.y, towards.x)) - moved.dot(&towards);
            let slope = SVector::from([-towards.x, -towards.y, turned, 0.0, 0.0, 0.0]);
            self.update(&slope, expected - view.dot(&towards), variance);
        }
        true
    }

    /// Standard deviation of a quantity with a gradient in the state.
    fn deviation(&self, slope: &SVector<f64, 6>) -> f64 {
        slope.dot(&(self.covariance * slope)).max(0.0).sqrt()
    }

    /// Scalar Kalman update: gradient in the state, innovation, variance.
    fn update(&mut self, slope: &SVector<f64, 6>, innovation: f64, variance: f64) {
        let spread = self.covariance * slope;
        let total = slope.dot(&spread) + variance;
        if innovation * innovation > OUTLIER * OUTLIER * total {
            return;
        }
        let gain = spread / total;
        self.state += gain * innovation;
        self.covariance -= gain * spread.transpose();
        // Keep the covariance symmetric despite rounding.
        self.covariance = 0.5 * (self.covariance + self.covariance.transpose());
    }
}

/// Whether a post is known to have no walls; posts are counted from the lower left corner of the maze.
fn is_bare(maze: &Maze, x: i64, y: i64) -> bool {
    let inside = 0 < x && x < maze.width() as i64 && 0 < y && y < maze.height() as i64;
    if !inside {
        return false;
    }
    let (x, y) = (x as u16, y as u16);
    let below = Cell::new(x - 1, y - 1);
    let above = Cell::new(x, y);
    [(below, Direction::North), (below, Direction::East), (above, Direction::South), (above, Direction::West)]
        .into_iter()
        .all(|(cell, side)| maze.wall(cell, side) == WallState::Absent)
}

/// Measurement model of a reading.
struct Model {
    crossing: Crossing,
    /// Offset from robot to sensor, in the maze frame.
    offset: Vector,
    ray: Vector,
}

impl Model {
    /// Gradient of the distance to the wall's face.
    fn range_slope(&self) -> SVector<f64, 6> {
        let (offset, ray, d) = (self.offset, self.ray, self.crossing.distance);
        let mut slope = SVector::zeros();
        if self.crossing.upright {
            slope[0] = -1.0 / ray.x;
            slope[HEADING] = (offset.y + d * ray.y) / ray.x;
        } else {
            slope[1] = -1.0 / ray.y;
            slope[HEADING] = -(offset.x + d * ray.x) / ray.y;
        }
        slope
    }

    /// Gradient of the hit position along the wall.
    fn along_slope(&self) -> SVector<f64, 6> {
        let (offset, ray, d) = (self.offset, self.ray, self.crossing.distance);
        let range = self.range_slope();
        let mut slope = SVector::zeros();
        if self.crossing.upright {
            slope[1] = 1.0;
            slope[0] = range[0] * ray.y;
            slope[HEADING] = offset.x + d * ray.x + range[HEADING] * ray.y;
        } else {
            slope[0] = 1.0;
            slope[1] = range[1] * ray.x;
            slope[HEADING] = -(offset.y + d * ray.y) + range[HEADING] * ray.x;
        }
        slope
    }
}
