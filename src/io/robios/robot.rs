use std::f64::consts::TAU;
use std::ffi::{CString, c_char, c_int, c_uchar};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use image::RgbImage;

use super::call::{call, order};
use super::library::Functions;
use super::numbers::{NOTHING, degrees, metres, millimetres, radians, range, whole};
use super::truth::{RobiosTruth, Told};
use crate::geometry::{Pose, Twist, Vector3, normalize_angle, units};
use crate::io::{
    Attitude, Camera, Clock, DepthSensor, DistanceSensors, Drive, Encoders, Error, Inertial, Lidar,
    LidarScan, LidarSettings, Manoeuvres, Motors, Odometry, Psd, Radio, RadioMessage, Resolution, Result,
    Servos, StallDetector,
};
use crate::world::InertialSpec;

/// A robot behind a RoBIOS library.
///
/// A library drives the one robot of its process: two instances with the same library are the same robot.
#[derive(Debug)]
pub struct RobiosRobot {
    pub(super) robios: Arc<Functions>,
    told: Arc<Mutex<Told>>,
    lidar: LidarSettings,
    /// Buffer for a scan of any size.
    distances: Vec<c_int>,
    resolution: Resolution,
    camera_is_on: bool,
    radio_is_on: bool,
    turns: bool,
    inertial: InertialSpec,
    depth_channel: Option<u8>,
}

/// Maximum length of a received radio message (bytes).
const LONGEST_MESSAGE: usize = 1024;

impl RobiosRobot {
    /// Loads a library. Its scanner is assumed to have 360 beams all round, unless the library reports
    /// another number.
    pub fn open(path: impl AsRef<Path>) -> Result<Self> {
        Ok(Self {
            robios: Arc::new(Functions::load(path.as_ref())?),
            told: Arc::default(),
            lidar: LidarSettings { field_of_view: TAU, tilt: 0.0, points: 360 },
            distances: vec![NOTHING; LidarSettings::MAX_POINTS],
            resolution: Resolution::default(),
            camera_is_on: false,
            radio_is_on: false,
            turns: false,
            inertial: InertialSpec::default(),
            depth_channel: None,
        })
    }

    /// Gives the robot an inertial unit, which the library reads on these channels: RoBIOS does not tell of
    /// any.
    #[must_use]
    pub fn with_inertial(self, inertial: InertialSpec) -> Self {
        Self { inertial, ..self }
    }

    /// Gives the robot a pressure sensor, which the library reads on a channel in mm of depth.
    #[must_use]
    pub fn with_depth_sensor(self, channel: u8) -> Self {
        Self { depth_channel: Some(channel), ..self }
    }

    /// What three analog channels read.
    fn channels(&mut self, name: &str, channels: Option<[u8; 3]>) -> Result<[f64; 3]> {
        let [a, b, c] = channels.ok_or_else(|| Error::unsupported(name))?;
        let read = |channel: u8| -> Result<f64> { Ok(call!(self, ANALOGRead(channel.into())).into()) };
        Ok([read(a)?, read(b)?, read(c)?])
    }

    /// Access to the ground truth, as far as known, for a start pose in the world.
    pub fn truth(&self, start: Pose) -> RobiosTruth {
        RobiosTruth::new(Arc::clone(&self.robios), Arc::clone(&self.told), start)
    }

    fn note(&mut self, note: impl FnOnce(&mut Told)) {
        note(&mut self.told.lock().unwrap_or_else(PoisonError::into_inner));
    }

    fn start_camera(&mut self) -> Result<()> {
        if !self.camera_is_on {
            self.set_resolution(self.resolution)?;
        }
        Ok(())
    }

    fn start_radio(&mut self) -> Result<()> {
        if !self.radio_is_on {
            order!(self, RADIOInit())?;
            self.radio_is_on = true;
        }
        Ok(())
    }
}

impl Clock for RobiosRobot {
    fn now(&mut self) -> Result<f64> {
        let time = f64::from(call!(self, OSGetCount())) / 1000.0;
        self.note(|told| told.time = time);
        Ok(time)
    }

    fn wait(&mut self, seconds: f64) -> Result<()> {
        let milliseconds = whole("waiting time", 1000.0 * seconds.max(0.0))?;
        order!(self, OSWait(milliseconds))
    }
}

impl Drive for RobiosRobot {
    fn set_speed(&mut self, twist: Twist) -> Result<()> {
        let linear = millimetres("linear speed", twist.linear)?;
        let angular = degrees("angular speed", twist.angular)?;
        order!(self, VWSetSpeed(linear, angular))
    }
}

