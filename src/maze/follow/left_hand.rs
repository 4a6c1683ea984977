use std::f64::consts::FRAC_PI_2;
use std::ops::ControlFlow;

use super::cell_drive::{CellDrive, CellDriveParameters, read};
use crate::geometry::{Pose, Twist};
use crate::io::control::{Behaviour, Decision, Manoeuvre, Senses, halts};
use crate::io::reading::{check_distances, check_pose, check_speed};
use crate::io::{DistanceSensors, Manoeuvres, Odometry, Result, StallDetector};
use crate::maze::Direction;
use crate::parameter::require_positive;

/// How the robot drives from cell to cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Straight {
    /// By odometry only, as in the book's first program (section 9.2).
    OpenLoop {
        /// Distance (m).
        length: f64,
        /// Speed (m/s).
        speed: f64,
    },
    /// Midway between the walls (section 9.3).
    Controlled(CellDriveParameters),
}

/// Parameters of [`LeftHand`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeftHandParameters {
    /// Reading above which there is no wall (m).
    pub threshold: f64,
    /// Angular velocity on the spot (rad/s).
    pub turn_rate: f64,
    /// How to drive from cell to cell.
    pub straight: Straight,
    /// Control period of a controlled drive (s).
    pub period: f64,
}

impl LeftHandParameters {
    /// The book's open-loop program: threshold 400 mm, 45 deg/s, 180 mm/s, cells of 360 mm.
    pub fn as_printed() -> Self {
        Self {
            threshold: 0.400,
            turn_rate: 45_f64.to_radians(),
            straight: Straight::OpenLoop { length: 0.360, speed: 0.180 },
            period: 0.01,
        }
    }

    /// The same with a controlled drive. The threshold lies midway between a wall of the robot's own cell and
    /// one of the next.
    pub fn controlled(drive: CellDriveParameters) -> Self {
        let threshold = 0.5 * (drive.ahead + drive.aside + drive.cell);
        Self { threshold, straight: Straight::Controlled(drive), ..Self::as_printed() }
    }
}

/// Left-hand rule: left if free, else straight on, else right, else back (book, section 9.2). It ends in a
/// cell with walls on all sides.
///
/// ```
/// use roverlab::maze::{Direction, LeftHand, LeftHandParameters};
/// let rule = LeftHand::new(LeftHandParameters::as_printed(), Direction::North)?;
/// // Front, left, right: quarter turns to the left.
/// assert_eq!(rule.choose([0.1, 0.5, 0.5]), 1);
/// assert_eq!(rule.choose([0.5, 0.1, 0.5]), 0);
/// assert_eq!(rule.choose([0.1, 0.1, f64::INFINITY]), -1);
/// assert_eq!(rule.choose([0.1, 0.1, 0.1]), 2);
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct LeftHand {
    parameters: LeftHandParameters,
    controller: Option<CellDrive>,
    phase: Phase,
    at: (i32, i32),
    heading: Direction,
    cells: usize,
}

/// Phase of the motion.
#[derive(Debug, Clone, Copy)]
enum Phase {
    /// Stands in a cell.
    Choosing,
    /// Turns on the spot, perhaps back from walls ahead and at both sides.
    Turning { back: bool },
    /// Drives into the next cell.
    Driving,
    /// Comes to rest before the next reading, for at most this number of steps.
    Resting(usize),
}

/// Maximum time for coming to rest (s).
const REST: f64 = 0.3;
/// Speed below which the robot counts as at rest (m/s).
const AT_REST: f64 = 2e-3;

/// Outcome of a drive by the left-hand rule.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum LeftHandOutcome {
    /// The observer stopped it.
    Stopped,
    /// The time limit was exceeded.
    TimedOut,
    /// The robot stalled.
    Stalled,
    /// There are walls on all sides.
    Enclosed,
}

halts!(LeftHandOutcome { Stalled: "something holds the robot", Enclosed: "there are walls on all sides" });

/// Observation of a [`LeftHand`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LeftHandObservation {
    /// Pose by odometry.
    pub pose: Pose,
    /// Velocity by odometry.
    pub speed: Twist,
    /// Readings of the front, left and right sensor (m).
    pub readings: [f64; 3],
    /// Whether no manoeuvre is in progress.
    pub done: bool,
    /// Whether the robot is stalled.
    pub stalled: bool,
}

impl LeftHand {
    /// The rule for a robot with an initial heading.
    ///
    /// # Errors
    ///
    /// If a parameter is out of range.
    pub fn new(parameters: LeftHandParameters, heading: Direction) -> Result<Self> {
        require_positive("threshold", parameters.threshold)?;
        require_positive("turn rate", parameters.turn_rate)?;
        require_positive("control period", parameters.period)?;
        let controller = match parameters.straight {
            Straight::OpenLoop { length, speed } => {
                require_positive("length", length)?;
                require_positive("speed", speed)?;
                None
            }
            Straight::Controlled(drive) => Some(CellDrive::new(drive)?),
        };
        Ok(Self { parameters, controller, phase: Phase::Choosing, at: (0, 0), heading, cells: 0 })
    }

