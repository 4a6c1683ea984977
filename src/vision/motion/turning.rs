use crate::ParameterError;
use crate::geometry::math;
use crate::vision::{GrayView, GrayViewMut, ImageError};

/// Removes the robot's own rotation from an image, so that the remaining change is the motion of others
/// (book, section 11.6).
///
/// For a camera that turns about its own axis, the image change does not depend on distances: each line of
/// sight is rotated back, and the image is sampled there. Odometry gives the angle, which slip or a jump may
/// falsify; the angle that best explains the second image corrects it. A camera ahead of the axis also
/// translates, which displaces near objects; use
/// [`MotionDetector::compare_loosely`](super::MotionDetector::compare_loosely) for that.
///
/// ```
/// use roverlab::vision::motion::TurnCompensator;
/// use roverlab::vision::{GrayView, mean_difference};
/// // A camera with a field of view of 1 rad turns left by 0.1 rad: the scene moves to the right.
/// let focal = 40.0 / 0.5_f64.tan();
/// let wall = |turn: f64| -> Vec<u8> {
///     let angle = |column: usize| turn - ((column as f64 - 39.5) / focal).atan();
///     (0..80 * 20).map(|i| (128.0 + 90.0 * (12.0 * angle(i % 80)).sin()) as u8).collect()
/// };
/// let (before, after) = (wall(0.0), wall(0.1));
/// let (before, after) = (GrayView::new(&before, 80, 20)?, GrayView::new(&after, 80, 20)?);
/// let mut compensator = TurnCompensator::new(1.0)?;
/// let turned = compensator.turn(before, after, 0.1)?;
/// let (corner, width) = ((turned.from, 0), turned.to - turned.from);
/// let left = mean_difference(turned.image.region(corner, width, 20)?, after.region(corner, width, 20)?)?;
/// assert!(left < 3.0 && mean_difference(before, after)? > 30.0, "only the camera has moved");
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
#[derive(Debug, Clone)]
pub struct TurnCompensator {
    field_of_view: f64,
    turned: Vec<u8>,
}

/// An image as the camera would see it after a rotation.
#[derive(Debug, Clone, Copy)]
pub struct Turned<'a> {
    /// The image; columns outside `from..to` are undefined.
    pub image: GrayView<'a>,
    /// First column visible in both images.
    pub from: usize,
    /// One past the last column visible in both images.
    pub to: usize,
    /// Displacement of the image centre by the rotation, without sign (pixels).
    pub shift: f64,
}

/// Search range around the odometry angle, in addition to that angle itself (pixels).
const SEARCH: f64 = 16.0;
/// Step sizes of the coarse and the fine search (pixels).
const STEPS: [f64; 2] = [1.0, 0.25];
/// Cost of a deviation from odometry (gray levels per pixel).
const TRUST: f64 = 0.03;

impl TurnCompensator {
    /// A compensator for a level camera with a horizontal field of view (rad).
    ///
    /// # Errors
    ///
    /// If the field of view is not between 0 and 3 rad.
    pub fn new(field_of_view: f64) -> Result<Self, ImageError> {
        if !(field_of_view > 0.0 && field_of_view < 3.0) {
            let expected = "more than 0 and below 3 radians";
            return Err(ParameterError::new("field of view", field_of_view, expected).into());
        }
        Ok(Self { field_of_view, turned: Vec::new() })
    }

    /// Returns `first` as the camera would see it after turning left by `angle` (rad). The angle comes from
    /// odometry and is corrected by means of `second`.
    ///
    /// # Errors
    ///
    /// If the sizes differ.
    pub fn turn(
        &mut self,
        first: GrayView<'_>,
        second: GrayView<'_>,
        angle: f64,
    ) -> Result<Turned<'_>, ImageError> {
        crate::vision::view::require_size("second image", second.size(), first.size())?;
        let (width, height) = first.size();
        let focal = 0.5 * width as f64 / math::tan(0.5 * self.field_of_view);
        let angle = registered(first, second, angle, focal);
        self.turned.resize(width * height, 0);
        let mut turned = GrayViewMut::new(&mut self.turned, width, height)?;
        let (mut from, mut to) = (width, 0);
        for x in 0..width {
            let Some((column, scale)) = source(x as f64, width, angle, focal) else { continue };
            (from, to) = (from.min(x), x + 1);
            for y in 0..height {
                let middle = 0.5 * (height as f64 - 1.0);
                let row = middle + (y as f64 - middle) * scale;
                turned.row_mut(y)[x] = sample(first, column, row);
            }
        }
        let image = GrayView::new(&self.turned, width, height)?;
        Ok(Turned { image, from: from.min(to), to, shift: (angle * focal).abs() })
    }
}

/// Angle near that of odometry which best explains the second image. A jump of odometry may account for all
/// of its angle, or hide as much.
fn registered(first: GrayView<'_>, second: GrayView<'_>, angle: f64, focal: f64) -> f64 {
    let cost = |shift: f64| mismatch(first, second, angle + shift / focal, focal) + TRUST * shift.abs();
    let mut reach = (SEARCH + angle.abs() * focal).min(0.5 * first.width() as f64);
    let mut best = (cost(0.0), 0.0);
    for step in STEPS {
        let around = best.1;
        for i in 1..=(reach / step) as i32 {
            for shift in [around + step * f64::from(i), around - step * f64::from(i)] {
                let cost = cost(shift);
                if cost < best.0 {
                    best = (cost, shift);
                }
            }
        }
        reach = step;
    }
    angle + best.1 / focal
}

/// Source column of a column of the rotated image, and the scale of distances from the middle row.
fn source(x: f64, width: usize, angle: f64, focal: f64) -> Option<(f64, f64)> {
    let middle = 0.5 * (width as f64 - 1.0);
    // Line of sight before the rotation, positive to the left of straight ahead.
    let sight = math::atan((middle - x) / focal) + angle;
    let column = middle - focal * math::tan(sight);
    let inside = sight.abs() < 1.5 && (0.0..=width as f64 - 1.0).contains(&column);
    let slant = |place: f64| (focal * focal + (place - middle) * (place - middle)).sqrt();
    inside.then(|| (column, slant(column) / slant(x)))
}

/// Bilinear interpolation; rows outside the image repeat the border.
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

/// Mean absolute difference left by a rotation, on every eighth row.
fn mismatch(first: GrayView<'_>, second: GrayView<'_>, angle: f64, focal: f64) -> f64 {
    let (width, height) = first.size();
    let middle = 0.5 * (height as f64 - 1.0);
    let (mut sum, mut count) = (0.0, 0.0);
    for x in 0..width {
        let Some((column, scale)) = source(x as f64, width, angle, focal) else { continue };
        for y in (0..height).step_by(8) {
            let shade = sample(first, column, middle + (y as f64 - middle) * scale);
            // Clipped, so that moving objects do not bias the angle.
            sum += f64::from(shade.abs_diff(second.row(y)[x]).min(20));
            count += 1.0;
        }
    }
    if count > 0.0 { sum / count } else { f64::INFINITY }
}
