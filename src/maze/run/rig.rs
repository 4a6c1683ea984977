use std::f64::consts::FRAC_PI_2;

use crate::io::{Error, Psd, Result};
use crate::kinematics::OdometryErrors;
use crate::world::{DriveSpec, Footprint, MotorSpec, Mount, PsdSpec, RobotSpec};

/// A robot of the size of a micromouse: two wheels, three distance sensors, quick motors.
pub fn mouse() -> RobotSpec {
    let psd = |id: u8, name: &str, x, y, yaw| PsdSpec {
        id,
        name: name.into(),
        mount: Mount { x, y, z: 0.020, yaw, ..Mount::default() },
        max_range: 1.0,
    };
    RobotSpec {
        name: "Mouse".into(),
        drive: DriveSpec::Differential {
            wheel_diameter: 0.024,
            track: 0.056,
            max_wheel_speed: 300.0,
            ticks_per_turn: 4096.0,
        },
        motor: MotorSpec { time_constant: 0.020, max_acceleration: 20.0 },
        footprint: Footprint::Disc { radius: 0.035 },
        height: 0.030,
        mass: 0.1,
        psds: vec![
            psd(Psd::FRONT.0, "PSD_FRONT", 0.030, 0.0, 0.0),
            psd(Psd::LEFT.0, "PSD_LEFT", 0.020, 0.020, FRAC_PI_2),
            psd(Psd::RIGHT.0, "PSD_RIGHT", 0.020, -0.020, -FRAC_PI_2),
        ],
        lidar: None,
        camera: None,
        ..RobotSpec::s4()
    }
}

/// What a program has to know about its robot to drive it through a maze.
#[derive(Debug, Clone, PartialEq)]
pub struct Rig {
    /// Metres between the wheels.
    pub track: f64,
    /// The time constant, in seconds, with which wheel speed follows a command.
    pub lag: f64,
    /// The distance sensors at the front, on the left and on the right.
    pub sensors: [RigSensor; 3],
    /// Standard deviations of the robot from its description.
    pub errors: OdometryErrors,
    /// The standard deviation of a distance sensor's reading, in metres.
    pub range_error: f64,
}

/// A distance sensor of a rig.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigSensor {
    /// The number by which programs read it.
    pub id: Psd,
    /// Where it sits, and where it points.
    pub mount: Mount,
    /// The farthest distance that it reports, in metres.
    pub max_range: f64,
}

impl Rig {
    /// The rig of a described robot, whose drive and sensors err as said. Fails for a robot without two driven wheels or
    /// without one of the three sensors.
    pub fn new(spec: &RobotSpec, errors: OdometryErrors, range_error: f64) -> Result<Self> {
        let DriveSpec::Differential { track, .. } = spec.drive else {
            let message = format!("robot {}: a drive other than two wheels side by side", spec.name);
            return Err(Error::unsupported(message));
        };
        let sensor = |id: Psd| {
            let psd = spec.psds.iter().find(|psd| psd.id == id.0);
            let psd = psd.ok_or_else(|| Error::unsupported(format!("robot {}: {id}", spec.name)))?;
            Ok::<_, Error>(RigSensor { id, mount: psd.mount, max_range: psd.max_range })
        };
        let sensors = [sensor(Psd::FRONT)?, sensor(Psd::LEFT)?, sensor(Psd::RIGHT)?];
        Ok(Self { track, lag: spec.motor.time_constant, sensors, errors, range_error })
    }
}
