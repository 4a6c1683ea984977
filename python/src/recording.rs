use std::collections::BTreeMap;
use std::path::PathBuf;

use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList};
use roverlab::geometry::Pose;
use roverlab::io::log::{Log, LogError, Sight};
use roverlab::world::World;
use roverlab::world::formats::wld;

use crate::arrays::{self, Natural};
use crate::errors::{Failure, FileFormatError, Outcome};
use crate::scene::Scene;

/// A recording of a run: an MCAP file that a command's ``--record`` or the library has written.
///
/// Made by `load` or `read`. Its tables are dicts of columns: arrays, or lists of texts, of equal length, in
/// the
/// order of the recording. Robots are given by their index, from 0 on.
#[pyclass(frozen, module = "roverlab.log")]
#[derive(Debug)]
pub(crate) struct Recording {
    log: Log,
}

/// The file of a recording's world, among its attachments.
const WORLD: &str = "scene.wld";

impl Recording {
    fn of(py: Python<'_>, bytes: Vec<u8>, name: &str) -> Outcome<Self> {
        let wrong = |error: LogError| {
            Failure::from(FileFormatError::new_err(format!("{name}: {error}; expected a recording")))
        };
        Ok(Self { log: py.detach(|| Log::read(bytes)).map_err(wrong)? })
    }

    fn check(&self, robot: Natural) -> Outcome<usize> {
        let (robot, robots) = (robot.index("robot")?, self.log.robots());
        if robot < robots {
            return Ok(robot);
        }
        Err(Failure::value(
            "robot",
            robot,
            &format!("an index below {robots}, the number of recorded robots"),
        ))
    }

    /// What is seen of a robot, with times, as far as `take` wants it.
    fn seen<T: Send>(
        &self,
        py: Python<'_>,
        robot: usize,
        take: impl Fn(Sight) -> Option<T> + Sync,
    ) -> Vec<(f64, T)> {
        py.detach(|| {
            let seen = self.log.messages().flat_map(|message| message.seen());
            let own = seen.filter(|seen| seen.robot == robot);
            own.filter_map(|seen| Some((seen.time, take(seen.sight)?))).collect()
        })
    }
}

/// A table of poses.
fn poses_of<'py>(py: Python<'py>, poses: &[(f64, Pose)]) -> Outcome<Bound<'py, PyDict>> {
    let column = |value: fn(&(f64, Pose)) -> f64| PyArray1::from_iter(py, poses.iter().map(value));
    let table = PyDict::new(py);
    table.set_item("time", column(|row| row.0))?;
    table.set_item("x", column(|row| row.1.x))?;
    table.set_item("y", column(|row| row.1.y))?;
    table.set_item("heading", column(|row| row.1.heading))?;
    Ok(table)
}

