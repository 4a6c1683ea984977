use std::path::PathBuf;
use std::sync::Arc;

use super::{Body, Mesh};
use crate::ParameterError;
use crate::geometry::{Aabb, Point3, Pose3};
use crate::kinematics::marine::CraftSpec;
use crate::parameter::{require, require_finite, require_not_negative, require_positive};

/// Description of a robot: drive, outline and sensors. EyeSim's `.robi`.
///
/// ```
/// use roverlab::world::{Footprint, RobotSpec};
/// let mut robot = RobotSpec { name: "wide".into(), ..RobotSpec::s4() };
/// robot.footprint = Footprint::Disc { radius: 0.2 };
/// assert_eq!((robot.footprint.bounding_radius(), robot.validate().is_ok()), (0.2, true));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct RobotSpec {
    /// Name for scenes.
    pub name: String,
    /// Its drive.
    pub drive: DriveSpec,
    /// Limits of its motors.
    pub motor: MotorSpec,
    /// Its outline on the floor, relative to the middle of its driven axle.
    pub footprint: Footprint,
    /// Height of its top above the floor, for other robots' sensors (m).
    pub height: f64,
    /// A mast above that height.
    pub mast: Option<Mast>,
    /// Mass (kg).
    pub mass: f64,
    /// Coefficient of friction between the ground and its wheels or belts, used on hills.
    pub friction: f64,
    /// Its position-sensitive devices: distance sensors with a single ray.
    pub psds: Vec<PsdSpec>,
    /// Its laser scanner, if it has one.
    pub lidar: Option<LidarSpec>,
    /// Its camera, if it has one.
    pub camera: Option<CameraSpec>,
    /// Its pressure sensor, if it has one.
    pub depth_sensor: Option<DepthSensorSpec>,
    /// Measurements of its inertial unit.
    pub inertial: InertialSpec,
    /// File of its 3D model.
    pub model: Option<PathBuf>,
    /// Surface for cameras; default: the outline.
    pub mesh: Option<Arc<Mesh>>,
    /// Data of its description file about its solid beyond footprint and height.
    pub body: Body,
}

/// How a robot moves.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum DriveSpec {
    /// Two driven wheels side by side.
    Differential {
        /// Wheel diameter (m).
        wheel_diameter: f64,
        /// Distance between the wheels' contact points (m).
        track: f64,
        /// Highest wheel speed (rad/s).
        max_wheel_speed: f64,
        /// Encoder ticks per wheel turn.
        ticks_per_turn: f64,
    },
    /// Driven rear wheels and steered front wheels, like a car.
    Ackermann {
        /// Wheel diameter (m).
        wheel_diameter: f64,
        /// Distance between the wheels of an axle (m).
        track: f64,
        /// Distance between the axles (m).
        wheelbase: f64,
        /// Largest steering angle of the bicycle model (rad).
        max_steering: f64,
        /// Highest wheel speed (rad/s).
        max_wheel_speed: f64,
        /// Encoder ticks per wheel turn.
        ticks_per_turn: f64,
        /// Mass and tyres of a car that is fast enough to slip; without it, wheels roll without slip.
        dynamics: Option<CarDynamics>,
    },
    /// Two belts side by side, with skid steering. The robot's origin is midway between them.
    Tracked {
        /// Diameter of the wheel that drives a belt (m).
        wheel_diameter: f64,
        /// Distance between the belts' centre lines (m).
        track: f64,
        /// Length of a belt on the ground (m).
        length: f64,
        /// Width of a belt (m).
        width: f64,
        /// Highest speed of a driving wheel (rad/s).
        max_wheel_speed: f64,
        /// Encoder ticks per turn of a driving wheel.
        ticks_per_turn: f64,
    },
    /// Four Mecanum wheels.
    Omni {
        /// Wheel diameter (m).
        wheel_diameter: f64,
        /// Distance between left and right wheels (m).
        track: f64,
        /// Distance between front and rear wheels (m).
        wheelbase: f64,
        /// Highest wheel speed (rad/s).
        max_wheel_speed: f64,
        /// Encoder ticks per wheel turn.
        ticks_per_turn: f64,
    },
    /// A boat or an underwater craft: its hull, its mass and its thrusters, about a point on the floor below it.
    Craft(Arc<CraftSpec>),
}

