use roverlab::geometry::{Aabb, Point, Segment, Vector};
use roverlab::world::{HeightField, World};

use super::ground;

/// Where the ground and the walls of a world come to a height: the sides of its water there.
#[derive(Debug, Clone)]
pub(crate) struct Shore {
    sides: Vec<Segment>,
}

/// The cosine of the angle (45 degrees) by which a side nearby is turned at a corner.
const TURNED: f64 = 0.707;

impl Shore {
    /// The shore at a height above the world's origin.
    pub(crate) fn of(world: &World, height: f64) -> Self {
        let walls = world.walls.iter().filter(|wall| wall.height >= height).map(|wall| wall.line);
        let mut sides: Vec<Segment> = walls.collect();
        if let Some(ground) = ground(world) {
            sides.extend(contour(ground, height));
        }
        Self { sides }
    }

    /// The box around it; `None` if there is no side.
    pub(crate) fn bounds(&self) -> Option<Aabb> {
        Aabb::around(self.points())
    }

    /// The length of all its sides (m).
    pub(crate) fn length(&self) -> f64 {
        self.sides.iter().map(|side| (side.b - side.a).norm()).sum()
    }

    /// The ends of its sides.
    pub(crate) fn points(&self) -> impl Iterator<Item = Point> {
        self.sides.iter().flat_map(|side| [side.a, side.b])
    }

    /// Metres from a point to the nearest side; `None` without any.
    pub(crate) fn distance(&self, point: Point) -> Option<f64> {
        self.nearest(point).map(|side| side.distance_to(point))
    }

    /// Whether a side within so many metres of the one nearest to a point is turned by more than 45 degrees.
    pub(crate) fn is_corner(&self, point: Point, around: f64) -> bool {
        let Some(side) = self.nearest(point) else { return false };
        let (place, along) = (side.closest_point(point), way(side));
        let near = self.sides.iter().filter(|other| other.distance_to(place) < around);
        near.map(|other| way(other).dot(&along).abs()).any(|cosine| cosine < TURNED)
    }

    fn nearest(&self, point: Point) -> Option<&Segment> {
        self.sides.iter().min_by(|a, b| a.distance_to(point).total_cmp(&b.distance_to(point)))
    }
}

fn way(side: &Segment) -> Vector {
    (side.b - side.a).try_normalize(1e-9).unwrap_or_else(Vector::zeros)
}

/// The line at a height on the two triangles of each cell.
fn contour(ground: &HeightField, height: f64) -> Vec<Segment> {
    let pitch = ground.pitch();
    let place = |column: usize, row: usize| {
        let offset = pitch.component_mul(&Vector::new(column as f64, row as f64));
        (ground.area().min + offset, ground.sample(column, row))
    };
    let mut sides = Vec::new();
    for row in 1..ground.rows() {
        for column in 1..ground.columns() {
            let corner = |right: usize, up: usize| place(column - 1 + right, row - 1 + up);
            let (a, b, c, d) = (corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1));
            for triangle in [[a, b, c], [a, c, d]] {
                let crossing = |from: (Point, f64), to: (Point, f64)| {
                    let crosses = (from.1 >= height) != (to.1 >= height);
                    crosses.then(|| from.0 + (to.0 - from.0) * ((height - from.1) / (to.1 - from.1)))
                };
                let ends = (0..3).filter_map(|i| crossing(triangle[i], triangle[(i + 1) % 3]));
                let ends: Vec<Point> = ends.collect();
                if let [one, other] = ends[..] {
                    sides.extend((one != other).then(|| Segment::new(one, other)));
                }
            }
        }
    }
    sides
}

#[cfg(test)]
mod tests {
    use super::super::{LEVEL, pool};
    use super::*;

    /// Also where the last sample of the ground is, by its rounded place, just beyond it.
    #[test]
    fn the_shore_of_a_pool_is_its_rim_whatever_its_size() {
        for size in 0..60 {
            let size = [5.0 + 0.0713 * f64::from(size), 7.0 + 0.0931 * f64::from(size)];
            let bounds = Shore::of(&pool(size, |_| 0.0), LEVEL - 0.5).bounds().unwrap();
            let low = bounds.min.coords;
            let high = Vector::from(size) - bounds.max.coords;
            for rim in [low.x, low.y, high.x, high.y] {
                assert!((0.2..0.8).contains(&rim), "{size:?}: {bounds:?}");
            }
        }
    }
}
