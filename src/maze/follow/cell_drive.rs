use crate::drive::{Pid, PidParameters};
use crate::geometry::{Pose, Twist, angle_difference, math};
use crate::io::error::require_positive;
use crate::io::{DistanceSensors, Psd, Result};
use crate::maze::{Rig, Scale};

/// What [`CellDrive`] goes by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellDriveParameters {
    /// Metres from the middle of a cell to that of the next.
    pub cell: f64,
    /// Metres per second.
    pub speed: f64,
    /// What a side sensor reads in the middle between two walls, in metres.
    pub aside: f64,
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
            speed,
            aside: free - left.mount.y.abs(),
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

    fn validate(&self) -> Result<()> {
        require_positive("cell", self.cell)?;
        require_positive("speed", self.speed)?;
        require_positive("distance aside", self.aside)?;
        require_positive("distance ahead", self.ahead)?;
        self.reading_error.map_or(Ok(()), |error| require_positive("reading error", error))
    }
}

/// Drives straight into the next cell, in the middle between the walls beside it (book, section 9.3).
///
/// Which walls there are the readings tell: one that is far from what it would be in the middle comes from no wall of this
/// cell. Both walls, the left one, the right one or none are followed. The way ends after the length of a cell by odometry,
/// or by the wall ahead where there is one.
#[derive(Debug, Clone)]
pub struct CellDrive {
    parameters: CellDriveParameters,
    pid: Pid,
    start: Option<Pose>,
    aside: Aside,
}

/// Readings of the sensors at the front, on the left and on the right, in metres.
pub(super) type Readings = [f64; 3];

pub(super) fn read<R: DistanceSensors + ?Sized>(robot: &mut R) -> Result<Readings> {
    Ok([robot.distance(Psd::FRONT)?, robot.distance(Psd::LEFT)?, robot.distance(Psd::RIGHT)?])
}

impl CellDrive {
    /// A controller before its first cell. Fails with the name of the parameter that is out of range.
    pub fn new(parameters: CellDriveParameters) -> Result<Self> {
        parameters.validate()?;
        Ok(Self { pid: Pid::new(parameters.steering)?, parameters, start: None, aside: Aside::default() })
    }

    /// Begins with a new cell.
    pub fn begin(&mut self) {
        self.start = None;
        self.pid.reset();
    }

    /// Metres that the robot is left of the middle; `None` where no wall is beside it.
    pub fn off_middle(&self, [_, left, right]: [f64; 3]) -> Option<f64> {
        let CellDriveParameters { aside, cell, .. } = self.parameters;
        // As in the book: 100 to 180 mm where 125 are to be read in cells of 360 mm.
        let wall = |reading: &f64| (-0.07 * cell..0.16 * cell).contains(&(reading - aside));
        match (Some(left).filter(wall), Some(right).filter(wall)) {
            (Some(left), Some(right)) => Some(0.5 * (right - left)),
            (Some(left), None) => Some(aside - left),
            (None, Some(right)) => Some(right - aside),
            (None, None) => None,
        }
    }

    /// The speed for a pose by odometry and three readings (front, left, right), `seconds` after the last step; `None` once
    /// the robot is there.
    pub fn step(&mut self, pose: Pose, readings: [f64; 3], seconds: f64) -> Result<Option<Twist>> {
        let CellDriveParameters { cell, speed, ahead, coast, .. } = self.parameters;
        let start = *self.start.get_or_insert_with(|| {
            self.aside = Aside::at(pose, cell);
            pose
        });
        let driven = start.distance_to(pose.position());
        let front = readings[0];
        // A wall ahead tells better than odometry, once it can be that of the next cell alone.
        let by_wall = driven > 0.5 * cell && front < ahead + 0.5 * cell;
        let there =
            if by_wall { front <= ahead + coast || driven > 1.25 * cell } else { driven + coast >= cell };
        if there {
            return Ok(None);
        }
        let turn = if let Some(off) = self.smooth(pose, self.off_middle(readings)) {
            self.pid.step(0.0, off, seconds)?
        } else {
            self.pid.reset();
            0.0
        };
        Ok(Some(Twist::new(speed, turn)))
    }

    /// How far off the middle to take the robot to be.
    fn smooth(&mut self, pose: Pose, measured: Option<f64>) -> Option<f64> {
        let Some(error) = self.parameters.reading_error else { return measured };
        self.aside.predict(pose);
        if let Some(off) = measured {
            self.aside.correct(off, error);
        }
        Some(self.aside.off)
    }
}

/// Where a robot is aside of the middle and how it stands to it, by a Kalman filter from odometry and what the walls say.
#[derive(Debug, Clone, Copy, Default)]
struct Aside {
    /// Metres to the left.
    off: f64,
    /// Radians to the left.
    turn: f64,
    /// Variances of both, and what they have in common.
    spread: [f64; 2],
    common: f64,
    odometry: Pose,
}

impl Aside {
    /// A robot that has turned on the spot, more or less in the middle of a cell.
    fn at(odometry: Pose, cell: f64) -> Self {
        const OFF: f64 = 0.08;
        const TURN: f64 = 0.06;
        Self { spread: [OFF * OFF * cell * cell, TURN * TURN], odometry, ..Self::default() }
    }

    fn predict(&mut self, odometry: Pose) {
        /// How much of a turn and of a way odometry may miss.
        const MISSED: f64 = 0.02;
        let way = odometry.distance_to(self.odometry.position());
        let turned = angle_difference(odometry.heading, self.odometry.heading);
        self.odometry = odometry;
        self.off += way * math::sin(self.turn + 0.5 * turned);
        self.turn += turned;
        let [off, turn] = self.spread;
        self.spread[0] = off + 2.0 * way * self.common + way * way * turn;
        self.common += way * turn;
        self.spread[1] = turn + MISSED * MISSED * (turned.abs() + way);
    }

    fn correct(&mut self, off: f64, error: f64) {
        let [own, turn] = self.spread;
        let gains = [own, self.common].map(|spread| spread / (own + error * error));
        let innovation = off - self.off;
        self.off += gains[0] * innovation;
        self.turn += gains[1] * innovation;
        self.spread = [own * (1.0 - gains[0]), turn - gains[1] * self.common];
        self.common *= 1.0 - gains[0];
    }
}
