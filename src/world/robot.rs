use std::path::PathBuf;

use super::Body;
use crate::geometry::{Aabb, Point, units};

/// A description of a robot: its drive, outline and sensors. EyeSim's `.robi`.
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
    /// Kilograms.
    pub mass: f64,
    /// Its position-sensitive devices: single-ray distance sensors.
    pub psds: Vec<PsdSpec>,
    /// Its laser scanner, if it has one.
    pub lidar: Option<LidarSpec>,
    /// Its camera, if it has one.
    pub camera: Option<CameraSpec>,
    /// The 3D model that EyeSim shows, if any.
    pub model: Option<PathBuf>,
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
        /// Its mass and its tyres, for a car so fast that they matter; without it, wheels roll and never slip.
        dynamics: Option<CarDynamics>,
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
            | Self::Omni { wheel_diameter, max_wheel_speed, .. } => 0.5 * wheel_diameter * max_wheel_speed,
        }
    }

    /// Mass and tyres of a fast car.
    pub fn dynamics(&self) -> Option<CarDynamics> {
        match *self {
            Self::Ackermann { dynamics, .. } => dynamics,
            Self::Differential { .. } | Self::Omni { .. } => None,
        }
    }
}

/// Mass and tyres of a car: the dynamic bicycle model, with an axle's two tyres in one and no transfer of load.
///
/// The car accelerates as its [`MotorSpec`] says: the time constant is that with which its speed controller closes a
/// difference, and the acceleration the motors' greatest.
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
    /// Grip and stiffness of the front tyres as a share of those of the rear ones: less than 1, so that the front
    /// slides first.
    pub balance: f64,
    /// The greatest deceleration by the brakes, in m/s².
    pub brake: f64,
    /// Radians per second at which the steering turns.
    pub steering_rate: f64,
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
    /// Radians counter-clockwise from straight ahead.
    pub yaw: f64,
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
    /// Where it sits. The scan is centred on its yaw.
    pub mount: Mount,
    /// The angle that a scan covers, in radians, at most a full turn.
    pub field_of_view: f64,
    /// Radians by which the beams point above the horizontal.
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
    /// Where it sits; the yaw is the pan at rest.
    pub mount: Mount,
    /// Radians above the horizontal at rest.
    pub tilt: f64,
    /// The largest pan to either side, in radians.
    pub max_pan: f64,
    /// The largest tilt up or down, in radians.
    pub max_tilt: f64,
    /// The horizontal field of view, in radians.
    pub field_of_view: f64,
    /// Whether the lens is a fisheye.
    pub fisheye: bool,
}

impl CameraSpec {
    /// The horizontal field of view of a camera that states none, in radians: 60 degrees.
    pub const DEFAULT_FIELD_OF_VIEW: f64 = std::f64::consts::FRAC_PI_3;
}

/// What is wrong with a robot's description.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("robot {robot}: {parameter} is {value}; expected {expected}")]
pub struct SpecError {
    robot: String,
    parameter: &'static str,
    value: f64,
    expected: &'static str,
}

impl RobotSpec {
    /// EyeSim's S4: a small differential drive robot with four PSDs, a lidar and a camera.
    ///
    /// Wheels, encoders and track are those of its description file; the outline is a disc of 60 mm.
    pub fn s4() -> Self {
        Self {
            name: "S4".into(),
            drive: DriveSpec::Differential {
                wheel_diameter: 0.054,
                track: 0.090,
                max_wheel_speed: units::from_deg(3600.0),
                ticks_per_turn: 1100.0,
            },
            motor: MotorSpec::default(),
            footprint: Footprint::Disc { radius: 0.060 },
            height: 0.090,
            mass: 0.5,
            psds: four_psds(0.060, 0.045, 0.030),
            lidar: Some(LidarSpec::default()),
            camera: Some(CameraSpec {
                mount: Mount { x: 0.062, y: 0.0, z: 0.060, yaw: 0.0 },
                tilt: 0.0,
                max_pan: units::from_deg(90.0),
                max_tilt: units::from_deg(90.0),
                field_of_view: CameraSpec::DEFAULT_FIELD_OF_VIEW,
                fisheye: false,
            }),
            model: None,
            body: Body::default(),
        }
    }

