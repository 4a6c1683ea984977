use std::f64::consts::FRAC_PI_2;

use super::cell_drive::{CellDrive, CellDriveParameters, read};
use crate::geometry::{Pose, Twist};
use crate::io::error::require_positive;
use crate::io::{Clock, DistanceSensors, Drive, Result};
use crate::maze::Direction;

/// How a robot drives from one cell to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Straight {
    /// By odometry alone, as the book's first program does (section 9.2): so many metres at a speed.
    OpenLoop {
        /// Metres.
        length: f64,
        /// Metres per second.
        speed: f64,
    },
    /// In the middle between the walls (section 9.3).
    Controlled(CellDriveParameters),
}

/// What [`LeftHand`] goes by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeftHandParameters {
    /// A reading beyond it, in metres, says that there is no wall.
    pub threshold: f64,
    /// Radians per second on the spot.
    pub turn_rate: f64,
    /// How to drive from cell to cell.
    pub straight: Straight,
    /// Seconds from one step of a controlled drive to the next.
    pub period: f64,
}

/// The same on the way.
enum Way {
    OpenLoop { length: f64, speed: f64 },
    Controlled(Box<CellDrive>),
}

impl LeftHandParameters {
    /// The book's program, open loop: 400 mm, 45 degrees and 180 mm a second, cells of 360 mm.
    pub fn as_printed() -> Self {
        Self {
            threshold: 0.400,
            turn_rate: 45_f64.to_radians(),
            straight: Straight::OpenLoop { length: 0.360, speed: 0.180 },
            period: 0.01,
        }
    }

    /// The same with another way to drive. The threshold lies half a cell beyond a wall of the robot's own cell, half a cell
    /// before one of the next.
    pub fn controlled(drive: CellDriveParameters) -> Self {
        let threshold = 0.5 * (drive.ahead + drive.aside + drive.cell);
        Self { threshold, straight: Straight::Controlled(drive), ..Self::as_printed() }
    }
}

/// Keeps the left hand on the wall: left where that is free, else straight on, else right, else back (book, section 9.2).
///
/// ```
/// use roverlab::maze::{LeftHand, LeftHandParameters};
/// let rule = LeftHand::new(LeftHandParameters::as_printed())?;
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
}

/// How a drive along the left wall ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LeftHandOutcome {
    /// The caller had seen enough.
    Finished,
    /// Something holds the robot.
    Stalled,
}

impl LeftHand {
    /// The rule for a robot. Fails with the name of the parameter that is out of range.
    pub fn new(parameters: LeftHandParameters) -> Result<Self> {
        require_positive("threshold", parameters.threshold)?;
        require_positive("turn rate", parameters.turn_rate)?;
        require_positive("control period", parameters.period)?;
        match parameters.straight {
            Straight::OpenLoop { length, speed } => {
                require_positive("length", length)?;
                require_positive("speed", speed)?;
            }
            Straight::Controlled(drive) => {
                CellDrive::new(drive)?;
            }
        }
        Ok(Self { parameters })
    }

    /// Quarter turns to the left, -1 to 2, for readings at the front, on the left and on the right.
    pub fn choose(&self, readings: [f64; 3]) -> i32 {
        match readings.map(|reading| reading > self.parameters.threshold) {
            [_, true, _] => 1,
            [true, false, _] => 0,
            [false, false, true] => -1,
            [false, false, false] => 2,
        }
    }

    /// Drives from cell to cell until `finished`, which is asked after each cell with the cells to the east and to the north
    /// since the start, as the robot counts them, and with its heading. `watch` is called at each step.
    pub fn run<R: Clock + Drive + DistanceSensors + ?Sized>(
        &self,
        robot: &mut R,
        mut heading: Direction,
        mut finished: impl FnMut((i32, i32), Direction) -> bool,
        mut watch: impl FnMut(),
    ) -> Result<LeftHandOutcome> {
        let mut at = (0, 0);
        let mut way = match self.parameters.straight {
            Straight::Controlled(drive) => Way::Controlled(Box::new(CellDrive::new(drive)?)),
            Straight::OpenLoop { length, speed } => Way::OpenLoop { length, speed },
        };
        loop {
            let quarters = self.choose(read(robot)?);
            if quarters != 0 {
                robot.turn(f64::from(quarters) * FRAC_PI_2, self.parameters.turn_rate)?;
                self.await_manoeuvre(robot, |pose| {
                    if let Way::Controlled(controller) = &mut way {
                        controller.turned(pose);
                    }
                    watch();
                })?;
                heading = heading.turned_right((4 - quarters) as usize % 4);
            }
            let stalled = match &mut way {
                Way::Controlled(controller) => self.drive(robot, controller, &mut watch)?,
                &mut Way::OpenLoop { length, speed } => {
                    robot.straight(length, speed)?;
                    self.await_manoeuvre(robot, |_| watch())?;
                    robot.is_stalled()?
                }
            };
            if stalled {
                robot.set_speed(Twist::STOP)?;
                return Ok(LeftHandOutcome::Stalled);
            }
            let (dx, dy) = heading.step();
            at = (at.0 + dx, at.1 + dy);
            if finished(at, heading) {
                return Ok(LeftHandOutcome::Finished);
            }
        }
    }

    fn await_manoeuvre<R: Clock + Drive + ?Sized>(
        &self,
        robot: &mut R,
        mut watch: impl FnMut(Pose),
    ) -> Result<()> {
        while !robot.is_done()? && !robot.is_stalled()? {
            robot.wait(self.parameters.period)?;
            watch(robot.pose()?);
        }
        Ok(())
    }

    /// Drives into the next cell. Returns whether something holds the robot.
    fn drive<R: Clock + Drive + DistanceSensors + ?Sized>(
        &self,
        robot: &mut R,
        controller: &mut CellDrive,
        watch: &mut impl FnMut(),
    ) -> Result<bool> {
        let period = self.parameters.period;
        loop {
            let pose: Pose = robot.pose()?;
            let readings = read(robot)?;
            let Some(speed) = controller.step(pose, readings, period)? else { break };
            if robot.is_stalled()? {
                return Ok(true);
            }
            robot.set_speed(speed)?;
            robot.wait(period)?;
            watch();
        }
        robot.set_speed(Twist::STOP)?;
        // The robot comes to rest before it reads its sensors again.
        for _ in 0..(0.3 / period) as usize {
            if robot.speed()?.linear.abs() < 2e-3 {
                break;
            }
            robot.wait(period)?;
            watch();
        }
        controller.begin();
        Ok(false)
    }
}
