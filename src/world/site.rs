use super::World;
use crate::geometry::{Aabb, Point};

/// A gap of so many metres, and of so many times the size of what lies on one side of it, parts what stands in a world.
const GAP: f64 = 100.0;
const GAP_IN_SIZES: f64 = 10.0;

impl World {
    /// The box around where a robot can be: the same as [`bounds`](World::bounds) without what stands so far from most of the
    /// others that it is no part of the same place, as a wall whose coordinates have some digits too many.
    ///
    /// What maps a world maps this box. A gap has to be more than 100 m wide, and ten times as wide as what lies together.
    /// The floor reaches no farther than it does together with walls and objects. Time O(n log n).
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
        let Some(kept) = self.kept() else { return self.bounds() };
        let bounds = self.bounds();
        let within = |corner: Point| {
            Point::new(corner.x.clamp(kept.min.x, kept.max.x), corner.y.clamp(kept.min.y, kept.max.y))
        };
        Aabb::new(within(bounds.min), within(bounds.max))
    }

    /// How many walls and objects reach out of the [`site`](World::site).
    pub fn strays(&self) -> usize {
        let Some(kept) = self.kept() else { return 0 };
        let is_out = |point: Point| !kept.contains(point);
        let walls = self.walls.iter().filter(|wall| is_out(wall.line.a) || is_out(wall.line.b)).count();
        walls + self.objects.iter().filter(|object| is_out(object.pose.position())).count()
    }

    /// Between what coordinates most of what stands in the world lies; `None` if all of it does.
    fn kept(&self) -> Option<Aabb> {
        let walls = self.walls.iter().flat_map(|wall| [wall.line.a, wall.line.b]);
        let objects = self.objects.iter().map(|object| object.pose.position());
        let floor = [self.floor.min, self.floor.max];
        let mut points: Vec<Point> =
            walls.chain(objects).chain(floor).filter(|p| p.x.is_finite() && p.y.is_finite()).collect();
        let all = points.len();
        // What lies together along one axis may have fallen apart once the other one has been looked at.
        loop {
            let before = points.len();
            keep_larger(&mut points, |point| point.x);
            keep_larger(&mut points, |point| point.y);
            if points.len() == before {
                break;
            }
        }
        // Whatever there is round objects reaches a little beyond their middles.
        let reach = self.objects.iter().map(|object| object.kind.shape.bounding_radius()).fold(0.0, f64::max);
        (points.len() < all).then(|| Aabb::around(points))?.map(|kept| kept.inflated(reach))
    }
}

/// Parts points at the widest gap along an axis, if it is wide enough, and keeps the larger part.
fn keep_larger(points: &mut Vec<Point>, along: impl Fn(&Point) -> f64) {
    points.sort_by(|a, b| along(a).total_cmp(&along(b)));
    let gap = |i: &usize| along(&points[*i]) - along(&points[i - 1]);
    let Some(at) = (1..points.len()).max_by(|a, b| gap(a).total_cmp(&gap(b))) else { return };
    let first = 2 * at >= points.len();
    let part = if first { &points[..at] } else { &points[at..] };
    let size = along(&part[part.len() - 1]) - along(&part[0]);
    if gap(&at) <= GAP.max(GAP_IN_SIZES * size) {
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
