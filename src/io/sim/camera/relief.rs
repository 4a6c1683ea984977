use std::sync::Arc;

use super::canvas::{Canvas, Packed, Span, first_pixel};
use super::face::Cutter;
use super::light::{SUN, shade};
use super::texture::{Level, Texture};
use super::view::{NEAR, Place, Seen, View};
use crate::geometry::{Point, Point3, Vector};
use crate::world::HeightField;

/// Hills as cameras see them: the triangles that carry robots.
///
/// Where a cell is smaller than a pixel, larger triangles between fewer samples stand for it.
#[derive(Debug)]
pub(super) struct Relief {
    surface: Arc<HeightField>,
    /// The light on each sample: gray, with smaller versions.
    light: Texture,
    cutter: Cutter,
    mesh: Vec<Vertex>,
    blocks: Vec<Block>,
}

/// A sample in the camera's frame, and where it appears.
#[derive(Debug, Clone, Copy)]
struct Vertex {
    seen: Seen,
    x: f64,
    y: f64,
    nearness: f64,
}

/// A square of `1 << level` cells each way.
#[derive(Debug, Clone, Copy)]
struct Block {
    level: u32,
    column: usize,
    row: usize,
}

/// How samples come into the camera's frame: the place of the first at height 0, and the steps along x, y and
/// upwards.
struct Steps {
    origin: Seen,
    x: Seen,
    y: Seen,
    up: Seen,
}

/// Blocks of `1 << LEAF` cells each way, or of as many larger ones, are drawn as a whole.
const LEAF: u32 = 4;
/// Brightness of level ground in the sun: textures on the floor have it already.
const LEVEL: f64 = 0.91;
/// Texels of light are 0 to 255 for a brightness of 0 to 1.
const WHITE: f64 = 255.0;

impl Relief {
    pub(super) fn new(surface: Arc<HeightField>) -> Self {
        let light = light(&surface);
        Self { surface, light, cutter: Cutter::default(), mesh: Vec::new(), blocks: Vec::new() }
    }