impl Odometry for RobiosRobot {
    fn speed(&mut self) -> Result<Twist> {
        let (mut linear, mut angular) = (0, 0);
        order!(self, VWGetSpeed(&raw mut linear, &raw mut angular))?;
        Ok(Twist::new(metres(linear), radians(angular)))
    }

    fn pose(&mut self) -> Result<Pose> {
        let (mut x, mut y, mut phi) = (0, 0, 0);
        order!(self, VWGetPosition(&raw mut x, &raw mut y, &raw mut phi))?;
        let pose = Pose::new(metres(x), metres(y), radians(phi));
        self.note(|told| told.odometry = pose);
        Ok(pose)
    }

    fn set_pose(&mut self, pose: Pose) -> Result<()> {
        let (x, y) = (millimetres("x", pose.x)?, millimetres("y", pose.y)?);
        let phi = degrees("heading", normalize_angle(pose.heading))?;
        order!(self, VWSetPosition(x, y, if phi == -180 { 180 } else { phi }))
    }
}

impl Manoeuvres for RobiosRobot {
    fn straight(&mut self, distance: f64, speed: f64) -> Result<()> {
        let (distance, speed) = (millimetres("distance", distance)?, millimetres("speed", speed.abs())?);
        self.turns = false;
        order!(self, VWStraight(distance, speed))
    }

    fn turn(&mut self, angle: f64, speed: f64) -> Result<()> {
        let (angle, speed) = (degrees("angle", angle)?, degrees("speed", speed.abs())?);
        self.turns = true;
        order!(self, VWTurn(angle, speed))
    }

    fn curve(&mut self, length: f64, angle: f64, speed: f64) -> Result<()> {
        let (distance, change) = (millimetres("length", length)?, degrees("angle", angle)?);
        if distance == 0 {
            return self.turn(angle, speed);
        }
        self.turns = false;
        let speed = millimetres("speed", speed.abs())?;
        order!(self, VWCurve(distance, change, speed))
    }

    fn drive_to(&mut self, forward: f64, left: f64, speed: f64) -> Result<()> {
        let (x, y) = (millimetres("forward distance", forward)?, millimetres("distance to the left", left)?);
        let speed = millimetres("speed", speed.abs())?;
        self.turns = false;
        order!(self, VWDrive(x, y, speed))
    }

    fn remaining(&mut self) -> Result<f64> {
        let rest = call!(self, VWRemain());
        Ok(if self.turns { radians(rest) } else { metres(rest) })
    }

    fn is_done(&mut self) -> Result<bool> {
        Ok(call!(self, VWDone()) != 0)
    }

    fn wait_done(&mut self) -> Result<()> {
        order!(self, VWWait())
    }
}

impl StallDetector for RobiosRobot {
    fn is_stalled(&mut self) -> Result<bool> {
        Ok(call!(self, VWStalled()) != 0)
    }
}

impl DistanceSensors for RobiosRobot {
    /// RoBIOS returns 0 or less for missing sensors.
    fn distance(&mut self, sensor: Psd) -> Result<f64> {
        match call!(self, PSDGet(sensor.0.into())) {
            ..=0 => Err(Error::unsupported(sensor)),
            distance => Ok(range(distance)),
        }
    }
}

impl Lidar for RobiosRobot {
    fn scan_into(&mut self, scan: &mut LidarScan) -> Result<()> {
        let room = self.distances.as_mut_ptr();
        order!(self, LIDARGet(room))?;
        // Only known now that the library is running.
        if let Some(points) = self.robios.lidar_points() {
            self.lidar.points = points;
        }
        let distances = &mut self.distances[..self.lidar.points];
        if self.lidar.field_of_view > TAU - 1e-9 {
            // The beam behind comes first in both directions of rotation.
            distances.rotate_left(1);
        }
        let (angle_min, angle_increment) = self.lidar.beams();
        (scan.angle_min, scan.angle_increment) = (angle_min, angle_increment);
        scan.range_max = metres(NOTHING);
        scan.mount = Pose::default();
        scan.ranges.clear();
        scan.ranges.extend(distances.iter().rev().copied().map(range));
        Ok(())
    }

    fn configure_lidar(&mut self, settings: LidarSettings) -> Result<()> {
        settings.validate()?;
        let angle = degrees("lidar field of view", settings.field_of_view)?;
        let tilt = degrees("lidar tilt", settings.tilt)?;
        order!(self, LIDARSet(angle, -tilt, settings.points as c_int))?;
        let field_of_view = if angle == 360 { TAU } else { radians(angle) };
        self.lidar = LidarSettings { field_of_view, tilt: radians(tilt), points: settings.points };
        Ok(())
    }
}

