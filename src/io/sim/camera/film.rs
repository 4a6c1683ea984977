use image::RgbImage;

use super::canvas::{Canvas, whole};
use crate::geometry::math;
use crate::io::sim::NoiseModel;
use crate::random::Stream;

/// Converts a canvas to an image with lighting and the errors of a real camera.
#[derive(Debug)]
pub(super) struct Film {
    stream: Stream,
    /// Exposure error in standard deviations, and the time of the last image (s).
    drift: f64,
    last: f64,
}

/// Correlation time of the exposure error (s).
const DRIFT_TIME: f64 = 4.0;
/// Image width for which the noise model specifies the blur (pixels).
const BLUR_WIDTH: f64 = 320.0;
/// Level below which shot noise no longer decreases.
const DARKEST: f32 = 10.0;

/// Buffers for unfinished images.
#[derive(Debug, Default)]
pub(super) struct Darkroom {
    sharp: Vec<u8>,
    column: Vec<u16>,
    padded: Vec<u8>,
}

impl Film {
    pub(super) fn new(mut stream: Stream) -> Self {
        let drift = stream.normal();
        Self { stream, drift, last: 0.0 }
    }

    /// Makes an image of the canvas.
    pub(super) fn develop(
        &mut self,
        canvas: &Canvas,
        time: f64,
        light: f64,
        noise: &NoiseModel,
        room: &mut Darkroom,
        image: &mut RgbImage,
    ) {
        let gain = light * self.exposure(time, noise.exposure);
        let (width, height) = (canvas.width as u32, canvas.height as u32);
        if image.dimensions() != (width, height) {
            *image = RgbImage::new(width, height);
        }
        // In 256ths; the highest distinguished gain turns the darkest shade white.
        let gain = (gain * 256.0 + 0.5).clamp(0.0, 65_535.0) as u32;
        // A real camera's noise precedes quantisation and hides it; therefore levels are rounded randomly.
        let dither = (noise.shot > 0.0).then(|| self.stream.bits() as u32);
        let weights = blur_weights(noise.blur * f64::from(width) / BLUR_WIDTH);
        if weights.len() > 1 {
            room.sharp.resize(image.len(), 0);
            expose(&canvas.colours, gain, dither, &mut room.sharp);
            blur(room, &weights, width as usize, image);
        } else {
            expose(&canvas.colours, gain, dither, image);
        }
        if noise.shot > 0.0 {
            grain(image, noise.shot as f32, self.stream.bits() as u32);
        }
    }

    /// Factor of overexposure, which varies slowly about 1.
    fn exposure(&mut self, time: f64, sigma: f64) -> f64 {
        if sigma == 0.0 {
            return 1.0;
        }
        let kept = math::exp(-(time - self.last).max(0.0) / DRIFT_TIME);
        if time > self.last {
            self.drift = kept * self.drift + (1.0 - kept * kept).sqrt() * self.stream.normal();
            self.last = time;
        }
        (1.0 + sigma * self.drift).max(0.05)
    }
}

/// Weights of a Gaussian in 256ths, from the centre outwards; one weight if the blur is too small to see.
fn blur_weights(sigma: f64) -> Vec<u16> {
    /// Largest number of pixels of a filter on the stack.
    const WIDEST: usize = 48;
    let variance = sigma * sigma;
    if variance < 0.004 {
        return vec![256];
    }
    let reach = ((3.0 * sigma).ceil() as usize).clamp(1, WIDEST);
    let tails: Vec<f64> = if sigma <= 0.7 {
        // Three weights of exactly this variance; samples of the bell curve would deviate.
        vec![0.5 * variance]
    } else {
        let bell = |k: usize| math::exp(-0.5 * (k * k) as f64 / variance);
        let sum = 1.0 + 2.0 * (1..=reach).map(bell).sum::<f64>();
        (1..=reach).map(|k| bell(k) / sum).collect()
    };
    let tails: Vec<u16> = tails.iter().map(|weight| (256.0 * weight + 0.5) as u16).collect();
    let middle = 256_u16.saturating_sub(2 * tails.iter().sum::<u16>());
    let used = tails.iter().rposition(|&weight| weight > 0).map_or(0, |last| last + 1);
    [&[middle], &tails[..used]].concat()
}

