use super::cluster::CLUSTER;
use super::fan::{Fan, Sector};
use super::grid::Cells;
use super::polar::{PolarBuffer, Stroke};
use super::ray::Ray;
use super::shape::Shape;
use super::solid::SolidId;
use super::space::Space;
use crate::geometry::{Point, Pose, math};

/// Up to so many solids are looked at one by one; more, by the cells they are in.
const FEW_SOLIDS: usize = 64;

/// A laser scanner's beams, worked out once, and the memory that a scan needs.
#[derive(Debug, Clone)]
pub struct Scanner {
    buffer: PolarBuffer,
    z: f64,
    tilt: f64,
    max_range: f64,
    /// Whether the beams go round counter-clockwise, at most once or so: what a polar buffer can draw.
    drawn: bool,
    /// What may be seen; its order, nearest first: the distance's leading bits, then a place in `sights`; and which
    /// solids are done.
    sights: Vec<Sight>,
    order: Vec<u64>,
    seen: Vec<bool>,
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
        let drawn = tilt == 0.0 && angle_increment > 1e-6 && angle_increment.is_finite();
        let buffer = PolarBuffer::new(Fan::new(angle_min, angle_increment, beams));
        Self { buffer, z, tilt, max_range, drawn, sights: Vec::new(), order: Vec::new(), seen: Vec::new() }
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
            if sight.is_hidden(buffer) {
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
        let sector = buffer.sector_of(&self.solids[number as usize].shape);
        let near = sector.map_or(0.0, |(_, near)| near);
        let sector = sector.map(|(sector, _)| sector);
        (near <= reach).then_some(Sight { what: Sighted::Solid(number), sector, near })
    }

    fn draw_cluster(&self, buffer: &mut PolarBuffer, number: usize, z: f64) -> bool {
        let walls = &self.walls[self.clusters.clusters[number].members()];
        // First all strokes, then all drawing: the processor works on several strokes at a time.
        let strokes: [Option<Stroke>; CLUSTER] = std::array::from_fn(|i| {
            walls.get(i).filter(|wall| wall.span.contains(z)).map(|wall| buffer.stroke(&wall.shape))
        });
        strokes.iter().flatten().any(|stroke| {
            if !stroke.inside {
                buffer.draw(stroke);
            }
            stroke.inside
        })
    }

    fn draw_solid(&self, buffer: &mut PolarBuffer, number: u32, z: f64, seen: &mut [bool]) -> bool {
        let placed = &self.solids[number as usize];
        if std::mem::replace(&mut seen[number as usize], true) || !placed.span.contains(z) {
            return false;
        }
        match &placed.shape {
            Shape::Disc { centre, radius } => buffer.draw_disc(*centre, *radius),
            Shape::Box(shape) => {
                let stroke = buffer.stroke(shape);
                if !stroke.inside {
                    buffer.draw(&stroke);
                }
                stroke.inside
            }
        }
    }

    /// Draws the solids of some cells, but for those in cells that are hidden.
    fn draw_block(&self, buffer: &mut PolarBuffer, cells: Cells, z: f64, seen: &mut [bool]) -> bool {
        let lattice = &self.grid.lattice;
        cells.iter().any(|(x, y)| {
            let solids = self.grid.solids_in(lattice.index(x, y));
            solids.iter().any(|&number| {
                if seen[number as usize] {
                    return false;
                }
                let sector = buffer.sector_of(&self.solids[number as usize].shape);
                let hidden = sector.is_some_and(|(sector, near)| buffer.hides(sector, near));
                // What is hidden now stays so.
                seen[number as usize] = hidden;
                !hidden && self.draw_solid(buffer, number, z, seen)
            })
        })
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

/// Something that may be seen.
#[derive(Debug, Clone, Copy)]
struct Sight {
    what: Sighted,
    /// The beams it may be in; `None` if the eye is, or may be, in it.
    sector: Option<Sector>,
    /// Metres to it, at least.
    near: f64,
}

#[derive(Debug, Clone, Copy)]
enum Sighted {
    Cluster(u32),
    Solid(u32),
    /// The solids listed in some cells.
    Block(Cells),
}

impl Sight {
    #[inline]
    fn is_hidden(&self, buffer: &PolarBuffer) -> bool {
        self.sector.is_some_and(|sector| buffer.hides(sector, self.near))
    }
}

/// Sorts by distance, then by place.
#[inline]
fn key(distance: f64, place: usize) -> u64 {
    u64::from((distance as f32).to_bits()) << 32 | place as u64
}
