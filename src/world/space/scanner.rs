use super::cluster::CLUSTER;
use super::fan::{Fan, Sector};
use super::lattice::Cells;
use super::polar::PolarBuffer;
use super::ray::Ray;
use super::shape::{OrientedBox, Shape};
use super::solid::SolidId;
use super::store::Space;
use crate::geometry::{Point, Pose, math};

/// Number of solids up to which they are tested individually; above, by their cells.
const FEW_SOLIDS: usize = 64;

/// Precomputed beams of a laser scanner, and the buffers of a scan.
///
/// ```
/// use roverlab::geometry::{Point, Pose};
/// use roverlab::world::Wall;
/// use roverlab::world::space::{Scanner, Space};
/// let space = Space::new(&[Wall::new(Point::new(2.0, -5.0), Point::new(2.0, 5.0))]);
/// let quarter = std::f64::consts::FRAC_PI_2;
/// let mut scanner = Scanner::new(-quarter, quarter, 3, 0.1, 0.0, 4.0);
/// let mut ranges = [0.0; 3];
/// space.scan(&mut scanner, &Pose::default(), None, &mut ranges);
/// assert!(ranges[1] < 2.0 && ranges[1] > 1.9, "to the face of a wall ahead; right, ahead, left");
/// assert!(ranges[0] >= 4.0 && ranges[2] >= 4.0);
/// ```
#[derive(Debug, Clone)]
pub struct Scanner {
    pub(super) buffer: PolarBuffer,
    z: f64,
    pub(super) tilt: f64,
    pub(super) max_range: f64,
    /// Whether the beams run counter-clockwise for at most about one turn, as a polar buffer requires.
    drawn: bool,
    /// Possibly visible things; their order, nearest first (leading bits of the distance, then the index in
    /// `sights`); and flags of the processed solids.
    sights: Vec<Sight>,
    order: Vec<u64>,
    seen: Vec<bool>,
}

/// Beams of a scanner at most.
const MOST_BEAMS: usize = 1_000_000;

impl Scanner {
    /// A scanner with `beams` beams, at most a million, `angle_increment` radians apart, the first one `angle_min` radians
    /// counter-clockwise from straight ahead.
    ///
    /// Its height above the floor is `z` metres. Its beams point `tilt` radians above the horizontal and
    /// reach `max_range` metres.
    pub fn new(
        angle_min: f64,
        angle_increment: f64,
        beams: usize,
        z: f64,
        tilt: f64,
        max_range: f64,
    ) -> Self {
        let drawn = tilt == 0.0 && angle_increment > 1e-6 && angle_increment.is_finite();
        let buffer = PolarBuffer::new(Fan::new(angle_min, angle_increment, beams.min(MOST_BEAMS)));
        Self { buffer, z, tilt, max_range, drawn, sights: Vec::new(), order: Vec::new(), seen: Vec::new() }
    }

    /// Number of beams.
    pub fn beams(&self) -> usize {
        self.buffer.fan.beams()
    }

    /// Range of a beam (m).
    pub fn max_range(&self) -> f64 {
        self.max_range
    }
}

impl Space {
    /// Computes the distance to the first hit of each beam of a scanner (m); infinity without a hit within
    /// the scanner's range.
    ///
    /// `pose` is the scanner's pose in the world, and `except` the solid that carries it. Beams that point
    /// below the horizontal hit the floor; those that have risen above a wall pass over it. A scanner inside
    /// an obstacle has range 0. `ranges` receives one number per beam; if it is shorter, the first ones, and
    /// if it is longer, infinity for the rest.
    pub fn scan(&self, scanner: &mut Scanner, pose: &Pose, except: Option<SolidId>, ranges: &mut [f64]) {
        let beams = ranges.len().min(scanner.beams());
        let (ranges, beyond) = ranges.split_at_mut(beams);
        beyond.fill(f64::INFINITY);
        scanner.buffer.aim(pose.position(), pose.heading);
        if !scanner.drawn {
            self.cast_beams(scanner, pose.position(), except, ranges);
        } else if self.draw(scanner, pose.position(), except) {
            ranges.fill(0.0);
        } else {
            scanner.buffer.ranges(scanner.max_range, ranges);
        }
    }

