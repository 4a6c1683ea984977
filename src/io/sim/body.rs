use std::collections::VecDeque;
use std::sync::Arc;

use super::SimOptions;
use super::camera::CameraDevice;
use super::course::Course;
use super::inertial_unit::InertialUnit;
use super::mechanics::Powertrain;
use crate::geometry::{Point, Point3, Pose, Pose3, Vector3, direction, math};
use crate::io::{Error, Key, Lcd, LidarSettings, Psd, RadioMessage, Result, TrailPoint};
use crate::random::Stream;
use crate::world::space::{Scanner, SolidId, Span};
use crate::world::{Footprint, Mount, PsdSpec, RobotPlacement, RobotSpec};

/// One robot in the engine: its mechanics, its devices and what is true about it.
#[derive(Debug)]
pub(super) struct Body {
    pub(super) spec: Arc<RobotSpec>,
    pub(super) solid: SolidId,
    /// Where it truly is.
    pub(super) course: Course,
    pub(super) span: Span,
    pub(super) outline: Footprint,
    /// The radius of the circle about its origin that just holds its outline.
    pub(super) radius: f64,
    /// How far its outline may move at once without jumping over anything.
    pub(super) stride: f64,
    pub(super) drive: Powertrain,
    psds: Box<[PsdDevice]>,
    pub(super) psd_noise: Stream,
    pub(super) lidar: Option<Box<LidarDevice>>,
    pub(super) camera: Option<Box<CameraDevice>>,
    pub(super) inertial: Option<Box<InertialUnit>>,
    pub(super) mailbox: VecDeque<RadioMessage>,
    pub(super) keys: VecDeque<KeyPress>,
    /// Made when the program first draws: most robots of a fleet never do.
    lcd: Option<Box<Lcd>>,
    /// Calls of the display so far.
    drawings: u64,
    pub(super) encoder_offsets: [i64; 4],
    pub(super) touch: Touch,
    pub(super) path_length: f64,
    pub(super) trail: Vec<TrailPoint>,
    /// How far the robot may move before the next look for walls.
    pub(super) wall_budget: f64,
    /// How far it and others may move towards each other before the next look for solids.
    pub(super) solid_budget: f64,
}

/// A key press that a script has scheduled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct KeyPress {
    pub(super) time: f64,
    pub(super) key: Key,
}

/// What a robot touches, and has touched.
#[derive(Debug, Clone, Default)]
pub(super) struct Touch {
    /// How often the robot came into contact with something.
    pub(super) contacts: u32,
    /// Whether it is in contact now.
    pub(super) touching: bool,
    /// Where it first touched each time.
    pub(super) places: Vec<Point>,
    /// Ticks since its wheels last moved it as they should.
    pub(super) held_ticks: u32,
}

/// Places of contacts that are remembered; the count goes on.
const MAX_CONTACT_PLACES: usize = 1000;
/// Ticks for which a robot must be held to count as stalled: half a second.
const STALL_TICKS: u32 = 50;

impl Touch {
    pub(super) fn begin(&mut self, place: Point) {
        if !self.touching {
            self.count(place);
        }
        self.touching = true;
    }

    /// Counts a contact that is over at once.
    pub(super) fn count(&mut self, place: Point) {
        self.contacts += 1;
        if self.places.len() < MAX_CONTACT_PLACES {
            self.places.push(place);
        }
    }

    /// Forgets what the robot touches: it is taken elsewhere.
    pub(super) fn leave(&mut self) {
        self.touching = false;
        self.held_ticks = 0;
    }

    pub(super) fn is_stalled(&self) -> bool {
        self.held_ticks >= STALL_TICKS
    }
}

/// A distance sensor of one ray, in the robot's frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct PsdDevice {
    id: u8,
    pub(super) place: Point3,
    pub(super) direction: Vector3,
    /// Whether it is parallel to the robot's floor.
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

