use std::ops::Range;

use super::place::PlaceInCell;
use crate::ParameterError;
use crate::drive::{Pid, PidParameters};
use crate::geometry::{Pose, Twist};
use crate::io::{DistanceSensors, Psd, Result};
use crate::maze::{Rig, Scale};
use crate::parameter::{require_finite, require_positive};

/// Parameters of [`CellDrive`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellDriveParameters {
    /// Cell size (m).
    pub cell: f64,
    /// Thickness of the walls (m).
    pub wall: f64,
    /// Speed (m/s).
    pub speed: f64,
    /// Reading of a side sensor midway between two walls (m).
    pub aside: f64,
    /// Distance of the side sensors ahead of the robot's centre (m).
    pub sensors_ahead: f64,
    /// Reading of the front sensor in a cell's centre with a wall ahead (m).
    pub ahead: f64,
    /// Distance that the robot rolls after the command to stop (m).
    pub coast: f64,
    /// Standard deviation of a side sensor's reading (m). If given, the lateral offset is filtered with
    /// odometry; otherwise readings are used directly.
    pub reading_error: Option<f64>,
    /// Controller of the angular velocity (rad/s) from the lateral offset (m).
    pub steering: PidParameters,
}

impl CellDriveParameters {
    /// The book's proportional controller, 1 deg/s per millimetre of difference, scaled to the maze.
    ///
    /// It oscillates about the centre line. With slow motors, such as those of an S4, the oscillation grows
    /// along a straight until the robot hits a wall.
    pub fn proportional(rig: &Rig, scale: Scale, speed: f64) -> Self {
        let [front, left, _] = rig.sensors;
        let free = 0.5 * (scale.cell - scale.wall);
        let gain = 1000.0_f64.to_radians() * Scale::DOUBLED.cell / scale.cell;
        Self {
            cell: scale.cell,
            wall: scale.wall,
            speed,
            aside: free - left.mount.y.abs(),
            sensors_ahead: left.mount.x,
            ahead: free - front.mount.x,
            coast: speed * rig.lag,
            reading_error: None,
            steering: PidParameters { proportional: gain, limits: [-1.5, 1.5], ..PidParameters::default() },
        }
    }

    /// A PID controller (section 9.8) that corrects an offset within half a cell without oscillation.
    pub fn pid(rig: &Rig, scale: Scale, speed: f64) -> Self {
        let book = Self::proportional(rig, scale, speed);
        let reach = 0.4 * scale.cell;
        let gain = speed / (reach * reach);
        let steering = PidParameters {
            proportional: gain,
            integral: 0.05 * gain,
            derivative: 2.0 / reach,
            derivative_filter: 0.05,
            ..book.steering
        };
        Self { reading_error: Some(rig.range_error.max(2e-3)), steering, ..book }
    }

    fn validate(&self) -> std::result::Result<(), ParameterError> {
        require_positive("cell", self.cell)?;
        require_positive("speed", self.speed)?;
        require_positive("distance aside", self.aside)?;
        require_positive("distance ahead", self.ahead)?;
        require_finite("wall", self.wall)?;
        require_finite("coast", self.coast)?;
        require_finite("sensors ahead", self.sensors_ahead)?;
        self.reading_error.map_or(Ok(()), |error| require_positive("reading error", error))
    }
}

/// Drives straight into the next cell, midway between the walls beside it (book, section 9.3).
///
/// The readings determine which walls exist: one that is far from the expected value does not come from a
/// wall of this cell. The robot follows both walls, the left one, the right one or none. It stops after one
/// cell length by odometry, or by the wall ahead if there is one.
///
/// With a [`reading_error`](CellDriveParameters::reading_error), the position in the cell is tracked from
/// cell to cell, so that a slanted beam at a side opening is not mistaken for a wall: readings count only
/// away from posts and if they agree with the estimate. Where walls end, the robot also learns the scale
/// error of its odometry. If no wall ends until that error may reach half a cell, as after some 16 cells with
/// wheels 3 % too large, cells can no longer be told apart.
///
/// ```
/// use roverlab::geometry::Pose;
/// use roverlab::kinematics::OdometryErrors;
/// use roverlab::maze::{CellDrive, CellDriveParameters, Rig, Scale, mouse};
/// let rig = Rig::new(&mouse(), OdometryErrors::default(), 0.0)?;
/// let (scale, speed) = (Scale::MICROMOUSE, 0.1);
/// let mut drive = CellDrive::new(CellDriveParameters::pid(&rig, scale, speed))?;
/// drive.begin();
/// // Nothing ahead, and closer to the left wall than to the right one: steer to the right.
/// let twist = drive.step(Pose::default(), [f64::INFINITY, 0.04, 0.06], 0.02)?.expect("on the way");
/// assert!(twist.linear > 0.0 && twist.angular < 0.0);
/// let next = Pose::new(scale.cell, 0.0, 0.0);
/// assert_eq!(drive.step(next, [f64::INFINITY; 3], 1.8)?, None, "in the next cell");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct CellDrive {
    parameters: CellDriveParameters,
    pid: Pid,
    place: Option<PlaceInCell>,
    /// Readings of the previous step.
    last: Option<Readings>,
}

/// Readings of the front, left and right sensor (m).
pub(super) type Readings = [f64; 3];

pub(super) fn read<R: DistanceSensors + ?Sized>(robot: &mut R) -> Result<Readings> {
    Ok([robot.distance(Psd::FRONT)?, robot.distance(Psd::LEFT)?, robot.distance(Psd::RIGHT)?])
}

impl CellDrive {
    /// Minimum distance of a valid side reading from the middle of a post (cells): half a post, plus the
    /// slant of the beam.
    const NEAR_POST: f64 = 0.16;
    /// Standard deviation of the position by the end of a wall (cells).
    const EDGE: f64 = 0.03;

