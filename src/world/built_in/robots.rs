use std::sync::Arc;

use crate::geometry::{Aabb, Point, units};
use crate::kinematics::marine::CraftSpec;
use crate::world::{
    Body, CameraSpec, CarDynamics, DepthSensorSpec, DriveSpec, Footprint, InertialSpec, LidarSpec, Mast,
    MotorSpec, Mount, PsdSpec, RobotSpec,
};

impl RobotSpec {
    /// The robots that every scene knows by name.
    pub const PREDEFINED: [&'static str; 16] = [
        "S4",
        "SoccerBot",
        "LabBot",
        "LidarBot",
        "Cubot",
        "Cubot-r",
        "Cubot-b",
        "Cubot-y",
        "Omni",
        "Blizzard",
        "Car",
        "Ackermann",
        "SAE",
        "RoadCar",
        "Mako",
        "SolarRaft",
    ];

    /// EyeSim's S4: a small differential-drive robot with four PSDs, a lidar and a camera.
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
            mast: None,
            mass: 0.5,
            friction: Self::DEFAULT_FRICTION,
            psds: four_psds(0.060, 0.045, 0.030),
            lidar: Some(LidarSpec::default()),
            camera: Some(CameraSpec {
                mount: Mount { x: 0.062, z: 0.060, ..Mount::default() },
                tilt: 0.0,
                max_pan: units::from_deg(90.0),
                max_tilt: units::from_deg(90.0),
                field_of_view: CameraSpec::DEFAULT_FIELD_OF_VIEW,
                fisheye: false,
            }),
            depth_sensor: None,
            dvl: None,
            inertial: InertialSpec::default(),
            compass: false,
            model: None,
            mesh: None,
            body: Body::default(),
        }
    }

    /// EyeSim's LabBot: a larger differential-drive robot with a high handle at its back, by which others
    /// recognise it from afar (book, section 5.3). A lidar at a height of 100 mm with a tilt of 10 degrees
    /// sees the handle from up to 2.8 m.
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
            mast: Some(Mast {
                outline: Aabb::new(Point::new(-0.060, -0.055), Point::new(-0.045, 0.055)),
                top: 0.600,
            }),
            mass: 1.5,
            psds: four_psds(0.045, 0.027, 0.040),
            ..Self::s4()
        }
    }

    /// A robot with four Mecanum wheels, modelled on the book's Omni-1 (section 7.2), with an S4's sensors.
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

    /// A snow truck on two belts, a 1:12 model (book, section 7.3), with an S4's sensors, a lidar on its roof
    /// and an inertial unit.
    pub fn blizzard() -> Self {
        let (half_length, half_width) = (0.200, 0.130);
        Self {
            name: "Blizzard".into(),
            drive: DriveSpec::Tracked {
                wheel_diameter: 0.060,
                track: 0.185,
                length: 0.260,
                width: 0.070,
                max_wheel_speed: units::from_deg(900.0),
                ticks_per_turn: 1200.0,
            },
            footprint: Footprint::Rectangle(Aabb::new(
                Point::new(-half_length, -half_width),
                Point::new(half_length, half_width),
            )),
            height: 0.190,
            mass: 2.4,
            psds: four_psds(half_length, half_width, 0.070),
            lidar: Some(LidarSpec { mount: Mount { z: 0.200, ..Mount::default() }, ..LidarSpec::default() }),
            camera: Self::s4().camera.map(|camera| CameraSpec {
                mount: Mount { x: 0.120, z: 0.170, ..Mount::default() },
                ..camera
            }),
            inertial: InertialSpec::ALL,
            ..Self::s4()
        }
    }

    /// A model car with Ackermann steering (book, section 7.1) and an S4's sensors. The radius of its turning
    /// circle is 0.45 m.
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
            psds: front_and_back(front, back, 0.050),
            lidar: Some(LidarSpec {
                mount: Mount { x: 0.5 * wheelbase, z: 0.100, ..Mount::default() },
                ..LidarSpec::default()
            }),
            ..Self::s4()
        }
    }

    /// A 1:10 model car for roads by the rules of the CAuDri-Challenge (book, chapter 13): at most 3 m/s,
    /// tyres that slip, and a wide-angle camera on a mast above the rear axle, tilted down to the road.
    pub fn road_car() -> Self {
        let (wheelbase, half_width) = (0.260, 0.095);
        Self {
            name: "RoadCar".into(),
            drive: DriveSpec::Ackermann {
                wheel_diameter: 0.066,
                track: 0.165,
                wheelbase,
                max_steering: units::from_deg(28.0),
                max_wheel_speed: 3.0 / 0.033,
                ticks_per_turn: 1300.0,
                // Rubber on a smooth indoor floor; a servo with 60 degrees in 0.12 s steers the wheels.
                dynamics: Some(CarDynamics {
                    mass_centre: 0.125,
                    gyration: 0.110,
                    grip: 7.0,
                    stiffness: 20.0,
                    balance: 0.95,
                    brake: 5.0,
                    steering_rate: 5.0,
                }),
            },
            motor: MotorSpec { time_constant: 0.1, max_acceleration: 3.0 },
            footprint: Footprint::Rectangle(Aabb::new(
                Point::new(-0.080, -half_width),
                Point::new(0.350, half_width),
            )),
            height: 0.120,
            mass: 2.5,
            psds: Vec::new(),
            lidar: None,
            camera: Some(CameraSpec {
                mount: Mount { x: 0.060, y: 0.0, z: 0.250, yaw: 0.0, ..Mount::default() },
                tilt: units::from_deg(-25.0),
                max_pan: 0.0,
                max_tilt: 0.0,
                field_of_view: units::from_deg(95.0),
                fisheye: false,
            }),
            ..Self::s4()
        }
    }

    /// A Formula Student car (book, section 14.5) with a motor at each wheel, a low lidar at its nose and a
    /// camera above the driver's head.
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
                // At this height the cones of a track have a radius of 65 mm.
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

    /// The racing car for EyeSim's programs (section 14.5): 5 m/s at full motor power, and an all-round
    /// lidar.
    pub fn sae() -> Self {
        let mut car = Self { name: "SAE".into(), ..Self::race_car() };
        if let DriveSpec::Ackermann { max_wheel_speed, .. } = &mut car.drive {
            *max_wheel_speed = 20.0;
        }
        car.lidar = car.lidar.map(|lidar| LidarSpec { mount: lidar.mount, ..LidarSpec::default() });
        car
    }

    /// The follower of section 5.3: an S4 with a tilted lidar that sees over robots of its kind (Program
    /// 5.8), and four additional sensors (Program 5.9).
    pub fn lidarbot() -> Self {
        let s4 = Self::s4();
        let ahead = s4.psds[0].clone();
        let oblique =
            [(5, "PSD_FL", 45.0), (6, "PSD_FR", -45.0), (7, "PSD_FFL", 25.0), (8, "PSD_FFR", -25.0)];
        let oblique = oblique.map(|(id, name, yaw)| PsdSpec {
            id,
            name: name.into(),
            mount: Mount { yaw: units::from_deg(yaw), ..ahead.mount },
            ..ahead
        });
        let lidar = LidarSpec {
            mount: Mount { z: 0.100, ..Mount::default() },
            field_of_view: std::f64::consts::PI,
            tilt: units::from_deg(10.0),
            points: 180,
            ..LidarSpec::default()
        };
        let psds = s4.psds.iter().cloned().chain(oblique).collect();
        Self { name: "LidarBot".into(), psds, lidar: Some(lidar), ..s4 }
    }

    /// The underwater craft Mako (book, chapter 8), with PSDs ahead, to the left, to the right, back, up and
    /// down.
    ///
    /// Its body is [`CraftSpec::mako`](crate::kinematics::marine::CraftSpec::mako).
    pub fn mako() -> Self {
        let psd = |id, name: &str, (x, y, z), (pitch, yaw)| PsdSpec {
            id,
            name: name.into(),
            mount: Mount { x, y, z, roll: 0.0, pitch: units::from_deg(pitch), yaw: units::from_deg(yaw) },
            max_range: PsdSpec::DEFAULT_MAX_RANGE,
        };
        let (half_length, half_width, height) = (0.670, 0.3225, 0.460);
        Self {
            name: "Mako".into(),
            drive: DriveSpec::Craft(Arc::new(CraftSpec::mako())),
            footprint: Footprint::Rectangle(Aabb::new(
                Point::new(-half_length, -half_width),
                Point::new(half_length, half_width),
            )),
            height,
            mass: 35.0,
            psds: vec![
                psd(1, "PSD_FRONT", (half_length, 0.0, 0.34), (0.0, 0.0)),
                psd(2, "PSD_LEFT", (0.0, half_width, 0.26), (0.0, 90.0)),
                psd(3, "PSD_RIGHT", (0.0, -half_width, 0.26), (0.0, -90.0)),
                psd(4, "PSD_BACK", (-half_length, 0.0, 0.34), (0.0, 180.0)),
                psd(5, "PSD_UP", (0.0, 0.0, height), (-90.0, 0.0)),
                psd(6, "PSD_DOWN", (0.0, 0.0, 0.0), (90.0, 0.0)),
            ],
            lidar: None,
            camera: Some(CameraSpec {
                mount: Mount { x: 0.60, z: 0.10, ..Mount::default() },
                tilt: 0.0,
                max_pan: 0.0,
                max_tilt: units::from_deg(90.0),
                field_of_view: CameraSpec::DEFAULT_FIELD_OF_VIEW,
                fisheye: false,
            }),
            depth_sensor: Some(DepthSensorSpec { channel: 18, z: 0.26 }),
            inertial: InertialSpec::ALL,
            body: Body { mass_centre: [0.0, 0.0, 0.20], ..Body::default() },
            ..Self::s4()
        }
    }

    /// The solar raft (book, section 8.1): a boat with two thrusters.
    ///
    /// Its body is [`CraftSpec::solar_raft`](crate::kinematics::marine::CraftSpec::solar_raft).
    pub fn solar_raft() -> Self {
        Self {
            name: "SolarRaft".into(),
            drive: DriveSpec::Craft(Arc::new(CraftSpec::solar_raft())),
            footprint: Footprint::Rectangle(Aabb::new(Point::new(-0.65, -0.38), Point::new(0.65, 0.38))),
            height: 0.24,
            mass: 20.0,
            psds: Vec::new(),
            lidar: None,
            camera: None,
            inertial: InertialSpec::ALL,
            compass: true,
            body: Body { mass_centre: [0.0, 0.0, 0.08], ..Body::default() },
            ..Self::s4()
        }
    }

    /// A robot of [`PREDEFINED`](Self::PREDEFINED), without regard to case.
    pub fn predefined(name: &str) -> Option<Self> {
        let name = Self::PREDEFINED.into_iter().find(|known| known.eq_ignore_ascii_case(name))?;
        let spec = match name {
            "LabBot" => Self::labbot(),
            "LidarBot" => Self::lidarbot(),
            "Omni" => Self::omni(),
            "Blizzard" => Self::blizzard(),
            "Car" | "Ackermann" => Self::car(),
            "SAE" => Self::sae(),
            "RoadCar" => Self::road_car(),
            "Mako" => Self::mako(),
            "SolarRaft" => Self::solar_raft(),
            _ => Self::s4(),
        };
        Some(Self { name: name.into(), ..spec })
    }
}