    /// EyeSim's LabBot: a larger differential drive robot.
    pub fn labbot() -> Self {
        Self {
            name: "LabBot".into(),
            drive: DriveSpec::Differential {
                wheel_diameter: 0.045,
                track: 0.140,
                max_wheel_speed: units::from_deg(3600.0),
                ticks_per_turn: 540.0,
            },
            footprint: Footprint::Disc { radius: 0.090 },
            height: 0.120,
            mass: 1.5,
            psds: four_psds(0.045, 0.027, 0.040),
            ..Self::s4()
        }
    }

    /// A robot on four Mecanum wheels, after the book's Omni-1 (section 7.2), with an S4's sensors.
    pub fn omni() -> Self {
        let (half_length, half_width) = (0.130, 0.120);
        Self {
            name: "Omni".into(),
            drive: DriveSpec::Omni {
                wheel_diameter: 0.060,
                track: 0.180,
                wheelbase: 0.160,
                max_wheel_speed: units::from_deg(900.0),
                ticks_per_turn: 1200.0,
            },
            footprint: Footprint::Rectangle(Aabb::new(
                Point::new(-half_length, -half_width),
                Point::new(half_length, half_width),
            )),
            height: 0.120,
            mass: 2.5,
            psds: four_psds(half_length, half_width, 0.040),
            ..Self::s4()
        }
    }

    /// A model car that is steered as its big sisters are (book, section 7.1), with an S4's sensors. Its turning circle
    /// measures 0.45 m in radius.
    pub fn car() -> Self {
        let (wheelbase, half_width) = (0.260, 0.090);
        let (back, front) = (-0.060, 0.320);
        Self {
            name: "Car".into(),
            drive: DriveSpec::Ackermann {
                wheel_diameter: 0.064,
                track: 0.160,
                wheelbase,
                max_steering: units::from_deg(30.0),
                max_wheel_speed: units::from_deg(900.0),
                ticks_per_turn: 1300.0,
                dynamics: None,
            },
            footprint: Footprint::Rectangle(Aabb::new(
                Point::new(back, -half_width),
                Point::new(front, half_width),
            )),
            height: 0.120,
            mass: 2.0,
            psds: [(1, "PSD_FRONT", front, 0.0), (4, "PSD_BACK", back, 180.0)]
                .into_iter()
                .map(|(id, name, x, yaw)| PsdSpec {
                    id,
                    name: name.into(),
                    mount: Mount { x, y: 0.0, z: 0.050, yaw: units::from_deg(yaw) },
                    max_range: PsdSpec::DEFAULT_MAX_RANGE,
                })
                .collect(),
            lidar: Some(LidarSpec {
                mount: Mount { x: 0.5 * wheelbase, z: 0.100, ..Mount::default() },
                ..LidarSpec::default()
            }),
            ..Self::s4()
        }
    }

    /// A student's Formula car (book, section 14.5), with a motor at each wheel, a low lidar at its nose and a camera
    /// above the driver's head.
    pub fn race_car() -> Self {
        let (nose, half_width) = (2.15, 0.70);
        Self {
            name: "RaceCar".into(),
            drive: DriveSpec::Ackermann {
                wheel_diameter: 0.50,
                track: 1.20,
                wheelbase: 1.55,
                max_steering: 0.60,
                max_wheel_speed: 120.0,
                ticks_per_turn: 1000.0,
                dynamics: Some(CarDynamics::default()),
            },
            motor: MotorSpec { time_constant: 1.0 / 12.0, max_acceleration: 8.0 },
            footprint: Footprint::Rectangle(Aabb::new(
                Point::new(-0.45, -half_width),
                Point::new(nose, half_width),
            )),
            height: 1.20,
            mass: 250.0,
            psds: Vec::new(),
            lidar: Some(LidarSpec {
                // Where the cones of a track are 65 mm in radius.
                mount: Mount { x: nose, z: 0.20, ..Mount::default() },
                field_of_view: std::f64::consts::PI,
                tilt: 0.0,
                points: 901,
                max_range: 25.0,
            }),
            camera: Some(CameraSpec {
                mount: Mount { x: 0.6, z: 1.1, ..Mount::default() },
                tilt: -0.16,
                max_pan: 0.0,
                max_tilt: 0.0,
                field_of_view: 1.75,
                fisheye: false,
            }),
            ..Self::s4()
        }
    }

