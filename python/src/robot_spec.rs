use std::path::PathBuf;
use std::sync::Arc;

use pyo3::prelude::*;
use roverlab::drive::terrain::SlopeSensor;
use roverlab::io::{LidarSettings, Psd};
use roverlab::world;
use roverlab::world::formats::{load_robot_tolerantly, parse_robot};

use crate::arrays::Natural;
use crate::errors::{Failure, Outcome};

/// Description of a robot: drive, outline and sensors.
///
/// Parameters
/// ----------
/// name : str
///     One of `RobotSpec.names()`, in any case, such as ``"S4"`` or ``"LabBot"``.
///
/// Raises
/// ------
/// ValueError
///     If no built-in robot has this name.
#[pyclass(frozen, module = "roverlab.sim")]
#[derive(Debug)]
pub(crate) struct RobotSpec {
    pub(crate) spec: Arc<world::RobotSpec>,
}

/// Name of the racing car, which scripts of scenes do not know.
const RACE_CAR: &str = "RaceCar";

impl RobotSpec {
    fn of(spec: world::RobotSpec) -> Self {
        Self { spec: Arc::new(spec) }
    }
}

#[pymethods]
impl RobotSpec {
    #[new]
    pub(crate) fn new(name: &str) -> Outcome<Self> {
        let spec = if name.eq_ignore_ascii_case(RACE_CAR) {
            Some(world::RobotSpec::race_car())
        } else {
            world::RobotSpec::predefined(name)
        };
        spec.map(Self::of).ok_or_else(|| {
            let expected = format!("one of {}", Self::names().join(", "));
            Failure::value("name", format!("{name:?}"), &expected)
        })
    }

    /// Names of the built-in robots.
    #[staticmethod]
    fn names() -> Vec<&'static str> {
        world::RobotSpec::PREDEFINED.into_iter().chain([RACE_CAR]).collect()
    }

    /// Reads EyeSim's description of a robot, a file ``.robi``.
    ///
    /// Raises
    /// ------
    /// FileNotFoundError, FileFormatError
    ///     If there is no such file, or it is not understood.
    #[staticmethod]
    fn load(path: PathBuf) -> Outcome<Self> {
        if !path.exists() {
            return Err(Failure::no_file(&path));
        }
        Ok(Self::of(load_robot_tolerantly(path)?.value))
    }

    /// Reads a description from the text of a file ``.robi``; errors call it `name`.
    #[staticmethod]
    #[pyo3(signature = (text, name = "robot.robi"))]
    fn parse(text: String, name: &str) -> Outcome<Self> {
        Ok(Self::of(parse_robot(text.into_bytes(), name)?.value))
    }

    /// The same robot with another laser scanner, or with one.
    ///
    /// Parameters
    /// ----------
    /// beams : int
    ///     Number of beams, 1 to 100000.
    /// field_of_view : float
    ///     Angle between the first and the last beam, centred on straight ahead (rad). A full turn, the
    ///     default, omits the last beam, which would repeat the first.
    /// max_range : float, optional
    ///     Longest distance that it reports (m); otherwise that of the present scanner.
    #[pyo3(signature = (beams, field_of_view = std::f64::consts::TAU, max_range = None))]
    fn with_lidar(&self, beams: Natural, field_of_view: f64, max_range: Option<f64>) -> Outcome<Self> {
        let beams = beams.index("beams")?;
        LidarSettings { field_of_view, tilt: 0.0, points: beams }.validate()?;
        let mut spec = world::RobotSpec::clone(&self.spec);
        let old = spec.lidar.unwrap_or_default();
        let max_range = max_range.unwrap_or(old.max_range);
        spec.lidar = Some(world::LidarSpec { field_of_view, points: beams, max_range, ..old });
        spec.validate()?;
        Ok(Self::of(spec))
    }

    /// The same robot with eight distance sensors more, 11 to 18, at its top: they point outwards, each 45
    /// degrees counter-clockwise from the one before, and down by 45 degrees.
    fn with_slope_sensors(&self) -> Self {
        Self::of(SlopeSensor::equip(world::RobotSpec::clone(&self.spec)))
    }

    /// Name of the robot.
    #[getter]
    fn name(&self) -> &str {
        &self.spec.name
    }

    /// Radius of the smallest circle about its origin that contains its outline (m).
    #[getter]
    fn radius(&self) -> f64 {
        self.spec.footprint.bounding_radius()
    }

    /// Highest speed (m/s).
    #[getter]
    fn top_speed(&self) -> f64 {
        self.spec.drive.top_speed()
    }

    /// Number of beams of its laser scanner; 0 without one.
    #[getter]
    fn beams(&self) -> usize {
        self.spec.lidar.map_or(0, |lidar| lidar.points)
    }

    /// Names of its distance sensors: ``front``, ``left``, ``right`` and ``back``, or their numbers.
    #[getter]
    fn distance_sensors(&self) -> Vec<String> {
        self.spec.psds.iter().map(|psd| sensor_name(Psd(psd.id))).collect()
    }

    fn __repr__(&self) -> String {
        format!("RobotSpec({:?})", self.spec.name)
    }
}

/// Names of the distance sensors that every robot may have.
const SENSORS: [(&str, Psd); 4] =
    [("front", Psd::FRONT), ("left", Psd::LEFT), ("right", Psd::RIGHT), ("back", Psd::BACK)];

pub(crate) fn sensor_name(sensor: Psd) -> String {
    let named = SENSORS.iter().find(|(_, psd)| *psd == sensor);
    named.map_or_else(|| sensor.0.to_string(), |(name, _)| (*name).into())
}

/// The sensor of a name: `front`, `left`, `right`, `back`, or a number.
pub(crate) fn sensor(name: &str) -> Outcome<Psd> {
    let named = SENSORS.iter().find(|(known, _)| *known == name).map(|(_, psd)| *psd);
    named.or_else(|| name.parse().ok().map(Psd)).ok_or_else(|| {
        Failure::value("sensor", format!("{name:?}"), "front, left, right, back or the number of a sensor")
    })
}
