use roverlab::geometry::{Aabb, Point, Pose, direction};
use roverlab::random::Stream;
use roverlab::world::{HeightField, Scene, Terrain, World};

use crate::water::{BOOK, pool, surveyor};

/// What the floor of a pool is like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Floor {
    Slope,
    Steps,
    Bowl,
    /// In deep water, for craft that hold their altitude.
    Ridge,
}

impl Floor {
    pub(super) const ALL: [Self; 4] = [Self::Slope, Self::Steps, Self::Bowl, Self::Ridge];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Slope => "slope",
            Self::Steps => "steps",
            Self::Bowl => "bowl",
            Self::Ridge => "ridge",
        }
    }
}

/// The most that a floor rises (m).
const RISE: [f64; 2] = [0.3, 0.8];

/// The floor of a seed, for craft that hold an altitude or a depth.
pub(super) fn floor(seed: u64, altitude: Option<f64>) -> Floor {
    if altitude.is_some() { Floor::Ridge } else { Floor::ALL[(seed % 3) as usize] }
}

/// The book's pool with the floor of a seed; for craft that hold an altitude, a ridge.
pub(super) fn scene(seed: u64, altitude: Option<f64>) -> Scene {
    if floor(seed, altitude) == Floor::Ridge { ridge(seed) } else { book(seed) }
}

fn book(seed: u64) -> Scene {
    let mut stream = Stream::new(seed).child("floor", 0);
    let rise = stream.between(RISE[0], RISE[1]);
    let place = Point::new(stream.between(8.0, 17.0), stream.between(15.0, 35.0));
    let (wide, steps) = (stream.between(5.0, 9.0), 2 + stream.below(3));
    let kind = floor(seed, None);
    let height = move |at: Point| match kind {
        Floor::Slope => rise * at.y / 50.0,
        Floor::Steps => rise * (at.y / 50.0 * (steps + 1) as f64).floor() / steps as f64,
        Floor::Bowl => rise * ((at - place).norm_squared() / (wide * wide)).min(1.0),
        Floor::Ridge => 0.0,
    };
    let start = Pose::new(3.0, 4.0, std::f64::consts::FRAC_PI_2);
    Scene::with_robot(pool(BOOK, height), surveyor(), start)
}

/// Metres of the deep basin, of its water, between samples of its ground, and along a slope.
const BASIN: [f64; 2] = [16.0, 32.0];
const DEEP: f64 = 6.0;
const PITCH: f64 = 0.25;
const SLOPE: f64 = 12.0;
/// The slope's gradient, and half of the flat ridge between two of them (m).
const GRADIENT: f64 = 0.2;
const FLAT: f64 = 1.0;

/// A basin with walls, across whose middle runs a ridge with a slope on both sides.
fn ridge(seed: u64) -> Scene {
    let across = direction(Stream::new(seed).child("ridge", 0).between(0.8, 2.4));
    let [width, length] = BASIN;
    let middle = Point::new(0.5 * width, 0.5 * length);
    let height = |at: Point| {
        let off = (at - middle).dot(&across).abs();
        GRADIENT * (SLOPE - (off - FLAT).clamp(0.0, SLOPE))
    };
    let samples = |length: f64| (length / PITCH) as usize + 1;
    let area = Aabb::new(Point::origin(), Point::new(width, length));
    let surface = HeightField::from_fn(samples(width), samples(length), area, height).ok();
    let mut world = World {
        terrain: surface.map(|surface| Terrain::new("basin", surface)),
        water_level: Some(DEEP),
        ..World::walled(width, length)
    };
    for wall in &mut world.walls {
        wall.height = DEEP;
    }
    Scene::with_robot(world, surveyor(), Pose::new(3.0, 4.0, std::f64::consts::FRAC_PI_2))
}