/// A lidar with the settings that the program has given it.
#[derive(Debug)]
pub(super) struct LidarDevice {
    /// Where it sits in the robot's frame.
    pub(super) mount: Pose,
    /// The same in space, and whether its plane is parallel to the robot's floor.
    pub(super) frame: Pose3,
    pub(super) level: bool,
    /// Metres above the world's floor.
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

impl Body {
    pub(super) fn new(
        placement: &RobotPlacement,
        solid: SolidId,
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
            solid,
            course: Course::new(placement.pose),
            span: span(placement),
            outline: spec.footprint,
            radius: spec.footprint.bounding_radius(),
            stride: stride(&spec.footprint),
            drive,
            psds: spec.psds.iter().map(PsdDevice::new).collect(),
            psd_noise: streams.child("psd", 0),
            lidar,
            camera: spec.camera.map(|camera| {
                Box::new(CameraDevice::new(camera, placement.elevation, streams.child("camera", 0)))
            }),
            inertial: InertialUnit::of(spec.inertial, streams),
            mailbox: VecDeque::new(),
            keys: VecDeque::new(),
            lcd: None,
            drawings: 0,
            encoder_offsets: [0; 4],
            touch: Touch::default(),
            path_length: 0.0,
            trail: Vec::new(),
            wall_budget: 0.0,
            solid_budget: 0.0,
            spec: Arc::clone(spec),
        })
    }

    pub(super) fn lcd(&mut self) -> &mut Lcd {
        self.drawings += 1;
        self.lcd.get_or_insert_with(|| Box::new(Lcd::new()))
    }

    /// What the display shows, and how many calls of it there have been.
    pub(super) fn display(&self) -> Option<(u64, &Lcd)> {
        Some((self.drawings, self.lcd.as_deref()?))
    }

    /// Where it truly is.
    pub(super) fn pose(&self) -> Pose {
        self.course.pose()
    }

    pub(super) fn psd(&self, psd: Psd) -> Result<&PsdDevice> {
        self.psds.iter().find(|device| device.id == psd.0).ok_or_else(|| Error::unsupported(psd))
    }

    /// Notes how far the outline moved instead of as far as the wheels wished.
    pub(super) fn note_motion(&mut self, wished: f64, moved: f64) {
        let held = self.touch.touching && moved < 0.2 * wished && self.drive.get().is_driving();
        self.touch.held_ticks = if held { self.touch.held_ticks.saturating_add(1) } else { 0 };
    }

    /// The motor that a motor's or an encoder's number means.
    pub(super) fn motor_index(&self, number: u8, device: &str) -> Result<usize> {
        let motors = self.drive.get().motors();
        let index = usize::from(number).checked_sub(1).filter(|&index| index < motors);
        index.ok_or_else(|| Error::unsupported(format!("{device} {number}")))
    }

    /// An encoder's count since the last reset.
    pub(super) fn encoder(&self, motor: u8) -> Result<i64> {
        let wheel = self.motor_index(motor, "encoder")?;
        Ok(self.drive.get().count(wheel) - self.encoder_offsets[wheel])
    }

    pub(super) fn reset_encoder(&mut self, motor: u8) -> Result<()> {
        let wheel = self.motor_index(motor, "encoder")?;
        self.encoder_offsets[wheel] = self.drive.get().count(wheel);
        Ok(())
    }

    /// Adds a key press, in order of time; of two at one time, the one scheduled first comes first.
    pub(super) fn schedule_key(&mut self, time: f64, key: Key) {
        let later = self.keys.iter().position(|press| press.time > time).unwrap_or(self.keys.len());
        self.keys.insert(later, KeyPress { time, key });
    }

    /// The oldest key press that is due.
    pub(super) fn take_key(&mut self, now: f64) -> Option<Key> {
        let due = self.keys.front().is_some_and(|press| press.time <= now);
        if due { self.keys.pop_front().map(|press| press.key) } else { None }
    }
}

fn span(placement: &RobotPlacement) -> Span {
    Span { bottom: placement.elevation, top: placement.elevation + placement.spec.height }
}

/// A quarter of the outline's least width: within it, the way out of a wall is the way it came.
fn stride(footprint: &Footprint) -> f64 {
    let width = match footprint {
        Footprint::Disc { radius } => 2.0 * radius,
        Footprint::Rectangle(rectangle) => rectangle.size().min(),
    };
    (0.25 * width).max(1e-4)
}
