use super::canvas::{Canvas, Packed, first_pixel};
use super::light::{lit, scaled};
use super::texture::{Level, Texture};
use super::view::View;
use crate::geometry::{Aabb, Point, Vector};
use crate::world::Colour;

/// The sky at the horizon and overhead: pale, so that it has no hue that a program would look for.
const HORIZON: Colour = Colour::from_hex(0xde_e6_ee);
const ZENITH: Colour = Colour::from_hex(0xb9_cb_de);
/// What lies beyond the floor.
const BEYOND: Colour = Colour::from_hex(0x8c_8a_84);
/// The mean colour of a floor without an image.
const FLOOR: u32 = 196;
/// Texels on each side of the pattern of such a floor, and their size in metres.
const TILE: usize = 128;
const SPECKLE: f64 = 0.008;

/// Floor and sky.
#[derive(Debug)]
pub(super) struct Ground {
    floor: Aabb,
    texture: Texture,
    /// Whether the texture is an image over the whole floor, instead of a pattern that repeats.
    stretched: bool,
}

/// Where the rays of one row meet the floor: the place of its first pixel, and the step to the next.
struct FloorRow {
    start: Point,
    step: Vector,
    /// Metres of floor from one row to the next.
    depth_of_row: f64,
}

impl Ground {
    pub(super) fn new(floor: Aabb, image: Option<&image::RgbImage>) -> Self {
        let up = 0.91;
        let stretched = image.and_then(|image| Texture::new(image, up));
        match stretched {
            Some(texture) => Self { floor, texture, stretched: true },
            None => Self { floor, texture: speckles(), stretched: false },
        }
    }

    /// Fills the canvas.
    pub(super) fn draw(&self, canvas: &mut Canvas, view: &View) {
        let width = canvas.width;
        for (row, pixels) in canvas.colours.chunks_exact_mut(width).enumerate() {
            match floor_row(view, row) {
                Some(line) => self.draw_floor(pixels, &line),
                None => pixels.fill(sky(view, row)),
            }
        }
    }

    fn draw_floor(&self, pixels: &mut [Packed], line: &FloorRow) {
        let beyond = lit(BEYOND, [0.0, 0.0, 1.0]);
        let (from, to) = self.on_floor(line, pixels.len());
        pixels[..from].fill(beyond);
        pixels[to..].fill(beyond);
        let size = self.floor.size();
        let (columns, rows) = {
            let (whole, _) = self.texture.level(1.0);
            if self.stretched {
                (whole.width as f64 / size.x, whole.height as f64 / size.y)
            } else {
                (1.0 / SPECKLE, 1.0 / SPECKLE)
            }
        };
        let pixel = line.step.norm().max(0.5 * line.depth_of_row);
        let (level, halvings) = self.texture.level(pixel * columns.max(rows));
        // Exact: a power of two.
        let scale = 1.0 / f64::from(1_u32 << halvings);
        let first = line.start + line.step * from as f64;
        // The image's first row lies along the far side, at the largest y.
        let corner = Point::new(self.floor.min.x, self.floor.max.y);
        let run = Run {
            u: (first.x - corner.x) * columns * scale,
            v: (corner.y - first.y) * rows * scale,
            du: line.step.x * columns * scale,
            dv: -line.step.y * rows * scale,
        };
        let pixels = &mut pixels[from..to];
        if self.stretched { run.within(level, pixels) } else { run.repeated(level, pixels) }
    }

    /// The pixels of a row that show the floor.
    fn on_floor(&self, line: &FloorRow, width: usize) -> (usize, usize) {
        let (mut from, mut to) = (0.0, width as f64);
        let sides = [
            (line.start.x, line.step.x, self.floor.min.x, self.floor.max.x),
            (line.start.y, line.step.y, self.floor.min.y, self.floor.max.y),
        ];
        for (start, step, low, high) in sides {
            if step == 0.0 {
                if !(low..=high).contains(&start) {
                    return (width, width);
                }
                continue;
            }
            let (a, b) = ((low - start) / step, (high - start) / step);
            from = a.min(b).max(from);
            to = a.max(b).min(to);
        }
        // Places count from the middle of the first pixel.
        let (from, to) = (first_pixel(from + 0.5, width), first_pixel(to + 0.5, width));
        (from.min(to), to)
    }
}

