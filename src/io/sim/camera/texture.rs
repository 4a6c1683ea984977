use image::RgbImage;

use super::canvas::Packed;
use super::light::scaled;
use crate::world::Colour;

/// A picture for a surface, beside smaller versions of itself for looking at it from afar.
#[derive(Debug, Clone)]
pub(super) struct Texture {
    levels: Vec<Level>,
}

/// One version of a texture.
#[derive(Debug, Clone)]
pub(super) struct Level {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) texels: Vec<Packed>,
}

impl Texture {
    /// A texture of an image, every channel multiplied by a factor from 0 to 1. `None` for an image without pixels.
    pub(super) fn new(image: &RgbImage, factor: f64) -> Option<Self> {
        let texels = image.pixels().map(|&image::Rgb([r, g, b])| scaled(Colour::new(r, g, b), factor));
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

    /// The version to look at when a pixel covers so many texels of the largest one, and how often it was halved.
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
    /// Half as wide and half as high, each texel the mean of four.
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

fn mean(texels: [Packed; 4]) -> Packed {
    let channel = |shift: u32| {
        let sum: u32 = texels.iter().map(|texel| (texel >> shift) & 255).sum();
        ((sum + 2) / 4) << shift
    };
    channel(16) | channel(8) | channel(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smaller_versions_keep_the_mean() {
        let image = RgbImage::from_fn(8, 4, |x, y| image::Rgb([(30 * x) as u8, (50 * y) as u8, 7]));
        let texture = Texture::new(&image, 1.0).unwrap();
        let sizes: Vec<_> = texture.levels.iter().map(|level| (level.width, level.height)).collect();
        assert_eq!(sizes, [(8, 4), (4, 2), (2, 1), (1, 1)]);
        let last = texture.levels[3].texels[0];
        assert!((last >> 16).abs_diff(105) <= 2 && ((last >> 8) & 255).abs_diff(75) <= 2 && last & 255 == 7);
        assert_eq!(texture.level(1.0).1, 0);
        assert_eq!(texture.level(2.0).1, 1);
        assert_eq!(texture.level(1e9).1, 3);
    }

    #[test]
    fn odd_sizes_and_single_rows_shrink_to_one_texel() {
        let texture = Texture::new(&RgbImage::from_pixel(5, 1, image::Rgb([9, 8, 7])), 1.0).unwrap();
        assert_eq!(texture.levels.last().map(|level| level.texels.clone()), Some(vec![0x09_08_07]));
        assert!(Texture::new(&RgbImage::new(0, 3), 1.0).is_none());
    }
}
