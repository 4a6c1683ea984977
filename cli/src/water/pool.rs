use roverlab::geometry::{Aabb, Point};
use roverlab::world::{HeightField, Terrain, World};

/// Metres of the water above the pool's floor.
pub(crate) const LEVEL: f64 = 1.9;
/// Metres along the pool's sides, and of its rim.
const SIZE: [f64; 2] = [25.0, 50.0];
const RIM: [f64; 2] = [0.5, 2.0];

/// The book's pool: 25 x 50 m with a rim of 2 m (section 8.2), and a floor above its deepest place.
pub(crate) fn pool(floor: impl Fn(Point) -> f64) -> World {
    let [width, length] = SIZE;
    let area = Aabb::new(Point::origin(), Point::new(width, length));
    let height = |at: Point| {
        let inside = at.x.min(width - at.x).min(at.y).min(length - at.y);
        if inside > RIM[0] { floor(at) } else { RIM[1] }
    };
    let surface = HeightField::from_fn(101, 201, area, height).ok();
    World {
        terrain: surface.map(|surface| Terrain::new("pool", surface)),
        water_level: Some(LEVEL),
        ..World::empty(width, length)
    }
}
