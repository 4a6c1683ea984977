use std::path::PathBuf;
use std::sync::Arc;

use super::{Body, Mesh};
use crate::ParameterError;
use crate::geometry::{Aabb, Point3, Pose3};
use crate::parameter::{require, require_finite, require_not_negative, require_positive};

/// A description of a robot: its drive, outline and sensors. EyeSim's `.robi`.
///
/// ```
/// use roverlab::world::{Footprint, RobotSpec};
/// let mut robot = RobotSpec { name: "wide".into(), ..RobotSpec::s4() };
/// robot.footprint = Footprint::Disc { radius: 0.2 };
/// assert_eq!((robot.footprint.bounding_radius(), robot.validate().is_ok()), (0.2, true));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct RobotSpec {
    /// The name under which scenes place it.
    pub name: String,
    /// How it moves.
    pub drive: DriveSpec,
    /// What its motors can do.
    pub motor: MotorSpec,
    /// Its outline on the floor, about the middle of its driven axle.
    pub footprint: Footprint,
    /// Metres from the floor to its top: what other robots' sensors see.
    pub height: f64,
    /// What stands up above that, if anything.
    pub mast: Option<Mast>,
    /// Kilograms.
    pub mass: f64,
    /// The coefficient of friction between the ground and its wheels or belts, which counts on hills.
    pub friction: f64,
    /// Its position-sensitive devices: single-ray distance sensors.
    pub psds: Vec<PsdSpec>,
    /// Its laser scanner, if it has one.
    pub lidar: Option<LidarSpec>,
    /// Its camera, if it has one.
    pub camera: Option<CameraSpec>,
    /// Quantities that its inertial unit measures.
    pub inertial: InertialSpec,
    /// The file of its 3D model, if it has one.
    pub model: Option<PathBuf>,
    /// The surface that cameras see; without it, they see the outline.
    pub mesh: Option<Arc<Mesh>>,
    /// What its description file says about its solid beyond footprint and height.
    pub body: Body,
}

/// How a robot moves.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum DriveSpec {
    /// Two driven wheels side by side.
    Differential {
        /// Metres.
        wheel_diameter: f64,
        /// Metres between the wheels' contact points.
        track: f64,
        /// The fastest that a wheel turns, in radians per second.
        max_wheel_speed: f64,
        /// Encoder ticks in one turn of a wheel.
        ticks_per_turn: f64,
    },
    /// Driven rear wheels and steered front wheels, as a car.
    Ackermann {
        /// Metres.
        wheel_diameter: f64,
        /// Metres between the wheels of an axle.
        track: f64,
        /// Metres between the axles.
        wheelbase: f64,
        /// The largest steering angle of the bicycle model, in radians.
        max_steering: f64,
        /// The fastest that a wheel turns, in radians per second.
        max_wheel_speed: f64,
        /// Encoder ticks in one turn of a wheel.
        ticks_per_turn: f64,
        /// Its mass and its tyres, for a car so fast that they matter; without it, wheels roll and never
        /// slip.
        dynamics: Option<CarDynamics>,
    },
    /// Two belts side by side, which turn their robot by skidding. Its origin is in the middle between them.
    Tracked {
        /// Metres across the wheel that drives a belt.
        wheel_diameter: f64,
        /// Metres between the belts' middles.
        track: f64,
        /// Metres of a belt that lie on the ground.
        length: f64,
        /// Metres across a belt.
        width: f64,
        /// The fastest that a driving wheel turns, in radians per second.
        max_wheel_speed: f64,
        /// Encoder ticks in one turn of a driving wheel.
        ticks_per_turn: f64,
    },
    /// Four Mecanum wheels.
    Omni {
        /// Metres.
        wheel_diameter: f64,
        /// Metres between left and right wheels.
        track: f64,
        /// Metres between front and rear wheels.
        wheelbase: f64,
        /// The fastest that a wheel turns, in radians per second.
        max_wheel_speed: f64,
        /// Encoder ticks in one turn of a wheel.
        ticks_per_turn: f64,
    },
}

