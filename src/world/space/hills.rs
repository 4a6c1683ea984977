//! Rays in space over hills or a level floor: the ground stops them, and objects have their base on it.

use super::ray::{Ray, lesser};
use super::scanner::Scanner;
use super::shape::{Block, OrientedBox};
use super::solid::{SolidId, Span};
use super::store::{Placed, Space};
use crate::geometry::{Point, Point3, Pose3, Vector, Vector3, math};
use crate::world::HeightField;

/// Smallest horizontal component of a ray's direction for which the traversal of cells is accurate.
const LEAST: f64 = 1e-6;
/// Height range of a wall for queries about its outline only.
const ENDLESS: Span = Span { bottom: -1e9, top: 1e9 };

/// The ground: hills, or the level floor.
#[derive(Debug, Clone, Copy)]
struct Ground<'a>(Option<&'a HeightField>);

impl Ground<'_> {
    /// Elevation at a point; beyond the hills, that of the floor.
    fn height(self, at: Point) -> f64 {
        self.0.and_then(|hills| hills.height(at)).unwrap_or(0.0)
    }

    /// Distance to the first intersection of a ray with the ground.
    fn cast_ray(self, origin: Point3, direction: Vector3, max_range: f64) -> f64 {
        match self.0 {
            Some(hills) => hills.cast_ray(origin, direction, max_range),
            None if direction.z < 0.0 && origin.z >= 0.0 => origin.z / -direction.z,
            None => f64::INFINITY,
        }
    }
}

impl Space {
    /// Distance along a ray in space to the first intersection (m): with the ground, a wall or a solid;
    /// infinite if there is none within `max_range`.
    ///
    /// `ground` is the surface, or `None` for a level floor at height 0, which stops rays from above.
    /// `direction` is a unit vector. Walls follow the ground: their top is at a constant height above it. A
    /// solid's heights are relative to the level set by [`set_level`](Space::set_level). A ray that starts in
    /// or on an obstacle has distance 0. The solid `except` is ignored.
    pub fn cast_ray_over<'a>(
        &self,
        ground: impl Into<Option<&'a HeightField>>,
        origin: Point3,
        direction: Vector3,
        max_range: f64,
        except: Option<SolidId>,
    ) -> f64 {
        self.cast_over(Ground(ground.into()), (origin, direction), max_range, except)
    }

    /// Computes the distance to the first hit of each beam of a scanner (m); infinity without a hit within
    /// the scanner's range.
    ///
    /// `ground` is as in [`cast_ray_over`](Space::cast_ray_over). `pose` is the scanner's pose in the world,
    /// and `except` the solid that carries it. `ranges` receives one number per beam; if it is shorter, the
    /// first ones, and if it is longer, infinity for the rest.
    pub fn scan_over<'a>(
        &self,
        ground: impl Into<Option<&'a HeightField>>,
        scanner: &Scanner,
        pose: &Pose3,
        except: Option<SolidId>,
        ranges: &mut [f64],
    ) {
        let ground = Ground(ground.into());
        let (rise, run) = math::sin_cos(scanner.tilt);
        let turned = pose.attitude.to_rotation_matrix();
        let beams = ranges.len().min(scanner.beams());
        let (ranges, beyond) = ranges.split_at_mut(beams);
        beyond.fill(f64::INFINITY);
        for (beam, range) in ranges.iter_mut().enumerate() {
            let flat = scanner.buffer.fan.own_direction(beam) * run;
            let direction = turned * Vector3::new(flat.x, flat.y, rise);
            *range = self.cast_over(ground, (pose.position, direction), scanner.max_range, except);
        }
    }

    fn cast_over(
        &self,
        ground: Ground<'_>,
        (origin, direction): (Point3, Vector3),
        max_range: f64,
        except: Option<SolidId>,
    ) -> f64 {
        let hit = ground.cast_ray(origin, direction, max_range);
        let ray = Slanted::new(origin, direction);
        let limit = lesser(hit, max_range) * ray.run;
        let nearest = self.nearest_over(ground, &ray, limit, except) / ray.run;
        let nearest = lesser(nearest, hit);
        if nearest <= max_range { nearest } else { f64::INFINITY }
    }

    /// Horizontal distance to the first wall or solid within a limit; infinite if there is none.
    fn nearest_over(
        &self,
        ground: Ground<'_>,
        slanted: &Slanted,
        limit: f64,
        except: Option<SolidId>,
    ) -> f64 {
        let mut nearest = f64::INFINITY;
        let ray = &slanted.ray;
        let wall = |wall: &Block, nearest: &mut f64| {
            if let Some(hit) = slanted.hit_wall(ground, wall, lesser(*nearest, limit)) {
                *nearest = lesser(hit, *nearest);
            }
        };
        let solid = |number: u32, nearest: &mut f64| {
            if except != Some(SolidId(number))
                && let Some(hit) = slanted.hit_solid(&self.solids[number as usize])
            {
                *nearest = lesser(hit, *nearest);
            }
        };
        self.grid.loose_walls().iter().for_each(|&n| wall(&self.walls[n as usize], &mut nearest));
        self.grid.loose_solids().iter().for_each(|&n| solid(n, &mut nearest));
        self.grid.lattice.walk(ray.origin, ray.direction, lesser(nearest, limit), |cell| {
            self.grid.walls_in(cell).iter().for_each(|own| wall(own, &mut nearest));
            self.grid.solids_in(cell).for_each(|&n| solid(n, &mut nearest));
            nearest
        });
        if nearest <= limit { nearest } else { f64::INFINITY }
    }

    /// The level on which a solid stands.
    ///
    /// # Panics
    ///
    /// If the solid is of another space that holds more solids.
    pub fn level(&self, id: SolidId) -> f64 {
        self.solids[id.index()].level
    }

    /// Puts a solid on a different level, to which its heights are relative.
    ///
    /// # Panics
    ///
    /// If the solid is of another space that holds more solids.
    pub fn set_level(&mut self, id: SolidId, level: f64) {
        self.solids[id.index()].level = level;
    }
}