    /// Draws the depth of the surface where it is nearest. Colours are for
    /// [`paint`](Self::paint).
    pub(super) fn draw(&mut self, canvas: &mut Canvas, view: &View) {
        let area = self.surface.area();
        let pitch = self.surface.pitch();
        let steps = Steps {
            origin: view.see([area.min.x, area.min.y, 0.0]),
            x: view.turned([pitch.x, 0.0, 0.0]),
            y: view.turned([0.0, pitch.y, 0.0]),
            up: view.turned([0.0, 0.0, 1.0]),
        };
        self.blocks.clear();
        self.blocks.push(Block { level: self.surface.top_level(), column: 0, row: 0 });
        while let Some(block) = self.blocks.pop() {
            let Some(depth) = self.depth(&block, &steps, view) else { continue };
            let coarse = coarseness(view.focal * pitch.max(), depth);
            if block.level <= LEAF + coarse {
                self.draw_block(block, &steps, canvas, view);
                continue;
            }
            let level = block.level - 1;
            for (right, above) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let (column, row) = (block.column + (right << level), block.row + (above << level));
                if column < self.surface.columns() - 1 && row < self.surface.rows() - 1 {
                    self.blocks.push(Block { level, column, row });
                }
            }
        }
    }

    /// The least depth of a block, at least 0; `None` if nothing of it is in the picture.
    fn depth(&self, block: &Block, steps: &Steps, view: &View) -> Option<f64> {
        let cells = (self.surface.columns() - 1, self.surface.rows() - 1);
        let size = 1_usize << block.level;
        let half = |from: usize, cells: usize| {
            let to = (from + size).min(cells);
            (0.5 * (from + to) as f64, 0.5 * (to - from) as f64)
        };
        let ((x, half_x), (y, half_y)) = (half(block.column, cells.0), half(block.row, cells.1));
        let (low, high) = self.surface.bounds(block.level, block.column, block.row);
        let (z, half_z) = (0.5 * (low + high), 0.5 * (high - low));
        let middle = steps.place(x, y, z);
        // How far before a plane through the eye, with this normal, the block reaches at most.
        let reach = |normal: Seen| {
            let along = |axis: Seen, half: f64| (axis.dot(normal) * half).abs();
            let extent = along(steps.x, half_x) + along(steps.y, half_y) + along(steps.up, half_z);
            (middle.dot(normal), extent)
        };
        let (wide, tall) = (0.5 * view.width as f64 / view.focal, 0.5 * view.height as f64 / view.focal);
        let sides = [(1.0, 0.0, wide), (-1.0, 0.0, wide), (0.0, 1.0, tall), (0.0, -1.0, tall)];
        let hidden = sides.iter().any(|&(x, y, z)| {
            let (before, extent) = reach(Seen { x, y, z });
            before + extent < 0.0
        });
        let (ahead, extent) = reach(Seen { x: 0.0, y: 0.0, z: 1.0 });
        (!hidden && ahead + extent >= NEAR).then_some((ahead - extent).max(0.0))
    }

    fn draw_block(&mut self, block: Block, steps: &Steps, canvas: &mut Canvas, view: &View) {
        let step = 1_usize << block.level.saturating_sub(LEAF);
        let size = 1_usize << block.level;
        // Coarse blocks reach a step into their neighbours, so that no gap opens towards finer ones.
        let aside = if step > 1 { step } else { 0 };
        let samples = |from: usize, cells: usize| {
            let to = (from + size + aside).min(cells);
            let from = from.saturating_sub(aside);
            let count = (to - from).div_ceil(step) + 1;
            (0..count).map(move |i| (from + i * step).min(to))
        };
        let columns = samples(block.column, self.surface.columns() - 1);
        let rows = samples(block.row, self.surface.rows() - 1);
        let width = columns.len();
        self.mesh.clear();
        for row in rows.clone() {
            for column in columns.clone() {
                let height = self.surface.sample(column, row);
                let seen = steps.place(column as f64, row as f64, height);
                let (x, y) = view.project(seen);
                self.mesh.push(Vertex { seen, x, y, nearness: 1.0 / seen.z });
            }
        }
        for row in 1..rows.len() {
            let (near, far) = (&self.mesh[(row - 1) * width..], &self.mesh[row * width..]);
            for column in 1..width {
                let ([a, b], [c, d]) = ([near[column - 1], near[column]], [far[column - 1], far[column]]);
                draw_triangle(&mut self.cutter, canvas, view, [a, b, d]);
                draw_triangle(&mut self.cutter, canvas, view, [a, d, c]);
            }
        }
    }

    /// The light on a place of the surface, in 256ths of that on level ground, for pixels that cover so many
    /// metres.
    #[inline]
    pub(super) fn light(&self, at: Point, pixel: f64) -> u32 {
        let per_metre = self.surface.per_metre();
        let (level, halvings) = self.light.level(pixel * per_metre.x);
        let scale = 1.0 / f64::from(1_u32 << halvings);
        let place = (at - self.surface.area().min).component_mul(&per_metre) * scale;
        let brightness = between_texels(level, place);
        (brightness * (256.0 / (WHITE * LEVEL)) as f32) as u32
    }
}

impl Steps {
    #[inline]
    fn place(&self, column: f64, row: f64, height: f64) -> Seen {
        let Self { origin: o, x, y, up } = self;
        Seen {
            x: o.x + x.x * column + y.x * row + up.x * height,
            y: o.y + x.y * column + y.y * row + up.y * height,
            z: o.z + x.z * column + y.z * row + up.z * height,
        }
    }
}

/// How often cells of so many pixels at a metre may be doubled to be no larger than a pixel at a depth.
fn coarseness(pixels: f64, depth: f64) -> u32 {
    let mut doubled = 0;
    let mut size = 2.0 * pixels;
    while size <= depth && doubled < 12 {
        size *= 2.0;
        doubled += 1;
    }
    doubled
}

