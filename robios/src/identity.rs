//! What a program's library has to know of its robot.

use roverlab::kinematics::Ackermann;
use roverlab::world::{DriveSpec, InertialSpec, RobotSpec};

/// Properties of a robot, for its library.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Identity {
    /// Number of the robot, from 1, counted over robots and objects.
    pub id: u32,
    /// Number of robots.
    pub robots: u32,
    /// Number of objects.
    pub objects: u32,
    /// Maximum rim speed of its wheels (m/s).
    pub top_speed: f64,
    /// Rim speed that a turn rate adds on the outside, per radian (m); 0 without wheels.
    pub reach: f64,
    /// Curvature of the tightest turn (1/m); infinite for robots that turn on the spot.
    pub tightest_turn: f64,
    /// Rim speed at 100 percent of a motor (m/s).
    pub full_speed: f64,
    /// Distance rolled per encoder tick (m).
    pub tick_length: f64,
    /// Number of beams per scan.
    pub lidar_points: u32,
    /// Whether scans cover a full turn.
    pub full_turn: bool,
    /// Duration of a call (s).
    pub call_duration: f64,
    /// Time after which every call fails (s); infinite without a limit.
    pub time_limit: f64,
    /// Whether a repeated reading at the same time may be assumed equal.
    pub exact: bool,
    /// Whether the robot has a camera.
    pub camera: bool,
    /// The channel of its depth sensor; 0 without one.
    pub depth_channel: u8,
    /// What its inertial unit measures, and on which channels.
    pub inertial: InertialSpec,
}

/// Rim speed at 100 percent of a motor in EyeSim, whatever the motor's limit (m/s).
const FULL_SPEED: f64 = 0.4;
/// The same for cars.
const FULL_SPEED_OF_CARS: f64 = 0.5;

/// Maximum rim speed of the wheels, rim speed at 100 percent, and distance per encoder tick.
pub(crate) fn speeds(spec: &RobotSpec) -> (f64, f64, f64) {
    let (diameter, fastest, ticks, full) = match spec.drive {
        DriveSpec::Differential { wheel_diameter, max_wheel_speed, ticks_per_turn, .. }
        | DriveSpec::Tracked { wheel_diameter, max_wheel_speed, ticks_per_turn, .. }
        | DriveSpec::Omni { wheel_diameter, max_wheel_speed, ticks_per_turn, .. } => {
            (wheel_diameter, max_wheel_speed, ticks_per_turn, FULL_SPEED)
        }
        DriveSpec::Ackermann { wheel_diameter, max_wheel_speed, ticks_per_turn, .. } => {
            (wheel_diameter, max_wheel_speed, ticks_per_turn, FULL_SPEED_OF_CARS)
        }
        // Thrusters: as if wheels of 2 m turned so that their rims have its top speed. All of it is 100
        // percent; one that cannot drive ahead still has a full speed of its other thrusters.
        DriveSpec::Craft(_) => (2.0, spec.drive.top_speed().max(1e-3), 1.0, f64::INFINITY),
        _ => (0.0, 0.0, 1.0, FULL_SPEED),
    };
    let top_speed = 0.5 * diameter * fastest;
    (top_speed, full.min(top_speed), std::f64::consts::PI * diameter / ticks)
}

/// Rim speed per turn rate (m), and curvature of the tightest turn (1/m).
pub(crate) fn turns(drive: &DriveSpec) -> (f64, f64) {
    match *drive {
        DriveSpec::Differential { track, .. } | DriveSpec::Tracked { track, .. } => {
            (0.5 * track, f64::INFINITY)
        }
        DriveSpec::Omni { track, wheelbase, .. } => (0.5 * (track + wheelbase), f64::INFINITY),
        DriveSpec::Ackermann { track, wheelbase, max_steering, .. } => {
            let car = Ackermann::new(wheelbase, track, max_steering);
            (0.5 * track, car.map_or(f64::INFINITY, |car| car.max_curvature()))
        }
        _ => (0.0, f64::INFINITY),
    }
}

impl Identity {
    /// Maximum turn rate on the spot (rad/s); infinite where unknown, and 0 for cars.
    pub fn top_turn(&self) -> f64 {
        match (self.tightest_turn.is_finite(), self.reach > 0.0) {
            (true, _) => 0.0,
            (false, true) => self.top_speed / self.reach,
            (false, false) => f64::INFINITY,
        }
    }
}
