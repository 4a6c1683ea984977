use roverlab::geometry::{Aabb, Point};
use roverlab::world::{HeightField, Terrain, World};

/// Metres of the water above the pool's floor.
pub(crate) const LEVEL: f64 = 1.9;
/// Metres along the sides of the book's pool (section 8.2).
pub(crate) const BOOK: [f64; 2] = [25.0, 50.0];
/// Width and height of a pool's rim (m), and between samples of its ground.
const RIM: [f64; 2] = [0.5, 2.0];
const PITCH: f64 = 0.25;

/// A pool of a size with a rim of 2 m, and a floor above its deepest place.
pub(crate) fn pool([width, length]: [f64; 2], floor: impl Fn(Point) -> f64) -> World {
    let area = Aabb::new(Point::origin(), Point::new(width, length));
    let height = |at: Point| {
        let inside = at.x.min(width - at.x).min(at.y).min(length - at.y);
        if inside > RIM[0] { floor(at) } else { RIM[1] }
    };
    let surface = HeightField::from_fn(samples(width), samples(length), area, height).ok();
    World {
        terrain: surface.map(|surface| Terrain::new("pool", surface)),
        water_level: Some(LEVEL),
        ..World::empty(width, length)
    }
}

/// Samples along a side.
fn samples(length: f64) -> usize {
    (length / PITCH).round() as usize + 1
}
