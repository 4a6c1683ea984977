use std::ops::Range;

use super::place::PlaceInCell;
use crate::ParameterError;
use crate::drive::{Pid, PidParameters};
use crate::geometry::{Pose, Twist};
use crate::io::{DistanceSensors, Psd, Result};
use crate::maze::{Rig, Scale};
use crate::parameter::{require_finite, require_positive};

/// What [`CellDrive`] goes by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellDriveParameters {
    /// Metres from the middle of a cell to that of the next.
    pub cell: f64,
    /// How thick the walls are, in metres.
    pub wall: f64,
    /// Metres per second.
    pub speed: f64,
    /// What a side sensor reads in the middle between two walls, in metres.
    pub aside: f64,
    /// Metres that the side sensors sit before the middle of the robot.
    pub sensors_ahead: f64,
    /// What the front sensor reads in the middle of a cell with a wall ahead, in metres.
    pub ahead: f64,
    /// Metres that the robot goes on once it is told to stop.
    pub coast: f64,
    /// The standard deviation of a side sensor's reading, in metres. With it, odometry smoothes how far off the middle the
    /// robot is; without it, the readings are taken as they are.
    pub reading_error: Option<f64>,
    /// Turning speed, in rad/s, for a metre off the middle.
    pub steering: PidParameters,
}

impl CellDriveParameters {
    /// The book's proportional controller, a degree per second for each millimetre of difference, for a robot in a maze.
    ///
    /// It swings about the middle. Motors that lag as an S4's make the swing grow along a straight, up to the walls.
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

    /// A PID controller (section 9.8) for the same, which takes an error back within half of a cell without swinging.
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

/// Drives straight into the next cell, in the middle between the walls beside it (book, section 9.3).
///
/// Which walls there are the readings tell: one that is far from what it would be in the middle comes from no wall of this
/// cell. Both walls, the left one, the right one or none are followed. The way ends after the length of a cell by odometry,
/// or by the wall ahead where there is one.
///
/// With a [`reading_error`](CellDriveParameters::reading_error), the place in the cell is kept from cell to cell, and what a
/// slanted beam meets at a side opening is not taken for a wall beside the robot: readings count away from posts, and where
/// they agree with what is known. How much farther the robot rolls than odometry says is learnt from where walls end. Where
/// none has ended yet for so long that this may be half a cell, as after some 16 cells with wheels 3 % too large, it
/// cannot tell one cell from the next.
///
/// ```
/// use roverlab::geometry::Pose;
/// use roverlab::kinematics::OdometryErrors;
/// use roverlab::maze::{CellDrive, CellDriveParameters, Rig, Scale, mouse};
/// let rig = Rig::new(&mouse(), OdometryErrors::default(), 0.0)?;
/// let (scale, speed) = (Scale::MICROMOUSE, 0.1);
/// let mut drive = CellDrive::new(CellDriveParameters::pid(&rig, scale, speed))?;
/// drive.begin();
/// // Nothing ahead, and nearer to the left wall than to the right one: it steers to the right.
/// let twist = drive.step(Pose::default(), [f64::INFINITY, 0.04, 0.06], 0.02)?.expect("not there yet");
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
    /// The readings of the last step on the way.
    last: Option<Readings>,
}

/// Readings of the sensors at the front, on the left and on the right, in metres.
pub(super) type Readings = [f64; 3];

pub(super) fn read<R: DistanceSensors + ?Sized>(robot: &mut R) -> Result<Readings> {
    Ok([robot.distance(Psd::FRONT)?, robot.distance(Psd::LEFT)?, robot.distance(Psd::RIGHT)?])
}

impl CellDrive {
    /// Of a cell, how far from the middle of a post a side sensor has to be to be believed: half of a post, and what
    /// a beam may slant.
    const NEAR_POST: f64 = 0.16;
    /// Of a cell, how well the end of a wall tells where the robot is.
    const EDGE: f64 = 0.03;

    /// A controller before its first cell. Fails with the name of the parameter that is out of range.
    pub fn new(parameters: CellDriveParameters) -> Result<Self> {
        parameters.validate()?;
        Ok(Self { pid: Pid::new(parameters.steering)?, parameters, place: None, last: None })
    }

    /// Begins with a new cell, after a turn on the spot or without one.
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

    /// Metres that the robot is left of the middle; `None` where no wall is beside it.
    pub fn off_middle(&self, readings: [f64; 3]) -> Option<f64> {
        // As in the book: 100 to 180 mm where 125 are to be read in cells of 360 mm.
        middle(self.by_walls(readings, -0.07..0.16))
    }

    /// The same by the left and by the right wall: by what is, in cells, so far from what would be read in the middle.
    fn by_walls(&self, [_, left, right]: [f64; 3], walls: Range<f64>) -> [Option<f64>; 2] {
        let CellDriveParameters { aside, cell, .. } = self.parameters;
        let wall = |reading: f64| walls.contains(&((reading - aside) / cell));
        [wall(left).then_some(aside - left), wall(right).then_some(right - aside)]
    }

    /// The speed for a pose by odometry and three readings (front, left, right), `seconds` after the last step; `None` once
    /// the robot is there.
    pub fn step(&mut self, pose: Pose, readings: [f64; 3], seconds: f64) -> Result<Option<Twist>> {
        let CellDriveParameters { cell, speed, ahead, coast, reading_error, .. } = self.parameters;
        let mut place = self.place.unwrap_or(PlaceInCell::at(pose, cell));
        place.predict(pose);
        let front = readings[0];
        // A wall ahead tells better than odometry, once it can be that of the next cell alone.
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
        // A reading as it is may say too early that the wall is there.
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

    /// How far off the middle to take the robot to be.
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
        // A sensor before the middle is moved aside as the robot turns. What counts is whether a reading agrees with what is
        // known: a narrow gate would keep the errors to one side.
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

    /// Metres by which the robot is farther along than it takes itself to be, where a side sensor passes the end of a wall:
    /// walls end at either face of a post. `side` is 1 on the left and -1 on the right.
    fn edge(&self, place: &PlaceInCell, [before, now]: [f64; 2], side: f64) -> Option<f64> {
        let CellDriveParameters { cell, wall, aside, sensors_ahead, .. } = self.parameters;
        let beside = |reading: f64| (reading - aside).abs() < 0.12 * cell;
        let open = |reading: f64| reading > aside + 0.3 * cell;
        let face = match (beside(before) && open(now), open(before) && beside(now)) {
            (true, _) => 0.5 * wall,
            (_, true) => -0.5 * wall,
            _ => return None,
        };
        // A beam slants as the robot is turned.
        let met = place.along + sensors_ahead - side * 0.5 * (cell - wall) * place.turn;
        let past_post = ((met / cell).rem_euclid(1.0) - 0.5) * cell;
        Some(face - past_post).filter(|&missing| place.believes_along(missing, Self::EDGE * cell))
    }
}

/// What two walls say, if both or one of them says anything.
fn middle(by_walls: [Option<f64>; 2]) -> Option<f64> {
    match by_walls {
        [Some(left), Some(right)] => Some(0.5 * (left + right)),
        [one, other] => one.or(other),
    }
}