impl DriveSpec {
    /// The fastest rim speed of its wheels, or the speed of a craft at full thrust, in metres per second.
    pub fn top_speed(&self) -> f64 {
        match *self {
            Self::Differential { wheel_diameter, max_wheel_speed, .. }
            | Self::Ackermann { wheel_diameter, max_wheel_speed, .. }
            | Self::Tracked { wheel_diameter, max_wheel_speed, .. }
            | Self::Omni { wheel_diameter, max_wheel_speed, .. } => 0.5 * wheel_diameter * max_wheel_speed,
            Self::Craft(ref craft) => craft.top_speed(),
        }
    }

    /// Mass and tyres of a fast car.
    pub fn dynamics(&self) -> Option<CarDynamics> {
        match *self {
            Self::Ackermann { dynamics, .. } => dynamics,
            Self::Differential { .. } | Self::Tracked { .. } | Self::Omni { .. } | Self::Craft(_) => None,
        }
    }
}

/// Mass and tyres of a car: the dynamic bicycle model, with one equivalent tyre per axle and without load
/// transfer.
///
/// The car accelerates according to its [`MotorSpec`]: the time constant is that of its speed controller, and
/// the acceleration the motors' largest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CarDynamics {
    /// Distance from the rear axle to the centre of mass (m).
    pub mass_centre: f64,
    /// Radius of gyration about the vertical axis (m).
    pub gyration: f64,
    /// Radius of the friction circle as an acceleration (m/s²).
    pub grip: f64,
    /// Cornering force of a tyre per load and slip angle (1/rad).
    pub stiffness: f64,
    /// Grip and stiffness of the front tyres relative to the rear ones; below 1, the front slides first.
    pub balance: f64,
    /// Largest deceleration of the brakes (m/s²).
    pub brake: f64,
    /// Rate at which the steering turns (rad/s).
    pub steering_rate: f64,
}

impl CarDynamics {
    /// Speed above which tyres slip (m/s). Below half of it, wheels roll; in between, both are blended.
    pub const SLIPS: f64 = 4.0;
}

impl Default for CarDynamics {
    /// A Formula Student car.
    fn default() -> Self {
        Self {
            mass_centre: 0.75,
            gyration: 0.70,
            grip: 12.0,
            stiffness: 22.0,
            balance: 0.9,
            brake: 11.0,
            steering_rate: 2.0,
        }
    }
}

/// Limits of a robot's motors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotorSpec {
    /// Time constant of the first-order lag between command and wheel speed (s).
    pub time_constant: f64,
    /// Largest change of a wheel's rim speed (m/s²).
    pub max_acceleration: f64,
}

impl Default for MotorSpec {
    /// A lag of 0.2 s, in the middle of the range for the book's programs, and 2 m/s².
    fn default() -> Self {
        Self { time_constant: 0.2, max_acceleration: 2.0 }
    }
}

/// Outline of a robot or other solid on the floor, in its own frame.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Footprint {
    /// A disc about the origin: for a robot, the middle of the driven axle.
    Disc {
        /// Radius (m).
        radius: f64,
    },
    /// A rectangle along the frame's axes.
    Rectangle(Aabb),
}

impl Footprint {
    /// Radius of the smallest enclosing circle about the robot's origin.
    pub fn bounding_radius(&self) -> f64 {
        match self {
            Footprint::Disc { radius } => *radius,
            Footprint::Rectangle(b) => {
                let x = b.min.x.abs().max(b.max.x.abs());
                let y = b.min.y.abs().max(b.max.y.abs());
                crate::geometry::math::hypot(x, y)
            }
        }
    }

    fn validate(&self) -> Result<(), ParameterError> {
        match self {
            Self::Disc { radius } => require_positive("radius", *radius),
            Self::Rectangle(outline) => validate_outline(outline),
        }
    }

    /// Whether a rectangle of the robot's frame is within the outline.
    fn holds(&self, part: &Aabb) -> bool {
        match self {
            Footprint::Disc { radius } => Footprint::Rectangle(*part).bounding_radius() <= *radius,
            Footprint::Rectangle(b) => {
                b.min.x <= part.min.x
                    && b.min.y <= part.min.y
                    && part.max.x <= b.max.x
                    && part.max.y <= b.max.y
            }
        }
    }
}

