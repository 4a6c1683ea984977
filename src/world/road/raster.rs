use image::{Rgba, RgbaImage};

use super::course::{CourseError, RoadCourse};
use super::paint::quads;
use crate::geometry::{Aabb, Point, Vector, cross, math};
use crate::random::Stream;
use crate::world::{Texture, World};

/// Appearance of a course.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Appearance {
    /// Size of a pixel of its picture on the floor (m).
    pub pixel: f64,
    /// Fraction of the paint that is worn off, 0 to 1.
    pub wear: f64,
    /// Number of light patches from lamps on the floor.
    pub glare: usize,
    /// Seed of wear, light and the floor's grain.
    pub seed: u64,
}

impl Default for Appearance {
    /// 2 mm per pixel, fresh paint, no glare.
    fn default() -> Self {
        Self { pixel: 0.002, wear: 0.0, glare: 0, seed: 1 }
    }
}

/// Largest number of pixels of a picture.
const MOST_PIXELS: usize = 200_000_000;
/// Brightness of the floor, 0 to 255.
const FLOOR: f64 = 44.0;
/// Number of shades of the floor's grain, brighter than the floor.
const GRAIN: u32 = 10;
/// Brightness of paint, 0 to 255.
const PAINT: f64 = 236.0;
/// Size of a spot of worn paint (m).
const SPOT: f64 = 0.024;
/// Largest additional brightness of a light patch.
const GLARE: f64 = 110.0;

impl RoadCourse {
    /// The course as a world with the road's picture on its floor. Fails if the floor is too large for a
    /// picture.
    pub fn world(&self, appearance: &Appearance) -> Result<World, CourseError> {
        let floor = self.floor();
        let image = self.floor_image(appearance)?;
        let world = World::empty(1.0, 1.0);
        let floor_texture = Some(Texture::new("course.png", image));
        Ok(World { floor, floor_texture, start: Some(self.start()), ..world })
    }

    /// Picture of the road from above, far side on top; it fills the [floor](Self::floor).
    pub fn floor_image(&self, appearance: &Appearance) -> Result<RgbaImage, CourseError> {
        self.check()?;
        let mut raster = Raster::new(self.floor(), appearance.pixel)?;
        for quad in quads(self) {
            raster.fill(&quad);
        }
        Ok(raster.develop(appearance))
    }
}

/// Coverage of each pixel with paint.
struct Raster {
    width: usize,
    height: usize,
    /// The far left corner, and the size of a pixel along x and y (m).
    corner: Point,
    pixel: Vector,
    covered: Vec<u8>,
}

impl Raster {
    fn new(floor: Aabb, pixel: f64) -> Result<Self, CourseError> {
        let size = floor.size();
        let too_large = CourseError::TooLarge { width: size.x, height: size.y, pixel, most: MOST_PIXELS };
        let count = (size.x / pixel).ceil() * (size.y / pixel).ceil();
        if !(pixel > 0.0 && count <= MOST_PIXELS as f64) {
            return Err(too_large);
        }
        let (width, height) = ((size.x / pixel).ceil() as usize, (size.y / pixel).ceil() as usize);
        let corner = Point::new(floor.min.x, floor.max.y);
        let pixel = Vector::new(size.x / width as f64, size.y / height as f64);
        Ok(Self { width, height, corner, pixel, covered: vec![0; width * height] })
    }

    /// Paints a convex shape. The coverage of adjacent parts adds up at their common edge.
    fn fill(&mut self, corners: &[Point; 4]) {
        let own = corners.map(|corner| {
            let (x, y) = (corner.x - self.corner.x, self.corner.y - corner.y);
            Point::new(x / self.pixel.x, y / self.pixel.y)
        });
        let turn = cross(own[2] - own[0], own[3] - own[1]);
        let edges: [Edge; 4] = std::array::from_fn(|i| Edge::new(own[i], own[(i + 1) % 4], turn));
        let span = |values: [f64; 4], most: usize| {
            let low = values.into_iter().fold(f64::INFINITY, f64::min) - 1.0;
            let high = values.into_iter().fold(f64::NEG_INFINITY, f64::max) + 1.0;
            (low.clamp(0.0, most as f64) as usize)..(high.clamp(0.0, most as f64) as usize)
        };
        for row in span(own.map(|p| p.y), self.height) {
            for column in span(own.map(|p| p.x), self.width) {
                let middle = Point::new(column as f64 + 0.5, row as f64 + 0.5);
                let inside = edges.iter().map(|edge| (edge.inside(middle) + 0.5).clamp(0.0, 1.0));
                let share = inside.fold(1.0, f64::min);
                let covered = &mut self.covered[row * self.width + column];
                *covered = covered.saturating_add((255.0 * share + 0.5) as u8);
            }
        }
    }

