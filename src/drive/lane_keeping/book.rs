use std::ops::ControlFlow;

use super::{LaneObservation, LaneOutcome};
use crate::geometry::{Twist, math};
use crate::io::control::{Behaviour, Decision, Senses};
use crate::io::{self, Camera, Odometry, Resolution};
use crate::parameter::require_positive;
use crate::vision::{
    Canny, CannyThresholds, GaussianKernel, GrayView, GrayViewMut, GrayWeights, HoughSegments, ImageError,
    LineSegment, RgbView, SegmentParameters, gaussian_into, gray_into,
};

/// Parameters of the book's lane keeper. The defaults are those of its programs where they state any.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BookLaneParameters {
    /// Control period (s).
    pub period: f64,
    /// Speed (m/s).
    pub speed: f64,
    /// Curvature commanded for a lane whose centre is at the edge of the image (1/m).
    pub gain: f64,
    /// Upper part of the image without line detection (fraction of the height).
    pub horizon: f64,
}

impl Default for BookLaneParameters {
    fn default() -> Self {
        Self { period: 1.0 / 30.0, speed: 0.5, gain: 2.5, horizon: 0.5 }
    }
}

/// The book's lane keeper. It converts the image to grey, smooths it, and finds edges and straight lines in
/// its lower part. It averages the lines that lean to the right and those that lean to the left, and commands
/// a curvature proportional to the offset of the middle between the two. A missing side is assumed at its
/// last distance; if both are missing, the curvature is kept.
#[derive(Debug)]
pub struct BookLaneKeeper {
    parameters: BookLaneParameters,
    kernel: GaussianKernel,
    canny: Canny,
    hough: HoughSegments,
    gray: Vec<u8>,
    smooth: Vec<u8>,
    /// Last distance between the two lines in the lowest row (pixels).
    width: Option<f64>,
    /// Commanded curvature (1/m).
    bend: f64,
}

/// Maximum slope of a line along the road (columns per row).
const LEANS: f64 = 3.0;

impl BookLaneKeeper {
    /// Creates a lane keeper. Fails for parameters out of range.
    pub fn new(parameters: BookLaneParameters) -> Result<Self, ImageError> {
        require_positive("control period", parameters.period)?;
        require_positive("speed", parameters.speed)?;
        require_positive("gain", parameters.gain)?;
        let good = (0.0..0.9).contains(&parameters.horizon);
        crate::parameter::require("horizon", parameters.horizon, good, "0 to 0.9")?;
        Ok(Self {
            parameters,
            kernel: GaussianKernel::new(5, 1.1)?,
            canny: Canny::new(),
            hough: HoughSegments::new(180)?,
            gray: Vec::new(),
            smooth: Vec::new(),
            width: None,
            bend: 0.0,
        })
    }

    /// Straight lines in the lower part of the image.
    ///
    /// # Errors
    ///
    /// If the image is empty or too small for the kernels.
    pub fn lines(&mut self, image: &image::RgbImage) -> Result<Vec<LineSegment>, ImageError> {
        let (width, height) = (image.width() as usize, image.height() as usize);
        self.gray.resize(width * height, 0);
        self.smooth.resize(width * height, 0);
        let rgb = RgbView::new(image.as_raw(), width, height)?;
        gray_into(rgb, GrayViewMut::new(&mut self.gray, width, height)?, GrayWeights::default())?;
        let (gray, smooth) = (GrayView::new(&self.gray, width, height)?, &mut self.smooth);
        gaussian_into(gray, GrayViewMut::new(smooth, width, height)?, self.kernel)?;
        let (smooth, edges) = (GrayView::new(&self.smooth, width, height)?, &mut self.gray);
        self.canny.find_into(smooth, GrayViewMut::new(edges, width, height)?, CannyThresholds::default())?;
        let above = (self.parameters.horizon * height as f64) as usize;
        self.gray[..above * width].fill(0);
        let parameters =
            SegmentParameters { threshold: 20, min_length: 20, max_gap: 10, ..SegmentParameters::default() };
        Ok(self.hough.find(GrayView::new(&self.gray, width, height)?, parameters))
    }

    /// Curvature for the lines in an image of a given size (1/m).
    fn steer(&mut self, lines: &[LineSegment], (width, height): (f64, f64)) -> f64 {
        let [left, right] = [-1.0, 1.0].map(|side| mean_line(lines, side, (width, height)));
        let (left, right) = match (left, right, self.width) {
            (Some(left), Some(right), _) => {
                self.width = Some(right - left);
                (left, right)
            }
            (Some(left), None, Some(wide)) => (left, left + wide),
            (None, Some(right), Some(wide)) => (right - wide, right),
            _ => return self.bend,
        };
        let aside = (0.5 * (left + right) - 0.5 * width) / (0.5 * width);
        self.bend = -self.parameters.gain * aside.clamp(-1.0, 1.0);
        self.bend
    }
}

/// Column at which the mean of the lines on one side, -1 for the left and 1 for the right, crosses the row a
/// quarter above the bottom of the image. A line to the left of a camera leans to the right. Lines count by
/// their length.
fn mean_line(lines: &[LineSegment], side: f64, (width, height): (f64, f64)) -> Option<f64> {
    let (mut sum, mut weight) = (0.0, 0.0);
    for line in lines {
        let [a, b] = [line.from, line.to].map(|(x, y)| (x as f64, y as f64));
        let (across, down) = (b.0 - a.0, b.1 - a.1);
        if down == 0.0 || across.abs() > LEANS * down.abs() {
            continue;
        }
        let slope = across / down;
        let meets = a.0 + slope * (0.75 * height - a.1);
        // Lines of the other lanes are beyond the edges of the image.
        let is_own = slope * side > 0.05 && meets > -0.5 * width && meets < 1.5 * width;
        if is_own {
            let long = math::hypot(across, down);
            sum += meets * long;
            weight += long;
        }
    }
    (weight > 0.0).then(|| sum / weight)
}

impl Behaviour for BookLaneKeeper {
    type Observation = LaneObservation;
    type Command = Twist;
    type Outcome = LaneOutcome;

    fn period(&self) -> f64 {
        self.parameters.period
    }

    fn step(&mut self, _time: f64, seen: &LaneObservation) -> Decision<Self> {
        seen.check()?;
        let lines = self.lines(&seen.image).map_err(io::Error::caused_by)?;
        let size = (f64::from(seen.image.width()), f64::from(seen.image.height()));
        let bend = self.steer(&lines, size);
        let speed = self.parameters.speed;
        Ok(ControlFlow::Continue(Twist::new(speed, speed * bend)))
    }
}

impl<R: Camera + Odometry + ?Sized> Senses<R> for BookLaneKeeper {
    fn prepare(&mut self, robot: &mut R) -> io::Result<()> {
        robot.set_resolution(Resolution::Qvga)
    }

    fn sense(&mut self, robot: &mut R, _time: f64, seen: &mut LaneObservation) -> io::Result<()> {
        seen.read(robot)
    }
}
