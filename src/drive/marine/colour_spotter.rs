use image::RgbImage;

use crate::geometry::math;
use crate::vision::{Components, GrayView, HueLimits, HueScale, ImageError, hue};
use crate::world::Colour;

/// Finds a colour in images of the ground under water.
///
/// The ground is grey and as deep as the objects on it. So its apparent colour, the median of the image,
/// measures the effect of water and light on all colours. Pixels are divided by it before their hues are
/// compared. What is nearer than the ground, such as a ledge, lacks less red, so that gray looks red there: a
/// colour counts only if no distance makes gray of it.
#[derive(Debug, Clone)]
pub(super) struct ColourSpotter {
    /// On RoBIOS's scale.
    hue: u8,
    mask: Vec<u8>,
    components: Components,
}

/// What an image shows of a colour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Sight {
    /// Nothing of it.
    Nothing,
    /// The ground gives back too little light to tell colours.
    Dark,
    /// A thing of it, so many pixels from the middle of the image.
    Thing { column: f64, row: f64 },
}

/// The level that the ground has after division: brighter things have room above it.
const GROUND: u32 = 128;
/// Hues around a circle on RoBIOS's scale, and the most that a hue may differ: 14 degrees.
const AROUND: i32 = 252;
const TOLERANCE: i32 = 10;
/// A quarter of the full saturation: water with its veil takes the rest. Noise makes less of gray ground.
const LIMITS: HueLimits = HueLimits { min_saturation: 64, min_intensity: 8 };
/// Half of it, for what has a colour by all but its red.
const GRAY: HueLimits = HueLimits { min_saturation: 32, ..LIMITS };
/// The least level of a colour's brightest channel: three quarters of the ground's. A thing of a colour
/// reflects that about as well as the gray ground does; what is dark has a colour by noise, or by the veil of
/// turbid water.
const BRIGHT: u8 = 96;
/// By how much more a metre of pure water absorbs of red light than of green light (1/m; Pope and Fry,
/// *Applied Optics* 36, 1997).
const REDDENS: f64 = 0.233;
/// Pixels of the smallest thing.
const LEAST: usize = 12;

impl ColourSpotter {
    pub(super) fn new(colour: Colour) -> Self {
        let Colour { red, green, blue } = colour;
        let hue = hue([red, green, blue], HueScale::Robios, HueLimits::NONE);
        Self { hue, mask: Vec::new(), components: Components::new() }
    }

    /// The largest thing of the colour that is not cut off by the image's edge. The ground is so many metres
    /// below the camera.
    pub(super) fn find(&mut self, image: &RgbImage, altitude: f64) -> Result<Sight, ImageError> {
        let ground = ground(image);
        if ground.contains(&0) {
            return Ok(Sight::Dark);
        }
        let (width, height) = (image.width() as usize, image.height() as usize);
        // Light goes down there, and up again.
        let red = math::exp(-2.0 * REDDENS * altitude);
        self.mask.clear();
        self.mask.extend(image.pixels().map(|pixel| {
            let level =
                |channel: usize| (u32::from(pixel.0[channel]) * GROUND / ground[channel]).min(255) as u8;
            let levels = [level(0), level(1), level(2)];
            let found = hue(levels, HueScale::Robios, LIMITS);
            let off = (i32::from(found) - i32::from(self.hue)).rem_euclid(AROUND);
            let is_bright = levels.iter().any(|level| *level >= BRIGHT);
            // The red, of all that it may be at the ground's distance, which is the most like gray.
            let least = (f64::from(levels[0]) * red) as u8;
            let gray = [levels[1].max(levels[2]).clamp(least, levels[0]), levels[1], levels[2]];
            let is_coloured = is_bright && i32::from(hue(gray, HueScale::Robios, GRAY)) < AROUND;
            u8::from(is_coloured && i32::from(found) < AROUND && off.min(AROUND - off) <= TOLERANCE)
        }));
        let mask = GrayView::new(&self.mask, width, height)?;
        let whole = self.components.find(mask, LEAST).iter().filter(|blob| {
            blob.min.0 > 0 && blob.min.1 > 0 && blob.max.0 + 1 < width && blob.max.1 + 1 < height
        });
        let largest = whole.max_by_key(|blob| blob.area);
        Ok(largest.map_or(Sight::Nothing, |blob| {
            let (column, row) = blob.centroid;
            let (column, row) = (column + 0.5 - 0.5 * width as f64, row + 0.5 - 0.5 * height as f64);
            Sight::Thing { column, row }
        }))
    }
}

/// The median of each channel.
fn ground(image: &RgbImage) -> [u32; 3] {
    let mut counts = [[0_u32; 256]; 3];
    for pixel in image.pixels() {
        for (counts, &level) in counts.iter_mut().zip(&pixel.0) {
            counts[usize::from(level)] += 1;
        }
    }
    let half = image.width() * image.height() / 2;
    counts.map(|counts| {
        let mut below = 0;
        let median = counts.iter().position(|count| {
            below += count;
            below > half
        });
        median.unwrap_or(0) as u32
    })
}

#[cfg(test)]
mod tests {
    use image::Rgb;

    use super::*;

    /// A gray ground with a patch of a colour, seen through water that takes most of the red.
    fn picture(patch: [u8; 3], light: f64) -> RgbImage {
        RgbImage::from_fn(40, 30, |x, y| {
            let colour = if (10..18).contains(&x) && (20..25).contains(&y) { patch } else { [196; 3] };
            let seen = |channel: usize, share: f64| (f64::from(colour[channel]) * share * light) as u8;
            Rgb([seen(0, 0.4), seen(1, 0.85), seen(2, 0.95)])
        })
    }

    #[test]
    fn a_colour_is_found_through_water_and_in_little_light() {
        let mut spotter = ColourSpotter::new(Colour::RED);
        for light in [0.3, 1.0] {
            let sight = spotter.find(&picture([200, 30, 30], light), 1.2).unwrap();
            assert_eq!(sight, Sight::Thing { column: -6.0, row: 7.5 });
        }
    }

    #[test]
    fn other_colours_gray_things_and_darkness_are_none() {
        let mut spotter = ColourSpotter::new(Colour::RED);
        for other in
            [[230, 140, 20], [40, 60, 200], [30, 160, 60], [60, 60, 60], [90, 30, 30], [250, 250, 250]]
        {
            assert_eq!(spotter.find(&picture(other, 1.0), 1.2).unwrap(), Sight::Nothing, "{other:?}");
        }
        assert_eq!(spotter.find(&picture([200, 30, 30], 0.0), 1.2).unwrap(), Sight::Dark);
        // Gray ledges below the surface, with most of their red; the last ones in the shade.
        let ground = [90, 166, 186];
        for (ledge, ground) in
            [([170, 190, 194], ground), ([102, 114, 116], ground), ([90, 129, 132], [69, 139, 147])]
        {
            let picture = RgbImage::from_fn(40, 30, |x, y| {
                Rgb(if (10..18).contains(&x) && (20..25).contains(&y) { ledge } else { ground })
            });
            assert_eq!(spotter.find(&picture, 1.5).unwrap(), Sight::Nothing, "{ledge:?}");
        }
    }
}
