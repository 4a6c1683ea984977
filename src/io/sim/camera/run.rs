use super::canvas::{Packed, whole};
use super::texture::{Level, between};

/// Pixels of a row that are worked on together, step by step: so the compiler makes each step one for many.
const AT_ONCE: usize = 64;
/// More texels than a row crosses, and a multiple of every pattern's side.
const SHIFT: f32 = 131_072.0;

/// Texels along a row: the first position and the step.
pub(super) struct Run {
    pub(super) u: f64,
    pub(super) v: f64,
    pub(super) du: f64,
    pub(super) dv: f64,
}

impl Run {
    /// Bilinear interpolation for pixels smaller than texels. Edge texels repeat beyond the edge.
    pub(super) fn smooth(&self, level: &Level, pixels: &mut [Packed]) {
        let mut corners = Corners::default();
        for (block, pixels) in pixels.chunks_mut(AT_ONCE).enumerate() {
            let Self { u, v, du, dv } = *self;
            let line = [u as f32 - 0.5, v as f32 - 0.5, du as f32, dv as f32];
            locate(&mut corners, line, block * AT_ONCE, (level.width, level.height));
            corners.look_up(&level.texels, pixels.len());
            mix(&corners, pixels);
        }
    }

    /// Averages the texels of some runs, a power of two in number. Positions that rounding moves off the
    /// image use the nearest texel.
    pub(super) fn averaged(runs: &[Self], level: &Level, pixels: &mut [Packed]) {
        let shift = runs.len().trailing_zeros();
        let half = runs.len() as u32 / 2;
        for (block, pixels) in pixels.chunks_mut(AT_ONCE).enumerate() {
            // Two channels at a time, each with headroom for the sum.
            let (mut ends, mut middles) = ([half << 16 | half; AT_ONCE], [half; AT_ONCE]);
            for &Self { u, v, du, dv } in runs {
                let mut places = [0; AT_ONCE];
                nearest([u, v, du, dv], block * AT_ONCE, (level.width, level.height), &mut places);
                let sums = ends.iter_mut().zip(&mut middles).zip(&places);
                for ((ends, middle), &place) in sums.take(pixels.len()) {
                    let texel = level.texels[place as usize];
                    *ends += texel & 0xff_00_ff;
                    *middle += texel >> 8 & 0xff;
                }
            }
            for ((pixel, ends), middle) in pixels.iter_mut().zip(ends).zip(middles) {
                *pixel = ends >> shift & 0xff_00_ff | (middle >> shift) << 8;
            }
        }
    }

    /// Samples a repeated pattern whose sides are powers of two.
    pub(super) fn repeated(&self, level: &Level, pixels: &mut [Packed]) {
        let side = level.width as f64;
        let home = |place: f64| place - side * (place / side).floor();
        let (u, v, du, dv) = (home(self.u) as f32, home(self.v) as f32, self.du as f32, self.dv as f32);
        let (mask, side) = (level.width as i32 - 1, level.width as i32);
        for (i, pixel) in (0_u32..).zip(pixels) {
            // Positions may be negative; the shift turns truncation into rounding down.
            let x = (u + du * i as f32 + SHIFT) as i32 & mask;
            let y = (v + dv * i as f32 + SHIFT) as i32 & mask;
            *pixel = level.texels[(y * side + x) as usize];
        }
    }
}

/// Bilinear interpolation at a single position, in texels from the upper left corner. Edge texels repeat
/// beyond the edge.
pub(super) fn smooth_at(level: &Level, u: f64, v: f64) -> Packed {
    let within = |place: f64, size: usize| (place as f32 - 0.5).max(0.0).min(size as f32 - 1.0);
    let (x, y) = (within(u, level.width), within(v, level.height));
    let (column, row) = (whole(x) as usize, whole(y) as usize);
    let (next, below) = ((column + 1).min(level.width - 1), (row + 1).min(level.height - 1));
    let (to_right, down) = (whole(256.0 * (x - x.floor())), whole(256.0 * (y - y.floor())));
    let at = |column: usize, row: usize| level.texels[row * level.width + column];
    let (upper, lower) = ([at(column, row), at(next, row)], [at(column, below), at(next, below)]);
    let [upper, lower] = [upper, lower].map(|[left, right]| between(left, right, to_right));
    between(upper, lower, down) & 0xff_ff_ff
}

/// The four texels around each of some pixels.
struct Corners {
    /// Index of the upper left one, and what the right and the lower ones are beyond it.
    first: [u32; AT_ONCE],
    right: [u32; AT_ONCE],
    below: [u32; AT_ONCE],
    /// 256ths of the way from the left to the right, and down.
    to_right: [u32; AT_ONCE],
    down: [u32; AT_ONCE],
    texels: [[Packed; AT_ONCE]; 4],
}

impl Default for Corners {
    fn default() -> Self {
        let none = [0; AT_ONCE];
        Self { first: none, right: none, below: none, to_right: none, down: none, texels: [none; 4] }
    }
}