impl Camera for RobiosRobot {
    fn set_resolution(&mut self, resolution: Resolution) -> Result<()> {
        let number = Resolution::ALL.iter().position(|&r| r == resolution).unwrap_or_default();
        order!(self, CAMInit(number as c_int))?;
        self.resolution = resolution;
        self.camera_is_on = true;
        Ok(())
    }

    /// The last value set: RoBIOS cannot read it.
    fn resolution(&mut self) -> Result<Resolution> {
        Ok(self.resolution)
    }

    fn image_into(&mut self, image: &mut RgbImage) -> Result<()> {
        self.start_camera()?;
        let (width, height) = self.resolution.dimensions();
        if image.dimensions() != (width, height) {
            *image = RgbImage::new(width, height);
        }
        let pixels: *mut c_uchar = image.as_mut().as_mut_ptr();
        order!(self, CAMGet(pixels))
    }
}

impl Radio for RobiosRobot {
    fn radio_id(&mut self) -> Result<u32> {
        self.start_radio()?;
        Ok(call!(self, RADIOGetID()) as u32)
    }

    fn radio_peers(&mut self) -> Result<Vec<u32>> {
        self.start_radio()?;
        // RoBIOS's ids are single bytes.
        let mut ids = [0; 256];
        let count = call!(self, RADIOStatus(ids.as_mut_ptr()));
        let count = usize::try_from(count).unwrap_or_default().min(ids.len());
        Ok(ids[..count].iter().map(|&id| id as u32).collect())
    }

    fn send(&mut self, to: u32, data: &[u8]) -> Result<()> {
        self.start_radio()?;
        let refused = || Error::invalid_input("radio message", format!("{data:?}"), "bytes other than 0");
        let message = CString::new(data).map_err(|_| refused())?;
        if data.is_empty() {
            return Err(refused());
        }
        order!(self, RADIOSend(to as c_int, message.as_ptr()))
    }

    fn receive(&mut self) -> Result<Option<RadioMessage>> {
        self.start_radio()?;
        let mut from = 0;
        if call!(self, RADIOCheck(&raw mut from)) == 0 {
            return Ok(None);
        }
        let mut buffer: [c_char; LONGEST_MESSAGE] = [0; LONGEST_MESSAGE];
        // Some libraries return the length, others 0 for success; a message always ends with a zero byte.
        call!(self, RADIOReceive(&raw mut from, buffer.as_mut_ptr(), LONGEST_MESSAGE as c_int));
        let data = buffer.iter().take_while(|&&byte| byte != 0).map(|&byte| byte as u8).collect();
        Ok(Some(RadioMessage { from: from as u32, data }))
    }
}

impl Motors for RobiosRobot {
    fn set_motor(&mut self, motor: u8, fraction: f64) -> Result<()> {
        let percent = whole("motor speed", 100.0 * fraction)?;
        order!(self, MOTORDrive(motor.into(), percent))
    }
}

impl Servos for RobiosRobot {
    fn set_servo(&mut self, servo: u8, position: f64) -> Result<()> {
        if !(-1.0..=1.0).contains(&position) {
            return Err(Error::invalid_input("servo position", position, "-1 to 1"));
        }
        let angle = whole("servo position", 128.0 + 128.0 * position)?.min(255);
        order!(self, SERVOSet(servo.into(), angle))
    }
}

impl Encoders for RobiosRobot {
    fn encoder(&mut self, motor: u8) -> Result<i64> {
        Ok(call!(self, ENCODERRead(motor.into())).into())
    }

    fn reset_encoder(&mut self, motor: u8) -> Result<()> {
        order!(self, ENCODERReset(motor.into()))
    }
}

/// Tenths of degrees.
fn from_tenths(tenths: f64) -> f64 {
    units::from_deg(tenths / 10.0)
}

impl DepthSensor for RobiosRobot {
    fn depth(&mut self) -> Result<f64> {
        let channel = self.depth_channel.ok_or_else(|| Error::unsupported("depth sensor"))?;
        Ok(units::from_mm(call!(self, ANALOGRead(channel.into())).into()))
    }
}

impl Inertial for RobiosRobot {
    fn attitude(&mut self) -> Result<Attitude> {
        let [roll, pitch, yaw] = self.channels("attitude", self.inertial.attitude)?.map(from_tenths);
        Ok(Attitude { roll, pitch, yaw })
    }

    fn turn_rates(&mut self) -> Result<Vector3> {
        Ok(self.channels("turn rates", self.inertial.turn_rates)?.map(from_tenths).into())
    }

    fn acceleration(&mut self) -> Result<Vector3> {
        Ok(self.channels("acceleration", self.inertial.acceleration)?.map(units::from_mm).into())
    }
}
