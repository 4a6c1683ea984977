use std::collections::VecDeque;
use std::sync::Arc;

use super::SimOptions;
use super::camera::CameraDevice;
use super::depth_gauge::DepthGauge;
use super::inertial_unit::InertialUnit;
use super::mechanics::Powertrain;
use crate::geometry::{Point3, Pose, Pose3, Vector3, direction, math};
use crate::io::{Error, Key, Lcd, LidarSettings, Psd, RadioMessage, Result, TrailPoint};
use crate::random::Stream;
use crate::world::space::Scanner;
use crate::world::{Mount, PsdSpec, RobotPlacement, RobotSpec};

/// A robot but for its motion, which is its [`Body`](super::body::Body): its drive and devices.
#[derive(Debug)]
pub(super) struct Machine {
    pub(super) spec: Arc<RobotSpec>,
    pub(super) drive: Powertrain,
    /// Shared by robots of one description, so that a fleet reads it from the cache.
    psds: Arc<[PsdDevice]>,
    pub(super) psd_noise: Stream,
    pub(super) lidar: Option<Box<LidarDevice>>,
    pub(super) camera: Option<Box<CameraDevice>>,
    pub(super) inertial: Option<Box<InertialUnit>>,
    pub(super) depth: Option<Box<DepthGauge>>,
    pub(super) mailbox: VecDeque<RadioMessage>,
    pub(super) keys: VecDeque<KeyPress>,
    /// Created at the first drawing; most robots of a fleet never draw.
    lcd: Option<Box<Lcd>>,
    /// Number of display calls so far.
    drawings: u64,
    pub(super) encoder_offsets: [i64; 4],
    pub(super) trail: Vec<TrailPoint>,
}

/// A scheduled key press.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct KeyPress {
    pub(super) time: f64,
    pub(super) key: Key,
}

/// A distance sensor with a single ray, in the robot's frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct PsdDevice {
    id: u8,
    pub(super) place: Point3,
    pub(super) direction: Vector3,
    /// Whether its ray is parallel to the robot's floor.
    pub(super) level: bool,
    pub(super) max_range: f64,
}

impl PsdDevice {
    fn new(spec: &PsdSpec) -> Self {
        let (Mount { x, y, z, pitch, yaw, .. }, level) = (spec.mount, spec.mount.is_level());
        let flat = direction(yaw);
        let (sin, cos) = if level { (0.0, 1.0) } else { math::sin_cos(pitch) };
        let direction = Vector3::new(flat.x * cos, flat.y * cos, -sin);
        Self { id: spec.id, place: Point3::new(x, y, z), direction, level, max_range: spec.max_range }
    }
}

/// A lidar with the program's settings.
#[derive(Debug)]
pub(super) struct LidarDevice {
    /// Its pose in the robot's frame.
    pub(super) mount: Pose,
    /// The same in space, and whether its plane is parallel to the robot's floor.
    pub(super) frame: Pose3,
    pub(super) level: bool,
    /// Height above the world's floor (m).
    height: f64,
    pub(super) max_range: f64,
    pub(super) settings: LidarSettings,
    pub(super) scanner: Scanner,
    pub(super) noise: Stream,
}

impl LidarDevice {
    pub(super) fn configure(&mut self, settings: LidarSettings) -> Result<()> {
        settings.validate()?;
        self.settings = settings;
        self.scanner = scanner(self.height, self.max_range, &settings);
        Ok(())
    }
}

fn scanner(height: f64, max_range: f64, settings: &LidarSettings) -> Scanner {
    let (first, increment) = settings.beams();
    Scanner::new(first, increment, settings.points, height, settings.tilt, max_range)
}