#[multiversion::multiversion(targets("x86_64+avx2+bmi1+bmi2", "x86_64+ssse3+sse4.1"))]
fn expose(colours: &[u32], gain: u32, dither: Option<u32>, image: &mut [u8]) {
    let pixels = image.as_chunks_mut::<3>().0.iter_mut().zip(colours);
    let level =
        |colour: u32, shift: u32, more: u32| (((colour >> shift & 255) * gain + more) >> 8).min(255) as u8;
    match dither {
        None => {
            for (pixel, &colour) in pixels {
                *pixel = [level(colour, 16, 128), level(colour, 8, 128), level(colour, 0, 128)];
            }
        }
        Some(seed) => {
            for ((pixel, &colour), i) in pixels.zip(0_u32..) {
                let random = hash(i, seed);
                let more = |shift: u32| random >> shift & 255;
                *pixel = [level(colour, 16, more(0)), level(colour, 8, more(8)), level(colour, 0, more(16))];
            }
        }
    }
}

/// Blurs the sharp image, columns first, then rows. Edge pixels repeat beyond the edges.
fn blur(room: &mut Darkroom, weights: &[u16], width: usize, image: &mut [u8]) {
    let reach = weights.len() - 1;
    let row_bytes = 3 * width;
    let rows = image.len() / row_bytes;
    room.column.resize(row_bytes, 0);
    room.padded.resize(row_bytes + 6 * reach, 0);
    for (y, out) in image.chunks_exact_mut(row_bytes).enumerate() {
        let row = |y: usize| &room.sharp[y * row_bytes..][..row_bytes];
        room.column.fill(128);
        add(&mut room.column, row(y), weights[0]);
        for (k, &weight) in weights.iter().enumerate().skip(1) {
            add(&mut room.column, row(y.saturating_sub(k)), weight);
            add(&mut room.column, row((y + k).min(rows - 1)), weight);
        }
        let (left, rest) = room.padded.split_at_mut(3 * reach);
        let (middle, right) = rest.split_at_mut(row_bytes);
        halve(&room.column, middle);
        for pixel in left.as_chunks_mut::<3>().0 {
            pixel.copy_from_slice(&middle[..3]);
        }
        for pixel in right.as_chunks_mut::<3>().0 {
            pixel.copy_from_slice(&middle[row_bytes - 3..]);
        }
        room.column.fill(128);
        let shifted = |pixels: usize| &room.padded[3 * pixels..][..row_bytes];
        add(&mut room.column, shifted(reach), weights[0]);
        for (k, &weight) in weights.iter().enumerate().skip(1) {
            add(&mut room.column, shifted(reach - k), weight);
            add(&mut room.column, shifted(reach + k), weight);
        }
        halve(&room.column, out);
    }
}

#[multiversion::multiversion(targets("x86_64+avx2+bmi1+bmi2", "x86_64+ssse3+sse4.1"))]
fn add(sums: &mut [u16], values: &[u8], weight: u16) {
    for (sum, &value) in sums.iter_mut().zip(values) {
        // Weights sum to 256 and values are at most 255, so the rounded sum fits.
        *sum = sum.wrapping_add(u16::from(value) * weight);
    }
}

#[multiversion::multiversion(targets("x86_64+avx2+bmi1+bmi2", "x86_64+ssse3+sse4.1"))]
fn halve(sums: &[u16], out: &mut [u8]) {
    for (out, &sum) in out.iter_mut().zip(sums) {
        *out = (sum >> 8) as u8;
    }
}

/// Adds photon noise: its standard deviation is `sigma` levels on white and proportional to the square root
/// of the brightness.
#[multiversion::multiversion(targets(
    "x86_64+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx2+bmi1+bmi2",
    "x86_64+ssse3+sse4.1",
))]
fn grain(image: &mut [u8], sigma: f32, seed: u32) {
    // Standard deviation of a sum of four bytes.
    let scale = sigma / 147.800_77 / 15.968_72;
    for (i, byte) in (0_u32..).zip(image) {
        let level = f32::from(*byte);
        let noise = f32::from(four_bytes(i, seed)) * scale * level.max(DARKEST).sqrt();
        *byte = whole((level + noise + 0.5).clamp(0.0, 255.0)) as u8;
    }
}

/// An approximately normal random number from -510 to 510: the sum of the four bytes of a hash minus its
/// mean.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a loop compiled for several processors")]
fn four_bytes(index: u32, seed: u32) -> i16 {
    let x = hash(index, seed);
    let sum = (x & 255) + (x >> 8 & 255) + (x >> 16 & 255) + (x >> 24);
    sum as i16 - 510
}

