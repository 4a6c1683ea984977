use image::GrayImage;

use crate::geometry::math;
use crate::vision::{Error, GrayView};

/// Takes the robot's own turn out of an image, so that what is left of its change is the motion of others (book, section
/// 11.6).
///
/// A camera that turns about its own axis sees the world through another rotation, whatever the distances: each pixel's
/// line of sight is turned back, and the image is read where it came from. A camera that sits ahead of the axis moves a
/// little as well, which shifts what is near; [`MotionParameters::slack`](super::MotionParameters::slack) is for that.
#[derive(Debug, Clone)]
pub struct TurnCompensator {
    field_of_view: f64,
    turned: GrayImage,
    trial: Vec<f64>,
}

/// Pixels by which odometry's turn may be wrong, and the steps in which the best one is looked for.
const SEARCH: f64 = 1.5;
const STEP: f64 = 0.25;

impl TurnCompensator {
    /// For a level camera with a horizontal field of view in radians.
    pub fn new(field_of_view: f64) -> Result<Self, Error> {
        if !(field_of_view > 0.0 && field_of_view < 3.0) {
            let expected = "more than 0 and below 3 radians";
            return Err(Error::Parameter { parameter: "field of view", found: field_of_view, expected });
        }
        Ok(Self { field_of_view, turned: GrayImage::default(), trial: Vec::new() })
    }

    /// The first image as the camera would have seen it after turning left by `angle`, beside the columns, from one to
    /// before the other, that both images show. The angle is that of odometry; what the images say corrects it.
    pub fn turn(
        &mut self,
        first: GrayView<'_>,
        second: GrayView<'_>,
        angle: f64,
    ) -> Result<(&GrayImage, usize, usize), Error> {
        crate::vision::view::require_size("second image", second.size(), first.size())?;
        let (width, height) = first.size();
        let focal = 0.5 * width as f64 / math::tan(0.5 * self.field_of_view);
        let steps = (2.0 * SEARCH / STEP) as i32;
        let angles = (0..=steps).map(|i| angle + (STEP * f64::from(i) - SEARCH) / focal);
        self.trial.clear();
        for angle in angles.clone() {
            self.trial.push(mismatch(first, second, angle, focal));
        }
        let best = (0..self.trial.len()).min_by(|&a, &b| self.trial[a].total_cmp(&self.trial[b]));
        let best = best.and_then(|best| angles.clone().nth(best)).unwrap_or(angle);
        if self.turned.dimensions() != (width as u32, height as u32) {
            self.turned = GrayImage::new(width as u32, height as u32);
        }
        let (mut from, mut to) = (width, 0);
        for x in 0..width {
            let Some((column, scale)) = source(x as f64, width, best, focal) else { continue };
            (from, to) = (from.min(x), x + 1);
            for y in 0..height {
                let middle = 0.5 * (height as f64 - 1.0);
                let row = middle + (y as f64 - middle) * scale;
                self.turned.put_pixel(x as u32, y as u32, image::Luma([sample(first, column, row)]));
            }
        }
        Ok((&self.turned, from.min(to), to))
    }
}

/// The column of an image that a column of the turned one shows, and the factor of distances from the middle row.
fn source(x: f64, width: usize, angle: f64, focal: f64) -> Option<(f64, f64)> {
    let middle = 0.5 * (width as f64 - 1.0);
    // To the left of straight ahead, before the turn.
    let sight = math::atan((middle - x) / focal) + angle;
    let column = middle - focal * math::tan(sight);
    let inside = sight.abs() < 1.5 && (0.0..=width as f64 - 1.0).contains(&column);
    let slant = |place: f64| (focal * focal + (place - middle) * (place - middle)).sqrt();
    inside.then(|| (column, slant(column) / slant(x)))
}

/// An image between its pixels, by the four around the place; rows beyond the edge are those at the edge.
fn sample(image: GrayView<'_>, column: f64, row: f64) -> u8 {
    let (width, height) = image.size();
    let row = row.clamp(0.0, height as f64 - 1.0);
    let (x, y) = (column as usize, row as usize);
    let (u, v) = (column - x as f64, row - y as f64);
    let (right, below) = ((x + 1).min(width - 1), (y + 1).min(height - 1));
    let at = |x: usize, y: usize| f64::from(image.row(y)[x]);
    let upper = at(x, y) * (1.0 - u) + at(right, y) * u;
    let lower = at(x, below) * (1.0 - u) + at(right, below) * u;
    (upper * (1.0 - v) + lower * v + 0.5) as u8
}

/// How badly a turn explains the second image, on every fourth row.
fn mismatch(first: GrayView<'_>, second: GrayView<'_>, angle: f64, focal: f64) -> f64 {
    let (width, height) = first.size();
    let middle = 0.5 * (height as f64 - 1.0);
    let (mut sum, mut count) = (0.0, 0.0);
    for x in 0..width {
        let Some((column, scale)) = source(x as f64, width, angle, focal) else { continue };
        for y in (0..height).step_by(4) {
            let shade = sample(first, column, middle + (y as f64 - middle) * scale);
            // What others move must not pull the turn along.
            sum += f64::from(shade.abs_diff(second.row(y)[x]).min(20));
            count += 1.0;
        }
    }
    if count > 0.0 { sum / count } else { f64::INFINITY }
}