    /// A controller before its first cell.
    ///
    /// # Errors
    ///
    /// If a parameter is out of range.
    pub fn new(parameters: CellDriveParameters) -> Result<Self> {
        parameters.validate()?;
        Ok(Self { pid: Pid::new(parameters.steering)?, parameters, place: None, last: None })
    }

    /// Starts a new cell, with or without a turn on the spot before.
    pub fn begin(&mut self) {
        if let Some(place) = &mut self.place {
            place.along -= self.parameters.cell;
        }
        self.last = None;
        self.pid.reset();
    }

    /// Follows a turn on the spot, in steps of less than half a turn.
    pub fn turned(&mut self, pose: Pose) {
        if let Some(place) = &mut self.place {
            place.predict(pose);
        }
    }

    /// Lateral offset of the robot, positive to the left (m); `None` without a wall beside it.
    pub fn off_middle(&self, readings: [f64; 3]) -> Option<f64> {
        // As in the book: 100 to 180 mm where 125 mm is expected, in cells of 360 mm.
        middle(self.by_walls(readings, -0.07..0.16))
    }

    /// Lateral offset by the left and by the right wall. `walls` is the accepted deviation from the expected
    /// reading (cells).
    fn by_walls(&self, [_, left, right]: [f64; 3], walls: Range<f64>) -> [Option<f64>; 2] {
        let CellDriveParameters { aside, cell, .. } = self.parameters;
        let wall = |reading: f64| walls.contains(&((reading - aside) / cell));
        [wall(left).then_some(aside - left), wall(right).then_some(right - aside)]
    }

    /// Velocity command for a pose by odometry and three readings (front, left, right), `seconds` after the
    /// previous step; `None` once the robot has arrived.
    ///
    /// # Errors
    ///
    /// If the controller rejects an input.
    pub fn step(&mut self, pose: Pose, readings: [f64; 3], seconds: f64) -> Result<Option<Twist>> {
        let CellDriveParameters { cell, speed, ahead, coast, reading_error, .. } = self.parameters;
        let mut place = self.place.unwrap_or(PlaceInCell::at(pose, cell));
        place.predict(pose);
        let front = readings[0];
        // A wall ahead is more reliable than odometry, once it can only be that of the next cell.
        let by_wall = place.along > 0.5 * cell && front < ahead + 0.5 * cell;
        let far = place.along > 1.25 * cell;
        if by_wall {
            place.correct_along(cell + ahead - front, reading_error.unwrap_or(0.01 * cell));
        }
        let off = match reading_error {
            Some(error) => Some(self.smooth(&mut place, readings, error)),
            None => self.off_middle(readings),
        };
        self.place = Some(place);
        // An unfiltered reading may report the wall too early.
        let there = if by_wall && reading_error.is_none() {
            front <= ahead + coast || far
        } else {
            place.along + coast >= cell
        };
        if there {
            return Ok(None);
        }
        let turn = if let Some(off) = off {
            self.pid.step(0.0, off, seconds)?
        } else {
            self.pid.reset();
            0.0
        };
        Ok(Some(Twist::new(speed, turn)))
    }

    /// Filtered lateral offset (m).
    fn smooth(&mut self, place: &mut PlaceInCell, readings: [f64; 3], error: f64) -> f64 {
        let CellDriveParameters { cell, sensors_ahead, .. } = self.parameters;
        let last = self.last.replace(readings).unwrap_or(readings);
        for (sensor, side) in [(1, 1.0), (2, -1.0)] {
            if let Some(missing) = self.edge(place, [last[sensor], readings[sensor]], side) {
                place.correct_along(place.along + missing, Self::EDGE * cell);
            }
        }
        let from_post = ((place.along + sensors_ahead) / cell).rem_euclid(1.0) - 0.5;
        if from_post.abs() < Self::NEAR_POST {
            return place.off;
        }
        // A sensor ahead of the centre moves sideways as the robot turns. Readings are gated by the estimate;
        // a narrow fixed gate would bias the errors to one side.
        let seen =
            self.by_walls(readings, -0.4..0.4).map(|off| off.map(|off| off - sensors_ahead * place.turn));
        let believed = seen.map(|off| off.filter(|&off| place.believes(off, error)));
        if let Some(off) = middle(believed) {
            place.correct_off(off, error);
        } else if middle(seen).is_some() {
            place.doubt(0.005 * cell);
        }
        place.off
    }

    /// Longitudinal correction where a side sensor passes the end of a wall (m): walls end at either face of
    /// a post. `side` is 1 on the left and -1 on the right.
    fn edge(&self, place: &PlaceInCell, [before, now]: [f64; 2], side: f64) -> Option<f64> {
        let CellDriveParameters { cell, wall, aside, sensors_ahead, .. } = self.parameters;
        let beside = |reading: f64| (reading - aside).abs() < 0.12 * cell;
        let open = |reading: f64| reading > aside + 0.3 * cell;
        let face = match (beside(before) && open(now), open(before) && beside(now)) {
            (true, _) => 0.5 * wall,
            (_, true) => -0.5 * wall,
            _ => return None,
        };
        // The beam slants with the robot.
        let met = place.along + sensors_ahead - side * 0.5 * (cell - wall) * place.turn;
        let past_post = ((met / cell).rem_euclid(1.0) - 0.5) * cell;
        Some(face - past_post).filter(|&missing| place.believes_along(missing, Self::EDGE * cell))
    }
}

/// Mean of the walls that give a value; `None` if neither does.
fn middle(by_walls: [Option<f64>; 2]) -> Option<f64> {
    match by_walls {
        [Some(left), Some(right)] => Some(0.5 * (left + right)),
        [one, other] => one.or(other),
    }
}
