use std::ops::Range;

use super::{Object, World};
use crate::geometry::{Aabb, Point, Vector};

/// Width of a gap that separates the contents of a world (m).
const GAP: f64 = 30.0;
/// The same, relative to the extent of one side.
const GAP_IN_SIZES: f64 = 10.0;
/// Distance to the farthest wall within which a floor ends there (m).
const NEAR: f64 = 1.0;

impl World {
    /// Bounding box of the places that a robot can reach: [`bounds`](World::bounds) without outliers, which
    /// are too far from most of the other things to belong to the same place. An example is a wall whose
    /// coordinates have extra digits.
    ///
    /// Maps of a world cover this box. A gap must be more than 30 m wide, ten times as wide as the group of
    /// things, and spanned by at most one wall, because two form a corridor. A floor that extends as far as
    /// the outliers was made for them and is cut as well. Of two places with such a gap between them, the
    /// site is the one with the world's [`start`](World::start), otherwise the one with more things.
    ///
    /// ```
    /// use roverlab::geometry::Point;
    /// use roverlab::world::{Wall, World};
    /// let mut world = World::walled(3.0, 2.0);
    /// let site = world.site();
    /// world.walls.push(Wall::new(Point::new(1e6, 0.0), Point::new(1e6, 1.0)));
    /// assert_eq!((world.site(), world.strays()), (site, 1));
    /// ```
    pub fn site(&self) -> Aabb {
        let Some((kept, all)) = self.kept() else { return self.bounds() };
        if !reaches_outliers(&self.floor, &kept, &all) {
            return kept.union(&self.floor);
        }
        let least = |kept: f64, all: f64, floor: f64| {
            if all < kept && floor <= all + NEAR { kept } else { kept.min(floor) }
        };
        let most = |kept: f64, all: f64, floor: f64| {
            if all > kept && floor >= all - NEAR { kept } else { kept.max(floor) }
        };
        let (low, high) = (self.floor.min, self.floor.max);
        Aabb::new(
            Point::new(least(kept.min.x, all.min.x, low.x), least(kept.min.y, all.min.y, low.y)),
            Point::new(most(kept.max.x, all.max.x, high.x), most(kept.max.y, all.max.y, high.y)),
        )
    }

    /// Number of walls and objects that extend beyond the [`site`](World::site).
    pub fn strays(&self) -> usize {
        let Some((kept, _)) = self.kept() else { return 0 };
        let is_out = |point: Point| !kept.contains(point);
        let walls = self.walls.iter().filter(|wall| is_out(wall.line.a) || is_out(wall.line.b)).count();
        walls + self.objects.iter().filter(|object| is_out(object.pose.position())).count()
    }

    /// Bounding boxes of most things in the world and of all things; `None` if they are equal.
    fn kept(&self) -> Option<(Aabb, Aabb)> {
        let walls = self.walls.iter().map(|wall| [wall.line.a, wall.line.b]);
        let reach = |object: &Object| Vector::new(1.0, 1.0) * object.kind.shape.bounding_radius();
        let objects = self
            .objects
            .iter()
            .map(|object| [object.pose.position() - reach(object), object.pose.position() + reach(object)]);
        let is_finite = |ends: &[Point; 2]| ends.iter().all(|end| end.x.is_finite() && end.y.is_finite());
        let ends: Vec<[Point; 2]> = walls.chain(objects).filter(is_finite).collect();
        let mut points: Vec<Point> = ends.iter().flatten().copied().collect();
        let all = Aabb::around(points.iter().copied())?;
        // A floor is a thing as well, unless it was made for all the others: a single wall far from it is an
        // outlier.
        let floor = [self.floor.min, self.floor.max];
        let has_floor = is_finite(&floor) && self.floor.size().min() > 0.0 && self.floor != all;
        points.extend(floor.into_iter().filter(|_| has_floor));
        let start = self.start.map(|start| start.position()).filter(|start| is_finite(&[*start; 2]));
        points.extend(start);
        let (count, middle) = (points.len(), nalgebra::center(&self.floor.min, &self.floor.max));
        // A group along one axis may split after a cut along the other.
        loop {
            let before = points.len();
            keep_place(&mut points, &ends, (start, middle), |point| point.x);
            keep_place(&mut points, &ends, (start, middle), |point| point.y);
            if points.len() == before {
                break;
            }
        }
        (points.len() < count).then(|| Aabb::around(points))?.map(|kept| (kept, all))
    }
}

/// Whether a floor extends as far as what is farther than a gap from what is kept.
fn reaches_outliers(floor: &Aabb, kept: &Aabb, all: &Aabb) -> bool {
    [0, 1].into_iter().any(|axis| {
        let low = kept.min[axis] - all.min[axis] > GAP && floor.min[axis] <= all.min[axis] + NEAR;
        low || (all.max[axis] - kept.max[axis] > GAP && floor.max[axis] >= all.max[axis] - NEAR)
    })
}