/// Fails unless a rectangle has a finite positive width and depth.
fn validate_outline(outline: &Aabb) -> Result<(), ParameterError> {
    for (name, least, most) in
        [("outline along x", outline.min.x, outline.max.x), ("outline along y", outline.min.y, outline.max.y)]
    {
        require_finite(name, least)?;
        require_finite(name, most)?;
        require(name, most - least, most > least, "a corner beyond the other one")?;
    }
    Ok(())
}

/// A part of a robot that is higher and narrower than the rest, such as a handle or pole. Rays hit it;
/// collisions use the footprint, which contains the mast.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mast {
    /// Its rectangle in the robot's frame.
    pub outline: Aabb,
    /// Height of its top above the robot's foot (m).
    pub top: f64,
}

/// Pose of a sensor on a robot.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Mount {
    /// Distance ahead of the middle of the driven axle (m).
    pub x: f64,
    /// Distance to its left (m).
    pub y: f64,
    /// Height above the floor (m).
    pub z: f64,
    /// Roll, positive with the left side up (rad).
    pub roll: f64,
    /// Pitch, positive downwards (rad).
    pub pitch: f64,
    /// Yaw, counter-clockwise from straight ahead (rad).
    pub yaw: f64,
}

impl Mount {
    /// The sensor's frame in the robot's frame: roll, pitch and yaw rotate it about fixed axes in this order.
    pub fn frame(&self) -> Pose3 {
        Pose3::from_angles(Point3::new(self.x, self.y, self.z), self.roll, self.pitch, self.yaw)
    }

    /// Whether the sensor's plane is parallel to the robot's floor.
    pub fn is_level(&self) -> bool {
        self.roll == 0.0 && self.pitch == 0.0
    }

    fn validate(&self) -> Result<(), ParameterError> {
        for (name, value) in [
            ("mount x", self.x),
            ("mount y", self.y),
            ("mount z", self.z),
            ("mount roll", self.roll),
            ("mount pitch", self.pitch),
            ("mount yaw", self.yaw),
        ] {
            require_finite(name, value)?;
        }
        Ok(())
    }
}

/// A position-sensitive device: a distance sensor with a single ray.
#[derive(Debug, Clone, PartialEq)]
pub struct PsdSpec {
    /// Number for programs.
    pub id: u8,
    /// Its name in the robot's description.
    pub name: String,
    /// Its position and direction.
    pub mount: Mount,
    /// Longest distance that it reports (m).
    pub max_range: f64,
}

impl PsdSpec {
    /// RoBIOS reports no distances beyond 9.999 m.
    pub const DEFAULT_MAX_RANGE: f64 = 9.999;
}

/// A laser scanner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LidarSpec {
    /// Its position and the orientation of its plane. The scan is centred on its yaw.
    pub mount: Mount,
    /// Field of view (rad), at most a full turn.
    pub field_of_view: f64,
    /// Elevation of each beam above the scanner's plane (rad), which makes the scan a cone.
    pub tilt: f64,
    /// Number of beams per scan.
    pub points: usize,
    /// Longest distance that it reports (m).
    pub max_range: f64,
}

impl Default for LidarSpec {
    /// 360 level beams all round, 40 mm above the floor, so that they hit other robots and a golf ball; with
    /// the range of RoBIOS.
    fn default() -> Self {
        Self {
            mount: Mount { z: 0.04, ..Mount::default() },
            field_of_view: std::f64::consts::TAU,
            tilt: 0.0,
            points: 360,
            max_range: PsdSpec::DEFAULT_MAX_RANGE,
        }
    }
}

/// A camera on a pan-tilt head.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraSpec {
    /// Its position; the yaw is the pan at rest. Its roll and pitch are 0.
    pub mount: Mount,
    /// Elevation angle at rest (rad).
    pub tilt: f64,
    /// Largest pan to either side (rad).
    pub max_pan: f64,
    /// Largest tilt up or down (rad).
    pub max_tilt: f64,
    /// Horizontal field of view (rad).
    pub field_of_view: f64,
    /// Whether the lens is an equidistant fisheye: the distance of an image point from the centre is
    /// proportional to its angle from the line of sight. Other cameras are pinholes.
    pub fisheye: bool,
}

