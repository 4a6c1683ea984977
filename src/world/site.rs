use super::{Object, World};
use crate::geometry::{Aabb, Point, Vector};

/// A gap of so many metres, and of so many times the size of what lies on one side of it, parts what stands in a world.
const GAP: f64 = 100.0;
const GAP_IN_SIZES: f64 = 10.0;
/// Metres to the farthest wall within which a floor ends there.
const NEAR: f64 = 1.0;

impl World {
    /// The box around where a robot can be: the same as [`bounds`](World::bounds) without what stands so far from most of the
    /// others that it is no part of the same place, as a wall whose coordinates have some digits too many.
    ///
    /// What maps a world maps this box. A gap has to be more than 100 m wide, ten times as wide as what lies together, and
    /// spanned by no more than one wall: two are a corridor. A floor that reaches as far as what is left out was made to do so,
    /// and is cut as well. Time O(n log n).
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

    /// How many walls and objects reach out of the [`site`](World::site).
    pub fn strays(&self) -> usize {
        let Some((kept, _)) = self.kept() else { return 0 };
        let is_out = |point: Point| !kept.contains(point);
        let walls = self.walls.iter().filter(|wall| is_out(wall.line.a) || is_out(wall.line.b)).count();
        walls + self.objects.iter().filter(|object| is_out(object.pose.position())).count()
    }

    /// The boxes around most of what stands in the world and around all of it; `None` if they are the same.
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
        // What lies together along one axis may have fallen apart once the other one has been looked at.
        loop {
            let before = points.len();
            keep_larger(&mut points, &ends, |point| point.x);
            keep_larger(&mut points, &ends, |point| point.y);
            if points.len() == before {
                break;
            }
        }
        (points.len() < 2 * ends.len()).then(|| Aabb::around(points))?.map(|kept| (kept, all))
    }
}

/// Parts points at the widest gap along an axis, if it is wide enough, and keeps the larger part.
fn keep_larger(points: &mut Vec<Point>, ends: &[[Point; 2]], along: impl Fn(&Point) -> f64) {
    points.sort_by(|a, b| along(a).total_cmp(&along(b)));
    let gap = |i: &usize| along(&points[*i]) - along(&points[i - 1]);
    let Some(at) = (1..points.len()).max_by(|a, b| gap(a).total_cmp(&gap(b))) else { return };
    let first = 2 * at >= points.len();
    let part = if first { &points[..at] } else { &points[at..] };
    let size = along(&part[part.len() - 1]) - along(&part[0]);
    let middle = 0.5 * (along(&points[at]) + along(&points[at - 1]));
    let spans = |[a, b]: &&[Point; 2]| (along(a) < middle) != (along(b) < middle);
    if gap(&at) <= GAP.max(GAP_IN_SIZES * size) || ends.iter().filter(spans).count() > 1 {
        return;
    }
    if first {
        points.truncate(at);
    } else {
        points.drain(..at);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::{Clearance, Wall};

    fn stray(place: Point) -> World {
        let mut world = World::walled(3.0, 2.0);
        world.walls.push(Wall::new(place, Point::new(place.x, place.y + 1.0)));
        // A reader without a floor takes the box around all walls.
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

    #[test]
    fn what_lies_together_stays_together() {
        // A wall in the middle of a large floor; a hall; a wall no farther away than it may be.
        let mut wide = World::empty(150.0, 150.0);
        wide.walls.push(Wall::new(Point::new(75.0, 75.0), Point::new(76.0, 75.0)));
        for world in
            [wide, World::walled(1000.0, 1000.0), stray(Point::new(90.0, 0.0)), World::empty(0.0, 0.0)]
        {
            assert_eq!((world.site(), world.strays()), (world.bounds(), 0));
        }
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
