use roverlab::geometry::{Point, Point3, Pose};
use roverlab::picture::{Picture, Style};
use roverlab::world::{Colour, Scene, World};

use super::ground;
use crate::driving::Run;

/// The water from the side, along the way of a craft. Neither lengths nor heights are to scale.
pub(crate) struct Side {
    width: f64,
    level: f64,
    /// How far the craft had come (m), where it was, and the floor there.
    way: Vec<(f64, Point3, f64)>,
}

/// Length of the way in the picture relative to its width, so that the craft has room at its end.
const LONG: f64 = 0.9;
/// Height of the water in the picture relative to its width, and of what is drawn below and above it relative
/// to the water's.
const HIGH: f64 = 0.35;
const BELOW: f64 = 0.1;
const ABOVE: f64 = 0.25;

impl Side {
    pub(crate) fn of<T>(scene: &Scene, run: &Run<T>) -> Self {
        let size = scene.world.site().size();
        let (mut come, mut last) = (0.0, None);
        let places = run.in_space.iter().map(|space| space.pose.position);
        let way = places.map(|place| {
            come += last.map_or(0.0, |last: Point3| (place - last).xy().norm());
            last = Some(place);
            let floor = ground(&scene.world).and_then(|ground| ground.height(place.xy()));
            (come, place, floor.unwrap_or(0.0))
        });
        Self {
            width: size.x.max(0.5 * size.y),
            level: scene.world.water_level.unwrap_or_default(),
            way: way.collect(),
        }
    }

    /// The floor below the way where it comes nearest to a place, in the picture; `None` without a way.
    pub(crate) fn beside(&self, place: Point) -> Option<Point> {
        let off = |step: &&(f64, Point3, f64)| (step.1.xy() - place).norm();
        let nearest = self.way.iter().min_by(|a, b| off(a).total_cmp(&off(b)))?;
        Some(self.at(nearest.0, nearest.2))
    }

    /// The surface, the floor below the way, and the craft's origin.
    pub(crate) fn picture(&self, scene: &Scene) -> Picture {
        let height = HIGH * self.width * (1.0 + BELOW + ABOVE);
        let mut side = Picture::new(&World::empty(self.width, height));
        side.title(format!("From the side, along its way of {:.0} m", self.length()));
        side.without_scale();
        let surface = [0.0, self.length()].map(|come| self.at(come, self.level));
        side.line(surface, Style::new(Colour::from_hex(0x70_c0_d8)).labelled("surface"));
        let floor = self.way.iter().map(|(come, _, floor)| self.at(*come, *floor));
        side.line(floor, Style::new(Colour::from_hex(0x60_50_40)).labelled("floor below it"));
        side.true_path(self.way.iter().map(|(come, place, _)| self.at(*come, place.z)));
        if let Some((come, place, _)) = self.way.last() {
            let end = self.at(*come, place.z);
            side.robot(Pose::new(end.x, end.y, 0.0), &scene.robots[0].spec.footprint);
        }
        side
    }

    fn length(&self) -> f64 {
        self.way.last().map_or(0.0, |step| step.0)
    }

    fn at(&self, come: f64, height: f64) -> Point {
        let up = height / self.level.max(1e-6) + BELOW;
        Point::new(LONG * self.width * come / self.length().max(1e-6), HIGH * self.width * up)
    }
}