/// Keeps the points of one place along an axis: the smallest group with most of the points, or with half of
/// them and the floor's middle. A start in none of these has a group of its own.
fn keep_place(
    points: &mut Vec<Point>,
    ends: &[[Point; 2]],
    (start, middle): (Option<Point>, Point),
    along: impl Fn(&Point) -> f64,
) {
    points.sort_by(|a, b| along(a).total_cmp(&along(b)));
    let places: Vec<f64> = points.iter().map(&along).collect();
    let line = Line { places: &places, ends: ends.iter().map(|[a, b]| (along(a), along(b))).collect() };
    let is_main = |group: &Range<usize>| {
        let is_half = 2 * group.len() == places.len();
        2 * group.len() > places.len() || (is_half && line.covers(group, along(&middle)))
    };
    let medians = [(places.len() - 1) / 2, places.len() / 2];
    let mut kept = medians.map(|median| line.group(median)).into_iter().find(is_main).unwrap_or_else(|| {
        let mut group = line.group(medians[0]);
        while !is_main(&group) {
            group = line.grown(line.extended(group));
        }
        group
    });
    if let Some(start) = start.map(|start| along(&start))
        && !line.covers(&kept, start)
    {
        kept = line.group(places.partition_point(|&place| place < start));
    }
    points.truncate(kept.end);
    points.drain(..kept.start);
}

/// Coordinates of points along an axis, in order, and of the ends of walls and objects.
struct Line<'a> {
    places: &'a [f64],
    ends: Vec<(f64, f64)>,
}

