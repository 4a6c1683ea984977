use crate::ParameterError;
use crate::geometry::{Aabb, Point, Pose, Segment, Vector, cross, direction, math};
use crate::random::Stream;
use crate::world::{HeightField, Terrain, World};

/// The outline of a pool that [`pool`] draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PoolKind {
    /// Four sides, in any direction.
    Rectangle,
    /// A rectangle that lacks a corner.
    L,
    /// A wide arc with round ends.
    Kidney,
}

impl PoolKind {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Rectangle, Self::L, Self::Kidney];
}

/// A generated pool.
#[derive(Debug, Clone, PartialEq)]
pub struct Pool {
    /// The pool as hills with water: a floor that slopes, steep sides, and a rim 100 mm above the water.
    pub world: World,
    /// A place at least 1.5 m from the sides, and the way a craft looks there.
    pub start: Pose,
}

/// Draws a pool of 6 to 16 m and at most 2.4 m depth. The same stream gives the same pool on every platform.
///
/// ```
/// use roverlab::random::Stream;
/// use roverlab::world::generate::{PoolKind, pool};
/// let pool = pool(&mut Stream::new(1), PoolKind::L)?;
/// let ground = pool.world.terrain.and_then(|terrain| terrain.surface).unwrap();
/// let depth = pool.world.water_level.unwrap() - ground.height(pool.start.position()).unwrap();
/// assert!(depth > 1.4 && depth < 2.5);
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
pub fn pool(stream: &mut Stream, kind: PoolKind) -> Result<Pool, ParameterError> {
    let sides = Sides::draw(stream, kind);
    let (low, high) = sides.extent();
    let origin = low - Vector::repeat(RIM);
    let size = high - low + Vector::repeat(2.0 * RIM);
    let area = Aabb::new(Point::origin(), Point::from(size));
    let deep = stream.between(DEPTHS[1], DEPTHS[2]);
    let shallow = stream.between(DEPTHS[0], deep);
    let downhill = direction(stream.between(0.0, std::f64::consts::TAU));
    let batter = stream.between(BATTER[0], BATTER[1]);
    let reach = 0.5 * size.norm();
    let height = |at: Point| {
        let inside = sides.inside(at + origin.coords);
        let share = 0.5 * (1.0 - (at.coords - 0.5 * size).dot(&downhill) / reach);
        let floor = (deep - shallow) * share.clamp(0.0, 1.0);
        let side = (deep + ABOVE) * (0.5 - inside / batter).clamp(0.0, 1.0);
        floor.max(side)
    };
    let samples = |length: f64| (length / PITCH).round() as usize + 1;
    let surface = HeightField::from_fn(samples(size.x), samples(size.y), area, height)?;
    let world = World {
        terrain: Some(Terrain::new(format!("{kind:?}.png").to_lowercase(), surface)),
        water_level: Some(deep),
        ..World::empty(size.x, size.y)
    };
    let start = loop {
        let draw = |stream: &mut Stream, most: f64| stream.between(0.0, most);
        let place = Point::new(draw(stream, size.x), draw(stream, size.y));
        if sides.inside(place + origin.coords) >= CLEAR {
            break place;
        }
    };
    let heading = stream.between(-std::f64::consts::PI, std::f64::consts::PI);
    Ok(Pool { world, start: Pose::new(start.x, start.y, heading) })
}

/// Width of the rim around a pool (m).
const RIM: f64 = 0.5;
/// Height of the rim above the water (m).
const ABOVE: f64 = 0.1;
/// Distance between samples of the ground (m).
const PITCH: f64 = 0.1;
/// Water depths: minimum, and range of the deepest place (m).
const DEPTHS: [f64; 3] = [1.5, 1.7, 2.4];
/// Width over which the sides rise to the rim (m).
const BATTER: [f64; 2] = [0.15, 0.4];
/// Distance from a start to the sides (m).
const CLEAR: f64 = 1.5;

/// The outline of a pool.
#[derive(Debug, Clone)]
enum Sides {
    /// Corners in order.
    Polygon(Vec<Point>),
    /// All that is at most `width` from an arc about the origin, `half` radians to either side of the x axis.
    Arc { radius: f64, half: f64, width: f64 },
}