/// A 32-bit hash.
#[inline(always)]
#[allow(clippy::inline_always, reason = "part of a loop compiled for several processors")]
fn hash(index: u32, seed: u32) -> u32 {
    let mut x = index.wrapping_mul(0x9e37_79b9).wrapping_add(seed);
    x = (x ^ x >> 16).wrapping_mul(0x7feb_352d);
    x = (x ^ x >> 15).wrapping_mul(0x846c_a68b);
    x ^ x >> 16
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean and standard deviation.
    fn moments(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
        let count = values.clone().count() as f64;
        let mean = values.clone().sum::<f64>() / count;
        (mean, (values.map(|v| (v - mean) * (v - mean)).sum::<f64>() / count).sqrt())
    }

    #[test]
    fn shot_noise_grows_with_the_square_root_of_the_brightness() {
        for (level, share) in [(250, 0.990_f64), (100, 0.626), (25, 0.313)] {
            let mut image = vec![level; 60_000];
            grain(&mut image, 4.0, 99);
            let (mean, deviation) = moments(image.iter().map(|&v| f64::from(v)));
            // White is clipped on one side, and levels are integers.
            let tolerance = if level == 250 { 0.9 } else { 0.05 };
            assert!((mean - f64::from(level)).abs() < tolerance, "{level}: {mean}");
            let expected = (16.0 * share * share + 1.0 / 12.0).sqrt();
            assert!((deviation - expected).abs() < 0.25 * expected, "{level}: {deviation}, {expected}");
        }
    }

    #[test]
    fn noise_of_neighbours_and_of_other_images_is_independent() {
        let noise = |seed| (0..20_000).map(move |i| f64::from(four_bytes(i, seed)));
        let product = |a: Vec<f64>, b: Vec<f64>| {
            a.iter().zip(&b).map(|(a, b)| a * b).sum::<f64>() / a.len() as f64 / (147.8 * 147.8)
        };
        let a: Vec<f64> = noise(1).collect();
        assert!((moments(noise(1)).1 - 147.8).abs() < 3.0);
        assert!(product(a[1..].to_vec(), a[..a.len() - 1].to_vec()).abs() < 0.03);
        assert!(product(a[3..].to_vec(), a[..a.len() - 3].to_vec()).abs() < 0.03);
        assert!(product(a, noise(2).collect()).abs() < 0.03);
    }

    #[test]
    fn weights_sum_to_one_and_have_the_variance() {
        for sigma in [0.1, 0.3, 0.5, 0.7, 0.8, 1.0, 2.0, 4.0] {
            let weights = blur_weights(sigma);
            let sum: u16 = weights[0] + 2 * weights[1..].iter().sum::<u16>();
            assert_eq!(sum, 256, "{sigma}");
            let square = |(k, &w): (usize, &u16)| 2.0 * (k * k) as f64 * f64::from(w) / 256.0;
            let variance: f64 = weights.iter().enumerate().map(square).sum();
            assert!((variance - sigma * sigma).abs() < 0.08 * sigma * sigma + 0.01, "{sigma}: {variance}");
        }
        assert_eq!(blur_weights(0.0), [256]);
    }

    #[test]
    fn rounding_by_chance_keeps_the_mean() {
        let colours = vec![0x14_28_50; 20_000];
        let mut image = vec![0; 3 * colours.len()];
        // 20, 40 and 80 levels times 1.0117.
        expose(&colours, 259, Some(5), &mut image);
        for (channel, level) in [20.0, 40.0, 80.0].into_iter().enumerate() {
            let (mean, _) = moments(image.iter().skip(channel).step_by(3).map(|&v| f64::from(v)));
            assert!((mean - level * 259.0 / 256.0).abs() < 0.02, "{level}: {mean}");
        }
        expose(&colours, 259, None, &mut image);
        assert_eq!(image[..3], [20, 40, 81]);
    }

    #[test]
    fn a_blur_keeps_even_images_and_spreads_a_point() {
        let mut room = Darkroom { sharp: vec![77; 3 * 5 * 4], ..Darkroom::default() };
        let mut image = vec![0; 3 * 5 * 4];
        blur(&mut room, &blur_weights(0.8), 5, &mut image);
        assert_eq!(image, [77; 3 * 5 * 4]);
        room.sharp.fill(0);
        room.sharp[3 * (5 + 2)] = 255;
        blur(&mut room, &[128, 64], 5, &mut image);
        let red: Vec<u8> = image.iter().copied().step_by(3).collect();
        assert_eq!(red[..15], [0, 16, 32, 16, 0, 0, 32, 64, 32, 0, 0, 16, 32, 16, 0]);
    }

    #[test]
    fn exposure_wanders_about_one() {
        let mut film = Film::new(Stream::new(3));
        let gains: Vec<f64> = (0..4000).map(|i| film.exposure(f64::from(i), 0.03)).collect();
        let (mean, deviation) = moments(gains.iter().copied());
        assert!((mean - 1.0).abs() < 0.006 && (deviation - 0.03).abs() < 0.004, "{mean} {deviation}");
        let step = moments(gains.windows(2).map(|pair| pair[1] - pair[0])).1;
        assert!(step < deviation, "{step}");
        assert_eq!(film.exposure(4000.0, 0.0), 1.0);
    }
}