/// Draws the depth of a triangle where it is nearest.
#[inline]
fn draw_triangle(cutter: &mut Cutter, canvas: &mut Canvas, view: &View, corners: [Vertex; 3]) {
    let [a, b, c] = corners;
    let (nearest, farthest) = (a.seen.z.min(b.seen.z).min(c.seen.z), a.seen.z.max(b.seen.z).max(c.seen.z));
    if nearest < NEAR {
        if farthest >= NEAR {
            cutter.draw_seen(canvas, view, &corners.map(|corner| corner.seen));
        }
        return;
    }
    let top = first_pixel(a.y.min(b.y).min(c.y), canvas.height);
    let bottom = first_pixel(a.y.max(b.y).max(c.y), canvas.height);
    // Most triangles are smaller than a pixel.
    if top >= bottom {
        return;
    }
    let left = first_pixel(a.x.min(b.x).min(c.x), canvas.width);
    let right = first_pixel(a.x.max(b.x).max(c.x), canvas.width);
    if left >= right {
        return;
    }
    let area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if area == 0.0 {
        return;
    }
    let (along, across) = (b.nearness - a.nearness, c.nearness - a.nearness);
    let per_column = (along * (c.y - a.y) - across * (b.y - a.y)) / area;
    let per_row = (across * (b.x - a.x) - along * (c.x - a.x)) / area;
    for row in top..bottom {
        let y = row as f64 + 0.5;
        let span = span(&corners, y);
        let (from, to) = (first_pixel(span.left, canvas.width), first_pixel(span.right, canvas.width));
        let start = a.nearness + per_row * (y - a.y) + per_column * (0.5 - a.x);
        let line = &mut canvas.nearness[row * canvas.width..(row + 1) * canvas.width];
        for (column, near) in line.iter_mut().enumerate().take(to).skip(from) {
            let here = (start + per_column * column as f64) as f32;
            *near = if here > *near { here } else { *near };
        }
    }
}

/// Part of a row covered by a triangle.
#[inline]
fn span(corners: &[Vertex; 3], y: f64) -> Span {
    let mut span = Span::EMPTY;
    for (a, b) in [(0, 1), (1, 2), (2, 0)].map(|(a, b)| (&corners[a], &corners[b])) {
        if (a.y <= y) == (b.y <= y) {
            continue;
        }
        // The same edge has the same pixels in both triangles that share it.
        let (upper, lower) = if a.y < b.y { (a, b) } else { (b, a) };
        let x = upper.x + (y - upper.y) * ((lower.x - upper.x) / (lower.y - upper.y));
        (span.left, span.right) = (span.left.min(x), span.right.max(x));
    }
    span
}

/// A gray between the four texels next to a place, 0 to 255. At the edges it goes on as it ends.
#[inline]
fn between_texels(level: &Level, place: Vector) -> f32 {
    let x = (place.x as f32).clamp(0.0, level.width as f32 - 1.0);
    let y = (place.y as f32).clamp(0.0, level.height as f32 - 1.0);
    let (column, row) = (x as usize, y as usize);
    let (next, above) = ((column + 1).min(level.width - 1), (row + 1).min(level.height - 1));
    let (share, rise) = (x - column as f32, y - row as f32);
    let texel = |column: usize, row: usize| (level.texels[row * level.width + column] & 0xff) as f32;
    let below = texel(column, row) + share * (texel(next, row) - texel(column, row));
    let over = texel(column, above) + share * (texel(next, above) - texel(column, above));
    below + rise * (over - below)
}

/// The light on each sample, by the slope between its neighbours.
fn light(surface: &HeightField) -> Texture {
    let (columns, rows) = (surface.columns(), surface.rows());
    let per_metre = surface.per_metre();
    let mut texels = Vec::with_capacity(columns * rows);
    for row in 0..rows {
        let (below, above) = (row.saturating_sub(1), (row + 1).min(rows - 1));
        for column in 0..columns {
            let (left, right) = (column.saturating_sub(1), (column + 1).min(columns - 1));
            let rise =
                |from: f64, to: f64, samples: usize, per_metre: f64| (to - from) * per_metre / samples as f64;
            let x = rise(surface.sample(left, row), surface.sample(right, row), right - left, per_metre.x);
            let y = rise(
                surface.sample(column, below),
                surface.sample(column, above),
                above - below,
                per_metre.y,
            );
            let length = (x * x + y * y + 1.0).sqrt();
            let cosine = (SUN[2] - x * SUN[0] - y * SUN[1]) / length;
            let gray = (WHITE * shade(cosine) + 0.5) as Packed;
            texels.push(0xff << 24 | gray << 16 | gray << 8 | gray);
        }
    }
    Texture::with_smaller_ones(Level { width: columns, height: rows, texels })
}