    /// Draws possibly visible things from near to far; true if the scanner is in one of them.
    fn draw(&self, scanner: &mut Scanner, eye: Point, except: Option<SolidId>) -> bool {
        let Scanner { buffer, sights, order, seen, z, max_range, .. } = scanner;
        sights.clear();
        self.clusters.for_each_near(eye, *max_range, |number, squared| {
            let sector = buffer.sector_of_box(&self.clusters.clusters[number].bounds);
            sights.push(Sight { what: Sighted::Cluster(number as u32), sector, near: squared.sqrt() });
        });
        seen.clear();
        seen.resize(self.solids.len(), false);
        if self.solids.len() <= FEW_SOLIDS {
            (0..self.solids.len() as u32)
                .for_each(|n| sights.extend(self.sight_solid(buffer, n, *max_range)));
        } else {
            let loose = self.grid.loose_solids().iter();
            sights.extend(loose.filter_map(|&number| self.sight_solid(buffer, number, *max_range)));
            self.grid.lattice.for_each_block_near(eye, *max_range, |cells, bounds, near| {
                let sector = buffer.sector_of_box(&bounds);
                sights.push(Sight { what: Sighted::Block(cells), sector, near });
            });
        }
        if let Some(SolidId(number)) = except
            && let Some(seen) = seen.get_mut(number as usize)
        {
            *seen = true;
        }
        order.clear();
        order.extend(sights.iter().enumerate().map(|(place, sight)| key(sight.near, place)));
        order.sort_unstable();
        order.iter().any(|entry| {
            let sight = &sights[(entry & u64::from(u32::MAX)) as usize];
            if buffer.hides(sight.sector, sight.near) {
                return false;
            }
            match sight.what {
                Sighted::Cluster(number) => self.draw_cluster(buffer, number as usize, *z),
                Sighted::Solid(number) => self.draw_solid(buffer, number, *z, seen),
                Sighted::Block(cells) => self.draw_block(buffer, cells, *z, seen),
            }
        })
    }

    /// A solid, if it is within reach.
    fn sight_solid(&self, buffer: &PolarBuffer, number: u32, reach: f64) -> Option<Sight> {
        let (sector, near) = buffer.sector_of(&self.solids[number as usize].shape);
        (near <= reach).then_some(Sight { what: Sighted::Solid(number), sector, near })
    }

    fn draw_cluster(&self, buffer: &mut PolarBuffer, number: usize, z: f64) -> bool {
        let walls = &self.walls[self.clusters.clusters[number].members()];
        // All strokes first, then all drawing, so that the processor works on several strokes at a time.
        let mut strokes = [None; CLUSTER];
        for (stroke, wall) in strokes.iter_mut().zip(walls.iter().filter(|wall| wall.span.contains(z))) {
            *stroke = Some(buffer.stroke(&wall.shape));
        }
        strokes.iter().flatten().any(|stroke| {
            if !stroke.inside {
                buffer.draw(stroke);
            }
            stroke.inside
        })
    }

    fn draw_solid(&self, buffer: &mut PolarBuffer, number: u32, z: f64, seen: &mut [bool]) -> bool {
        let placed = &self.solids[number as usize];
        if std::mem::replace(&mut seen[number as usize], true) {
            return false;
        }
        if !placed.span.contains(z) {
            let mast = placed.mast.as_ref().filter(|mast| mast.span.contains(z));
            return mast.is_some_and(|mast| draw_box(buffer, &mast.shape));
        }
        match &placed.shape {
            Shape::Disc { centre, .. } => buffer.draw_disc(*centre, placed.radius_at(z)),
            Shape::Box(shape) => draw_box(buffer, shape),
        }
    }

    /// Draws the solids of some cells, except those in hidden cells.
    fn draw_block(&self, buffer: &mut PolarBuffer, cells: Cells, z: f64, seen: &mut [bool]) -> bool {
        self.grid.solids_of(cells).any(|&number| {
            if seen[number as usize] {
                return false;
            }
            let shape = &self.solids[number as usize].shape;
            // Drawing a disc is as fast as testing whether it is hidden.
            if matches!(shape, Shape::Box(_)) {
                let (sector, near) = buffer.sector_of(shape);
                // Hidden things stay hidden.
                seen[number as usize] = buffer.hides(sector, near);
            }
            self.draw_solid(buffer, number, z, seen)
        })
    }