    /// The picture with light and wear.
    fn develop(&self, appearance: &Appearance) -> RgbaImage {
        let lamps = self.lamps(appearance);
        let salt = Stream::new(appearance.seed).child("road", 0).bits() as u32;
        let spots = Vector::new(self.pixel.x / SPOT, self.pixel.y / SPOT);
        let mut image = RgbaImage::new(self.width as u32, self.height as u32);
        for (row, pixels) in image.chunks_exact_mut(4 * self.width).enumerate() {
            let covered = &self.covered[row * self.width..][..self.width];
            for (column, (pixel, &covered)) in
                pixels.as_chunks_mut::<4>().0.iter_mut().zip(covered).enumerate()
            {
                let random = hash(column as u32, row as u32, salt);
                let mut shade = FLOOR + f64::from(random % GRAIN);
                if covered > 0 {
                    let worn = if appearance.wear > 0.0 {
                        let place = (spots.x * column as f64, spots.y * row as f64);
                        appearance.wear >= worn_at(place, salt)
                    } else {
                        false
                    };
                    let share = f64::from(covered) / 255.0 * if worn { 0.15 } else { 1.0 };
                    shade += (PAINT - shade) * share;
                }
                for lamp in &lamps {
                    shade += lamp.light(column, row);
                }
                let shade = shade.min(255.0) as u8;
                *pixel = Rgba([shade, shade, shade, 255]).0;
            }
        }
        image
    }

    fn lamps(&self, appearance: &Appearance) -> Vec<Lamp> {
        let mut random = Stream::new(appearance.seed).child("glare", 0);
        let lamp = |_| Lamp {
            x: random.uniform() * self.width as f64,
            y: random.uniform() * self.height as f64,
            radius: random.between(0.15, 0.45) / self.pixel.x,
            light: random.between(0.4, 1.0) * GLARE,
        };
        (0..appearance.glare).map(lamp).collect()
    }
}

/// A straight edge; distances are in pixels, positive inside.
struct Edge {
    from: Point,
    normal: Vector,
}

impl Edge {
    fn new(from: Point, to: Point, turn: f64) -> Self {
        let along = (to - from) / (to - from).norm().max(1e-9);
        let sign = if turn < 0.0 { -1.0 } else { 1.0 };
        Self { from, normal: Vector::new(-along.y, along.x) * sign }
    }

    fn inside(&self, point: Point) -> f64 {
        (point - self.from).dot(&self.normal)
    }
}

/// A round patch of light (pixels).
struct Lamp {
    x: f64,
    y: f64,
    radius: f64,
    light: f64,
}

impl Lamp {
    fn light(&self, column: usize, row: usize) -> f64 {
        let (x, y) = ((column as f64 - self.x) / self.radius, (row as f64 - self.y) / self.radius);
        let square = x * x + y * y;
        if square > 6.0 { 0.0 } else { self.light * math::exp(-square) }
    }
}

/// A number from 0 to 1 that varies smoothly between spots; paint wears off first where it is small.
fn worn_at((x, y): (f64, f64), salt: u32) -> f64 {
    let corner = |dx: u32, dy: u32| {
        let random = hash((x as u32).wrapping_add(dx), (y as u32).wrapping_add(dy), salt ^ 0x5bd1_e995);
        f64::from(random >> 8) / f64::from(1_u32 << 24)
    };
    let (u, v) = (x.fract(), y.fract());
    let top = corner(0, 0) * (1.0 - u) + corner(1, 0) * u;
    let bottom = corner(0, 1) * (1.0 - u) + corner(1, 1) * u;
    top * (1.0 - v) + bottom * v
}

/// A 32-bit hash.
fn hash(x: u32, y: u32, salt: u32) -> u32 {
    let mut h = x.wrapping_mul(0x9e37_79b9) ^ y.wrapping_mul(0x85eb_ca6b) ^ salt;
    h = (h ^ h >> 16).wrapping_mul(0x7feb_352d);
    h = (h ^ h >> 15).wrapping_mul(0x846c_a68b);
    h ^ h >> 16
}