    /// How fast it can brake, in metres per second squared.
    pub fn deceleration(&self) -> f64 {
        self.drive.dynamics().map_or(self.motor.max_acceleration, |dynamics| dynamics.brake)
    }

    /// A robot that every scene knows by name, without regard to case: `S4`, `LabBot` or `Omni`.
    pub fn predefined(name: &str) -> Option<Self> {
        match name.to_ascii_lowercase().as_str() {
            "s4" => Some(Self::s4()),
            "labbot" => Some(Self::labbot()),
            "omni" => Some(Self::omni()),
            _ => None,
        }
    }

    /// Checks that every length, speed and count makes sense.
    pub fn validate(&self) -> Result<(), SpecError> {
        let check = |parameter, value: f64, good: bool, expected| {
            if good {
                Ok(())
            } else {
                Err(SpecError { robot: self.name.clone(), parameter, value, expected })
            }
        };
        let positive = |parameter, value: f64| {
            check(parameter, value, value.is_finite() && value > 0.0, "a positive, finite number")
        };
        match self.drive {
            DriveSpec::Differential { wheel_diameter, track, max_wheel_speed, ticks_per_turn } => {
                positive("wheel diameter", wheel_diameter)?;
                positive("track", track)?;
                positive("maximal wheel speed", max_wheel_speed)?;
                positive("ticks per turn", ticks_per_turn)?;
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
                positive("wheel diameter", wheel_diameter)?;
                positive("track", track)?;
                positive("wheelbase", wheelbase)?;
                positive("maximal steering", max_steering)?;
                positive("maximal wheel speed", max_wheel_speed)?;
                positive("ticks per turn", ticks_per_turn)?;
                if let Some(dynamics) = dynamics {
                    let within = |parameter, value: f64, most: f64, expected| {
                        check(parameter, value, value > 0.0 && value < most, expected)
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
            DriveSpec::Omni { wheel_diameter, track, wheelbase, max_wheel_speed, ticks_per_turn } => {
                positive("wheel diameter", wheel_diameter)?;
                positive("track", track)?;
                positive("wheelbase", wheelbase)?;
                positive("maximal wheel speed", max_wheel_speed)?;
                positive("ticks per turn", ticks_per_turn)?;
            }
        }
        let lag = self.motor.time_constant;
        check("motor time constant", lag, lag.is_finite() && lag >= 0.0, "a finite number of at least 0")?;
        positive("maximal acceleration", self.motor.max_acceleration)?;
        positive("footprint radius", self.footprint.bounding_radius())?;
        positive("height", self.height)?;
        for psd in &self.psds {
            positive("PSD maximal range", psd.max_range)?;
        }
        if let Some(lidar) = &self.lidar {
            let (fov, points) = (lidar.field_of_view, lidar.points as f64);
            let full_turn = std::f64::consts::TAU * (1.0 + 1e-9);
            check(
                "lidar field of view",
                fov,
                fov > 0.0 && fov <= full_turn,
                "more than 0 and at most a full turn",
            )?;
            check("lidar points", points, (1.0..=100_000.0).contains(&points), "1 to 100000")?;
            positive("lidar maximal range", lidar.max_range)?;
        }
        Ok(())
    }
}

/// PSDs 1 to 4 at the front, left, right and back, as the simulator numbers them.
fn four_psds(ahead: f64, aside: f64, z: f64) -> Vec<PsdSpec> {
    [
        (1, "PSD_FRONT", ahead, 0.0, 0.0),
        (2, "PSD_LEFT", ahead - 0.005, aside, 90.0),
        (3, "PSD_RIGHT", ahead - 0.005, -aside, -90.0),
        (4, "PSD_BACK", -ahead, 0.0, 180.0),
    ]
    .into_iter()
    .map(|(id, name, x, y, yaw)| PsdSpec {
        id,
        name: name.into(),
        mount: Mount { x, y, z, yaw: units::from_deg(yaw) },
        max_range: PsdSpec::DEFAULT_MAX_RANGE,
    })
    .collect()
}