    /// Casts the beams individually, for any tilt.
    fn cast_beams(&self, scanner: &Scanner, eye: Point, except: Option<SolidId>, ranges: &mut [f64]) {
        let (sin, cos) = math::sin_cos(scanner.tilt);
        let slope = sin / cos;
        let floor = if slope < 0.0 { scanner.z.max(0.0) / -slope } else { f64::INFINITY };
        for (beam, range) in ranges.iter_mut().enumerate() {
            let direction = scanner.buffer.fan.direction(beam);
            let ray = Ray { origin: eye, direction, z: scanner.z, slope };
            let hit = self.cast(&ray, (scanner.max_range * cos).min(floor), except).min(floor) / cos;
            *range = if hit <= scanner.max_range { hit } else { f64::INFINITY };
        }
    }
}

/// Draws a box; true if the scanner is in it.
fn draw_box(buffer: &mut PolarBuffer, shape: &OrientedBox) -> bool {
    let stroke = buffer.stroke(shape);
    if !stroke.inside {
        buffer.draw(&stroke);
    }
    stroke.inside
}

/// A possibly visible thing.
#[derive(Debug, Clone, Copy)]
struct Sight {
    what: Sighted,
    /// Beams that may hit it.
    sector: Sector,
    /// Lower bound of its distance (m).
    near: f64,
}

#[derive(Debug, Clone, Copy)]
enum Sighted {
    Cluster(u32),
    Solid(u32),
    /// The solids listed in some cells.
    Block(Cells),
}