#[pymethods]
impl Recording {
    /// Reads a file.
    ///
    /// Raises
    /// ------
    /// FileNotFoundError, FileFormatError
    ///     If there is no such file, or it is not an intact recording.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> Outcome<Self> {
        if !path.exists() {
            return Err(Failure::no_file(&path));
        }
        let bytes = py.detach(|| std::fs::read(&path)).map_err(PyErr::from)?;
        Self::of(py, bytes, &path.display().to_string())
    }

    /// Reads the bytes of a file.
    #[staticmethod]
    fn read(py: Python<'_>, data: &Bound<'_, PyAny>) -> Outcome<Self> {
        let bytes = data.cast::<PyBytes>().map_err(|_| Failure::kind("data", data.get_type(), "bytes"))?;
        Self::of(py, bytes.as_bytes().to_vec(), "data")
    }

    /// Scans of a robot's lidar.
    ///
    /// Returns
    /// -------
    /// dict
    ///     ``time`` (s), ``angle_min`` and ``angle_increment`` (rad), ``beams``, each of shape (scans,), and
    ///     ``ranges``
    ///     (m) of shape (scans, most beams): inf without a return, nan after a scan's last beam.
    #[pyo3(signature = (robot = Natural::ZERO), text_signature = "($self, robot=0)")]
    fn scans<'py>(&self, py: Python<'py>, robot: Natural) -> Outcome<Bound<'py, PyDict>> {
        let robot = self.check(robot)?;
        let scans = self.seen(py, robot, |sight| match sight {
            Sight::Scan(scan) => Some(scan),
            _ => None,
        });
        let most = scans.iter().map(|(_, scan)| scan.ranges.len()).max().unwrap_or(0);
        let mut ranges = Vec::with_capacity(most * scans.len());
        for (_, scan) in &scans {
            ranges.extend_from_slice(&scan.ranges);
            ranges.resize(ranges.len() + most - scan.ranges.len(), f64::NAN);
        }
        let table = PyDict::new(py);
        table.set_item("time", PyArray1::from_iter(py, scans.iter().map(|(time, _)| *time)))?;
        let scan = || scans.iter().map(|(_, scan)| scan);
        table.set_item("angle_min", PyArray1::from_iter(py, scan().map(|scan| scan.angle_min)))?;
        table
            .set_item("angle_increment", PyArray1::from_iter(py, scan().map(|scan| scan.angle_increment)))?;
        table.set_item("beams", PyArray1::from_iter(py, scan().map(|scan| scan.ranges.len() as i64)))?;
        table.set_item("ranges", arrays::matrix(py, ranges, [scans.len(), most])?)?;
        Ok(table)
    }

    /// Images of a robot's camera.
    ///
    /// Parameters
    /// ----------
    /// robot : int
    ///     Index of the robot.
    /// display : bool
    ///     Whether those of the robot's display instead.
    ///
    /// Returns
    /// -------
    /// dict
    ///     ``time`` (s) of shape (images,), and ``image``: a list of arrays of uint8 of shape (height, width,
    ///     3).
    #[pyo3(signature = (robot = Natural::ZERO, display = false), text_signature = "($self, robot=0, display=False)")]
    fn images<'py>(&self, py: Python<'py>, robot: Natural, display: bool) -> Outcome<Bound<'py, PyDict>> {
        let robot = self.check(robot)?;
        let images = self.seen(py, robot, |sight| match sight {
            Sight::Image(image) if !display => Some(image),
            Sight::Display(image) if display => Some(image),
            _ => None,
        });
        let (times, pictures) =
            (PyArray1::from_iter(py, images.iter().map(|(time, _)| *time)), PyList::empty(py));
        for (_, image) in images {
            let shape = [image.height() as usize, image.width() as usize, 3];
            pictures.append(PyArray1::from_vec(py, image.into_raw()).reshape(shape)?)?;
        }
        let table = PyDict::new(py);
        table.set_item("time", times)?;
        table.set_item("image", pictures)?;
        Ok(table)
    }

    /// Poses of a robot by odometry, relative to its start.
    ///
    /// Returns
    /// -------
    /// dict
    ///     ``time`` (s), ``x`` and ``y`` (m), ``heading`` (rad), each of shape (poses,).
    #[pyo3(signature = (robot = Natural::ZERO), text_signature = "($self, robot=0)")]
    fn odometry<'py>(&self, py: Python<'py>, robot: Natural) -> Outcome<Bound<'py, PyDict>> {
        let robot = self.check(robot)?;
        let poses = self.seen(py, robot, |sight| match sight {
            Sight::Odometry(pose) => Some(pose),
            _ => None,
        });
        poses_of(py, &poses)
    }

    /// True poses of a robot in the world, as far as the run asked for them.
    ///
    /// Returns
    /// -------
    /// dict
    ///     ``time`` (s), ``x`` and ``y`` (m), ``heading`` (rad), each of shape (poses,).
    #[pyo3(signature = (robot = Natural::ZERO), text_signature = "($self, robot=0)")]
    fn truth<'py>(&self, py: Python<'py>, robot: Natural) -> Outcome<Bound<'py, PyDict>> {
        let robot = self.check(robot)?;
        let poses = self.seen(py, robot, |sight| match sight {
            Sight::Truth(pose) => Some(pose),
            _ => None,
        });
        poses_of(py, &poses)
    }

    /// Readings of a robot's distance sensors.
    ///
    /// Returns
    /// -------
    /// dict
    ///     ``time`` (s), ``sensor``, the sensor's number, and ``distance`` (m), each of shape (readings,).
    #[pyo3(signature = (robot = Natural::ZERO), text_signature = "($self, robot=0)")]
    fn distances<'py>(&self, py: Python<'py>, robot: Natural) -> Outcome<Bound<'py, PyDict>> {
        let robot = self.check(robot)?;
        let readings = self.seen(py, robot, |sight| match sight {
            Sight::Distance(sensor, distance) => Some((sensor, distance)),
            _ => None,
        });
        let table = PyDict::new(py);
        table.set_item("time", PyArray1::from_iter(py, readings.iter().map(|(time, _)| *time)))?;
        table.set_item(
            "sensor",
            PyArray1::from_iter(py, readings.iter().map(|(_, (sensor, _))| i64::from(sensor.0))),
        )?;
        table.set_item(
            "distance",
            PyArray1::from_iter(py, readings.iter().map(|(_, (_, distance))| *distance)),
        )?;
        Ok(table)
    }

    /// All calls to a robot, and the queries of the ground truth beside it.
    ///
    /// Returns
    /// -------
    /// dict
    ///     ``time`` (s) and ``truth``, whether it asked for the ground truth: arrays of shape (calls,);
    ///     ``method``,
    ///     ``arguments``, ``result`` and ``error``: lists of texts, empty where there is none.
    #[pyo3(signature = (robot = Natural::ZERO), text_signature = "($self, robot=0)")]
    fn calls<'py>(&self, py: Python<'py>, robot: Natural) -> Outcome<Bound<'py, PyDict>> {
        let robot = self.check(robot)?;
        let entries: Vec<_> = py.detach(|| self.log.entries(robot).collect());
        let table = PyDict::new(py);
        table.set_item("time", PyArray1::from_iter(py, entries.iter().map(|entry| entry.time)))?;
        table.set_item("truth", PyArray1::from_iter(py, entries.iter().map(|entry| entry.truth)))?;
        let (mut methods, mut arguments) = (Vec::new(), Vec::new());
        let (mut results, mut errors) = (Vec::new(), Vec::new());
        for entry in entries {
            methods.push(entry.method);
            arguments.push(entry.arguments);
            let (result, error) = match entry.result {
                Ok(result) => (result, String::new()),
                Err(error) => (String::new(), error),
            };
            results.push(result);
            errors.push(error);
        }
        table.set_item("method", methods)?;
        table.set_item("arguments", arguments)?;
        table.set_item("result", results)?;
        table.set_item("error", errors)?;
        Ok(table)
    }

    /// The recorded world, without its robots; None if the recording has none.
    fn scene(&self) -> Outcome<Option<Scene>> {
        let Some(file) = self.log.header().attachment(WORLD) else { return Ok(None) };
        let world: World = wld::parse(&String::from_utf8_lossy(&file.data), WORLD)?.value;
        Ok(Some(Scene::of(world)))
    }

    /// Start pose of a robot in the world: x, y and heading (m, m, rad); None if it is not recorded.
    #[pyo3(signature = (robot = Natural::ZERO), text_signature = "($self, robot=0)")]
    fn start(&self, robot: Natural) -> Outcome<Option<(f64, f64, f64)>> {
        Ok(self.log.start(self.check(robot)?).map(arrays::triple))
    }

    /// Name of the program that was recorded.
    #[getter]
    fn program(&self) -> &str {
        &self.log.header().program
    }

    /// Its options that affect the run.
    #[getter]
    fn options(&self) -> Vec<String> {
        self.log.header().options.clone()
    }

    /// Seed of all random numbers, if there was one.
    #[getter]
    fn seed(&self) -> Option<u64> {
        self.log.header().seed
    }

    /// Version of the library that made the recording.
    #[getter]
    fn version(&self) -> &str {
        &self.log.header().version
    }

    /// Number of recorded robots.
    #[getter]
    fn robots(&self) -> usize {
        self.log.robots()
    }

    /// Times of the first and the last message (s); None without messages.
    #[getter]
    fn span(&self) -> Option<(f64, f64)> {
        self.log.span()
    }

    /// Number of messages on each topic.
    #[getter]
    fn topics(&self) -> BTreeMap<String, u64> {
        self.log.topics().clone()
    }

    /// Files that belong to the run, such as its world: their content by name.
    #[getter]
    fn attachments<'py>(&self, py: Python<'py>) -> Outcome<Bound<'py, PyDict>> {
        let files = PyDict::new(py);
        for file in &self.log.header().attachments {
            files.set_item(&file.name, PyBytes::new(py, &file.data))?;
        }
        Ok(files)
    }

    fn __repr__(&self) -> String {
        let (header, robots) = (self.log.header(), self.log.robots());
        let end = self.log.span().map_or(0.0, |(_, end)| end);
        format!("<Recording: {}, {robots} robots, {end} s>", header.program)
    }
}
