use roverlab::geometry::{Aabb, Point, Segment, Vector};
use roverlab::world::{HeightField, Raster, Wall, World};

use super::ground;

/// Where the ground and the walls of a world come to a height: the sides of its water there.
#[derive(Debug, Clone)]
pub(crate) struct Shore {
    sides: Vec<Segment>,
    /// Metres at most by which the outermost ends are farther out than the inner faces: the thickest wall, or
    /// what is left of sides that went on.
    across: f64,
}

/// Width of the cells in which enclosed water is looked for (m), and the most of them along a side.
const CELL: f64 = 0.1;
const CELLS: f64 = 1000.0;

/// The cosine of the angle (45 degrees) by which a side nearby is turned at a corner.
const TURNED: f64 = 0.707;

impl Shore {
    /// The shore at a height above the world's origin, without what is far from all the rest.
    pub(crate) fn of(world: &World, height: f64) -> Self {
        let site = world.site();
        let high = world.walls.iter().filter(|wall| wall.height >= height);
        let part = |wall: &Wall| Some(Wall { line: part_in(&site, &wall.line)?, ..*wall });
        let walls: Vec<Wall> = high.filter_map(part).collect();
        let mut sides: Vec<Segment> = walls.iter().flat_map(faces).collect();
        if let Some(ground) = ground(world) {
            sides.extend(contour(ground, height));
        }
        Self { sides, across: walls.iter().map(|wall| wall.thickness).fold(0.0, f64::max) }
    }

    /// The part of it around the water at a place; all of it where that is open.
    pub(crate) fn around(self, place: Point) -> Self {
        let Some((area, margin)) = self.basin(place) else { return self };
        let is_in = |side: &Segment| area.contains(side.a) && area.contains(side.b);
        let goes_on = |side: &Segment| !is_in(side) && area.span(side).is_some();
        let across = if self.sides.iter().any(goes_on) { self.across.max(margin) } else { self.across };
        Self { sides: self.sides.iter().filter_map(|side| part_in(&area, side)).collect(), across }
    }

    /// A box around the water that sides enclose at a place, and the most by which it is larger (m); `None`
    /// if that water is open.
    fn basin(&self, place: Point) -> Option<(Aabb, f64)> {
        let all = Aabb::around(self.points())?;
        let cell = CELL.max(all.size().max() / CELLS);
        let raster = Raster::over(all.inflated(2.0 * cell), cell).ok()?;
        let mut is_side = vec![false; raster.cells()];
        for side in &self.sides {
            // Steps of half a cell leave no gap through which edge-connected cells pass.
            let steps = (2.0 * (side.b - side.a).norm() / cell).ceil().max(1.0) as usize;
            for step in 0..=steps {
                let at = side.a + (side.b - side.a) * (step as f64 / steps as f64);
                raster.cell_at(at).into_iter().for_each(|cell| is_side[cell] = true);
            }
        }
        let regions = raster.regions(|cell| !is_side[cell]);
        let here = regions[raster.cell_at(place)?].filter(|here| Some(*here) != regions[0])?;
        let cells = (0..raster.cells()).filter(|cell| regions[*cell] == Some(here));
        let water = Aabb::around(cells.map(|cell| raster.centre(cell)))?;
        // Half a cell up to its edge, and one for the sides.
        let margin = 1.5 * cell;
        Some((water.inflated(margin), margin))
    }

    /// The box within the walls around it; `None` if there is no side.
    pub(crate) fn bounds(&self) -> Option<Aabb> {
        let mut area = Aabb::around(self.points())?;
        // Of each wall there, the inner face.
        for axis in [0, 1] {
            let across = self.across + 1e-9;
            let (low, high) = (area.min[axis] + across, area.max[axis] - across);
            let at = || self.points().map(|point| point[axis]);
            area.min[axis] = at().filter(|at| *at <= low).fold(area.min[axis], f64::max);
            area.max[axis] = at().filter(|at| *at >= high).fold(area.max[axis], f64::min);
        }
        Some(area)
    }

    /// Whether a side reaches into a box.
    pub(crate) fn crosses(&self, area: &Aabb) -> bool {
        self.sides.iter().any(|side| area.span(side).is_some())
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

/// The part of a line in a box; `None` if it misses the box.
fn part_in(area: &Aabb, line: &Segment) -> Option<Segment> {
    let [begin, end] = area.span(line)?;
    let Segment { a, b } = *line;
    Some(Segment::new(a + (b - a) * begin, b - (b - a) * (1.0 - end)))
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
    use roverlab::geometry::Pose;
    use roverlab::world::Scene;

    use super::super::{LEVEL, Site, pool, surveyor, widest};
    use super::*;

    /// The water of a world in which a craft is at (3, 2) m.
    fn site_of(world: &World) -> Site {
        Site::of(&Scene::with_robot(world.clone(), surveyor(), Pose::new(3.0, 2.0, 0.0)), 0.5)
    }

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
            let site = site_of(&world);
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
        let site = site_of(&world);
        for (from, to) in [((1e3, 0.0), (1e3, 1.0)), ((-1e6, 1.0), (-1e6, 2.0)), ((6.0, 5.0), (1e6, 5.0))] {
            let mut strayed = world.clone();
            let stray = Wall::new(Point::new(from.0, from.1), Point::new(to.0, to.1));
            strayed.walls.push(Wall { height: 1.0, ..stray });
            let found = site_of(&strayed);
            assert!(found.by_walls && (found.area.size() - site.area.size()).norm() < 1e-9, "{found:?}");
            assert!(Shore::of(&strayed, 0.5).length() <= Shore::of(&world, 0.5).length() + 1e-9);
        }
    }

    /// Water beyond the walls around a craft is not its own, be it a single wall or a whole other pool, and
    /// also if a wall goes on to there.
    #[test]
    fn the_site_is_the_water_that_walls_enclose_around_a_craft() {
        let basin = |x: f64, y: f64| {
            let corners = [(0.0, 0.0), (8.0, 0.0), (8.0, 6.0), (0.0, 6.0), (0.0, 0.0)];
            let corners = corners.map(|(right, up)| Point::new(x + right, y + up));
            corners
                .windows(2)
                .map(|ends| Wall { height: 2.0, ..Wall::new(ends[0], ends[1]) })
                .collect::<Vec<_>>()
        };
        let alone = World { water_level: Some(1.9), walls: basin(0.0, 0.0), ..World::empty(30.0, 20.0) };
        let area = site_of(&alone).area;
        assert!((area.size() - Vector::new(7.99, 5.99)).norm() < 1e-9, "{area:?}");
        let line = |from: (f64, f64), to: (f64, f64)| {
            vec![Wall { height: 2.0, ..Wall::new(Point::new(from.0, from.1), Point::new(to.0, to.1)) }]
        };
        let others = [
            line((20.0, 0.0), (20.0, 1.0)),
            line((8.0, 6.0), (25.0, 6.0)),
            line((-10.0, 0.0), (25.0, 0.0)),
            basin(8.0, 0.0),
            basin(15.0, 10.0),
        ];
        for other in others {
            let mut world = alone.clone();
            world.walls.extend(other);
            let found = site_of(&world);
            assert!(found.by_walls, "{found:?}");
            for (is, was) in [(found.area.min, area.min), (found.area.max, area.max)] {
                assert!((is - was).norm() < 1e-9, "{found:?}");
            }
        }
        let mut open = alone.clone();
        open.walls.pop();
        open.walls.extend(line((20.0, 0.0), (20.0, 1.0)));
        assert!(site_of(&open).area.size().x > 19.9);
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