impl Machine {
    /// The machine of a robot; `alike` is another one of the same description.
    pub(super) fn new(
        placement: &RobotPlacement,
        alike: Option<&Self>,
        options: &SimOptions,
        streams: &Stream,
    ) -> Result<Self> {
        let spec = &placement.spec;
        let drive = Powertrain::new(spec, &options.noise, options.ideal_encoders, streams.child("drive", 0))?;
        let lidar = spec.lidar.map(|lidar| {
            let settings =
                LidarSettings { field_of_view: lidar.field_of_view, tilt: lidar.tilt, points: lidar.points };
            let height = placement.elevation + lidar.mount.z;
            Box::new(LidarDevice {
                mount: Pose::new(lidar.mount.x, lidar.mount.y, lidar.mount.yaw),
                frame: lidar.mount.frame(),
                level: lidar.mount.is_level(),
                height,
                max_range: lidar.max_range,
                settings,
                scanner: scanner(height, lidar.max_range, &settings),
                noise: streams.child("lidar", 0),
            })
        });
        Ok(Self {
            drive,
            psds: match alike {
                Some(alike) => Arc::clone(&alike.psds),
                None => spec.psds.iter().map(PsdDevice::new).collect(),
            },
            psd_noise: streams.child("psd", 0),
            lidar,
            camera: spec.camera.map(|camera| {
                Box::new(CameraDevice::new(camera, placement.elevation, streams.child("camera", 0)))
            }),
            inertial: InertialUnit::of(spec.inertial, spec.compass, streams),
            depth: spec.depth_sensor.map(|own| Box::new(DepthGauge::new(own, streams.child("depth", 0)))),
            mailbox: VecDeque::new(),
            keys: VecDeque::new(),
            lcd: None,
            drawings: 0,
            encoder_offsets: [0; 4],
            trail: Vec::new(),
            spec: Arc::clone(spec),
        })
    }

    pub(super) fn lcd(&mut self) -> &mut Lcd {
        self.drawings += 1;
        self.lcd.get_or_insert_with(|| Box::new(Lcd::new()))
    }

    /// The display's content, and the number of its calls so far.
    pub(super) fn display(&self) -> Option<(u64, &Lcd)> {
        Some((self.drawings, self.lcd.as_deref()?))
    }

    pub(super) fn psd(&self, psd: Psd) -> Result<&PsdDevice> {
        self.psds.iter().find(|device| device.id == psd.0).ok_or_else(|| Error::unsupported(psd))
    }

    /// The motor that a number means.
    pub(super) fn motor_index(&self, number: u8) -> Result<usize> {
        device_index("motor", number, self.drive.get().motors())
    }

    fn encoder_index(&self, number: u8) -> Result<usize> {
        device_index("encoder", number, self.drive.get().encoders())
    }

    /// Encoder count since the last reset.
    pub(super) fn encoder(&self, motor: u8) -> Result<i64> {
        let wheel = self.encoder_index(motor)?;
        Ok(self.drive.get().count(wheel) - self.encoder_offsets[wheel])
    }

    pub(super) fn reset_encoder(&mut self, motor: u8) -> Result<()> {
        let wheel = self.encoder_index(motor)?;
        self.encoder_offsets[wheel] = self.drive.get().count(wheel);
        Ok(())
    }

    /// Adds a key press in order of time; simultaneous ones are in order of scheduling.
    pub(super) fn schedule_key(&mut self, time: f64, key: Key) {
        let later = self.keys.iter().position(|press| press.time > time).unwrap_or(self.keys.len());
        self.keys.insert(later, KeyPress { time, key });
    }

    /// The oldest due key press.
    pub(super) fn take_key(&mut self, now: f64) -> Option<Key> {
        let due = self.keys.front().is_some_and(|press| press.time <= now);
        if due { self.keys.pop_front().map(|press| press.key) } else { None }
    }
}

/// The index of the device that a number from 1 means.
fn device_index(device: &str, number: u8, count: usize) -> Result<usize> {
    let index = usize::from(number).checked_sub(1).filter(|&index| index < count);
    index.ok_or_else(|| Error::unsupported(format!("{device} {number}")))
}