/// How the picture's rays go in the world: the direction of the middle of pixel (0, 0), and the change to the
/// next column and row, each for a metre along the line of sight.
pub(super) struct Rays {
    eye: Point3,
    first: Place,
    column: Place,
    row: Place,
}

impl Rays {
    pub(super) fn of(view: &View) -> Self {
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| view.turned(axis));
        let part = |x: f64, y: f64, z: f64| axes.map(|axis| axis.dot(Seen { x, y, z }));
        Self {
            eye: Point3::new(view.eye[0], view.eye[1], view.eye[2]),
            first: part(view.ray_x(0.0), view.ray_y(0.0), 1.0),
            column: part(1.0 / view.focal, 0.0, 0.0),
            row: part(0.0, 1.0 / view.focal, 0.0),
        }
    }

    /// The direction of a pixel's ray.
    #[inline]
    pub(super) fn direction(&self, column: usize, row: usize) -> Place {
        let (column, row) = (column as f64, row as f64);
        [0, 1, 2].map(|axis| self.first[axis] + self.column[axis] * column + self.row[axis] * row)
    }

    /// Where a ray is at a depth.
    #[inline]
    pub(super) fn at(&self, direction: Place, depth: f64) -> Point {
        Point::new(self.eye.x + direction[0] * depth, self.eye.y + direction[1] * depth)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::{Aabb, Vector3, math};
    use crate::random::Stream;

    fn hills(seed: u64, samples: usize) -> HeightField {
        let mut stream = Stream::new(seed);
        let waves: Vec<_> = (0..6).map(|_| [0; 3].map(|_| stream.between(-4.0, 4.0))).collect();
        let area = Aabb::new(Point::origin(), Point::new(4.0, 3.0));
        HeightField::from_fn(samples, samples, area, |at| {
            waves.iter().map(|[x, y, phase]| 0.1 * math::sin(x * at.x + y * at.y + phase)).sum()
        })
        .unwrap()
    }

    proptest! {
        #![proptest_config(crate::testing::cases(24))]
        /// Each pixel shows what a ray through its middle meets, up to those at ridges.
        #[test]
        fn pictures_show_what_rays_meet(
            seed in any::<u64>(), samples in prop_oneof![Just(9_usize), Just(100), Just(600)],
            (x, y, above) in (0.2..3.8f64, 0.2..2.8f64, 0.05..0.5f64),
            (heading, tilt, roll) in (-3.0..3.0f64, -0.8..0.4f64, -0.6..0.6f64),
        ) {
            let surface = Arc::new(hills(seed, samples));
            let eye = Point3::new(x, y, surface.height(Point::new(x, y)).unwrap() + above);
            let view = View::new(eye.into(), heading, tilt, 1.0, (80, 60)).rolled(roll);
            let (mut canvas, rays) = (Canvas::default(), Rays::of(&view));
            canvas.reset(80, 60);
            Relief::new(Arc::clone(&surface)).draw(&mut canvas, &view);
            let mut wrong = 0;
            for (at, &near) in canvas.nearness.iter().enumerate() {
                let ray = Vector3::from(rays.direction(at % 80, at / 80));
                let depth = surface.cast_ray(eye, ray.normalize(), 100.0) / ray.norm();
                let found = 1.0 / f64::from(near);
                wrong += usize::from(!(found == depth || (found - depth).abs() < 0.01 * depth + 2e-3));
            }
            prop_assert!(wrong < 80 * 60 / 50, "{} pixels", wrong);
        }
    }

    #[test]
    fn level_ground_is_as_bright_as_the_floor() {
        let area = Aabb::new(Point::origin(), Point::new(2.0, 2.0));
        let level = HeightField::from_fn(9, 9, area, |_| 0.3).unwrap();
        let light = Relief::new(Arc::new(level)).light(Point::new(0.7, 1.1), 0.001);
        assert!((255..=256).contains(&light), "{light}");
        let bright = HeightField::from_fn(9, 9, area, |at| -0.5 * at.x).unwrap();
        let dark = HeightField::from_fn(9, 9, area, |at| 0.5 * at.x).unwrap();
        let [bright, dark] =
            [bright, dark].map(|hills| Relief::new(Arc::new(hills)).light(Point::new(1.0, 1.0), 0.01));
        assert!(bright > 260 && dark < 240, "{bright} {dark}");
    }
}
