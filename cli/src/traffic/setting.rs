//! The course, what is on it, and its appearance.

use roverlab::drive::traffic::TrafficScene;
use roverlab::io::sim::SimOptions;
use roverlab::random::Stream;
use roverlab::world::road::{Appearance, RoadCourse, RoadCourseOptions, generate};
use roverlab::world::{RobotSpec, Scene};

use super::Args;
use crate::common::Failure;
use crate::lane_keeping::course;

/// A course with traffic, the light, and the state of the paint.
#[derive(Debug, Clone)]
pub(super) struct Setting {
    pub(super) name: String,
    pub(super) scene: TrafficScene,
    look: Appearance,
    light: f64,
    seed: u64,
}

impl Setting {
    /// The course of a command line.
    pub(super) fn of(args: &Args) -> Result<Self, Failure> {
        let seed = args.common.seed;
        let course = course(&args.common, &args.course, generated)?;
        if (course.size - 1.0).abs() > 1e-9 {
            return Err(Failure::input(format!(
                "--course {}: found a scale of {}; expected 1, at which boxes and pedestrians have their size",
                args.course,
                1.0 / course.size
            )));
        }
        Ok(Self {
            name: args.course.clone(),
            scene: TrafficScene::drawn(course, seed),
            look: Appearance { seed, ..Appearance::default() },
            light: 1.0,
            seed,
        })
    }

    /// The course of a seed in a campaign, with its own light and wear.
    pub(super) fn drawn(seed: u64) -> Result<Self, Failure> {
        let mut random = Stream::new(seed).child("traffic campaign", 0);
        let light = random.between(0.5, 1.5);
        let (wear, glare) = (random.between(0.0, 0.35), random.below(6));
        let look = Appearance { wear, glare, seed, ..Appearance::default() };
        let scene = TrafficScene::drawn(generated(seed)?, seed);
        Ok(Self { name: seed.to_string(), scene, look, light, seed })
    }

    /// The car at the start of the course, and the boxes as objects.
    pub(super) fn scene(&self) -> Result<Scene, Failure> {
        self.scene.scene(&self.look, RobotSpec::road_car()).map_err(Failure::input)
    }

    pub(super) fn options(&self, args: &Args) -> SimOptions {
        SimOptions { light: self.light, ..SimOptions::with_noise(args.common.noise, self.seed) }
    }
}

/// Probabilities of a crossing and of a crosswalk on a straight with enough room.
const CROSSINGS: f64 = 0.9;
const ZEBRAS: f64 = 0.8;

fn generated(seed: u64) -> Result<RoadCourse, Failure> {
    let options = RoadCourseOptions { crossings: CROSSINGS, zebras: ZEBRAS, ..RoadCourseOptions::default() };
    generate(seed, &options).map_err(Failure::input)
}
