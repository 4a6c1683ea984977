//! Draws what was found in an image and describes it.

use image::{GrayImage, Rgb, RgbImage};
use roverlab::geometry::{math, units};
use roverlab::vision::{Blob, Components, Hog, HoughLine, ImageError, LineSegment, gray_to_rgb_into};
use serde_json::{Value, json};

use super::Processed;
use crate::common::rounded;

const MARK: Rgb<u8> = Rgb([255, 40, 40]);

/// Darkened, so that marks stand out.
fn dimmed(edges: &GrayImage) -> RgbImage {
    let mut output = RgbImage::new(edges.width(), edges.height());
    let (Ok(input), Ok(view)) = (edges.try_into(), (&mut output).try_into()) else { return output };
    if gray_to_rgb_into(input, view).is_ok() {
        output.iter_mut().for_each(|byte| *byte /= 2);
    }
    output
}

/// Straight lines from border to border.
pub(crate) fn lines(edges: &GrayImage, lines: &[HoughLine]) -> Processed {
    let mut image = dimmed(edges);
    for line in lines {
        let (sin, cos) = math::sin_cos(line.theta);
        let middle = (line.rho * cos, line.rho * sin);
        let reach = f64::from(edges.width() + edges.height());
        let end = |side: f64| (middle.0 - side * reach * sin, middle.1 + side * reach * cos);
        draw_line(&mut image, end(-1.0), end(1.0));
    }
    let value = |line: &HoughLine| {
        json!({
            "rho": rounded(line.rho),
            "theta_deg": rounded(units::to_deg(line.theta)),
            "votes": line.votes,
        })
    };
    let lines: Vec<Value> = lines.iter().map(value).collect();
    Processed { image: image.into(), fields: vec![("lines", lines.into())] }
}

/// Line segments.
pub(crate) fn segments(edges: &GrayImage, segments: &[LineSegment]) -> Processed {
    let mut image = dimmed(edges);
    let place = |(x, y): (usize, usize)| (x as f64, y as f64);
    for segment in segments {
        draw_line(&mut image, place(segment.from), place(segment.to));
    }
    let value = |s: &LineSegment| json!([s.from.0, s.from.1, s.to.0, s.to.1]);
    let lines: Vec<Value> = segments.iter().map(value).collect();
    Processed { image: image.into(), fields: vec![("lines", lines.into())] }
}

fn draw_line(image: &mut RgbImage, from: (f64, f64), to: (f64, f64)) {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let steps = dx.abs().max(dy.abs()).ceil().max(1.0);
    for step in 0..=steps as u32 {
        let t = f64::from(step) / steps;
        let (x, y) = ((from.0 + t * dx).round(), (from.1 + t * dy).round());
        if x >= 0.0 && y >= 0.0 {
            put(image, x as u32, y as u32);
        }
    }
}

fn put(image: &mut RgbImage, x: u32, y: u32) {
    if let Some(pixel) = image.get_pixel_mut_checked(x, y) {
        *pixel = MARK;
    }
}

/// Connected components, with their boxes drawn over the image.
pub(crate) fn blobs(input: &RgbImage, mask: &GrayImage, min_area: usize) -> Result<Processed, ImageError> {
    let mut components = Components::new();
    let blobs = components.find(mask.try_into()?, min_area);
    let mut image = input.clone();
    for blob in blobs {
        for x in blob.min.0..=blob.max.0 {
            put(&mut image, x as u32, blob.min.1 as u32);
            put(&mut image, x as u32, blob.max.1 as u32);
        }
        for y in blob.min.1..=blob.max.1 {
            put(&mut image, blob.min.0 as u32, y as u32);
            put(&mut image, blob.max.0 as u32, y as u32);
        }
    }
    let value = |blob: &Blob| {
        json!({
            "area": blob.area,
            "x": rounded(blob.centroid.0),
            "y": rounded(blob.centroid.1),
            "min": [blob.min.0, blob.min.1],
            "max": [blob.max.0, blob.max.1],
        })
    };
    let found: Vec<Value> = blobs.iter().map(value).collect();
    Ok(Processed { image: image.into(), fields: vec![("blobs", found.into())] })
}

/// Length and digest of the descriptor, and its values if requested; the picture shows the strength of each
/// cell's strongest direction.
pub(crate) fn hog(gray: &GrayImage, hog: &mut Hog, whole: bool) -> Result<Processed, ImageError> {
    let view: roverlab::vision::GrayView<'_> = gray.try_into()?;
    let (across, down) = hog.blocks(view.size());
    let descriptor = hog.describe(view)?;
    let each = descriptor.len() / (across * down).max(1);
    let strongest = descriptor.chunks(each.max(1)).map(|block| {
        let most = block.iter().copied().fold(0.0_f32, f32::max);
        (most * 255.0) as u8
    });
    let picture = GrayImage::from_raw(across as u32, down as u32, strongest.collect()).unwrap_or_default();
    // FNV-1a over the bits, equal on every platform.
    let digest = descriptor
        .iter()
        .flat_map(|value| value.to_bits().to_le_bytes())
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
        });
    let mut fields = vec![
        ("descriptor_length", json!(descriptor.len())),
        ("descriptor_digest", json!(format!("{digest:016x}"))),
    ];
    if whole {
        fields.push(("descriptor", json!(descriptor)));
    }
    Ok(Processed { image: picture.into(), fields })
}
