use super::RoadCamera;
use crate::ParameterError;
use crate::geometry::Point;
use crate::vision::GrayView;

/// A bright point of a line's width, on a row of the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MarkingPoint {
    /// Centre in the robot's frame, for the nominal camera.
    pub place: Point,
    /// Contrast to both sides (gray levels).
    pub contrast: f64,
    /// Width of a pixel there (m).
    pub pixel: f64,
}

/// Finds points of lines in an image, in rows across the road as seen from above. Tables are kept from image
/// to image.
///
/// On each row of the ground, the mean over a line's width is compared with the brighter of the means of both
/// sides, half a line's width away. Peaks of sufficient contrast are points of lines.
///
/// ```
/// use roverlab::geometry::Point;
/// use roverlab::vision::GrayView;
/// use roverlab::vision::lane_markings::{MarkingFilter, RoadCamera};
///
/// let camera = RoadCamera { field_of_view: 1.6, fisheye: false, tilt: -0.4, height: 0.25, ahead: 0.0 };
/// let mut image = vec![40; 320 * 240];
/// // A line straight ahead, 20 mm wide.
/// for step in 200..1500 {
///     for across in -10..=10 {
///         let place = Point::new(f64::from(step) / 1000.0, f64::from(across) / 1000.0);
///         if let Some((x, y)) = camera.project(place, 0.0, (320, 240)) && y < 240.0 {
///             image[y as usize * 320 + x as usize] = 220;
///         }
///     }
/// }
/// let mut points = Vec::new();
/// MarkingFilter::new(camera, 0.02, 1.5)?.find(GrayView::new(&image, 320, 240)?, &mut points);
/// assert!(points.len() > 30 && points.iter().all(|point| point.place.y.abs() < 0.01));
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
#[derive(Debug, Clone)]
pub struct MarkingFilter {
    camera: RoadCamera,
    line_width: f64,
    reach: f64,
    size: (u32, u32),
    rows: Vec<Row>,
    /// Pixel of every sample, with the offset to the right and down in 16ths of a pixel.
    samples: Vec<Sample>,
    /// Prefix sums of a row's samples.
    sums: Vec<u32>,
    response: Vec<i32>,
}

/// A row of the ground: distance ahead (m), range of its samples, and lateral position of the first one (m).
#[derive(Debug, Clone, Copy)]
struct Row {
    ahead: f64,
    from: usize,
    to: usize,
    right: f64,
    pixel: f64,
}

#[derive(Debug, Clone, Copy)]
struct Sample {
    at: u32,
    right: u8,
    down: u8,
}

/// Samples across a line.
const ACROSS: usize = 4;
/// Minimum distance of the rows (line widths).
const ROW_STEP: f64 = 0.6;
/// Minimum contrast of a line (gray levels).
const LEAST: i32 = 8;
/// Minimum contrast as a fraction of the brightness beside it.
const SHARE: f64 = 0.18;

impl MarkingFilter {
    /// A filter for lines of a given width (m), up to `reach` ahead of the camera (m) and half as far to its
    /// sides.
    ///
    /// # Errors
    ///
    /// If a parameter is out of range.
    pub fn new(camera: RoadCamera, line_width: f64, reach: f64) -> Result<Self, ParameterError> {
        camera.validate()?;
        let expected = "5 to 200 mm";
        crate::parameter::require("line width", line_width, (0.005..=0.2).contains(&line_width), expected)?;
        let expected = "10 to 500 widths of a line";
        let lines = reach / line_width;
        crate::parameter::require("reach", reach, (10.0..=500.0).contains(&lines), expected)?;
        Ok(Self {
            camera,
            line_width,
            reach,
            size: (0, 0),
            rows: Vec::new(),
            samples: Vec::new(),
            sums: Vec::new(),
            response: Vec::new(),
        })
    }

    /// Finds points of lines, ordered from near to far and from right to left.
    pub fn find(&mut self, image: GrayView<'_>, points: &mut Vec<MarkingPoint>) {
        points.clear();
        let size = (image.width() as u32, image.height() as u32);
        if self.size != size {
            self.work_out(size);
        }
        for index in 0..self.rows.len() {
            let row = self.rows[index];
            self.measure(image, &row);
            self.peaks(&row, points);
        }
    }

    /// Computes the pixels of the samples.
    fn work_out(&mut self, size: (u32, u32)) {
        (self.size, self.rows, self.samples) = (size, Vec::new(), Vec::new());
        let step = self.line_width / ACROSS as f64;
        let half = (0.55 * self.reach / step) as i32;
        let least = ROW_STEP * self.line_width;
        let mut ahead = self.camera.ahead;
        while ahead < self.camera.ahead + self.reach {
            let row = self.row(ahead, step, half);
            if row.to - row.from > 8 * ACROSS {
                self.rows.push(row);
            }
            // Advance to the next row of pixels.
            let deep = self.depth_of_row(ahead);
            ahead += deep.max(least);
        }
    }