    /// Present or last cell, relative to the start: cells to the east and to the north.
    pub fn at(&self) -> (i32, i32) {
        self.at
    }

    /// Present or target heading.
    pub fn heading(&self) -> Direction {
        self.heading
    }

    /// Number of cells entered.
    pub fn cells(&self) -> usize {
        self.cells
    }

    /// Quarter turns to the left, -1 to 2, for the readings front, left, right.
    pub fn choose(&self, readings: [f64; 3]) -> i32 {
        match readings.map(|reading| self.is_wall(reading)) {
            [_, false, _] => 1,
            [false, true, _] => 0,
            [true, true, false] => -1,
            [true, true, true] => 2,
        }
    }

    fn is_wall(&self, reading: f64) -> bool {
        reading <= self.parameters.threshold
    }

    fn turn_or_drive(&mut self, seen: &LeftHandObservation) -> Decision<Self> {
        let quarters = self.choose(seen.readings);
        if quarters == 0 {
            return self.set_off(seen);
        }
        self.heading = self.heading.turned_right((4 - quarters) as usize % 4);
        self.phase = Phase::Turning { back: quarters == 2 };
        let angle = f64::from(quarters) * FRAC_PI_2;
        Ok(ControlFlow::Continue(Manoeuvre::Turn(angle, self.parameters.turn_rate)))
    }

    /// Starts to drive into the next cell.
    fn set_off(&mut self, seen: &LeftHandObservation) -> Decision<Self> {
        self.phase = Phase::Driving;
        match self.parameters.straight {
            Straight::OpenLoop { length, speed } => {
                Ok(ControlFlow::Continue(Manoeuvre::Straight(length, speed)))
            }
            Straight::Controlled(_) => self.drive(seen),
        }
    }

    fn drive(&mut self, seen: &LeftHandObservation) -> Decision<Self> {
        let period = self.parameters.period;
        let Some(controller) = &mut self.controller else {
            if seen.done && !seen.stalled {
                self.arrive();
            }
            return Ok(ControlFlow::Continue(Manoeuvre::Continue));
        };
        let speed = controller.step(seen.pose, seen.readings, period)?;
        if speed.is_none() {
            controller.begin();
            self.phase = Phase::Resting((REST / period) as usize);
        }
        Ok(ControlFlow::Continue(Manoeuvre::Speed(speed.unwrap_or(Twist::STOP))))
    }

    fn arrive(&mut self) {
        let (dx, dy) = self.heading.step();
        self.at = (self.at.0 + dx, self.at.1 + dy);
        self.cells += 1;
        self.phase = Phase::Choosing;
    }
}

impl Behaviour for LeftHand {
    type Observation = LeftHandObservation;
    type Command = Manoeuvre;
    type Outcome = LeftHandOutcome;

    fn period(&self) -> f64 {
        self.parameters.period
    }

    fn step(&mut self, _time: f64, seen: &LeftHandObservation) -> Decision<Self> {
        check_pose(&seen.pose)?;
        check_speed(&seen.speed)?;
        check_distances("observed distance", &seen.readings)?;
        let waits = Ok(ControlFlow::Continue(Manoeuvre::Continue));
        match self.phase {
            Phase::Choosing => self.turn_or_drive(seen),
            Phase::Turning { back } => {
                if let Some(controller) = &mut self.controller {
                    controller.turned(seen.pose);
                }
                if !seen.done && !seen.stalled {
                    waits
                } else if back && self.is_wall(seen.readings[0]) {
                    Ok(ControlFlow::Break(LeftHandOutcome::Enclosed))
                } else {
                    self.set_off(seen)
                }
            }
            Phase::Driving if seen.stalled => Ok(ControlFlow::Break(LeftHandOutcome::Stalled)),
            Phase::Driving => self.drive(seen),
            Phase::Resting(left) => {
                self.phase = Phase::Resting(left.saturating_sub(1));
                if left == 0 || seen.speed.linear.abs() < AT_REST {
                    self.arrive();
                }
                waits
            }
        }
    }
}

impl<R: DistanceSensors + Odometry + Manoeuvres + StallDetector + ?Sized> Senses<R> for LeftHand {
    fn sense(&mut self, robot: &mut R, _time: f64, seen: &mut LeftHandObservation) -> Result<()> {
        *seen = LeftHandObservation {
            pose: robot.pose()?,
            speed: robot.speed()?,
            readings: read(robot)?,
            done: robot.is_done()?,
            stalled: robot.is_stalled()?,
        };
        Ok(())
    }
}
