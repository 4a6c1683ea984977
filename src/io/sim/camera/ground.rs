use std::sync::Arc;

use super::canvas::{Canvas, Packed, first_pixel};
use super::light::{lit, scaled};
use super::model::dimmed;
use super::relief::{Rays, Relief};
use super::run::{Run, smooth_at};
use super::texture::{Level, Texture};
use super::view::View;
use crate::geometry::{Aabb, Point, Vector, math};
use crate::world::{Colour, HeightField};

/// Sky at the horizon, too pale for programs that search for a hue.
const HORIZON: Colour = Colour::from_hex(0xde_e6_ee);
/// Sky at the zenith.
const ZENITH: Colour = Colour::from_hex(0xb9_cb_de);
/// Colour beyond the floor.
const BEYOND: Colour = Colour::from_hex(0x8c_8a_84);
/// Mean brightness of a floor without an image.
const FLOOR: u32 = 196;
/// Side of the repeated floor pattern (texels).
const TILE: usize = 128;
/// Size of a texel of the pattern (m).
const SPECKLE: f64 = 0.008;

/// Floor and sky.
#[derive(Debug)]
pub(super) struct Ground {
    floor: Aabb,
    texture: Texture,
    /// Whether the texture is one image over the whole floor instead of a repeated pattern.
    stretched: bool,
    /// Replacement of the level floor, if any.
    relief: Option<Relief>,
}

/// Largest number of floor samples per pixel.
const MOST_PLACES: u32 = 8;

/// Floor intersections of the rays of one row: the point of the first pixel, and the steps to the next pixel
/// and row.
struct FloorRow {
    start: Point,
    step: Vector,
    depth: Vector,
    /// Distance on the floor from one row to the next (m).
    depth_of_row: f64,
}

impl Ground {
    pub(super) fn new(
        floor: Aabb,
        image: Option<&image::RgbaImage>,
        hills: Option<Arc<HeightField>>,
    ) -> Self {
        let relief = hills.map(Relief::new);
        let light = Colour::from_hex(lit(Colour::WHITE, [0.0, 0.0, 1.0]));
        let stretched = image.and_then(|image| Texture::new(image, light));
        match stretched {
            Some(texture) => Self { floor, texture, stretched: true, relief },
            None => Self { floor, texture: speckles(), stretched: false, relief },
        }
    }

    /// Fills the canvas.
    pub(super) fn draw(&mut self, canvas: &mut Canvas, view: &View) {
        if let Some(relief) = &mut self.relief {
            relief.draw(canvas, view);
            self.paint_hills(canvas, view);
            return;
        }
        let width = canvas.width;
        for (row, pixels) in canvas.colours.chunks_exact_mut(width).enumerate() {
            match floor_row(view, row) {
                Some(line) => self.draw_floor(pixels, &line),
                None => pixels.fill(sky(view, row)),
            }
        }
    }

    /// Gives every pixel its colour, once it is known how near the hills are there.
    fn paint_hills(&self, canvas: &mut Canvas, view: &View) {
        let Some(relief) = &self.relief else { return };
        let (rays, width) = (Rays::of(view), canvas.width);
        let beyond = lit(BEYOND, [0.0, 0.0, 1.0]);
        for (at, (colour, &near)) in canvas.colours.iter_mut().zip(&canvas.nearness).enumerate() {
            let ray = rays.direction(at % width, at / width);
            *colour = if near > 0.0 {
                let depth = 1.0 / f64::from(near);
                let (place, pixel) = (rays.at(ray, depth), depth / view.focal);
                dimmed(self.texel(place, pixel), relief.light(place, pixel))
            } else if ray[2] < 0.0 {
                beyond
            } else {
                sky_towards(ray[2], math::hypot(ray[0], ray[1]))
            };
        }
    }

    /// Colour of the floor at a point, for pixels of a size on the floor (m).
    #[inline]
    fn texel(&self, at: Point, pixel: f64) -> Packed {
        if !self.stretched {
            let (level, halvings) = self.texture.level(pixel / SPECKLE);
            let texels = 1.0 / (SPECKLE * f64::from(1_u32 << halvings));
            let mask = level.width as i64 - 1;
            let (x, y) = ((at.x * texels).floor() as i64 & mask, (-at.y * texels).floor() as i64 & mask);
            return level.texels[y as usize * level.width + x as usize];
        }
        let size = self.floor.size();
        let (whole, _) = self.texture.level(1.0);
        let (level, _) = self.texture.level(pixel * whole.width as f64 / size.x);
        let u = (at.x - self.floor.min.x) / size.x * level.width as f64;
        let v = (self.floor.max.y - at.y) / size.y * level.height as f64;
        smooth_at(level, u, v)
    }