/// A ray in space; distances are horizontal.
struct Slanted {
    ray: Ray,
    /// Horizontal distance per metre along the ray.
    run: f64,
}

impl Slanted {
    fn new(origin: Point3, direction: Vector3) -> Self {
        let run = math::hypot(direction.x, direction.y);
        let (run, flat) = if run > LEAST {
            (run, Vector::new(direction.x, direction.y) / run)
        } else {
            (LEAST, Vector::x())
        };
        let ray = Ray { origin: origin.xy(), direction: flat, z: origin.z, slope: direction.z / run };
        Self { ray, run }
    }

    fn hit_solid(&self, placed: &Placed) -> Option<f64> {
        let ray = Ray { z: self.ray.z - placed.level, ..self.ray };
        let mast = || placed.mast.as_ref().and_then(|mast| ray.hit_box(&mast.shape, &mast.span));
        match (ray.hit(placed), mast()) {
            (Some(a), Some(b)) => Some(lesser(a, b)),
            (a, b) => a.or(b),
        }
    }

    /// Intersection of the ray with a side of a wall or its top, which is the ground raised by the wall's
    /// height.
    fn hit_wall(&self, ground: Ground<'_>, wall: &Block, limit: f64) -> Option<f64> {
        let enter = self.ray.hit_box(&wall.shape, &ENDLESS)?;
        if enter > limit {
            return None;
        }
        let at = self.at(enter);
        let above = self.ray.z + self.ray.slope * enter - ground.height(at) - wall.span.top;
        if above <= 0.0 {
            return Some(enter);
        }
        let direction = Vector3::new(self.ray.direction.x, self.ray.direction.y, self.ray.slope).normalize();
        let start = Point3::new(at.x, at.y, self.ray.z + self.ray.slope * enter - wall.span.top);
        let length = direction.xy().norm();
        let down = enter + ground.cast_ray(start, direction, (limit - enter) / length) * length;
        (down <= limit && is_over(&wall.shape, self.at(down))).then_some(down)
    }

    fn at(&self, distance: f64) -> Point {
        self.ray.origin + self.ray.direction * distance
    }
}

