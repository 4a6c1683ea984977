use super::fan::Fan;
use super::polar::PolarBuffer;
use super::ray::Ray;
use super::shape::Shape;
use super::solid::SolidId;
use super::space::Space;
use crate::geometry::{Aabb, Point, Pose, Vector, math};

/// A laser scanner's beams, worked out once, and the memory that a scan needs.
#[derive(Debug, Clone)]
pub struct Scanner {
    buffer: PolarBuffer,
    z: f64,
    tilt: f64,
    max_range: f64,
    /// Whether the beams go round counter-clockwise, at most once or so: what a polar buffer can draw.
    drawn: bool,
    /// What may be seen, nearest first: the distance's leading bits, then a number.
    order: Vec<u64>,
}

impl Scanner {
    /// A scanner with `beams` beams, `angle_increment` radians apart, the first `angle_min` radians counter-clockwise
    /// from straight ahead.
    ///
    /// It sits `z` metres above the floor. Its beams point `tilt` radians above the horizontal and reach `max_range`
    /// metres.
    pub fn new(
        angle_min: f64,
        angle_increment: f64,
        beams: usize,
        z: f64,
        tilt: f64,
        max_range: f64,
    ) -> Self {
        // A fan of less than a hundred thousandth of a turn from beam to beam is cast ray by ray.
        let drawn = tilt == 0.0 && angle_increment > 6e-5 && angle_increment.is_finite();
        let buffer = PolarBuffer::new(Fan::new(angle_min, angle_increment, beams));
        Self { buffer, z, tilt, max_range, drawn, order: Vec::new() }
    }

    /// The number of beams.
    pub fn beams(&self) -> usize {
        self.buffer.fan.beams()
    }

    /// Metres that a beam reaches.
    pub fn max_range(&self) -> f64 {
        self.max_range
    }
}

impl Space {
    /// Measures the distance in metres to what each beam of a scanner hits first, and infinity where there is nothing
    /// within the scanner's range.
    ///
    /// `pose` is the scanner's own in the world, and `except` the solid that carries it. Beams that point below the
    /// horizontal hit the floor; those that have risen above a wall pass it over. A scanner inside something measures
    /// 0. `ranges` takes one number for each beam; without room for all, the first ones; beyond them, infinity.
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

    /// Draws what may be seen, from near to far; true if the scanner is in something.
    fn draw(&self, scanner: &mut Scanner, eye: Point, except: Option<SolidId>) -> bool {
        let Scanner { buffer, order, z, max_range, .. } = scanner;
        order.clear();
        self.clusters.for_each_near(eye, *max_range, |number, squared| order.push(key(squared, number)));
        self.for_each_solid_near(eye, *max_range, |number| {
            let placed = &self.solids[number];
            if Some(SolidId(number as u32)) == except || !placed.span.contains(*z) {
                return;
            }
            let bounds = placed.shape.bounds();
            let reach = (bounds.max - bounds.min) * 0.5;
            let near = greater_than_zero((bounds.min + reach - eye).norm() - reach.norm());
            if near <= *max_range {
                order.push(key(near * near, self.clusters.clusters.len() + number));
            }
        });
        order.sort_unstable();
        order.iter().any(|entry| {
            let number = (entry & u64::from(u32::MAX)) as usize;
            match self.clusters.clusters.get(number) {
                Some(cluster) => {
                    let near = cluster.squared_distance(eye).sqrt();
                    if buffer.hides_box(&cluster.bounds, near) {
                        return false;
                    }
                    let walls = self.walls[cluster.members()].iter().filter(|wall| wall.span.contains(*z));
                    walls.fold(false, |inside, wall| buffer.draw_box(&wall.shape) || inside)
                }
                None => match &self.solids[number - self.clusters.clusters.len()].shape {
                    Shape::Disc { centre, radius } => {
                        !buffer.hides_disc(*centre, *radius) && buffer.draw_disc(*centre, *radius)
                    }
                    Shape::Box(shape) => buffer.draw_box(shape),
                },
            }
        })
    }

    /// Visits the solids that may be within reach, some of them perhaps more than once.
    fn for_each_solid_near(&self, eye: Point, reach: f64, mut visit: impl FnMut(usize)) {
        let reach = Vector::new(reach, reach);
        let window = self.grid.lattice.under(&Aabb { min: eye - reach, max: eye + reach });
        match window {
            Some((cells, _)) if cells.count() < self.solids.len() => {
                self.grid.loose_solids().iter().for_each(|&number| visit(number as usize));
                self.grid.for_each_solid_in(cells, |number, _, _| visit(number as usize));
            }
            _ => (0..self.solids.len()).for_each(visit),
        }
    }

    /// Casts beam by beam, whatever their tilt.
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

/// Sorts by distance, then by number.
#[inline]
fn key(squared_distance: f64, number: usize) -> u64 {
    u64::from((squared_distance as f32).to_bits()) << 32 | number as u64
}

#[inline]
fn greater_than_zero(x: f64) -> f64 {
    if x > 0.0 { x } else { 0.0 }
}