impl DriveSpec {
    /// The fastest rim speed of its wheels, in metres per second.
    pub fn top_speed(&self) -> f64 {
        match *self {
            Self::Differential { wheel_diameter, max_wheel_speed, .. }
            | Self::Ackermann { wheel_diameter, max_wheel_speed, .. }
            | Self::Tracked { wheel_diameter, max_wheel_speed, .. }
            | Self::Omni { wheel_diameter, max_wheel_speed, .. } => 0.5 * wheel_diameter * max_wheel_speed,
        }
    }

    /// Mass and tyres of a fast car.
    pub fn dynamics(&self) -> Option<CarDynamics> {
        match *self {
            Self::Ackermann { dynamics, .. } => dynamics,
            Self::Differential { .. } | Self::Tracked { .. } | Self::Omni { .. } => None,
        }
    }
}

/// Mass and tyres of a car: the dynamic bicycle model, with an axle's two tyres in one and no transfer of
/// load.
///
/// The car accelerates as its [`MotorSpec`] says: the time constant is that with which its speed controller
/// closes a difference, and the acceleration the motors' greatest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CarDynamics {
    /// Metres from the rear axle to the centre of mass.
    pub mass_centre: f64,
    /// The radius of gyration about the upright axis, in metres.
    pub gyration: f64,
    /// The radius of the friction circle as an acceleration, in m/s².
    pub grip: f64,
    /// The cornering force of a tyre for its load and its slip angle, in 1/rad.
    pub stiffness: f64,
    /// Grip and stiffness of the front tyres as a share of those of the rear ones: less than 1, so that the
    /// front slides first.
    pub balance: f64,
    /// The greatest deceleration by the brakes, in m/s².
    pub brake: f64,
    /// Radians per second at which the steering turns.
    pub steering_rate: f64,
}

impl CarDynamics {
    /// Metres per second above which tyres slip. Below half of it wheels roll; between, it is a mixture.
    pub const SLIPS: f64 = 4.0;
}

impl Default for CarDynamics {
    /// A student's Formula car.
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

/// What a robot's motors can do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotorSpec {
    /// The time constant, in seconds, of the first-order lag with which wheel speed follows the command.
    pub time_constant: f64,
    /// The largest change of a wheel's rim speed, in metres per second squared.
    pub max_acceleration: f64,
}

impl Default for MotorSpec {
    /// A lag of 0.2 s, the middle of the range in which the book's programs work, and 2 m/s².
    fn default() -> Self {
        Self { time_constant: 0.2, max_acceleration: 2.0 }
    }
}

/// The outline on the floor of a robot or another solid, in its own frame.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Footprint {
    /// A disc about the origin: for a robot, the middle of the driven axle.
    Disc {
        /// Metres.
        radius: f64,
    },
    /// A rectangle along the frame's axes.
    Rectangle(Aabb),
}

impl Footprint {
    /// The radius of the circle about the robot's origin that just holds the outline.
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

    /// Whether a rectangle of the robot's frame lies within the outline.
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

/// Fails unless a rectangle has a finite width and depth above zero.
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

/// A part of a robot that is higher and narrower than the rest: a handle, a pole. Rays meet it; what drives
/// into the robot meets its footprint, in which the mast stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mast {
    /// Its rectangle in the robot's frame.
    pub outline: Aabb,
    /// Metres from the robot's foot to the mast's top.
    pub top: f64,
}

/// Where a sensor sits on a robot.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Mount {
    /// Metres ahead of the middle of the driven axle.
    pub x: f64,
    /// Metres to the left of it.
    pub y: f64,
    /// Metres above the floor.
    pub z: f64,
    /// Roll (rad): positive lifts its left side. No effect on a single ray.
    pub roll: f64,
    /// Pitch (rad): positive points it downwards.
    pub pitch: f64,
    /// Radians counter-clockwise from straight ahead.
    pub yaw: f64,
}

impl Mount {
    /// Pose of the sensor in the robot's frame. Roll, pitch and yaw rotate it about fixed axes, in this order.
    pub fn frame(&self) -> Pose3 {
        Pose3::from_angles(Point3::new(self.x, self.y, self.z), self.roll, self.pitch, self.yaw)
    }