fn front_and_back(front: f64, back: f64, z: f64) -> Vec<PsdSpec> {
    [(1, "PSD_FRONT", front, 0.0), (4, "PSD_BACK", back, 180.0)]
        .into_iter()
        .map(|(id, name, x, yaw)| PsdSpec {
            id,
            name: name.into(),
            mount: Mount { x, z, yaw: units::from_deg(yaw), ..Mount::default() },
            max_range: PsdSpec::DEFAULT_MAX_RANGE,
        })
        .collect()
}

/// PSDs 1 to 4 at the front, left, right and back, with the simulator's numbers.
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
        mount: Mount { x, y, z, yaw: units::from_deg(yaw), ..Mount::default() },
        max_range: PsdSpec::DEFAULT_MAX_RANGE,
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_a_robot_that_can_be() {
        for name in RobotSpec::PREDEFINED {
            let spec = RobotSpec::predefined(&name.to_uppercase()).unwrap();
            assert_eq!((spec.name.as_str(), spec.validate()), (name, Ok(())));
        }
        assert_eq!(RobotSpec::predefined("R2D2"), None);
    }

    #[test]
    fn a_mast_stands_within_the_outline_and_above_the_rest() {
        let mut spec = RobotSpec::labbot();
        let mast = spec.mast.unwrap();
        for wrong in [
            Mast { top: 0.1, ..mast },
            Mast { outline: Aabb::new(mast.outline.min, Point::new(0.2, 0.0)), ..mast },
        ] {
            spec.mast = Some(wrong);
            assert!(spec.validate().unwrap_err().to_string().contains("mast"), "{wrong:?}");
        }
    }
}
