use roverlab::geometry::{Point, Pose};
use roverlab::random::Stream;
use roverlab::world::Scene;

use crate::water::{BOOK, pool, surveyor};

/// What the floor of a pool is like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Floor {
    Slope,
    Steps,
    Bowl,
}

impl Floor {
    pub(super) const ALL: [Self; 3] = [Self::Slope, Self::Steps, Self::Bowl];

    /// The floor of a seed.
    pub(super) fn of(seed: u64) -> Self {
        Self::ALL[(seed % 3) as usize]
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Slope => "slope",
            Self::Steps => "steps",
            Self::Bowl => "bowl",
        }
    }
}

/// The most that a floor rises (m).
const RISE: [f64; 2] = [0.3, 0.8];

/// The book's pool with the floor of a seed.
pub(super) fn scene(seed: u64) -> Scene {
    let mut stream = Stream::new(seed).child("floor", 0);
    let rise = stream.between(RISE[0], RISE[1]);
    let place = Point::new(stream.between(8.0, 17.0), stream.between(15.0, 35.0));
    let (wide, steps) = (stream.between(5.0, 9.0), 2 + stream.below(3));
    let kind = Floor::of(seed);
    let floor = move |at: Point| match kind {
        Floor::Slope => rise * at.y / 50.0,
        Floor::Steps => rise * (at.y / 50.0 * (steps + 1) as f64).floor() / steps as f64,
        Floor::Bowl => rise * ((at - place).norm_squared() / (wide * wide)).min(1.0),
    };
    let start = Pose::new(3.0, 4.0, std::f64::consts::FRAC_PI_2);
    Scene::with_robot(pool(BOOK, floor), surveyor(), start)
}
