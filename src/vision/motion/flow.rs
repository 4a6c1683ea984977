use super::{Motion, MotionDetector, MotionParameters};
use crate::geometry::{Point, Pose, math};
use crate::parameter::{require, require_not_negative, require_positive};
use crate::vision::view::require_size;
use crate::vision::{CameraGeometry, GrayView, ImageError};

use super::range::Ranges;

/// Parameters of [`FlowDetector`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlowParameters {
    /// Projection of the camera.
    pub camera: CameraGeometry,
    /// Blocks, and the change that counts as motion. The noise is `least_noise`.
    pub motion: MotionParameters,
    /// Displacement that rounding to pixels and odometry may cause (pixels).
    pub slack: usize,
    /// Width of parts of a thing that do not touch the floor, beside those that do (m).
    pub overhang: f64,
}

impl FlowParameters {
    /// Parameters for a camera.
    pub fn new(camera: CameraGeometry) -> Self {
        let motion = MotionParameters { threshold: 20.0, least_noise: 4.0, ..MotionParameters::default() };
        Self { camera, motion, slack: 1, overhang: 0.06 }
    }
}

/// Detects motion in the images of a camera that drives (book, section 11.6).
///
/// Odometry and the camera's geometry predict how the image of everything that stands still moves. The floor
/// is known: each of its pixels has one depth. A thing stands on the floor where the floor ends in its
/// column, and is no nearer than that; so each of its pixels came from a short stretch of the epipolar line,
/// between the positions for that depth and for the horizon. A pixel whose gray level did not occur on its
/// stretch, and which nothing nearer hid before, is not explained by the camera's own motion. A
/// [`MotionDetector`] sums such differences over blocks.
///
/// The floor is found by its gray level, from the bottom of the image on: where a thing looks like the floor,
/// it counts as farther away, and something that stands still may be taken for moving if it is near. A moving
/// thing is not found if it moves along the line of sight, or outwards and slower than a standing one would.
/// O(pixels × length of the stretches).
///
/// ```
/// use roverlab::geometry::Pose;
/// use roverlab::vision::motion::{FlowDetector, FlowParameters};
/// use roverlab::vision::{CameraGeometry, GrayView};
/// let camera = CameraGeometry { field_of_view: 1.0, height: 0.06, ahead: 0.06 };
/// // A dark box on a bright floor, before a wall: 30 pixels wide from a column on.
/// let scene = |from: usize| -> Vec<u8> {
///     let shade = |x: usize, y: usize| match y {
///         40..75 if (from..from + 30).contains(&x) => 40,
///         0..64 => 110,
///         _ => 180,
///     };
///     (0..160 * 120).map(|i| shade(i % 160, i / 160)).collect()
/// };
/// let mut detector = FlowDetector::new(FlowParameters::new(camera))?;
/// let (before, after, moved) = (scene(20), scene(30), scene(12));
/// let view = |image| GrayView::new(image, 160, 120);
/// // The camera drives ahead by 4 cm: what stands moves outwards, by less than a pixel at this distance.
/// let ahead = Pose::new(0.04, 0.0, 0.0);
/// assert!(!detector.compare(view(&before)?, view(&before)?, ahead)?.is_moving());
/// assert!(detector.compare(view(&before)?, view(&after)?, ahead)?.is_moving(), "it comes inwards");
/// assert!(detector.compare(view(&before)?, view(&moved)?, ahead)?.is_moving(), "it goes outwards too fast");
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
#[derive(Debug, Clone)]
pub struct FlowDetector {
    parameters: FlowParameters,
    detector: MotionDetector,
    ranges: Ranges,
    before: Floor,
    now: Floor,
    levels: Vec<u8>,
    unexplained: Vec<f64>,
    size: (usize, usize),
    /// Where the largest change was (column, row).
    place: Option<(f64, f64)>,
}

/// Where the floor ends in each column: the first row of the floor, and the same with overhangs.
#[derive(Debug, Clone, Default)]
struct Floor {
    ends: Vec<usize>,
    wide: Vec<usize>,
}

/// Deviations from the median of the floor's gray levels that still count as floor (median absolute
/// deviations), and at least (gray levels).
const FLOOR: (f64, f64) = (3.0, 12.0);
/// Errors of the depth of a foot and of the floor (fractions).
const DEPTHS: (f64, f64) = (0.15, 0.03);
/// Depth of a foot below which its column is not judged (m): a few centimetres move it by more pixels than
/// the depth is certain by.
const NEAREST: f64 = 0.25;
/// Distance taken for infinity (m).
const FAR: f64 = 50.0;
/// Rows by which a foot must be lower than another one to be nearer, and rows around it (pixels).
const LOWER: f64 = 0.6;

