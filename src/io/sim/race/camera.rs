//! What the camera above a car's driver sees: sky, asphalt and cones.

use image::{Rgb, RgbImage};

use super::world::{Obstacle, Race};
use crate::geometry::{Pose, math};
use crate::random::Stream;

/// Where the camera of a racing car is, and how it looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RaceCamera {
    /// Metres from the rear axle.
    pub forward: f64,
    /// Metres above the ground.
    pub height: f64,
    /// Radians by which it looks down.
    pub pitch: f64,
    /// Radians from the left to the right edge of an image.
    pub field_of_view: f64,
}

impl RaceCamera {
    /// That of every car: above the driver's head.
    pub const MOUNTED: Self = Self { forward: 0.6, height: 1.1, pitch: 0.16, field_of_view: 1.75 };
}

const SKY: [u8; 3] = [176, 200, 222];
const GROUND: [u8; 3] = [92, 92, 96];
/// Metres that cones are seen.
const FARTHEST: f64 = 30.0;
/// The width of a cone's tip as a share of that of its foot.
const TIP: f64 = 0.2;

impl Race {
    /// Takes an image into one of the right size.
    pub(super) fn draw(&mut self, index: usize, image: &mut RgbImage) {
        let car = &self.cars[index];
        let camera = RaceCamera::MOUNTED;
        let pose = car.body.pose(&car.spec);
        let eye = pose.compose(&Pose::new(camera.forward, 0.0, 0.0));
        let (width, height) = (f64::from(image.width()), f64::from(image.height()));
        let focal = 0.5 * width / math::tan(0.5 * camera.field_of_view);
        let (sin, cos) = math::sin_cos(camera.pitch);
        let horizon = (0.5 * height - focal * sin / cos).clamp(0.0, height) as u32;
        let columns = image.width();
        for (y, row) in image.chunks_exact_mut(3 * columns as usize).enumerate() {
            let paint = if (y as u32) < horizon { SKY } else { GROUND };
            for pixel in row.chunks_exact_mut(3) {
                pixel.copy_from_slice(&paint);
            }
        }
        let mut seen: Vec<(f64, &Obstacle)> = self
            .cones
            .iter()
            .filter(|cone| cone.stands)
            .map(|cone| (eye.to_local(cone.cone.position).x, cone))
            .filter(|(ahead, cone)| *ahead > 0.3 && (cone.cone.position - eye.position()).norm() < FARTHEST)
            .collect();
        seen.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (_, Obstacle { cone, .. }) in seen {
            let local = eye.to_local(cone.position);
            // A point of the axis at a height: row and pixels for a metre.
            let project = |z: f64| {
                let up = z - camera.height;
                let depth = local.x * cos - up * sin;
                let above = local.x * sin + up * cos;
                (0.5 * height - focal * above / depth, 0.5 * width - focal * local.y / depth, focal / depth)
            };
            let (foot, tip) = (project(0.0), project(cone.height));
            let rows = (foot.0 - tip.0).max(1e-6);
            let (first, last) = (tip.0.round().max(0.0) as u32, foot.0.round().clamp(0.0, height) as u32);
            for y in first..last {
                let down = ((f64::from(y) + 0.5 - tip.0) / rows).clamp(0.0, 1.0);
                let half = cone.radius * foot.2 * (TIP + (1.0 - TIP) * down);
                let centre = tip.1 + (foot.1 - tip.1) * down;
                let (from, to) =
                    ((centre - half).round().max(0.0) as u32, (centre + half).round().max(0.0) as u32);
                for x in from..to.min(columns) {
                    image.put_pixel(x, y, Rgb([cone.colour.red, cone.colour.green, cone.colour.blue]));
                }
            }
        }
        let shot = self.options.noise.shot;
        if shot > 0.0 {
            noise(image, shot, &mut self.cars[index].camera);
        }
    }
}

/// Adds noise of a standard deviation to every channel. Uniform, as each draw makes eight of them.
fn noise(image: &mut RgbImage, deviation: f64, random: &mut Stream) {
    // A byte's deviation is 256 / √12.
    let gain = (deviation * 256.0 / 73.9) as i32;
    for chunk in image.chunks_mut(8) {
        let bytes = random.bits().to_le_bytes();
        for (level, byte) in chunk.iter_mut().zip(bytes) {
            let change = ((i32::from(byte) - 128) * gain) >> 8;
            *level = (i32::from(*level) + change).clamp(0, 255) as u8;
        }
    }
}
