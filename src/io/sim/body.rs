use std::collections::VecDeque;
use std::sync::Arc;

use super::autopilot::Autopilot;
use super::course::Course;
use super::drivetrain::{DifferentialSpec, Drivetrain};
use super::{Lcd, SimOptions};
use crate::geometry::{Point, Pose, Vector, direction};
use crate::io::{Error, Key, LidarSettings, Psd, RadioMessage, Result};
use crate::random::Stream;
use crate::world::space::{Scanner, SolidId, Span};
use crate::world::{DriveSpec, Footprint, RobotPlacement, RobotSpec};

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
    pub(super) drivetrain: Drivetrain,
    pub(super) autopilot: Autopilot,
    psds: Box<[PsdDevice]>,
    pub(super) psd_noise: Stream,
    pub(super) lidar: Option<Box<LidarDevice>>,
    pub(super) mailbox: VecDeque<RadioMessage>,
    pub(super) keys: VecDeque<KeyPress>,
    /// Made when the program first draws: most robots of a fleet never do.
    lcd: Option<Box<Lcd>>,
    pub(super) encoder_offsets: [i64; 2],
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

/// Where a robot was at a time, truly and by its own odometry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrailPoint {
    /// Seconds since the start.
    pub time: f64,
    /// The true pose in the world.
    pub pose: Pose,
    /// What its odometry said, in its own frame.
    pub odometry: Pose,
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

/// The fastest robot, in metres per second.
const MAX_TOP_SPEED: f64 = 100.0;

impl Touch {
    pub(super) fn begin(&mut self, place: Point) {
        if !self.touching {
            self.contacts += 1;
            if self.places.len() < MAX_CONTACT_PLACES {
                self.places.push(place);
            }
        }
        self.touching = true;
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
    pub(super) offset: Vector,
    pub(super) direction: Vector,
    /// Metres above the world's floor.
    pub(super) height: f64,
    pub(super) max_range: f64,
}

/// A lidar with the settings that the program has given it.
#[derive(Debug)]
pub(super) struct LidarDevice {
    /// Where it sits in the robot's frame.
    pub(super) mount: Pose,
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
        let drive = differential(spec)?;
        check_top_speed(spec, &drive)?;
        let drivetrain = Drivetrain::new(
            &drive,
            spec.motor,
            &options.noise,
            options.ideal_encoders,
            streams.child("drive", 0),
        );
        let lidar = spec.lidar.map(|lidar| {
            let settings =
                LidarSettings { field_of_view: lidar.field_of_view, tilt: lidar.tilt, points: lidar.points };
            let height = placement.elevation + lidar.mount.z;
            Box::new(LidarDevice {
                mount: Pose::new(lidar.mount.x, lidar.mount.y, lidar.mount.yaw),
                height,
                max_range: lidar.max_range,
                settings,
                scanner: scanner(height, lidar.max_range, &settings),
                noise: streams.child("lidar", 0),
            })
        });
        let psds = spec.psds.iter().map(|psd| PsdDevice {
            id: psd.id,
            offset: Vector::new(psd.mount.x, psd.mount.y),
            direction: direction(psd.mount.yaw),
            height: placement.elevation + psd.mount.z,
            max_range: psd.max_range,
        });
        Ok(Self {
            solid,
            course: Course::new(placement.pose),
            span: span(placement),
            outline: spec.footprint,
            radius: spec.footprint.bounding_radius(),
            stride: stride(&spec.footprint),
            drivetrain,
            autopilot: Autopilot::new(),
            psds: psds.collect(),
            psd_noise: streams.child("psd", 0),
            lidar,
            mailbox: VecDeque::new(),
            keys: VecDeque::new(),
            lcd: None,
            encoder_offsets: [0; 2],
            touch: Touch::default(),
            path_length: 0.0,
            trail: Vec::new(),
            wall_budget: 0.0,
            solid_budget: 0.0,
            spec: Arc::clone(spec),
        })
    }

    pub(super) fn lcd(&mut self) -> &mut Lcd {
        self.lcd.get_or_insert_with(|| Box::new(Lcd::new()))
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
        let held = self.touch.touching && moved < 0.2 * wished && self.autopilot.is_driving();
        self.touch.held_ticks = if held { self.touch.held_ticks.saturating_add(1) } else { 0 };
    }

    /// An encoder's count since the last reset.
    pub(super) fn encoder(&self, motor: u8) -> Result<i64> {
        let wheel = wheel_index(motor, "encoder")?;
        Ok(self.drivetrain.count(wheel) - self.encoder_offsets[wheel])
    }

    pub(super) fn reset_encoder(&mut self, motor: u8) -> Result<()> {
        let wheel = wheel_index(motor, "encoder")?;
        self.encoder_offsets[wheel] = self.drivetrain.count(wheel);
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

/// The wheel that a motor or encoder number means.
pub(super) fn wheel_index(motor: u8, device: &str) -> Result<usize> {
    match motor {
        1 => Ok(0),
        2 => Ok(1),
        _ => Err(Error::unsupported(format!("{device} {motor}"))),
    }
}

/// The drive's description, if the simulator can drive it.
fn differential(spec: &RobotSpec) -> Result<DifferentialSpec> {
    match spec.drive {
        DriveSpec::Differential { wheel_diameter, track, max_wheel_speed, ticks_per_turn } => {
            Ok(DifferentialSpec { wheel_diameter, track, max_wheel_speed, ticks_per_turn })
        }
        _ => Err(Error::new(
            crate::io::ErrorKind::Unsupported,
            format!("robot {}: the simulator drives differential robots only", spec.name),
        )),
    }
}

/// Faster robots would cross walls and worlds within a tick.
fn check_top_speed(spec: &RobotSpec, drive: &DifferentialSpec) -> Result<()> {
    let speed = 0.5 * drive.wheel_diameter * drive.max_wheel_speed;
    if speed <= MAX_TOP_SPEED {
        return Ok(());
    }
    let name = format!("robot {}: top speed", spec.name);
    Err(Error::invalid_input(&name, format!("{speed} m/s"), &format!("at most {MAX_TOP_SPEED} m/s")))
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