impl CameraSpec {
    /// Default horizontal field of view of a camera (rad): 60 degrees.
    pub const DEFAULT_FIELD_OF_VIEW: f64 = std::f64::consts::FRAC_PI_3;

    fn validate(&self) -> Result<(), ParameterError> {
        self.mount.validate()?;
        let turned = if self.mount.roll == 0.0 { self.mount.pitch } else { self.mount.roll };
        require(
            "camera mount's roll and pitch",
            turned,
            turned == 0.0,
            "0: the camera's tilt says how it looks",
        )?;
        require_finite("camera tilt", self.tilt)?;
        require_not_negative("camera max pan", self.max_pan)?;
        require_not_negative("camera max tilt", self.max_tilt)?;
        let (view, full_turn) = (self.field_of_view, std::f64::consts::TAU * (1.0 + 1e-9));
        let good = view > 0.0 && view <= full_turn;
        require("camera field of view", view, good, "more than 0 and at most a full turn")
    }
}

/// A pressure sensor that measures depth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DepthSensorSpec {
    /// The channel by which RoBIOS programs read it with `ANALOGRead`, in mm.
    pub channel: u8,
    /// Metres above the robot's origin.
    pub z: f64,
}

/// Measurements of a robot's inertial unit, and the channels on which RoBIOS programs read them with
/// `ANALOGRead`. The default has no measurements: a robot without a unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct InertialSpec {
    /// Channels of roll, pitch and yaw (0.1 degrees).
    pub attitude: Option<[u8; 3]>,
    /// Channels of the turn rates about the forward, left and up axes (0.1 degrees/s).
    pub turn_rates: Option<[u8; 3]>,
    /// Channels of the accelerations along these axes (mm/s²).
    pub acceleration: Option<[u8; 3]>,
}

impl InertialSpec {
    /// A unit with all measurements, on channels after those of RoBIOS itself.
    pub const ALL: Self = Self {
        attitude: Some([9, 10, 11]),
        turn_rates: Some([12, 13, 14]),
        acceleration: Some([15, 16, 17]),
    };

    /// Fails unless the channels are distinct and start from 1.
    pub fn validate(&self) -> Result<(), ParameterError> {
        let groups = [self.attitude, self.turn_rates, self.acceleration];
        let channels: Vec<u8> = groups.into_iter().flatten().flatten().collect();
        for (index, &channel) in channels.iter().enumerate() {
            let new = channel > 0 && !channels[..index].contains(&channel);
            require("channel of the inertial unit", channel.into(), new, "1 to 255, each once")?;
        }
        Ok(())
    }
}

impl RobotSpec {
    /// Default coefficient of friction: rubber on a dry floor.
    pub const DEFAULT_FRICTION: f64 = 0.8;

    /// Checks that a mast is within the robot's outline and above its height.
    pub(super) fn validate_mast(&self) -> Result<(), ParameterError> {
        let Some(Mast { outline, top }) = self.mast else { return Ok(()) };
        validate_outline(&outline).map_err(|error| error.of(&format!("robot {}: mast", self.name)))?;
        let good = top.is_finite() && top > self.height;
        let reach = Footprint::Rectangle(outline).bounding_radius();
        let holds = self.footprint.holds(&outline);
        require("the mast's top", top, good, "a finite number above the robot's height")
            .and_then(|()| require("the mast's reach", reach, holds, "a mast within the robot's outline"))
            .map_err(|error| error.of(&format!("robot {}", self.name)))
    }

    /// Largest deceleration (m/s²).
    pub fn deceleration(&self) -> f64 {
        self.drive.dynamics().map_or(self.motor.max_acceleration, |dynamics| dynamics.brake)
    }

    /// Checks that every length, speed and count is valid.
    pub fn validate(&self) -> Result<(), ParameterError> {
        self.validate_parts().map_err(|error| error.of(&format!("robot {}", self.name)))?;
        self.validate_mast()
    }