impl FlowDetector {
    /// A detector.
    ///
    /// # Errors
    ///
    /// If a parameter is out of range.
    pub fn new(parameters: FlowParameters) -> Result<Self, ImageError> {
        let CameraGeometry { field_of_view, height, ahead } = parameters.camera;
        let is_angle = field_of_view > 0.0 && field_of_view < 3.0;
        require("field of view", field_of_view, is_angle, "more than 0 and below 3 radians")?;
        require_positive("height of the camera", height)?;
        require("camera ahead", ahead, ahead.abs() < 10.0, "-10 to 10 m")?;
        require("slack", parameters.slack as f64, parameters.slack <= 100, "0 to 100")?;
        require_not_negative("overhang", parameters.overhang)?;
        Ok(Self {
            parameters,
            detector: MotionDetector::new(parameters.motion)?,
            ranges: Ranges::default(),
            before: Floor::default(),
            now: Floor::default(),
            levels: Vec::new(),
            unexplained: Vec::new(),
            size: (0, 0),
            place: None,
        })
    }

    /// Compares two images of equal size; `moved` is the second pose of the robot in the frame of the first.
    ///
    /// # Errors
    ///
    /// If the sizes differ.
    pub fn compare(
        &mut self,
        first: GrayView<'_>,
        second: GrayView<'_>,
        moved: Pose,
    ) -> Result<Motion, ImageError> {
        require_size("second image", second.size(), first.size())?;
        self.size = second.size();
        self.ranges.find(first, self.parameters.slack);
        let mut floors = [std::mem::take(&mut self.before), std::mem::take(&mut self.now)];
        for (floor, image) in floors.iter_mut().zip([first, second]) {
            self.find_floor(image, floor);
        }
        [self.before, self.now] = floors;
        let gain = self.detector.gain_between(first, second);
        self.explain(second, moved, gain);
        let (motion, place) = self.detector.judge(first, second, &self.unexplained)?;
        self.place = motion.is_moving().then_some(place);
        Ok(motion)
    }

    /// Position on the floor, in the robot's frame, of what moved in the last comparison (m). `None` if
    /// nothing did, or its foot was not visible.
    pub fn place(&self) -> Option<Point> {
        let (column, _) = self.place?;
        let foot = self.now.wide.get(column as usize)?;
        let (width, height) = self.size;
        self.parameters.camera.floor(column, *foot as f64, (width as u32, height as u32))
    }

    /// Distance from the robot's centre to the nearest foot in a direction (rad), within a half-width of that
    /// line (m), in the last image. `None` before the first comparison, and if there is none.
    pub fn free_towards(&self, bearing: f64, half_width: f64) -> Option<f64> {
        let size = (self.size.0 as u32, self.size.1 as u32);
        let line = Pose::new(0.0, 0.0, bearing);
        let feet = self.now.ends.iter().enumerate();
        let places = feet.filter_map(|(x, foot)| self.parameters.camera.floor(x as f64, *foot as f64, size));
        let along = places.map(|place| line.to_local(place));
        along
            .filter(|place| place.x > 0.0 && place.y.abs() < half_width)
            .map(|place| place.x)
            .reduce(f64::min)
    }

    /// Depth of a row of the floor (m); never negative.
    fn depth(&self, row: f64) -> f64 {
        let CameraGeometry { height, .. } = self.parameters.camera;
        let middle = 0.5 * (self.size.1 as f64 - 1.0);
        self.focal() * height / (row - middle).max(0.3)
    }

    fn focal(&self) -> f64 {
        self.parameters.camera.focal(self.size.0 as u32)
    }

    /// Finds the floor in each column, from the bottom up: it ends where two pixels one above the other
    /// differ from it.
    fn find_floor(&mut self, image: GrayView<'_>, floor: &mut Floor) {
        let (width, height) = image.size();
        self.levels.clear();
        (height - height / 4..height).for_each(|y| self.levels.extend_from_slice(image.row(y)));
        let middle = median(&mut self.levels);
        self.levels.iter_mut().for_each(|level| *level = level.abs_diff(middle));
        let band = (FLOOR.0 * f64::from(median(&mut self.levels))).max(FLOOR.1);
        let horizon = height / 2 + 1;
        let differs = |x: usize, y: usize| f64::from(image.row(y)[x].abs_diff(middle)) > band;
        let end = |x: usize| (horizon..height).rev().find(|&y| differs(x, y) && differs(x, y - 1));
        floor.ends.clear();
        floor.ends.extend((0..width).map(|x| end(x).map_or(horizon, |y| y + 1)));
        floor.wide.clone_from(&floor.ends);
        for (x, &foot) in floor.ends.iter().enumerate() {
            let reach = self.focal() * self.parameters.overhang / self.depth(foot as f64 - 0.5);
            let reach = (reach + 0.5) as usize;
            let near = x.saturating_sub(reach)..x.saturating_add(reach).saturating_add(1).min(width);
            floor.wide[near].iter_mut().for_each(|other| *other = foot.max(*other));
        }
    }