impl Corners {
    fn look_up(&mut self, texels: &[Packed], pixels: usize) {
        for i in 0..pixels.min(AT_ONCE) {
            let (first, right, below) =
                (self.first[i] as usize, self.right[i] as usize, self.below[i] as usize);
            self.texels[0][i] = texels[first];
            self.texels[1][i] = texels[first + right];
            self.texels[2][i] = texels[first + below];
            self.texels[3][i] = texels[first + below + right];
        }
    }
}

/// Where the texels around the pixels from one on are, for a line of positions.
#[multiversion::multiversion(targets("x86_64+avx2+bmi1+bmi2", "x86_64+ssse3+sse4.1"))]
fn locate(corners: &mut Corners, [u, v, du, dv]: [f32; 4], from: usize, (width, height): (usize, usize)) {
    let last = |size: usize| (size as u32 - 1, size as f32 - 1.0);
    let ((last_column, right), (last_row, bottom)) = (last(width), last(height));
    for i in 0..AT_ONCE {
        let along = (from + i) as u32 as f32;
        let (x, y) = ((u + du * along).max(0.0).min(right), (v + dv * along).max(0.0).min(bottom));
        let (column, row) = (whole(x), whole(y));
        corners.first[i] = row * width as u32 + column;
        corners.right[i] = u32::from(column < last_column);
        corners.below[i] = if row < last_row { width as u32 } else { 0 };
        corners.to_right[i] = whole(256.0 * (x - x.floor()));
        corners.down[i] = whole(256.0 * (y - y.floor()));
    }
}

/// The colours between the texels.
#[multiversion::multiversion(targets("x86_64+avx2+bmi1+bmi2", "x86_64+ssse3+sse4.1"))]
fn mix(corners: &Corners, pixels: &mut [Packed]) {
    let [a, b, c, d] = &corners.texels;
    for (i, pixel) in pixels.iter_mut().enumerate().take(AT_ONCE) {
        let (top, bottom) =
            (between(a[i], b[i], corners.to_right[i]), between(c[i], d[i], corners.to_right[i]));
        *pixel = between(top, bottom, corners.down[i]) & 0xff_ff_ff;
    }
}

/// The texels nearest to the pixels from one on.
#[multiversion::multiversion(targets("x86_64+avx2+bmi1+bmi2", "x86_64+ssse3+sse4.1"))]
fn nearest(
    [u, v, du, dv]: [f64; 4],
    from: usize,
    (width, height): (usize, usize),
    places: &mut [u32; AT_ONCE],
) {
    let (right, bottom) = (width as f64 - 1.0, height as f64 - 1.0);
    for (i, place) in (from as u32..).zip(places) {
        let x = (u + du * f64::from(i)).max(0.0).min(right);
        let y = (v + dv * f64::from(i)).max(0.0).min(bottom);
        *place = whole(y.floor() as f32) * width as u32 + whole(x.floor() as f32);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An irregular picture.
    fn picture() -> Level {
        let (width, height) = (37, 21);
        let texels = (0..width * height).map(|i| (i as u32).wrapping_mul(0x9e37_79b9) >> 8);
        Level { width, height, texels: texels.collect() }
    }

    /// Rows of no whole number of blocks, that begin or end beyond the picture.
    const RUNS: [Run; 4] = [
        Run { u: -3.0, v: 4.2, du: 0.31, dv: 0.02 },
        Run { u: 40.0, v: 25.0, du: -0.27, dv: -0.19 },
        Run { u: 12.5, v: 7.5, du: 0.0, dv: 0.0 },
        Run { u: 1e9, v: f64::NAN, du: 0.1, dv: 0.1 },
    ];

    #[test]
    fn many_pixels_at_once_are_as_one_after_the_other() {
        let level = picture();
        for run in &RUNS {
            let mut pixels = [0; 150];
            run.smooth(&level, &mut pixels);
            for (i, pixel) in (0..).zip(pixels) {
                let place =
                    |from: f64, step: f64| f64::from(from as f32 - 0.5 + step as f32 * i as f32 + 0.5);
                let alone = smooth_at(&level, place(run.u, run.du), place(run.v, run.dv));
                let near = |shift: u32| (pixel >> shift & 255).abs_diff(alone >> shift & 255) < 4;
                assert!(near(0) && near(8) && near(16), "{i}: {pixel:x} {alone:x}");
            }
        }
    }

    #[test]
    fn means_are_those_of_the_nearest_texels() {
        let level = picture();
        let mut pixels = [0; 150];
        Run::averaged(&RUNS, &level, &mut pixels);
        for (i, pixel) in (0..).zip(pixels) {
            let nearest = |place: f64, size: usize| (place as i64).clamp(0, size as i64 - 1) as usize;
            let texels = RUNS.map(|Run { u, v, du, dv }| {
                let (u, v) = (u + du * f64::from(i), v + dv * f64::from(i));
                level.texels[nearest(v, level.height) * level.width + nearest(u, level.width)]
            });
            for shift in [0, 8, 16] {
                let sum: u32 = texels.iter().map(|texel| texel >> shift & 255).sum();
                assert_eq!(pixel >> shift & 255, (sum + 2) / 4, "{i}");
            }
        }
    }
}
