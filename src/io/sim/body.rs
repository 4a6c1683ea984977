use std::collections::VecDeque;
use std::sync::Arc;

use super::autopilot::Autopilot;
use super::drivetrain::{DifferentialSpec, Drivetrain};
use super::{Lcd, SimOptions};
use crate::geometry::{Point, Pose, direction};
use crate::io::{Error, Key, LidarSettings, Psd, RadioMessage, Result};
use crate::random::Stream;
use crate::world::space::{Contact, Outline, Scanner, Solid, SolidId, Span};
use crate::world::{DriveSpec, Mount, RobotPlacement, RobotSpec};

/// One robot in the engine: its mechanics, its devices and what is true about it.
#[derive(Debug)]
pub(super) struct Body {
    pub(super) spec: Arc<RobotSpec>,
    pub(super) solid: SolidId,
    pub(super) pose: Pose,
    pub(super) span: Span,
    pub(super) outline: Outline,
    pub(super) drivetrain: Drivetrain,
    pub(super) autopilot: Autopilot,
    pub(super) lidar: Option<LidarDevice>,
    pub(super) psd_noise: Stream,
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

    pub(super) fn is_stalled(&self) -> bool {
        self.held_ticks >= STALL_TICKS
    }
}

/// A lidar with the settings that the program has given it.
#[derive(Debug)]
pub(super) struct LidarDevice {
    pub(super) mount: Mount,
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
            LidarDevice {
                mount: lidar.mount,
                height,
                max_range: lidar.max_range,
                settings,
                scanner: scanner(height, lidar.max_range, &settings),
                noise: streams.child("lidar", 0),
            }
        });
        Ok(Self {
            solid,
            pose: placement.pose,
            span: span(placement),
            outline: Outline::from(&spec.footprint),
            drivetrain,
            autopilot: Autopilot::new(),
            lidar,
            psd_noise: streams.child("psd", 0),
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

    /// The robot as others see it.
    pub(super) fn as_solid(placement: &RobotPlacement) -> Solid {
        let span = span(placement);
        Solid {
            outline: Outline::from(&placement.spec.footprint),
            pose: placement.pose,
            bottom: span.bottom,
            top: span.top,
        }
    }

    pub(super) fn lcd(&mut self) -> &mut Lcd {
        self.lcd.get_or_insert_with(|| Box::new(Lcd::new()))
    }

    /// Where a device on the robot is, and where it looks, in the world.
    pub(super) fn device_pose(&self, mount: &Mount) -> Pose {
        self.pose.compose(&Pose::new(mount.x, mount.y, mount.yaw))
    }

    /// Metres above the world's floor of a device at height `z` on the robot.
    pub(super) fn device_height(&self, z: f64) -> f64 {
        self.span.bottom + z
    }

    /// The mount and the largest range of a PSD.
    pub(super) fn psd(&self, psd: Psd) -> Result<(Mount, f64)> {
        let device = self.spec.psds.iter().find(|device| device.id == psd.0);
        device.map(|device| (device.mount, device.max_range)).ok_or_else(|| Error::unsupported(psd))
    }

    /// Notes how the motion of a tick turned out.
    pub(super) fn note_motion(&mut self, wished: f64, moved: f64) {
        self.path_length += moved;
        let held = self.touch.touching && moved < 0.2 * wished && self.autopilot.is_driving();
        self.touch.held_ticks = if held { self.touch.held_ticks + 1 } else { 0 };
    }

    /// An encoder's count.
    pub(super) fn encoder(&self, motor: u8) -> Result<i64> {
        let wheel = wheel_index(motor, "encoder")?;
        Ok(self.encoder_count(wheel) - self.encoder_offsets[wheel])
    }

    pub(super) fn reset_encoder(&mut self, motor: u8) -> Result<()> {
        let wheel = wheel_index(motor, "encoder")?;
        self.encoder_offsets[wheel] = self.encoder_count(wheel);
        Ok(())
    }

    fn encoder_count(&self, wheel: usize) -> i64 {
        (self.drivetrain.measured()[wheel] / self.drivetrain.tick_length()).round() as i64
    }

    /// Adds a key press, in order of time; of two at one time, the one scheduled first comes first.
    pub(super) fn schedule_key(&mut self, time: f64, key: Key) {
        let later = self.keys.iter().position(|press| press.time > time).unwrap_or(self.keys.len());
        self.keys.insert(later, KeyPress { time, key });
    }

    /// The oldest key press that is due.
    pub(super) fn take_key(&mut self, now: f64) -> Option<Key> {
        self.keys.pop_front_if(|press| press.time <= now).map(|press| press.key)
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

fn span(placement: &RobotPlacement) -> Span {
    Span { bottom: placement.elevation, top: placement.elevation + placement.spec.height }
}

/// The sum of the pushes that free an outline from its contacts: the deepest push along each direction.
pub(super) fn push_out(contacts: &[Contact]) -> crate::geometry::Vector {
    let mut push = crate::geometry::Vector::zeros();
    for contact in contacts {
        // What earlier pushes already achieve along this normal need not be pushed again.
        let missing = contact.depth - push.dot(&contact.normal);
        if missing > 0.0 {
            push += contact.normal * missing;
        }
    }
    push
}

/// The beam directions of a device are relative to its yaw.
pub(super) fn ray(pose: &Pose) -> (Point, crate::geometry::Vector) {
    (pose.position(), direction(pose.heading))
}