    fn draw_floor(&self, pixels: &mut [Packed], line: &FloorRow) {
        let beyond = lit(BEYOND, [0.0, 0.0, 1.0]);
        let (from, to) = self.on_floor(line, pixels.len());
        pixels[..from].fill(beyond);
        pixels[to..].fill(beyond);
        if self.stretched {
            self.draw_image(&mut pixels[from..to], line, from);
        } else {
            let size = line.step.norm().max(0.5 * line.depth_of_row);
            let (level, halvings) = self.texture.level(size / SPECKLE);
            let texels = Vector::new(1.0 / SPECKLE, 1.0 / SPECKLE) / f64::from(1_u32 << halvings);
            self.run(line, from, texels, 0.0).repeated(level, &mut pixels[from..to]);
        }
    }

    /// The floor image averaged over each pixel: along the row by mipmaps, in depth by several samples.
    fn draw_image(&self, pixels: &mut [Packed], line: &FloorRow, from: usize) {
        let (whole, _) = self.texture.level(1.0);
        let size = self.floor.size();
        let texels = Vector::new(whole.width as f64 / size.x, whole.height as f64 / size.y);
        let (wide, deep) =
            (line.step.component_mul(&texels).norm(), line.depth.component_mul(&texels).norm());
        // Near the camera a pixel is smaller than a texel; far away its depth is much larger than its width.
        let places = (deep / wide.max(1.0)).min(f64::from(MOST_PLACES)) as u32;
        let places = places.max(1).next_power_of_two();
        let (level, halvings) = self.texture.level(wide.max(deep / f64::from(places)));
        let texels = texels / f64::from(1_u32 << halvings);
        if places == 1 {
            self.run(line, from, texels, 0.0).smooth(level, pixels);
            return;
        }
        let back = |place: u32| (f64::from(place) + 0.5) / f64::from(places) - 0.5;
        let runs: [Run; MOST_PLACES as usize] =
            std::array::from_fn(|place| self.run(line, from, texels, back(place as u32)));
        Run::averaged(&runs[..places as usize], level, pixels);
    }

    /// Texels along a row from pixel `from` on, `back` of a pixel's depth towards the camera.
    fn run(&self, line: &FloorRow, from: usize, texels: Vector, back: f64) -> Run {
        let first = line.start + line.step * from as f64 + line.depth * back;
        // The image's first row is at the far side, at the largest y.
        let corner = Point::new(self.floor.min.x, self.floor.max.y);
        Run {
            u: (first.x - corner.x) * texels.x,
            v: (corner.y - first.y) * texels.y,
            du: line.step.x * texels.x,
            dv: -line.step.y * texels.y,
        }
    }

    /// Pixels of a row that show the floor.
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
        // Positions are relative to the centre of the first pixel.
        let (from, to) = (first_pixel(from + 0.5, width), first_pixel(to + 0.5, width));
        (from.min(to), to)
    }
}

/// Floor intersections of a row's rays; `None` if there are none.
fn floor_row(view: &View, row: usize) -> Option<FloorRow> {
    let height = view.eye[2].max(1e-3);
    let meet = |row: f64| {
        let y = view.ray_y(row);
        let (ahead, up) = (view.cos + y * view.sin, view.sin - y * view.cos);
        // Rays at the horizon never meet the floor.
        (up < -1e-4).then(|| (height / -up, ahead))
    };
    let (far, ahead) = meet(row as f64)?;
    let below = meet(row as f64 + 1.0).map_or(0.0, |(far, ahead)| far * ahead);
    let eye = Point::new(view.eye[0], view.eye[1]);
    let start = eye + (view.ahead * ahead + view.right * view.ray_x(0.0)) * far;
    let step = view.right * (far / view.focal);
    // Straight towards the camera, without the perspective sideways component.
    let depth = view.ahead * (below - far * ahead);
    Some(FloorRow { start, step, depth, depth_of_row: (far * ahead - below).abs() })
}

/// Sky colour of a row.
fn sky(view: &View, row: usize) -> Packed {
    let y = view.ray_y(row as f64);
    sky_towards(view.sin - y * view.cos, view.cos + y * view.sin)
}

/// The sky in a direction.
fn sky_towards(up: f64, ahead: f64) -> Packed {
    let share = (up.max(0.0) / (up * up + ahead * ahead).sqrt().max(1e-9)).min(1.0);
    let channel = |a: u8, b: u8| (f64::from(a) + share * (f64::from(b) - f64::from(a)) + 0.5) as u32;
    channel(HORIZON.red, ZENITH.red) << 16
        | channel(HORIZON.green, ZENITH.green) << 8
        | channel(HORIZON.blue, ZENITH.blue)
}

/// A gray floor with fixed darker and lighter speckles.
fn speckles() -> Texture {
    let mut state = 0x2545_f491_u32;
    let texels = (0..TILE * TILE).map(|_| {
        // Marsaglia's xorshift; the pattern only needs to look irregular.
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        let shade = (FLOOR - 16 + (state >> 24) / 8) as u8;
        scaled(Colour::new(shade, shade, shade.saturating_sub(6)), 0.91)
    });
    Texture::with_smaller_ones(Level { width: TILE, height: TILE, texels: texels.collect() })
}
