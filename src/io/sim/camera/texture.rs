use image::RgbaImage;

use super::canvas::Packed;
use crate::world::Colour;

/// A texel: a colour, with the opacity (0 to 255) in the bits above.
pub(super) type Texel = u32;

/// Smallest visible opacity.
const OPAQUE: Texel = 128;

/// A surface image with mipmaps.
#[derive(Debug, Clone)]
pub(super) struct Texture {
    levels: Vec<Level>,
}

/// One mipmap level of a texture.
#[derive(Debug, Clone)]
pub(super) struct Level {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) texels: Vec<Texel>,
}

impl Texture {
    /// The texture of an image, with its channels multiplied by those of a colour. `None` for an empty image.
    pub(super) fn new(image: &RgbaImage, colour: Colour) -> Option<Self> {
        let by = [colour.red, colour.green, colour.blue].map(u32::from);
        let part = |value: u8, by: u32| (u32::from(value) * by + 127) / 255;
        let texels = image.pixels().map(|&image::Rgba([r, g, b, opacity])| {
            let [r, g, b] = [part(r, by[0]), part(g, by[1]), part(b, by[2])];
            u32::from(opacity) << 24 | r << 16 | g << 8 | b
        });
        let (width, height) = (image.width() as usize, image.height() as usize);
        let first = Level { width, height, texels: texels.collect() };
        (width > 0 && height > 0).then(|| Self::with_smaller_ones(first))
    }

    pub(super) fn with_smaller_ones(first: Level) -> Self {
        let mut levels = vec![first];
        while let Some(smaller) = levels.last().and_then(Level::halved) {
            levels.push(smaller);
        }
        Self { levels }
    }

    /// The level for a pixel that covers this number of full-size texels, and its number of halvings.
    pub(super) fn level(&self, texels_per_pixel: f64) -> (&Level, u32) {
        let mut halvings = 0;
        let mut size = texels_per_pixel;
        while size > 1.5 && halvings + 1 < self.levels.len() {
            size *= 0.5;
            halvings += 1;
        }
        (&self.levels[halvings], halvings as u32)
    }
}

impl Level {
    /// Bilinear colour at a position in texels from the upper left corner; `None` where it is mostly
    /// transparent. The image repeats beyond its edges.
    pub(super) fn smooth(&self, u: f32, v: f32) -> Option<Packed> {
        let (u, v) = (u - 0.5, v - 0.5);
        let (left, above) = (u.floor(), v.floor());
        let (right_share, below_share) = ((256.0 * (u - left)) as u32, (256.0 * (v - above)) as u32);
        let column = |place: f32| (place as i64).rem_euclid(self.width as i64) as usize;
        let row = |place: f32| (place as i64).rem_euclid(self.height as i64) as usize * self.width;
        let (columns, rows) = ([column(left), column(left + 1.0)], [row(above), row(above + 1.0)]);
        let at = |x: usize, y: usize| self.texels[rows[y] + columns[x]];
        let texel = between(
            between(at(0, 0), at(1, 0), right_share),
            between(at(0, 1), at(1, 1), right_share),
            below_share,
        );
        (texel >> 24 >= OPAQUE).then_some(texel & 0xff_ff_ff)
    }

    /// The image at half size; each texel is the mean of four.
    fn halved(&self) -> Option<Self> {
        if self.width == 1 && self.height == 1 {
            return None;
        }
        let (width, height) = (self.width.div_ceil(2), self.height.div_ceil(2));
        let mut texels = Vec::with_capacity(width * height);
        for y in 0..height {
            for x in 0..width {
                let (right, below) = ((2 * x + 1).min(self.width - 1), (2 * y + 1).min(self.height - 1));
                let at = |x: usize, y: usize| self.texels[y * self.width + x];
                let four = [at(2 * x, 2 * y), at(right, 2 * y), at(2 * x, below), at(right, below)];
                texels.push(mean(four));
            }
        }
        Some(Self { width, height, texels })
    }
}

fn mean(texels: [Texel; 4]) -> Texel {
    let channel = |shift: u32| {
        let sum: u32 = texels.iter().map(|texel| (texel >> shift) & 255).sum();
        ((sum + 2) / 4) << shift
    };
    channel(24) | channel(16) | channel(8) | channel(0)
}

/// Interpolates between two texels: `share` 256ths of the way from the first to the second.
#[inline]
pub(super) fn between(a: Texel, b: Texel, share: u32) -> Texel {
    // Two channels at a time, each with headroom for the product.
    /// Mask of every other byte of a pixel.
    const HALF: u32 = 0x00ff_00ff;
    let mixed = |a: u32, b: u32| ((a & HALF) * (256 - share) + (b & HALF) * share) >> 8 & HALF;
    mixed(a >> 8, b >> 8) << 8 | mixed(a, b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smaller_versions_keep_the_mean() {
        let image = RgbaImage::from_fn(8, 4, |x, y| image::Rgba([(30 * x) as u8, (50 * y) as u8, 7, 255]));
        let texture = Texture::new(&image, Colour::WHITE).unwrap();
        let sizes: Vec<_> = texture.levels.iter().map(|level| (level.width, level.height)).collect();
        assert_eq!(sizes, [(8, 4), (4, 2), (2, 1), (1, 1)]);
        let last = texture.levels[3].texels[0];
        assert!(
            ((last >> 16) & 255).abs_diff(105) <= 2
                && ((last >> 8) & 255).abs_diff(75) <= 2
                && last & 255 == 7
        );
        assert_eq!(texture.level(1.0).1, 0);
        assert_eq!(texture.level(2.0).1, 1);
        assert_eq!(texture.level(1e9).1, 3);
    }

    #[test]
    fn odd_sizes_and_single_rows_shrink_to_one_texel() {
        let image = RgbaImage::from_pixel(5, 1, image::Rgba([9, 8, 7, 255]));
        let texture = Texture::new(&image, Colour::WHITE).unwrap();
        assert_eq!(texture.levels.last().map(|level| level.texels.clone()), Some(vec![0xff_09_08_07]));
        assert!(Texture::new(&RgbaImage::new(0, 3), Colour::WHITE).is_none());
    }

    #[test]
    fn between_texels_colours_change_evenly_and_middles_keep_theirs() {
        let image = RgbaImage::from_fn(4, 2, |x, y| image::Rgba([(80 * x) as u8, (100 * y) as u8, 0, 255]));
        let texture = Texture::new(&image, Colour::WHITE).unwrap();
        let (level, _) = texture.level(0.1);
        let at = |u, v| level.smooth(u, v).unwrap().to_be_bytes();
        assert_eq!(at(1.5, 0.5), [0, 80, 0, 0]);
        assert_eq!(at(2.0, 1.0), [0, 120, 50, 0]);
        // The image repeats beyond the right edge.
        assert_eq!(at(4.0, 0.5), [0, 120, 0, 0]);
        assert_eq!(at(-2.5, 2.5), [0, 80, 0, 0]);
    }

    #[test]
    fn what_is_more_transparent_than_not_is_not_there() {
        let image = RgbaImage::from_fn(2, 1, |x, _| image::Rgba([9, 9, 9, if x == 0 { 0 } else { 255 }]));
        let texture = Texture::new(&image, Colour::WHITE).unwrap();
        let (level, _) = texture.level(1.0);
        assert_eq!((level.smooth(0.5, 0.5), level.smooth(1.5, 0.5)), (None, Some(0x09_09_09)));
    }
}