/// Sort key: by distance, then by index.
#[inline]
fn key(distance: f64, place: usize) -> u64 {
    u64::from((distance as f32).to_bits()) << 32 | place as u64
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, TAU};

    use proptest::prelude::*;

    use super::*;
    use crate::geometry::{Aabb, Vector, direction};
    use crate::world::Footprint;
    use crate::world::space::Solid;
    use crate::world::{Wall, World};

    fn scan(space: &Space, mut scanner: Scanner, pose: Pose) -> Vec<f64> {
        let mut ranges = vec![-1.0; scanner.beams()];
        space.scan(&mut scanner, &pose, None, &mut ranges);
        ranges
    }

    fn near(ranges: &[f64], expected: &[f64]) -> bool {
        let same = |(a, b): (&f64, &f64)| a == b || (a - b).abs() < 1e-9;
        ranges.len() == expected.len() && ranges.iter().zip(expected).all(same)
    }

    #[test]
    fn four_beams_in_a_walled_room_see_its_four_faces() {
        let space = Space::new(&World::walled(4.0, 2.0).walls);
        let scanner = Scanner::new(0.0, FRAC_PI_2, 4, 0.1, 0.0, 10.0);
        let pose = Pose::new(1.0, 0.5, 0.0);
        assert!(near(&scan(&space, scanner.clone(), pose), &[2.995, 1.495, 0.995, 0.495]));
        let turned = Pose::new(1.0, 0.5, FRAC_PI_2);
        assert!(near(&scan(&space, scanner, turned), &[1.495, 0.995, 0.495, 2.995]));
    }

    #[test]
    fn a_scan_that_goes_clockwise_or_stands_still_is_right_too() {
        let space = Space::new(&World::walled(4.0, 2.0).walls);
        let pose = Pose::new(1.0, 0.5, 0.0);
        let clockwise = Scanner::new(0.0, -FRAC_PI_2, 4, 0.1, 0.0, 10.0);
        assert!(near(&scan(&space, clockwise, pose), &[2.995, 0.495, 0.995, 1.495]));
        let still = Scanner::new(0.0, 0.0, 3, 0.1, 0.0, 10.0);
        assert!(near(&scan(&space, still, pose), &[2.995; 3]));
        let twice_around = Scanner::new(0.0, FRAC_PI_2, 8, 0.1, 0.0, 10.0);
        assert!(near(
            &scan(&space, twice_around, pose),
            &[2.995, 1.495, 0.995, 0.495, 2.995, 1.495, 0.995, 0.495]
        ));
        assert!(scan(&space, Scanner::new(0.0, 0.1, 0, 0.1, 0.0, 10.0), pose).is_empty());
    }

    #[test]
    fn there_is_no_return_from_beyond_the_range_or_above_the_walls_or_without_a_beam() {
        let space = Space::new(&World::walled(4.0, 2.0).walls);
        let pose = Pose::new(1.0, 0.5, 0.0);
        let none = f64::INFINITY;
        let short = Scanner::new(0.0, FRAC_PI_2, 4, 0.1, 0.0, 1.0);
        assert!(near(&scan(&space, short, pose), &[none, none, 0.995, 0.495]));
        let high = Scanner::new(0.0, FRAC_PI_2, 4, 0.201, 0.0, 10.0);
        assert!(near(&scan(&space, high, pose), &[none; 4]));
        let mut scanner = Scanner::new(0.0, FRAC_PI_2, 2, 0.1, 0.0, 10.0);
        let (mut long, mut short) = ([-1.0; 3], [-1.0; 1]);
        space.scan(&mut scanner, &pose, None, &mut long);
        space.scan(&mut scanner, &pose, None, &mut short);
        assert!(near(&long, &[2.995, 1.495, none]) && near(&short, &[2.995]));
    }

    #[test]
    fn a_robot_does_not_see_itself_but_others_do() {
        let mut space = Space::new(&World::walled(4.0, 2.0).walls);
        let pose = Pose::new(1.0, 0.5, 0.0);
        for outline in [
            Footprint::Disc { radius: 0.1 },
            Footprint::Rectangle(Aabb::new(Point::new(-0.1, -0.1), Point::new(0.1, 0.1))),
        ] {
            let id = space.add(Solid::new(outline, pose, 0.0, 0.15));
            let mut scanner = Scanner::new(0.0, FRAC_PI_2, 4, 0.1, 0.0, 10.0);
            let mut ranges = [0.0; 4];
            space.scan(&mut scanner, &pose, Some(id), &mut ranges);
            assert!(near(&ranges, &[2.995, 1.495, 0.995, 0.495]));
            space.scan(&mut scanner, &pose, None, &mut ranges);
            assert!(near(&ranges, &[0.0; 4]));
            space.scan(&mut scanner, &Pose::new(2.0, 0.5, 0.0), None, &mut ranges);
            assert!(near(&ranges, &[1.995, 1.495, 0.9, 0.495]));
            space.set_pose(id, Pose::new(3.0, 1.5, 0.0));
        }
    }

    /// The level scan, which is rasterised, and single rays hit the same narrow mast above a wide foot.
    #[test]
    fn a_mast_is_met_above_the_foot_alone() {
        let mut space = Space::new(&World::walled(4.0, 2.0).walls);
        let outline = Aabb::new(Point::new(-0.05, -0.04), Point::new(-0.03, 0.04));
        let foot = Solid::new(Footprint::Disc { radius: 0.1 }, Pose::new(1.0, 1.0, 0.0), 0.0, 0.12);
        let id = space.add(Solid { mast: Some(crate::world::Mast { outline, top: 0.6 }), ..foot });
        space.set_pose(id, Pose::new(2.0, 1.0, 0.0));
        for (z, expected) in [(0.1, 0.9), (0.3, 0.95), (0.5, 0.95), (0.61, f64::INFINITY)] {
            let eye = Point::new(1.0, 1.0);
            let ray = space.cast_ray(eye, Vector::x(), z, 10.0, None);
            let scan =
                scan(&space, Scanner::new(0.0, FRAC_PI_2, 4, z, 0.0, 10.0), Pose::new(1.0, 1.0, 0.0))[0];
            assert!(near(&[ray, scan], &[expected, expected]), "{z}: {ray} {scan}");
        }
        // Tilted by 10 degrees, from a height of 0.1 m at a distance of 0.95 m.
        let tilt = crate::geometry::units::from_deg(10.0);
        let range = scan(&space, Scanner::new(0.0, 0.1, 1, 0.1, tilt, 10.0), Pose::new(1.0, 1.0, 0.0))[0];
        assert!((range - 0.95 / math::cos(tilt)).abs() < 1e-9, "{range}");
    }

    #[test]
    fn tilted_beams_hit_the_floor_or_rise_above_low_walls() {
        let low = Wall { height: 0.12, ..Wall::new(Point::new(1.0, -1.0), Point::new(1.0, 1.0)) };
        let high = Wall { height: 1.0, ..Wall::new(Point::new(3.0, -1.0), Point::new(3.0, 1.0)) };
        let space = Space::new(&[low, high]);
        let ahead = |tilt: f64| scan(&space, Scanner::new(0.0, 0.1, 1, 0.1, tilt, 10.0), Pose::default())[0];
        // Rises 0.03 m per metre: over the first wall, onto the second.
        let tilt = math::atan(0.03);
        assert!((ahead(tilt) - 2.995 / math::cos(tilt)).abs() < 1e-12);
        // Falls 0.2 m per metre: onto the floor after 0.5 m.
        let tilt = math::atan(-0.2);
        assert!((ahead(tilt) - 0.5 / math::cos(tilt)).abs() < 1e-12);
        // From above onto the first wall's top, half-way across: 0.6 m down per metre from 0.72 m.
        let tilt = math::atan(-0.6);
        let scanner = Scanner::new(0.0, 0.1, 1, 0.72, tilt, 10.0);
        assert!((scan(&space, scanner, Pose::default())[0] - 1.0 / math::cos(tilt)).abs() < 1e-9);
        assert_eq!(ahead(math::atan(0.5)), f64::INFINITY);
    }

    proptest! {
        #![proptest_config(crate::testing::cases(32))]

        #[test]
        fn a_tilted_beam_ends_where_a_walk_along_it_first_enters_something(
            walls in prop::collection::vec((-2.0..2.0f64, -2.0..2.0f64, 0.0..TAU, 0.1..1.0f64, 0.05..0.3f64), 0..8),
            discs in prop::collection::vec((-2.0..2.0f64, -2.0..2.0f64, 0.05..0.4f64, 0.0..0.3f64), 0..8),
            tilt in -0.5..0.5f64, z in 0.0..0.3f64,
        ) {
            let walls: Vec<Wall> = walls.into_iter().map(|(x, y, angle, length, height)| {
                let a = Point::new(x, y);
                Wall { thickness: 0.1, height, ..Wall::new(a, a + direction(angle) * length) }
            }).collect();
            let mut space = Space::new(&walls);
            for &(x, y, radius, bottom) in &discs {
                let pose = Pose::new(x, y, 0.0);
                space.add(Solid::new(Footprint::Disc { radius }, pose, bottom, bottom + 0.1));
            }
            let filled = |p: Point, h: f64| {
                let in_wall = |w: &Wall| {
                    let along = (w.line.b - w.line.a).normalize();
                    let (u, s) = (along.dot(&(p - w.line.a)), crate::geometry::cross(along, p - w.line.a));
                    h <= w.height && 0.0 <= u && u <= w.line.length() && s.abs() <= 0.05
                };
                let in_disc = |&(x, y, r, b): &(f64, f64, f64, f64)| {
                    b <= h && h <= b + 0.1 && (p - Point::new(x, y)).norm() <= r
                };
                h < 0.0 || walls.iter().any(in_wall) || discs.iter().any(in_disc)
            };
            let ranges = scan(&space, Scanner::new(0.0, 0.5, 13, z, tilt, 5.0), Pose::default());
            let (rise, run) = math::sin_cos(tilt);
            for (beam, range) in ranges.into_iter().enumerate() {
                let d: Vector = direction(0.5 * beam as f64) * run;
                let at = |along: f64| filled(Point::origin() + d * along, z + rise * along);
                let steps = (range.min(5.0) / 1e-3) as usize;
                // Nothing nearer than the range except barely cut corners, and something directly behind it.
                let before = (0..steps).filter(|&step| at(1e-3 * step as f64)).count();
                prop_assert!(before <= 1, "beam {} of {} enters something {} times before", beam, range, before);
                let behind = [1e-9, 1e-6, 1e-5].map(|past| at(range + past));
                let grazing = [1e-3, 1e-2].iter().all(|past| !at(range + past));
                prop_assert!(range == f64::INFINITY || behind.contains(&true) || grazing);
            }
        }
    }
}