    /// Whether the sensor is parallel to the robot's floor.
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

/// A position-sensitive device: a distance sensor of one ray.
#[derive(Debug, Clone, PartialEq)]
pub struct PsdSpec {
    /// The number by which programs read it.
    pub id: u8,
    /// Its name in the robot's description.
    pub name: String,
    /// Where it sits, and where it points.
    pub mount: Mount,
    /// The farthest distance that it reports, in metres.
    pub max_range: f64,
}

impl PsdSpec {
    /// RoBIOS reports nothing beyond 9.999 m.
    pub const DEFAULT_MAX_RANGE: f64 = 9.999;
}

/// A laser scanner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LidarSpec {
    /// Where it sits, and how its plane is turned. The scan is centred on its yaw.
    pub mount: Mount,
    /// The angle that a scan covers, in radians, at most a full turn.
    pub field_of_view: f64,
    /// Elevation of every beam above the scanner's plane (rad): the beams form a cone.
    pub tilt: f64,
    /// Beams in a scan.
    pub points: usize,
    /// The farthest distance that it reports, in metres.
    pub max_range: f64,
}

impl Default for LidarSpec {
    /// 360 level beams all round, 40 mm above the floor, so that they meet other robots and a golf ball; as far as
    /// RoBIOS reports.
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
    /// Where it sits; the yaw is the pan at rest. Its roll and pitch are 0.
    pub mount: Mount,
    /// Radians above the horizontal at rest.
    pub tilt: f64,
    /// The largest pan to either side, in radians.
    pub max_pan: f64,
    /// The largest tilt up or down, in radians.
    pub max_tilt: f64,
    /// The horizontal field of view, in radians.
    pub field_of_view: f64,
    /// Whether the lens is equidistant, as fisheyes are: a place in the picture is as far from the middle as
    /// its angle from the line of sight says, twice as far for twice the angle. Other cameras are pinholes.
    pub fisheye: bool,
}

impl CameraSpec {
    /// The horizontal field of view of a camera that states none, in radians: 60 degrees.
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

/// Quantities of an inertial unit, and the `ANALOGRead` channels by which RoBIOS programs read them. The default, no
/// quantities, is a robot without a unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct InertialSpec {
    /// Channels of roll, pitch and yaw (tenths of degrees).
    pub attitude: Option<[u8; 3]>,
    /// Channels of the turn rates about the forward, left and upright axes (tenths of degrees per second).
    pub turn_rates: Option<[u8; 3]>,
    /// Channels of the accelerations along these axes (mm/s²).
    pub acceleration: Option<[u8; 3]>,
}

impl InertialSpec {
    /// All quantities, on channels above RoBIOS's own 0 to 8.
    pub const ALL: Self = Self {
        attitude: Some([9, 10, 11]),
        turn_rates: Some([12, 13, 14]),
        acceleration: Some([15, 16, 17]),
    };

    /// Fails unless channel numbers are positive and distinct.
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
    /// The coefficient of friction of rubber on a dry floor, for robots that state none.
    pub const DEFAULT_FRICTION: f64 = 0.8;

    /// Checks that a mast stands on the robot.
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

    /// How fast it can brake, in metres per second squared.
    pub fn deceleration(&self) -> f64 {
        self.drive.dynamics().map_or(self.motor.max_acceleration, |dynamics| dynamics.brake)
    }

    /// Checks that every length, speed and count makes sense.
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
                    // The integration is stable for cars that are not stiffer or lighter than these.
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
        }
        let lag = self.motor.time_constant;
        require("motor time constant", lag, lag.is_finite() && lag >= 0.0, "a finite number of at least 0")?;
        require_positive("maximal acceleration", self.motor.max_acceleration)?;
        self.footprint.validate().map_err(|error| error.of("footprint"))?;
        require_positive("height", self.height)?;
        require_not_negative("mass", self.mass)?;
        require_not_negative("friction", self.friction)?;
        self.inertial.validate()?;
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
