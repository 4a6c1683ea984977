use std::f64::consts::FRAC_PI_2;

use crate::io::{Error, Psd, Result};
use crate::kinematics::OdometryErrors;
use crate::world::{DriveSpec, Footprint, MotorSpec, Mount, PsdSpec, RobotSpec};

/// A robot of micromouse size: two wheels, three distance sensors, fast motors.
///
/// ```
/// use roverlab::maze::mouse;
/// assert_eq!(mouse().psds.len(), 3, "front, left, right");
/// ```
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

/// Properties of a robot that the maze programs need.
///
/// ```
/// use roverlab::kinematics::OdometryErrors;
/// use roverlab::maze::{Rig, mouse};
/// use roverlab::world::RobotSpec;
/// let rig = Rig::new(&mouse(), OdometryErrors::default(), 0.002)?;
/// assert!(rig.sensors.iter().all(|sensor| sensor.max_range > 0.1));
/// let blind = RobotSpec { psds: Vec::new(), ..mouse() };
/// assert!(Rig::new(&blind, OdometryErrors::default(), 0.002).is_err(), "three sensors are required");
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Rig {
    /// Distance between the wheels (m).
    pub track: f64,
    /// Time constant of the motors (s).
    pub lag: f64,
    /// Distance sensors: front, left, right.
    pub sensors: [RigSensor; 3],
    /// Odometry errors (standard deviations).
    pub errors: OdometryErrors,
    /// Standard deviation of a distance reading (m).
    pub range_error: f64,
}

/// A distance sensor of a rig.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigSensor {
    /// Sensor number.
    pub id: Psd,
    /// Position and direction on the robot.
    pub mount: Mount,
    /// Maximum reported distance (m).
    pub max_range: f64,
}

impl Rig {
    /// The rig of a described robot with the given errors.
    ///
    /// # Errors
    ///
    /// If the robot has no differential drive, or one of the three sensors is missing.
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