    /// Finds the difference of each pixel that the camera's own motion does not explain.
    fn explain(&mut self, second: GrayView<'_>, moved: Pose, gain: f64) {
        let (width, height) = self.size;
        let camera = Pose::new(self.parameters.camera.ahead, 0.0, 0.0);
        let moved = camera.inverse().compose(&moved).compose(&camera);
        let turn = (math::sin(moved.heading), math::cos(moved.heading));
        self.unexplained.clear();
        for y in 0..height {
            for x in 0..width {
                let level = f64::from(second.row(y)[x]);
                let levels = self.stretch(x, y, moved, turn).and_then(|stretch| self.levels_on(&stretch));
                let off = levels.map_or(0.0, |(low, high)| level - level.clamp(gain * low, gain * high));
                self.unexplained.push(off);
            }
        }
        self.thin_out();
    }

    /// Where a pixel may have been before. `None` if that is behind the camera, or too near to tell.
    fn stretch(&self, x: usize, y: usize, moved: Pose, (sin, cos): (f64, f64)) -> Option<Stretch> {
        let (width, height) = self.size;
        let focal = self.focal();
        let middle = (0.5 * (width as f64 - 1.0), 0.5 * (height as f64 - 1.0));
        let [own, wide] = [self.now.ends[x], self.now.wide[x]].map(|foot| foot as f64 - 0.5);
        let (column, row) = (x as f64, y as f64);
        let stands = row < own;
        if self.depth(wide) < NEAREST {
            return None;
        }
        let ground = if row > middle.1 + 0.5 { self.depth(row) } else { FAR };
        let (near, far) = if stands {
            ((1.0 - DEPTHS.0) * self.depth(wide), ground)
        } else {
            ((1.0 - DEPTHS.1) * ground, (1.0 + DEPTHS.1) * ground)
        };
        let (left, up) = ((middle.0 - column) / focal, (middle.1 - row) / focal);
        let at = |depth: f64| {
            let ahead = cos - sin * left + moved.x / depth;
            let aside = sin + cos * left + moved.y / depth;
            (ahead > 0.05).then(|| (middle.0 - focal * aside / ahead, middle.1 - focal * up / ahead))
        };
        Some(Stretch { ends: [at(far)?, at(near)?], stands, foot: own })
    }

    /// Lowest and highest gray level on a stretch. `None` if a part of it was outside the image, or hidden by
    /// something nearer.
    fn levels_on(&self, stretch: &Stretch) -> Option<(f64, f64)> {
        let (width, height) = self.size;
        let [(x0, y0), (x1, y1)] = stretch.ends;
        let steps = math::hypot(x1 - x0, y1 - y0).ceil().clamp(1.0, width as f64);
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for step in 0..=steps as usize {
            let share = step as f64 / steps;
            let (x, y) = ((x0 + (x1 - x0) * share).round(), (y0 + (y1 - y0) * share).round());
            if x < 0.0 || y < 0.0 || x >= width as f64 || y >= height as f64 {
                return None;
            }
            let (x, y) = (x as usize, y as usize);
            if (x.saturating_sub(1)..=(x + 1).min(width - 1)).any(|column| self.hid(column, y, stretch)) {
                return None;
            }
            let (least, most) = self.ranges.at(x, y);
            (low, high) = (low.min(f64::from(least)), high.max(f64::from(most)));
        }
        Some((low, high))
    }

    /// Whether something nearer hid a pixel in a column of the first image.
    fn hid(&self, column: usize, row: usize, stretch: &Stretch) -> bool {
        let row = row as f64;
        if stretch.stands {
            let foot = self.before.wide[column] as f64 - 0.5;
            row < foot + 1.0 && foot > stretch.foot + LOWER
        } else {
            row < self.before.ends[column] as f64
        }
    }

    /// Reduces each difference to that of its neighbours in the row with the same sign: single columns are
    /// faces of things that come into view.
    fn thin_out(&mut self) {
        for row in self.unexplained.chunks_mut(self.size.0.max(1)) {
            let mut left = 0.0;
            for x in 0..row.len() {
                let (own, right) = (row[x], row.get(x + 1).copied().unwrap_or(0.0));
                let alike = |other: f64| if other * own > 0.0 { other.abs() } else { 0.0 };
                row[x] = own.signum() * own.abs().min(alike(left).max(alike(right)));
                left = own;
            }
        }
    }
}

/// Where a pixel may have been: between two places, from the farthest to the nearest depth.
#[derive(Debug, Clone, Copy)]
struct Stretch {
    ends: [(f64, f64); 2],
    /// Whether it is above the foot of its column, and where that is.
    stands: bool,
    foot: f64,
}

/// Median of some gray levels; 0 without any.
fn median(levels: &mut [u8]) -> u8 {
    let middle = levels.len() / 2;
    if levels.is_empty() { 0 } else { *levels.select_nth_unstable(middle).1 }
}