    /// Length of ground between two rows of pixels (m).
    fn depth_of_row(&self, ahead: f64) -> f64 {
        let row = |x: f64| self.camera.project(Point::new(x, 0.0), 0.0, self.size).map(|(_, row)| row);
        match (row(ahead), row(ahead + 0.01)) {
            (Some(near), Some(far)) if near - far > 1e-3 => 0.01 / (near - far),
            _ => 0.0,
        }
    }

    fn row(&mut self, ahead: f64, step: f64, half: i32) -> Row {
        let (width, height) = self.size;
        let from = self.samples.len();
        let (mut right, mut is_first) = (0.0, true);
        for i in -half..=half {
            let y = f64::from(i) * step;
            let place = self.camera.project(Point::new(ahead, y), 0.0, self.size);
            let seen = place.map(|(column, row)| (column - 0.5, row - 0.5)).filter(|&(column, row)| {
                column >= 0.0
                    && row >= 0.0
                    && column < f64::from(width) - 1.0
                    && row < f64::from(height) - 1.0
            });
            let Some((column, row)) = seen else { continue };
            if std::mem::take(&mut is_first) {
                right = y;
            }
            let part = |place: f64| ((place - place.floor()) * 16.0) as u8;
            let at = row as u32 * width + column as u32;
            self.samples.push(Sample { at, right: part(column), down: part(row) });
        }
        let pixel = match (
            self.camera.project(Point::new(ahead, right), 0.0, self.size),
            self.camera.project(Point::new(ahead, right + 0.01), 0.0, self.size),
        ) {
            (Some((a, _)), Some((b, _))) => 0.01 / (a - b).abs().max(1e-3),
            _ => step,
        };
        Row { ahead, from, to: self.samples.len(), right, pixel }
    }

    /// Reads a row's samples into the prefix sums.
    fn measure(&mut self, image: GrayView<'_>, row: &Row) {
        let width = self.size.0;
        self.sums.clear();
        self.sums.push(0);
        let mut sum = 0;
        for &Sample { at, right, down } in &self.samples[row.from..row.to] {
            let (x, y) = ((at % width) as usize, (at / width) as usize);
            let (upper, lower) = (image.row(y), image.row(y + 1));
            let (right, down) = (u32::from(right), u32::from(down));
            let across = |line: &[u8]| u32::from(line[x]) * (16 - right) + u32::from(line[x + 1]) * right;
            sum += across(upper) * (16 - down) + across(lower) * down;
            self.sums.push(sum);
        }
    }

    fn peaks(&mut self, row: &Row, points: &mut Vec<MarkingPoint>) {
        let count = row.to - row.from;
        // A line narrower than a pixel is one pixel wide.
        let step = self.line_width / ACROSS as f64;
        let across = ACROSS.max((row.pixel / step).round() as usize);
        let (half, side) = (across / 2, across.div_ceil(2));
        let margin = half + across.div_ceil(2) + side;
        if count < 2 * margin + 3 {
            return;
        }
        let sums = &self.sums;
        let mean = |from: usize, to: usize| ((sums[to] - sums[from]) / (to - from) as u32) as i32;
        self.response.clear();
        self.response.resize(count, 0);
        for i in margin..count - margin {
            let line = mean(i - half, i - half + across);
            let beside = mean(i - margin, i - margin + side).max(mean(i + margin - side, i + margin));
            let contrast = line - beside;
            let least = (LEAST * 256).max((SHARE * f64::from(beside)) as i32);
            self.response[i] = if contrast > least { contrast } else { 0 };
        }
        let mut i = margin;
        while i < count - margin {
            if self.response[i] == 0 {
                i += 1;
                continue;
            }
            let from = i;
            while i < count && self.response[i] > 0 {
                i += 1;
            }
            // Reject anything much wider than a line.
            if i - from > 4 * across {
                continue;
            }
            let best = (from..i).max_by_key(|&k| self.response[k]).unwrap_or(from);
            let (mut weight, mut moment) = (0.0, 0.0);
            for k in from..i {
                // Only samples with at least half the peak's contrast count.
                let above = f64::from(2 * self.response[k] - self.response[best]).max(0.0);
                weight += above;
                moment += above * k as f64;
            }
            // Each mean begins half a line's width before its sample, so its centre lies between two samples.
            let middle = moment / weight - half as f64 + 0.5 * (across as f64 - 1.0);
            let y = row.right + step * middle;
            let contrast = f64::from(self.response[best]) / 256.0;
            points.push(MarkingPoint { place: Point::new(row.ahead, y), contrast, pixel: row.pixel });
        }
    }

    /// The camera.
    pub fn camera(&self) -> &RoadCamera {
        &self.camera
    }
}
