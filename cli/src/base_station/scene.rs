//! The course, the cars on it, and the base station beside it.

use std::sync::Arc;

use roverlab::geometry::Pose;
use roverlab::world::formats::course;
use roverlab::world::road::{Appearance, RoadCourse, RoadCourseOptions, generate};
use roverlab::world::{RobotPlacement, RobotSpec, Scene};

use super::Args;
use crate::common::Failure;
use crate::lane_keeping::course as course_of;

/// A course with cars, the base station last.
#[derive(Debug, Clone)]
pub(super) struct Setting {
    pub(super) course: RoadCourse,
    pub(super) scene: Scene,
    pub(super) cars: usize,
    /// Where they start along the course (m).
    pub(super) starts: Vec<f64>,
}

/// A figure of eight that meets itself at a right angle, without signs.
const EIGHT: &str = "course 1
start-line
straight 1000
arc 2000 270
straight 2000
crossing 90 none from-the-right
straight 2000
arc 2000 -270
straight 2000
crossing 90 none from-the-right
straight 1000
";
/// Distance from the middle of a crossing within which no car starts (m).
const CLEAR: f64 = 1.2;
/// Distance of the base station from the floor's corner (m).
const CORNER: f64 = 0.15;

impl Setting {
    /// The setting of a command line.
    pub(super) fn of(args: &Args) -> Result<Self, Failure> {
        let seed = args.common.seed;
        let course = if args.course == "eight" {
            course::parse(EIGHT, "eight").map_err(Failure::input)?
        } else {
            course_of(&args.common, &args.course, |seed| {
                generate(seed, &RoadCourseOptions::default()).map_err(Failure::input)
            })?
        };
        if (course.size - 1.0).abs() > 1e-9 {
            return Err(Failure::input(format!(
                "--course {}: found a scale of {}; expected 1, that of the cars",
                args.course,
                1.0 / course.size
            )));
        }
        let look = Appearance { seed, ..Appearance::default() };
        let mut scene = Scene::new(course.world(&look).map_err(Failure::input)?);
        let car = Arc::new(RobotSpec::road_car());
        let cars = usize::from(args.cars);
        let apart = course.line.length() / cars as f64;
        let starts: Vec<f64> = (0..cars).map(|index| free_place(&course, apart * index as f64)).collect();
        for &along in &starts {
            scene.robots.push(RobotPlacement::new(Arc::clone(&car), course.pose(along, 0.0)));
        }
        let corner = course.floor().min;
        let station = Pose::new(corner.x + CORNER, corner.y + CORNER, 0.0);
        scene.robots.push(RobotPlacement::new(Arc::new(RobotSpec::s4()), station));
        Ok(Self { course, scene, cars, starts })
    }
}

/// The first place from one on (m) that is away from all crossings.
fn free_place(course: &RoadCourse, from: f64) -> f64 {
    let length = course.line.length();
    let is_free = |along: &f64| {
        course.crossings().all(|(at, _)| {
            let way = (along - at).rem_euclid(length);
            way.min(length - way) > CLEAR
        })
    };
    let mut places = (0..(length / 0.1) as usize).map(|i| (from + 0.1 * i as f64) % length);
    places.find(is_free).unwrap_or(from)
}
