use roverlab::geometry::{Aabb, Point, Segment, Vector};
use roverlab::world::{HeightField, Wall, World};

use super::ground;

/// Where the ground and the walls of a world come to a height: the sides of its water there.
#[derive(Debug, Clone)]
pub(crate) struct Shore {
    sides: Vec<Segment>,
    /// Thickness of the thickest wall (m).
    thickest: f64,
}

/// The cosine of the angle (45 degrees) by which a side nearby is turned at a corner.
const TURNED: f64 = 0.707;

impl Shore {
    /// The shore at a height above the world's origin, without what is far from all the rest.
    pub(crate) fn of(world: &World, height: f64) -> Self {
        let site = world.site();
        let high = world.walls.iter().filter(|wall| wall.height >= height);
        let walls: Vec<Wall> = high.filter_map(|wall| part_in(&site, wall)).collect();
        let mut sides: Vec<Segment> = walls.iter().flat_map(faces).collect();
        if let Some(ground) = ground(world) {
            sides.extend(contour(ground, height));
        }
        Self { sides, thickest: walls.iter().map(|wall| wall.thickness).fold(0.0, f64::max) }
    }

    /// The box within the walls around it; `None` if there is no side.
    pub(crate) fn bounds(&self) -> Option<Aabb> {
        let mut area = Aabb::around(self.points())?;
        // Of each wall there, the inner face.
        for axis in [0, 1] {
            let across = self.thickest + 1e-9;
            let (low, high) = (area.min[axis] + across, area.max[axis] - across);
            let at = || self.points().map(|point| point[axis]);
            area.min[axis] = at().filter(|at| *at <= low).fold(area.min[axis], f64::max);
            area.max[axis] = at().filter(|at| *at >= high).fold(area.max[axis], f64::min);
        }
        Some(area)
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

/// The part of a wall in a box; `None` if it misses the box.
fn part_in(area: &Aabb, wall: &Wall) -> Option<Wall> {
    let Segment { a, b } = wall.line;
    let [begin, end] = area.span(&wall.line)?;
    let line = Segment::new(a + (b - a) * begin, b - (b - a) * (1.0 - end));
    Some(Wall { line, ..*wall })
}

/// Both faces of a wall.
fn faces(wall: &Wall) -> [Segment; 2] {
    let [x, y]: [f64; 2] = (way(&wall.line) * (0.5 * wall.thickness)).into();
    [Vector::new(-y, x), Vector::new(y, -x)]
        .map(|aside| Segment::new(wall.line.a + aside, wall.line.b + aside))
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
    use super::super::{LEVEL, Site, pool, widest};
    use super::*;

    /// Of thick walls the inner faces count, and low ones stop a craft too.
    #[test]
    fn walls_bound_the_water_by_their_faces() {
        let mut world = World { water_level: Some(1.9), ..World::walled(8.0, 6.0) };
        for height in [2.0, 0.2] {
            for wall in &mut world.walls {
                (wall.thickness, wall.height) = (0.4, height);
            }
            let start = widest(&world, 1.9).unwrap();
            assert!((start.x - 4.0).abs() < 1.5 && (start.y - 3.0).abs() < 0.2, "{start:?}");
            let site = Site::of(&world, 0.5);
            assert_eq!(site.by_walls, height > 1.0);
            assert!(!site.by_walls || (site.area.size() - Vector::new(7.6, 5.6)).norm() < 1e-9, "{site:?}");
        }
    }

    /// A pool's sides are where they were, whatever is far from all the rest.
    #[test]
    fn the_shore_leaves_out_what_is_far_off() {
        let mut world = World { water_level: Some(1.0), ..World::walled(6.0, 5.0) };
        for wall in &mut world.walls {
            wall.height = 1.0;
        }
        let site = Site::of(&world, 0.5);
        for (from, to) in [((1e3, 0.0), (1e3, 1.0)), ((-1e6, 1.0), (-1e6, 2.0)), ((6.0, 5.0), (1e6, 5.0))] {
            let mut strayed = world.clone();
            let stray = Wall::new(Point::new(from.0, from.1), Point::new(to.0, to.1));
            strayed.walls.push(Wall { height: 1.0, ..stray });
            let found = Site::of(&strayed, 0.5);
            assert!(found.by_walls && (found.area.size() - site.area.size()).norm() < 1e-9, "{found:?}");
            assert!(Shore::of(&strayed, 0.5).length() <= Shore::of(&world, 0.5).length() + 1e-9);
        }
    }

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