/// Texels along a row: the place of the first, and the step to the next.
struct Run {
    u: f64,
    v: f64,
    du: f64,
    dv: f64,
}

impl Run {
    /// Takes texels of an image; what rounding carries over its edge takes the nearest.
    fn within(&self, level: &Level, pixels: &mut [Packed]) {
        let (u, v, du, dv) = (self.u as f32, self.v as f32, self.du as f32, self.dv as f32);
        for (i, pixel) in (0_u32..).zip(pixels) {
            let x = ((u + du * i as f32) as usize).min(level.width - 1);
            let y = ((v + dv * i as f32) as usize).min(level.height - 1);
            *pixel = level.texels[y * level.width + x];
        }
    }

    /// Takes texels of a pattern that repeats; its sides are powers of two.
    fn repeated(&self, level: &Level, pixels: &mut [Packed]) {
        let side = level.width as f64;
        let home = |place: f64| place - side * (place / side).floor();
        let (u, v, du, dv) = (home(self.u) as f32, home(self.v) as f32, self.du as f32, self.dv as f32);
        let (mask, side) = (level.width as i32 - 1, level.width as i32);
        for (i, pixel) in (0_u32..).zip(pixels) {
            // A place may be below zero: the shift makes cutting round down.
            let x = (u + du * i as f32 + SHIFT) as i32 & mask;
            let y = (v + dv * i as f32 + SHIFT) as i32 & mask;
            *pixel = level.texels[(y * side + x) as usize];
        }
    }
}

/// More texels than a row crosses, and a multiple of every pattern's side.
const SHIFT: f32 = 131_072.0;

/// Where a row's rays meet the floor; `None` if they do not.
fn floor_row(view: &View, row: usize) -> Option<FloorRow> {
    let height = view.eye[2].max(1e-3);
    let meet = |row: f64| {
        let y = view.ray_y(row);
        let (ahead, up) = (view.cos + y * view.sin, view.sin - y * view.cos);
        // At the horizon rays run along the floor for ever.
        (up < -1e-4).then(|| (height / -up, ahead))
    };
    let (far, ahead) = meet(row as f64)?;
    let below = meet(row as f64 + 1.0).map_or(0.0, |(far, ahead)| far * ahead);
    let eye = Point::new(view.eye[0], view.eye[1]);
    let start = eye + (view.ahead * ahead + view.right * view.ray_x(0.0)) * far;
    let step = view.right * (far / view.focal);
    Some(FloorRow { start, step, depth_of_row: (far * ahead - below).abs() })
}

/// The sky in a row.
fn sky(view: &View, row: usize) -> Packed {
    let y = view.ray_y(row as f64);
    let (ahead, up) = (view.cos + y * view.sin, view.sin - y * view.cos);
    let share = (up.max(0.0) / (up * up + ahead * ahead).sqrt().max(1e-9)).min(1.0);
    let channel = |a: u8, b: u8| (f64::from(a) + share * (f64::from(b) - f64::from(a)) + 0.5) as u32;
    channel(HORIZON.red, ZENITH.red) << 16
        | channel(HORIZON.green, ZENITH.green) << 8
        | channel(HORIZON.blue, ZENITH.blue)
}

/// A gray floor with darker and lighter speckles, the same everywhere and always.
fn speckles() -> Texture {
    let mut state = 0x2545_f491_u32;
    let texels = (0..TILE * TILE).map(|_| {
        // Marsaglia's xorshift: the pattern needs to look irregular, no more.
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        let shade = (FLOOR - 16 + (state >> 24) / 8) as u8;
        scaled(Colour::new(shade, shade, shade.saturating_sub(6)), 0.91)
    });
    Texture::with_smaller_ones(Level { width: TILE, height: TILE, texels: texels.collect() })
}
