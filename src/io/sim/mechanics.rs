use super::bicycle::Bicycle;
use super::car::Car;
use super::drive_mechanics::{Drift, Mechanics};
use super::drivetrain::{MecanumWheels, TwoWheels};
use super::marine::CraftDrive;
use super::wheels::WheelSpec;
use super::{NoiseModel, TICK};

use crate::io::{Error, ErrorKind, Result};
use crate::kinematics::marine::Craft;
use crate::kinematics::{Ackermann, Differential, Omni, PlanarMotion, Tracked};
use crate::random::Stream;
use crate::world::{DriveSpec, RobotSpec};

/// A drive of any kind. Most robots have two wheels; the larger variants are boxed.
#[derive(Debug, Clone)]
#[allow(clippy::large_enum_variant, reason = "nearly all robots have this one, and it is stepped most")]
pub(super) enum Powertrain {
    Differential(TwoWheels),
    Car(Box<Car>),
    Omni(Box<MecanumWheels>),
    Craft(Box<CraftDrive>),
}

/// Highest top speed of a robot (m/s).
const MAX_TOP_SPEED: f64 = 100.0;

impl Powertrain {
    /// The drive of a description, with random errors for one robot.
    pub(super) fn new(
        spec: &RobotSpec,
        noise: &NoiseModel,
        ideal_encoders: bool,
        stream: Stream,
    ) -> Result<Self> {
        let invalid = |error: crate::ParameterError| {
            Error::new(ErrorKind::InvalidInput, format!("robot {}: {error}", spec.name)).with_source(error)
        };
        let wheels = wheel_spec(&spec.drive);
        check_top_speed(spec, &wheels)?;
        let motor = spec.motor;
        Ok(match spec.drive {
            DriveSpec::Differential { track, .. } => {
                let drive = Differential { track };
                Self::Differential(TwoWheels::new(drive, &wheels, motor, noise, ideal_encoders, stream))
            }
            DriveSpec::Tracked { track, length, width, .. } => {
                let drive = Tracked::new(track, length, width).map_err(invalid)?.equivalent();
                Self::Differential(TwoWheels::new(drive, &wheels, motor, noise, ideal_encoders, stream))
            }
            DriveSpec::Ackermann { track, wheelbase, max_steering, dynamics, .. } => {
                let drive = Ackermann::new(wheelbase, track, max_steering).map_err(invalid)?;
                let own = stream.child("dynamics", 0);
                let bicycle = dynamics.map(|dynamics| Bicycle::new(dynamics, motor, wheelbase, noise, own));
                let car = Car::new(drive, track, &wheels, motor, noise, ideal_encoders, stream);
                Self::Car(Box::new(car.with_dynamics(bicycle)))
            }
            DriveSpec::Omni { track, wheelbase, .. } => {
                let drive = Omni::mecanum(track, wheelbase).map_err(invalid)?;
                Self::Omni(Box::new(MecanumWheels::new(drive, &wheels, motor, noise, ideal_encoders, stream)))
            }
            DriveSpec::Craft(ref craft) => {
                let craft = Craft::new(craft, TICK).map_err(invalid)?;
                Self::Craft(Box::new(CraftDrive::new(craft, spec.dvl, noise, stream)))
            }
        })
    }

    /// Lets the motors follow their commands for some ticks, at most
    /// [`AHEAD`](super::drive_mechanics::AHEAD).
    pub(super) fn run(&mut self, drifts: &mut [Drift]) {
        match self {
            Self::Differential(drive) => drive.run(drifts),
            Self::Car(drive) => fill(drifts, || (drive.step(), drive.is_driving())),
            Self::Omni(drive) => fill(drifts, || (drive.step(), drive.is_driving())),
            // Water moves it, and the hills know how.
            Self::Craft(drive) => fill(drifts, || (PlanarMotion::default(), drive.is_driving())),
        }
    }

    /// Whether it does the same whatever stands in the robot's way.
    pub(super) fn is_independent(&self) -> bool {
        matches!(self, Self::Differential(_) | Self::Omni(_))
    }

    /// Records the robot's true motion in this tick, which obstacles may have changed.
    pub(super) fn settle(&mut self, moved: PlanarMotion) {
        if let Self::Car(drive) = self {
            drive.settle(moved);
        }
    }

    pub(super) fn get(&self) -> &dyn Mechanics {
        match self {
            Self::Differential(drive) => drive,
            Self::Car(drive) => drive.as_ref(),
            Self::Omni(drive) => drive.as_ref(),
            Self::Craft(drive) => drive.as_ref(),
        }
    }

    pub(super) fn get_mut(&mut self) -> &mut dyn Mechanics {
        match self {
            Self::Differential(drive) => drive,
            Self::Car(drive) => drive.as_mut(),
            Self::Omni(drive) => drive.as_mut(),
            Self::Craft(drive) => drive.as_mut(),
        }
    }

    /// The thrusters of a craft.
    pub(super) fn craft_mut(&mut self) -> Option<&mut CraftDrive> {
        if let Self::Craft(drive) = self { Some(drive) } else { None }
    }
}

fn fill(drifts: &mut [Drift], mut step: impl FnMut() -> (PlanarMotion, bool)) {
    drifts.fill_with(|| {
        let (motion, is_driving) = step();
        Drift { motion, is_driving, reach: 0.0 }
    });
}

fn wheel_spec(drive: &DriveSpec) -> WheelSpec {
    match *drive {
        DriveSpec::Craft(_) => WheelSpec::NONE,
        DriveSpec::Differential { wheel_diameter, max_wheel_speed, ticks_per_turn, .. }
        | DriveSpec::Ackermann { wheel_diameter, max_wheel_speed, ticks_per_turn, .. }
        | DriveSpec::Tracked { wheel_diameter, max_wheel_speed, ticks_per_turn, .. }
        | DriveSpec::Omni { wheel_diameter, max_wheel_speed, ticks_per_turn, .. } => {
            WheelSpec { diameter: wheel_diameter, max_speed: max_wheel_speed, ticks_per_turn }
        }
    }
}

/// Faster robots would cross walls and worlds within a tick.
fn check_top_speed(spec: &RobotSpec, wheels: &WheelSpec) -> Result<()> {
    let speed = wheels.limit();
    if speed <= MAX_TOP_SPEED {
        return Ok(());
    }
    let name = format!("robot {}: top speed", spec.name);
    Err(Error::invalid_input(&name, format!("{speed} m/s"), &format!("at most {MAX_TOP_SPEED} m/s")))
}