impl Line<'_> {
    /// The group of a point: all that no gap separates from it.
    fn group(&self, seed: usize) -> Range<usize> {
        self.grown(seed..seed + 1)
    }

    /// A group with all that no gap separates from it.
    fn grown(&self, mut group: Range<usize>) -> Range<usize> {
        loop {
            let width = self.places[group.end - 1] - self.places[group.start];
            let least = GAP.max(GAP_IN_SIZES * width);
            if group.start > 0 && !self.is_gap(group.start, least) {
                group.start -= 1;
            } else if group.end < self.places.len() && !self.is_gap(group.end, least) {
                group.end += 1;
            } else {
                return group;
            }
        }
    }

    /// A group with the nearest other point.
    fn extended(&self, group: Range<usize>) -> Range<usize> {
        let low = group
            .start
            .checked_sub(1)
            .map_or(f64::INFINITY, |below| self.places[group.start] - self.places[below]);
        let high =
            self.places.get(group.end).map_or(f64::INFINITY, |above| above - self.places[group.end - 1]);
        if low < high {
            group.start - 1..group.end
        } else {
            group.start..(group.end + 1).min(self.places.len())
        }
    }

    /// Whether the gap before a point is wider than a length, and spanned by at most one wall.
    fn is_gap(&self, at: usize, least: f64) -> bool {
        let (low, high) = (self.places[at - 1], self.places[at]);
        let middle = 0.5 * (low + high);
        let spans = |&&(a, b): &&(f64, f64)| (a < middle) != (b < middle);
        high - low > least && self.ends.iter().filter(spans).count() <= 1
    }

    /// Whether a coordinate is within a group.
    fn covers(&self, group: &Range<usize>, place: f64) -> bool {
        self.places[group.start] <= place && place <= self.places[group.end - 1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::world::{Clearance, Wall};

    fn stray(place: Point) -> World {
        let mut world = World::walled(3.0, 2.0);
        world.walls.push(Wall::new(place, Point::new(place.x, place.y + 1.0)));
        // A reader without a floor uses the bounding box of all walls.
        world.floor = world.bounds();
        world
    }

    #[test]
    fn a_stray_wall_is_no_part_of_the_site() {
        let site = World::walled(3.0, 2.0).site();
        for place in [(1e3, 0.0), (1e6, 0.0), (-1e6, 1e6), (0.0, 1e9), (1e12, -1e12)] {
            let world = stray(Point::new(place.0, place.1));
            assert_eq!((world.site(), world.strays()), (site, 1), "{place:?}");
            let clearance = Clearance::new(&world, 0.02, 0.3).unwrap();
            assert_eq!(
                clearance.raster().cells(),
                Clearance::new(&World::walled(3.0, 2.0), 0.02, 0.3).unwrap().raster().cells()
            );
        }
    }

    /// Also where it is longer than it is far away.
    #[test]
    fn a_long_stray_wall_is_no_part_of_the_site() {
        for end in [2100.0, 1e5] {
            let mut world = World::walled(3.0, 2.0);
            world.walls.push(Wall::new(Point::new(1000.0, 1000.0), Point::new(end, end)));
            world.floor = world.bounds();
            assert_eq!((world.site(), world.strays()), (World::walled(3.0, 2.0).site(), 1), "{end}");
        }
    }

    /// The floor that a file states counts, also where it is larger than what stands on it.
    #[test]
    fn a_stated_floor_is_the_site_whatever_is_far_off() {
        let on_it = [None, Some((1.5, 0.0)), Some((1.5, 1.2))];
        for place in [(1e3, 0.0), (-1e6, 0.0), (0.0, 1e6), (1e6, -1e6), (500.0, 1.9)] {
            for near in on_it {
                let mut world = World::empty(3.0, 2.0);
                for (x, y) in near.into_iter().chain([place]) {
                    world.walls.push(Wall::new(Point::new(x, y), Point::new(x, y + 0.5)));
                }
                let site = World::empty(3.0, 2.0).floor;
                assert_eq!((world.site(), world.strays()), (site, 1), "{near:?} {place:?}");
            }
        }
    }

    #[test]
    fn what_lies_together_stays_together() {
        // A wall in the middle of a large floor; a hall; a wall at the largest allowed distance.
        let mut wide = World::empty(150.0, 150.0);
        wide.walls.push(Wall::new(Point::new(75.0, 75.0), Point::new(76.0, 75.0)));
        for world in
            [wide, World::walled(1000.0, 1000.0), stray(Point::new(29.0, 0.0)), World::empty(0.0, 0.0)]
        {
            assert_eq!((world.site(), world.strays()), (world.bounds(), 0));
        }
    }

    /// Two rooms 150 m apart that a fence connects, one with twice as many walls.
    #[test]
    fn of_two_places_the_site_is_the_one_with_the_start() {
        let mut world = World::walled(3.0, 2.0);
        let shift = Vector::new(150.0, 0.0);
        let there = World::walled(3.0, 2.0).walls.into_iter().cycle().take(8);
        let fence = Wall::new(Point::new(1.0, 1.0), Point::new(151.0, 1.0));
        world
            .walls
            .extend(there.map(|wall| Wall::new(wall.line.a + shift, wall.line.b + shift)).chain([fence]));
        let room = World::walled(3.0, 2.0).bounds();
        let rooms = [room, Aabb::new(room.min + shift, room.max + shift)];
        assert_eq!((world.site(), world.strays()), (rooms[1], 5));
        for (start, room, strays) in [(0.5, rooms[0], 9), (150.5, rooms[1], 5), (151.5, rooms[1], 5)] {
            world.start = Some(Pose::new(start, 0.5, 0.0));
            assert_eq!((world.site(), world.strays()), (room, strays), "{start}");
        }
        // On a floor of its own, far from both.
        world.start = Some(Pose::new(-200.0, 0.5, 0.0));
        assert!(world.site().contains(Point::new(-200.0, 0.5)));
    }

    /// On either side, and along a wall that passes by.
    #[test]
    fn several_stray_walls_are_no_part_of_the_site() {
        let room = World::walled(3.0, 2.0);
        for strays in [[(1e6, 0.0), (-1e6, 0.0)], [(1e8, 1e8), (-1e8, -1e8)], [(40.0, 0.0), (-50.0, 40.0)]] {
            let mut world = room.clone();
            world.walls.extend(strays.map(|(x, y)| Wall::new(Point::new(x, y), Point::new(x, y + 1.0))));
            world.floor = world.bounds();
            assert_eq!((world.site(), world.strays()), (room.site(), 2), "{strays:?}");
        }
        let mut world = room.clone();
        world.walls.push(Wall::new(Point::new(-1e6, -0.1), Point::new(1e6, -0.1)));
        assert_eq!((world.site(), world.strays()), (room.site(), 1));
        // Nor how thick they are.
        let thick = Wall { thickness: 1e3, ..Wall::new(Point::new(2e3, 0.0), Point::new(2e3, 1.0)) };
        let world = World { walls: room.walls.iter().copied().chain([thick]).collect(), ..room.clone() };
        let cells = |world: &World| Clearance::new(world, 0.02, 0.3).unwrap().raster().cells();
        assert_eq!(cells(&world), cells(&room));
    }

    /// Things far from each other, of which none is near most others.
    #[test]
    fn what_is_sparse_stays_together() {
        let mut world = World::empty(0.0, 0.0);
        world.walls = (0..50)
            .map(|index| Point::new(150.0 * f64::from(index), 0.0))
            .map(|place| Wall::new(place, place + Vector::new(1.0, 1.0)))
            .collect();
        assert_eq!((world.site(), world.strays()), (world.bounds(), 0));
        world.start = Some(Pose::new(5.0, 5.0, 0.0));
        assert_eq!((world.site(), world.strays()), (world.bounds(), 0));
    }

    #[test]
    fn a_wall_that_leads_far_out_is_cut_off() {
        let mut world = World::walled(3.0, 2.0);
        world.walls.push(Wall::new(Point::new(1.0, 1.0), Point::new(1e6, 1.0)));
        assert_eq!((world.site(), world.strays()), (World::walled(3.0, 2.0).site(), 1));
        let clearance = Clearance::new(&world, 0.02, 0.3).unwrap();
        assert!(clearance.at_point(Point::new(2.0, 1.0)).unwrap() < 0.02);
    }
}
