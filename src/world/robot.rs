use std::path::PathBuf;
use std::sync::Arc;

use super::{Body, CameraSpec, DepthSensorSpec, InertialSpec, LidarSpec, Mesh, PsdSpec};
use crate::ParameterError;
use crate::geometry::Aabb;
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
    /// Range (m) of a craft's Doppler log: so far below, it sees the ground. Odometry then is the way over
    /// ground, otherwise that through the water.
    pub dvl: Option<f64>,
    /// Measurements of its inertial unit.
    pub inertial: InertialSpec,
    /// Whether its inertial unit has a compass, so that the yaw does not drift. Steel nearby, as in the walls
    /// of a pool, makes a compass useless.
    pub compass: bool,
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
    /// A boat or an underwater craft: its hull, its mass and its thrusters, about a point on the floor below
    /// it.
    Craft(Arc<CraftSpec>),
}

impl DriveSpec {
    /// Maximum rim speed of its wheels, or speed of a craft at full thrust (m/s).
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

    fn validate(&self) -> Result<(), ParameterError> {
        match *self {
            Self::Differential { wheel_diameter, track, max_wheel_speed, ticks_per_turn }
            | Self::Ackermann { wheel_diameter, track, max_wheel_speed, ticks_per_turn, .. }
            | Self::Tracked { wheel_diameter, track, max_wheel_speed, ticks_per_turn, .. }
            | Self::Omni { wheel_diameter, track, max_wheel_speed, ticks_per_turn, .. } => {
                require_positive("wheel diameter", wheel_diameter)?;
                require_positive("track", track)?;
                require_positive("maximal wheel speed", max_wheel_speed)?;
                require_positive("ticks per turn", ticks_per_turn)?;
            }
            Self::Craft(ref craft) => {
                let parts = craft.hull.len();
                require("hull parts of a craft", parts as f64, parts > 0, "at least one")?;
                craft.validate()?;
            }
        }
        match *self {
            Self::Ackermann { wheelbase, max_steering, dynamics, .. } => {
                require_positive("wheelbase", wheelbase)?;
                let good = max_steering > 0.0 && max_steering < std::f64::consts::FRAC_PI_2;
                require("maximal steering", max_steering, good, "more than 0 and less than a right angle")?;
                dynamics.map_or(Ok(()), |dynamics| dynamics.validate(wheelbase))
            }
            Self::Tracked { track, length, width, .. } => {
                require_positive("belt length", length)?;
                require_positive("belt width", width)?;
                require("belt width", width, width <= track, "at most the distance between the belts")
            }
            Self::Omni { wheelbase, .. } => require_positive("wheelbase", wheelbase),
            Self::Differential { .. } | Self::Craft(_) => Ok(()),
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

    /// The integration is stable within these limits of stiffness and mass.
    fn validate(&self, wheelbase: f64) -> Result<(), ParameterError> {
        let within = |parameter, value: f64, most: f64, expected: &'static str| {
            require(parameter, value, value > 0.0 && value < most, expected)
        };
        within("mass centre", self.mass_centre, wheelbase, "a place between the axles")?;
        within("radius of gyration", self.gyration, 100.0, "more than 0 and less than 100")?;
        within("grip", self.grip, 100.0, "more than 0 and less than 100")?;
        within("tyre stiffness", self.stiffness, 100.0, "more than 0 and less than 100")?;
        within("balance of the tyres", self.balance, 10.0, "more than 0 and less than 10")?;
        within("brake", self.brake, 100.0, "more than 0 and less than 100")?;
        within("steering rate", self.steering_rate, 100.0, "more than 0 and less than 100")
    }
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
    /// Radius of the smallest enclosing circle about the robot's origin (m).
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
        self.drive.validate()?;
        let lag = self.motor.time_constant;
        require("motor time constant", lag, lag.is_finite() && lag >= 0.0, "a finite number of at least 0")?;
        require_positive("maximal acceleration", self.motor.max_acceleration)?;
        self.footprint.validate().map_err(|error| error.of("footprint"))?;
        require_positive("height", self.height)?;
        require_not_negative("mass", self.mass)?;
        require_not_negative("friction", self.friction)?;
        self.inertial.validate()?;
        self.dvl.map_or(Ok(()), |range| require_positive("range of the Doppler log", range))?;
        if let Some(DepthSensorSpec { channel, z }) = self.depth_sensor {
            require("channel of the depth sensor", channel.into(), channel > 0, "1 to 255")?;
            require_finite("height of the depth sensor", z)?;
        }
        for psd in &self.psds {
            require_positive("PSD maximal range", psd.max_range)?;
            psd.mount.validate()?;
        }
        self.lidar.as_ref().map_or(Ok(()), LidarSpec::validate)?;
        self.camera.as_ref().map_or(Ok(()), CameraSpec::validate)
    }
}