    fn validate_parts(&self) -> Result<(), ParameterError> {
        match self.drive {
            DriveSpec::Differential { wheel_diameter, track, max_wheel_speed, ticks_per_turn } => {
                require_positive("wheel diameter", wheel_diameter)?;
                require_positive("track", track)?;
                require_positive("maximal wheel speed", max_wheel_speed)?;
                require_positive("ticks per turn", ticks_per_turn)?;
            }
            DriveSpec::Ackermann {
                wheel_diameter,
                track,
                wheelbase,
                max_wheel_speed,
                ticks_per_turn,
                max_steering,
                dynamics,
            } => {
                require_positive("wheel diameter", wheel_diameter)?;
                require_positive("track", track)?;
                require_positive("wheelbase", wheelbase)?;
                let good = max_steering > 0.0 && max_steering < std::f64::consts::FRAC_PI_2;
                require("maximal steering", max_steering, good, "more than 0 and less than a right angle")?;
                require_positive("maximal wheel speed", max_wheel_speed)?;
                require_positive("ticks per turn", ticks_per_turn)?;
                if let Some(dynamics) = dynamics {
                    let within = |parameter, value: f64, most: f64, expected: &'static str| {
                        require(parameter, value, value > 0.0 && value < most, expected)
                    };
                    within("mass centre", dynamics.mass_centre, wheelbase, "a place between the axles")?;
                    // The integration is stable within these limits of stiffness and mass.
                    within("radius of gyration", dynamics.gyration, 100.0, "more than 0 and less than 100")?;
                    within("grip", dynamics.grip, 100.0, "more than 0 and less than 100")?;
                    within("tyre stiffness", dynamics.stiffness, 100.0, "more than 0 and less than 100")?;
                    within("balance of the tyres", dynamics.balance, 10.0, "more than 0 and less than 10")?;
                    within("brake", dynamics.brake, 100.0, "more than 0 and less than 100")?;
                    within("steering rate", dynamics.steering_rate, 100.0, "more than 0 and less than 100")?;
                }
            }
            DriveSpec::Tracked { wheel_diameter, track, length, width, max_wheel_speed, ticks_per_turn } => {
                require_positive("wheel diameter", wheel_diameter)?;
                require_positive("track", track)?;
                require_positive("belt length", length)?;
                require_positive("belt width", width)?;
                require("belt width", width, width <= track, "at most the distance between the belts")?;
                require_positive("maximal wheel speed", max_wheel_speed)?;
                require_positive("ticks per turn", ticks_per_turn)?;
            }
            DriveSpec::Omni { wheel_diameter, track, wheelbase, max_wheel_speed, ticks_per_turn } => {
                require_positive("wheel diameter", wheel_diameter)?;
                require_positive("track", track)?;
                require_positive("wheelbase", wheelbase)?;
                require_positive("maximal wheel speed", max_wheel_speed)?;
                require_positive("ticks per turn", ticks_per_turn)?;
            }
            DriveSpec::Craft(ref craft) => {
                let parts = craft.hull.len();
                require("hull parts of a craft", parts as f64, parts > 0, "at least one")?;
                craft.validate()?;
            }
        }
        let lag = self.motor.time_constant;
        require("motor time constant", lag, lag.is_finite() && lag >= 0.0, "a finite number of at least 0")?;
        require_positive("maximal acceleration", self.motor.max_acceleration)?;
        self.footprint.validate().map_err(|error| error.of("footprint"))?;
        require_positive("height", self.height)?;
        require_not_negative("mass", self.mass)?;
        require_not_negative("friction", self.friction)?;
        self.inertial.validate()?;
        if let Some(DepthSensorSpec { channel, z }) = self.depth_sensor {
            require("channel of the depth sensor", channel.into(), channel > 0, "1 to 255")?;
            require_finite("height of the depth sensor", z)?;
        }
        for psd in &self.psds {
            require_positive("PSD maximal range", psd.max_range)?;
            psd.mount.validate()?;
        }
        if let Some(lidar) = &self.lidar {
            let (fov, points) = (lidar.field_of_view, lidar.points as f64);
            let full_turn = std::f64::consts::TAU * (1.0 + 1e-9);
            require(
                "lidar field of view",
                fov,
                fov > 0.0 && fov <= full_turn,
                "more than 0 and at most a full turn",
            )?;
            require("lidar points", points, (1.0..=100_000.0).contains(&points), "1 to 100000")?;
            require_positive("lidar maximal range", lidar.max_range)?;
            require_finite("lidar tilt", lidar.tilt)?;
            lidar.mount.validate()?;
        }
        self.camera.as_ref().map_or(Ok(()), CameraSpec::validate)
    }
}