fn is_over(shape: &OrientedBox, point: Point) -> bool {
    let local = shape.local(point);
    local.x.abs() <= shape.half.x && local.y.abs() <= shape.half.y
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Aabb, Pose};
    use crate::world::space::Solid;
    use crate::world::{Footprint, Wall};
    use proptest::prelude::*;

    fn slope(rise: f64) -> HeightField {
        let area = Aabb::new(Point::origin(), Point::new(10.0, 10.0));
        HeightField::from_fn(21, 21, area, |at| rise * at.x).unwrap()
    }

    fn unit(x: f64, y: f64, z: f64) -> Vector3 {
        Vector3::new(x, y, z).normalize()
    }

    #[test]
    fn walls_and_solids_stand_on_the_ground() {
        let ground = slope(0.1);
        let wall = Wall { height: 0.2, ..Wall::new(Point::new(5.0, 0.0), Point::new(5.0, 10.0)) };
        let mut space = Space::new(&[wall]);
        let can = Solid::new(Footprint::Disc { radius: 0.1 }, Pose::new(3.0, 2.0, 0.0), 0.0, 0.12);
        let can = space.add(can);
        space.set_level(can, 0.3);
        let along = unit(1.0, 0.0, 0.1);
        let range = |y: f64, above: f64, direction| {
            space.cast_ray_over(&ground, Point3::new(1.0, y, 0.1 + above), direction, 20.0, None)
                * direction.x
        };
        // Parallel to the ground: hits the wall below its top, and passes above it.
        assert!((range(5.0, 0.1, along) - 3.995).abs() < 1e-5);
        assert_eq!(range(5.0, 0.21, along), f64::INFINITY);
        assert!((range(2.0, 0.05, along) - 1.9).abs() < 1e-5);
        assert!((range(2.0, 0.15, along) - 3.995).abs() < 1e-5);
        // Level: into the ground.
        assert!((range(5.0, 0.1, Vector3::x()) - 1.0).abs() < 1e-5);
        // Down onto the wall's top.
        let down = space.cast_ray_over(&ground, Point3::new(5.0, 4.0, 1.0), -Vector3::z(), 20.0, None);
        assert!((down - 0.3).abs() < 1e-5, "{down}");
        let down = space.cast_ray_over(&ground, Point3::new(3.0, 2.0, 1.0), -Vector3::z(), 20.0, None);
        assert!((down - 0.58).abs() < 1e-5, "{down}");
        let down = space.cast_ray_over(&ground, Point3::new(3.0, 2.0, 1.0), -Vector3::z(), 20.0, Some(can));
        assert!((down - 0.7).abs() < 1e-5, "{down}");
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        /// On level ground, rays in space have the same hits as rays over the floor.
        #[test]
        fn on_level_ground_nothing_is_new(
            walls in prop::collection::vec((1.0..9.0f64, 1.0..9.0f64, 1.0..9.0f64, 1.0..9.0f64, 0.05..0.5f64), 0..6),
            discs in prop::collection::vec((1.0..9.0f64, 1.0..9.0f64, 0.05..0.4f64, 0.05..0.5f64), 0..6),
            (x, y, z) in (0.5..9.5f64, 0.5..9.5f64, 0.01..0.6f64), heading in -3.0..3.0f64,
        ) {
            let walls: Vec<Wall> = walls.iter().map(|&(ax, ay, bx, by, height)| {
                Wall { height, thickness: 0.05, ..Wall::new(Point::new(ax, ay), Point::new(bx, by)) }
            }).collect();
            let mut space = Space::new(&walls);
            for &(x, y, radius, top) in &discs {
                space.add(Solid::new(Footprint::Disc { radius }, Pose::new(x, y, 0.0), 0.0, top));
            }
            let flat = crate::geometry::direction(heading);
            let expected = space.cast_ray(Point::new(x, y), flat, z, 20.0, None);
            let found = space.cast_ray_over(
                &slope(0.0), Point3::new(x, y, z), Vector3::new(flat.x, flat.y, 0.0), 20.0, None,
            );
            prop_assert!(found == expected || (found - expected).abs() < 1e-9, "{} {}", found, expected);
        }

        /// Rays over a level floor and over level hills have the same hits in every direction.
        #[test]
        fn the_floor_is_as_good_as_level_hills(
            (x, y, z) in (1.0..9.0f64, 1.0..9.0f64, 0.01..0.6f64), (dx, dy, dz) in (-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64),
            (radius, top, height) in (0.05..0.4f64, 0.05..0.5f64, 0.05..0.4f64),
        ) {
            let mut space = Space::new(&[Wall { height, ..Wall::new(Point::new(2.0, 1.0), Point::new(7.0, 8.0)) }]);
            space.add(Solid::new(Footprint::Disc { radius }, Pose::new(5.0, 3.0, 0.0), 0.0, top));
            let Some(direction) = Vector3::new(dx, dy, dz).try_normalize(1e-3) else { return Ok(()) };
            let (origin, level) = (Point3::new(x, y, z), slope(0.0));
            let over = space.cast_ray_over(&level, origin, direction, 20.0, None);
            let found = space.cast_ray_over(None, origin, direction, 20.0, None);
            // The hills are bounded, the floor is not.
            let end = origin + direction * found.min(20.0);
            let inside = (0.0..=10.0).contains(&end.x) && (0.0..=10.0).contains(&end.y);
            prop_assert!(!inside || found == over || (found - over).abs() < 1e-9, "{} {}", found, over);
        }
    }
}
