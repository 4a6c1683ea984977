//! The course and its appearance.

use std::path::Path;

use roverlab::io::sim::SimOptions;
use roverlab::random::Stream;
use roverlab::world::formats::course;
use roverlab::world::road::{Appearance, RoadCourse, RoadCourseOptions, generate};
use roverlab::world::{Footprint, RobotSpec, Scene};

use crate::common::{CommonArgs, Failure};

/// A course, the light, and the state of the paint.
#[derive(Debug, Clone)]
pub(crate) struct Setting {
    pub(super) name: String,
    pub(crate) course: RoadCourse,
    look: Appearance,
    pub(super) light: f64,
    pub(super) seed: u64,
}

impl Setting {
    /// The course of a command line, in a light.
    pub(crate) fn of(common: &CommonArgs, name: &str, light: f64) -> Result<Self, Failure> {
        let seed = common.seed;
        let course = course(common, name, generated)?;
        let look = Appearance { seed, ..Appearance::default() };
        Ok(Self { name: name.into(), course, look, light, seed })
    }

    /// The course of a seed in a campaign, with its own light and wear.
    pub(crate) fn drawn(seed: u64) -> Result<Self, Failure> {
        Self::drawn_by(seed, &RoadCourseOptions::default())
    }

    /// The same for courses of other options.
    pub(crate) fn drawn_by(seed: u64, options: &RoadCourseOptions) -> Result<Self, Failure> {
        let mut random = Stream::new(seed).child("lane keeping", 0);
        let light = random.between(0.5, 1.5);
        let look = Appearance {
            wear: random.between(0.0, 0.35),
            glare: random.below(6),
            seed,
            ..Appearance::default()
        };
        let course = generate(seed, options).map_err(Failure::input)?;
        Ok(Self { name: seed.to_string(), course, look, light, seed })
    }

    /// The car at the start of the course.
    pub(crate) fn scene(&self) -> Result<Scene, Failure> {
        let world = self.course.world(&self.look).map_err(Failure::input)?;
        Ok(Scene::with_robot(world, RobotSpec::road_car(), self.course.start()))
    }

    pub(crate) fn options(&self, noise: f64) -> SimOptions {
        SimOptions { light: self.light, ..SimOptions::with_noise(noise, self.seed) }
    }
}

/// The course of a command line: a seed, or a file. Fails if the car does not fit in its lane.
pub(crate) fn course(
    common: &CommonArgs,
    name: &str,
    generated: impl Fn(u64) -> Result<RoadCourse, Failure>,
) -> Result<RoadCourse, Failure> {
    let course = if let Ok(seed) = name.parse::<u64>() {
        generated(seed)?
    } else {
        let bytes = common.read("course", Path::new(name)).map_err(Failure::input)?;
        course::parse(&String::from_utf8_lossy(&bytes), name).map_err(Failure::input)?
    };
    let width = match RobotSpec::road_car().footprint {
        Footprint::Rectangle(outline) => outline.size().y,
        other => 2.0 * other.bounding_radius(),
    };
    course.check_car(width).map_err(|error| Failure::input(format!("--course {name}: {error}")))?;
    Ok(course)
}

fn generated(seed: u64) -> Result<RoadCourse, Failure> {
    generate(seed, &RoadCourseOptions::default()).map_err(Failure::input)
}
