use std::sync::Arc;

use numpy::{PyArray1, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use roverlab::geometry::Twist;
use roverlab::io::sim::{FleetRobot, TICK};
use roverlab::io::{
    Camera, DepthSensor, DistanceSensors, Drive, Encoders, Inertial, Lidar, LidarSettings, Manoeuvres,
    Motors, Odometry, Resolution, Result, Servos, StallDetector,
};

use crate::arrays::{self, Natural};
use crate::errors::{Failure, Outcome};
use crate::robot_spec::sensor;
use crate::simulation::{Shared, State};

/// A robot of a `Simulation`: commands to it and readings of its sensors.
///
/// No call but `wait` and `wait_done` lets time pass. Each reading of a sensor has its own noise, also at the
/// same time.
#[pyclass(frozen, module = "roverlab.sim")]
#[derive(Debug)]
pub(crate) struct Robot {
    shared: Arc<Shared>,
    index: usize,
}

impl Robot {
    pub(crate) fn new(shared: &Arc<Shared>, index: usize) -> Outcome<Self> {
        let robots = shared.scene.robots.len();
        if index >= robots {
            let expected = format!("an index below {robots}, the number of robots");
            return Err(Failure::value("robot", index, &expected));
        }
        Ok(Self { shared: Arc::clone(shared), index })
    }

    /// Calls a function with the robot.
    pub(crate) fn call<T>(
        &self,
        py: Python<'_>,
        ask: impl FnOnce(&mut FleetRobot<'_>) -> Result<T>,
    ) -> Outcome<T> {
        Ok(ask(&mut self.shared.lock(py).world.robot(self.index)?)?)
    }

    /// Time of the world (s).
    pub(crate) fn clock(&self, py: Python<'_>) -> f64 {
        self.shared.lock(py).world.time()
    }

    /// Lets time pass.
    pub(crate) fn rest(&self, py: Python<'_>, seconds: f64) -> Outcome<()> {
        self.shared.run_for(py, seconds)
    }
}

#[pymethods]
impl Robot {
    /// Index of the robot in its scene.
    #[getter]
    fn index(&self) -> usize {
        self.index
    }

    /// Time since the start (s).
    #[getter]
    fn time(&self, py: Python<'_>) -> f64 {
        self.clock(py)
    }

    /// Lets time pass, for all robots of the world.
    ///
    /// Parameters
    /// ----------
    /// seconds : float
    ///     Duration (s), rounded to ticks of 10 ms.
    fn wait(&self, py: Python<'_>, seconds: f64) -> Outcome<()> {
        self.rest(py, seconds)
    }

    /// Drives at a velocity until the next command. What the wheels cannot reach is scaled down.
    ///
    /// Parameters
    /// ----------
    /// linear : float
    ///     Speed ahead (m/s).
    /// angular : float
    ///     Turn rate, counter-clockwise (rad/s).
    #[pyo3(signature = (linear, angular = 0.0))]
    fn set_speed(&self, py: Python<'_>, linear: f64, angular: f64) -> Outcome<()> {
        self.call(py, |robot| robot.set_speed(Twist::new(linear, angular)))
    }

    /// Stops the robot.
    fn stop(&self, py: Python<'_>) -> Outcome<()> {
        self.call(py, |robot| robot.stop())
    }

    /// Velocity by the wheels: linear (m/s) and angular (rad/s).
    fn speed(&self, py: Python<'_>) -> Outcome<(f64, f64)> {
        let twist = self.call(py, |robot| robot.speed())?;
        Ok((twist.linear, twist.angular))
    }

    /// Pose by odometry, relative to the start: x, y and heading (m, m, rad).
    fn pose(&self, py: Python<'_>) -> Outcome<(f64, f64, f64)> {
        Ok(arrays::triple(self.call(py, |robot| robot.pose())?))
    }

    /// Sets the pose of odometry; the robot does not move.
    fn set_pose(&self, py: Python<'_>, pose: [f64; 3]) -> Outcome<()> {
        self.call(py, |robot| robot.set_pose(arrays::pose(pose)))
    }

    /// Starts to drive straight ahead by `distance` (m), or back if it is negative, at `speed` (m/s).
    fn straight(&self, py: Python<'_>, distance: f64, speed: f64) -> Outcome<()> {
        self.call(py, |robot| robot.straight(distance, speed))
    }

    /// Starts to turn on the spot by `angle` (rad), counter-clockwise, at `speed` (rad/s).
    fn turn(&self, py: Python<'_>, angle: f64, speed: f64) -> Outcome<()> {
        self.call(py, |robot| robot.turn(angle, speed))
    }

    /// Starts to drive an arc of `length` (m) that turns the robot by `angle` (rad), at `speed` (m/s).
    fn curve(&self, py: Python<'_>, length: f64, angle: f64, speed: f64) -> Outcome<()> {
        self.call(py, |robot| robot.curve(length, angle, speed))
    }

    /// Starts to drive one arc to a point `forward` ahead and `left` to the left (m), at `speed` (m/s).
    fn drive_to(&self, py: Python<'_>, forward: f64, left: f64, speed: f64) -> Outcome<()> {
        self.call(py, |robot| robot.drive_to(forward, left, speed))
    }

    /// What is left of the running manoeuvre (m, or rad of a turn on the spot); 0 when none is running.
    fn remaining(&self, py: Python<'_>) -> Outcome<f64> {
        self.call(py, |robot| robot.remaining())
    }

    /// Whether no manoeuvre is running.
    #[getter]
    fn is_done(&self, py: Python<'_>) -> Outcome<bool> {
        self.call(py, |robot| robot.is_done())
    }

    /// Lets time pass until the running manoeuvre has ended or something holds the robot.
    fn wait_done(&self, py: Python<'_>) -> Outcome<()> {
        while !self.call(py, |robot| Ok(robot.is_done()? || robot.is_stalled()?))? {
            self.rest(py, TICK)?;
            py.check_signals()?;
        }
        Ok(())
    }

    /// Whether the wheels are told to turn and something holds the robot.
    #[getter]
    fn is_stalled(&self, py: Python<'_>) -> Outcome<bool> {
        self.call(py, |robot| robot.is_stalled())
    }

    /// Distance that a sensor measures (m); inf if nothing is in range.
    ///
    /// Parameters
    /// ----------
    /// name : str
    ///     ``front``, ``left``, ``right``, ``back``, or the number of a sensor.
    ///
    /// Raises
    /// ------
    /// UnsupportedError
    ///     If the robot has no such sensor.
    #[pyo3(signature = (name = "front"))]
    fn distance(&self, py: Python<'_>, name: &str) -> Outcome<f64> {
        let psd = sensor(name)?;
        self.call(py, |robot| robot.distance(psd))
    }

    /// Takes a scan with the lidar.
    ///
    /// Parameters
    /// ----------
    /// out : ndarray of float64, shape (beams,), optional
    ///     Array to write to; otherwise a new one.
    ///
    /// Returns
    /// -------
    /// ndarray of float64, shape (beams,)
    ///     Range of each beam (m), counter-clockwise; inf without a return. `beam_angles` has the directions.
    #[pyo3(signature = (out = None))]
    fn scan<'py>(
        &self,
        py: Python<'py>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> Outcome<Bound<'py, PyArray1<f64>>> {
        let mut guard = self.shared.lock(py);
        let State { world, scan, .. } = &mut *guard;
        world.robot(self.index)?.scan_into(scan)?;
        arrays::filled(py, &scan.ranges, out)
    }

    /// Directions of the lidar's beams, counter-clockwise from straight ahead (rad).
    ///
    /// Raises
    /// ------
    /// UnsupportedError
    ///     If the robot has no lidar.
    fn beam_angles<'py>(&self, py: Python<'py>) -> Outcome<Bound<'py, PyArray1<f64>>> {
        let lidar = self.shared.scene.robots[self.index].spec.lidar;
        let lidar = lidar.ok_or_else(|| roverlab::io::Error::unsupported("lidar"))?;
        let settings =
            LidarSettings { field_of_view: lidar.field_of_view, tilt: lidar.tilt, points: lidar.points };
        let (first, step) = settings.beams();
        Ok(PyArray1::from_iter(py, (0..lidar.points).map(|beam| first + step * beam as f64)))
    }

    /// Takes an image with the camera.
    ///
    /// Parameters
    /// ----------
    /// width, height : int
    ///     Size of the image in pixels: 160 x 120, 320 x 240, 640 x 480, 1296 x 730, 1920 x 1080 or 2592 x
    ///     1944.
    ///
    /// Returns
    /// -------
    /// ndarray of uint8, shape (height, width, 3)
    ///     Red, green and blue.
    #[pyo3(
        signature = (width = Natural::of(320), height = Natural::of(240)),
        text_signature = "($self, width=320, height=240)"
    )]
    fn image<'py>(
        &self,
        py: Python<'py>,
        width: Natural,
        height: Natural,
    ) -> Outcome<Bound<'py, PyArray3<u8>>> {
        let (width, height) = (width.pixels("width")?, height.pixels("height")?);
        let resolution = Resolution::of((width, height))?;
        let image = self.call(py, |robot| {
            robot.set_resolution(resolution)?;
            robot.image()
        })?;
        Ok(PyArray1::from_vec(py, image.into_raw()).reshape([height as usize, width as usize, 3])?)
    }

    /// Sets a motor, from 1, to a fraction of its full speed, -1 to 1.
    fn set_motor(&self, py: Python<'_>, motor: Natural, fraction: f64) -> Outcome<()> {
        let motor = motor.byte("motor")?;
        self.call(py, |robot| robot.set_motor(motor, fraction))
    }

    /// Sets a servo, from 1, to a position: -1 is full left or down, 1 full right or up.
    fn set_servo(&self, py: Python<'_>, servo: Natural, position: f64) -> Outcome<()> {
        let servo = servo.byte("servo")?;
        self.call(py, |robot| robot.set_servo(servo, position))
    }

    /// Ticks that the encoder of a motor, from 1, has counted.
    fn encoder(&self, py: Python<'_>, motor: Natural) -> Outcome<i64> {
        let motor = motor.byte("motor")?;
        self.call(py, |robot| robot.encoder(motor))
    }

    /// Attitude by the inertial unit: roll, pitch and yaw (rad). A positive pitch lowers the nose, a positive
    /// roll lifts the left side; yaw is counter-clockwise from the world's x axis.
    ///
    /// Raises
    /// ------
    /// UnsupportedError
    ///     If the robot's unit does not measure it.
    fn attitude(&self, py: Python<'_>) -> Outcome<(f64, f64, f64)> {
        let attitude = self.call(py, |robot| robot.attitude())?;
        Ok((attitude.roll, attitude.pitch, attitude.yaw))
    }

    /// Turn rates by the inertial unit about the axes ahead, to the left and upwards (rad/s).
    ///
    /// Raises
    /// ------
    /// UnsupportedError
    ///     If the robot's unit does not measure them.
    fn turn_rates(&self, py: Python<'_>) -> Outcome<(f64, f64, f64)> {
        let rates = self.call(py, |robot| robot.turn_rates())?;
        Ok((rates.x, rates.y, rates.z))
    }

    /// Depth of the depth sensor below the surface (m); 0 above it.
    ///
    /// Raises
    /// ------
    /// UnsupportedError
    ///     If the robot has no such sensor.
    fn depth(&self, py: Python<'_>) -> Outcome<f64> {
        self.call(py, |robot| robot.depth())
    }

    fn __repr__(&self) -> String {
        format!("<Robot {}: {}>", self.index, self.shared.scene.robots[self.index].spec.name)
    }
}