impl Sides {
    fn draw(stream: &mut Stream, kind: PoolKind) -> Self {
        let turned = direction(stream.between(0.0, std::f64::consts::TAU));
        let corners = |points: &[(f64, f64)]| {
            let turn =
                |&(x, y): &(f64, f64)| Point::new(turned.x * x - turned.y * y, turned.y * x + turned.x * y);
            Self::Polygon(points.iter().map(turn).collect())
        };
        let (length, width) = (stream.between(7.0, 12.0), stream.between(5.0, 8.0));
        match kind {
            PoolKind::Rectangle => corners(&[(0.0, 0.0), (length, 0.0), (length, width), (0.0, width)]),
            PoolKind::L => {
                // Both arms are at least 3.5 m wide.
                let (length, width) = (length + 1.0, width + 2.5);
                let x = stream.between(3.5, length - 2.5);
                let y = stream.between(3.5, width - 2.5);
                corners(&[(0.0, 0.0), (length, 0.0), (length, y), (x, y), (x, width), (0.0, width)])
            }
            PoolKind::Kidney => Self::Arc {
                radius: stream.between(4.8, 6.5),
                half: stream.between(0.7, 1.2),
                width: stream.between(2.3, 2.8),
            },
        }
    }

    fn extent(&self) -> (Point, Point) {
        match self {
            Self::Polygon(corners) => {
                let first = corners[0];
                let all = corners
                    .iter()
                    .fold(Aabb::new(first, first), |all, &next| all.union(&Aabb::new(next, next)));
                (all.min, all.max)
            }
            Self::Arc { radius, half, width } => {
                let end = direction(*half) * *radius;
                let least = end.x - width;
                let most = end.y + width;
                (Point::new(least, -most), Point::new(radius + width, most))
            }
        }
    }

    /// Distance from a point to the sides (m); negative outside.
    fn inside(&self, at: Point) -> f64 {
        match self {
            Self::Polygon(corners) => {
                let next = corners.iter().cycle().skip(1);
                let (mut distance, mut is_in) = (f64::INFINITY, false);
                for (&a, &b) in corners.iter().zip(next) {
                    distance = distance.min(Segment { a, b }.distance_to(at));
                    if (a.y > at.y) != (b.y > at.y) {
                        let left = cross(b - a, at - a) > 0.0;
                        is_in ^= left == (b.y > a.y);
                    }
                }
                if is_in { distance } else { -distance }
            }
            Self::Arc { radius, half, width } => {
                let angle = math::atan2(at.y, at.x);
                let nearest = direction(angle.clamp(-half, *half)) * *radius;
                width - (at.coords - nearest).norm()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(24))]
        #[test]
        fn pools_hold_water_and_have_a_rim(seed in any::<u64>(), kind in 0..3_usize) {
            let kind = PoolKind::ALL[kind];
            let made = pool(&mut Stream::new(seed), kind).unwrap();
            prop_assert_eq!(&pool(&mut Stream::new(seed), kind).unwrap(), &made);
            let (level, ground) = (made.world.water_level.unwrap(), made.world.terrain.unwrap().surface.unwrap());
            let area = ground.area();
            // All along the border it is dry, at the start it is deep.
            for i in 0..=100 {
                let share = f64::from(i) / 100.0;
                let (x, y) = (share * area.max.x, share * area.max.y);
                for at in [(x, 0.0), (x, area.max.y), (0.0, y), (area.max.x, y)] {
                    let dry = ground.height(Point::new(at.0, at.1)).unwrap();
                    prop_assert!((dry - level - ABOVE).abs() < 1e-5, "{:?} {}", at, dry);
                }
            }
            let depth = level - ground.height(made.start.position()).unwrap();
            prop_assert!((DEPTHS[0]..=DEPTHS[2]).contains(&(depth + 1e-6)), "{}", depth);
            prop_assert!(ground.lowest() >= 0.0 && level - ground.lowest() <= DEPTHS[2]);
        }
    }
}
