use crate::ParameterError;
use std::f64::consts::PI;

use super::dispatch::vectorised;
use super::{GrayView, ImageError};
use crate::geometry::math;

/// A straight line: all points with `x cos(theta) + y sin(theta) = rho`, in pixels from the centre of the
/// upper left pixel, x to the right, y down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HoughLine {
    /// Signed distance from the origin (pixels).
    pub rho: f64,
    /// Direction of the line's normal, `0..pi` (rad).
    pub theta: f64,
    /// Number of pixels on the line.
    pub votes: u32,
}

/// Finds straight lines by the Hough transform (R. O. Duda and P. E. Hart, "Use of the Hough transformation
/// to detect lines and curves in pictures", CACM 15(1), 1972). Its buffers are reused from image to image.
///
/// Each pixel that is not 0 votes, at each angle, for the line through it, with `rho` rounded to a multiple
/// of the step. A line has more votes than the threshold, more than its neighbours at the next smaller `rho`
/// and angle, and at least as many as those at the next larger. Time: edge pixels times angles.
///
/// ```
/// use roverlab::vision::{GrayView, HoughLines};
/// let mut edges = [0; 40 * 30];
/// (0..30).for_each(|row| edges[40 * row + 12] = 255);
/// let lines = HoughLines::new(1.0, 180)?.find(GrayView::new(&edges, 40, 30)?, 20);
/// assert_eq!((lines[0].rho, lines[0].theta, lines[0].votes), (12.0, 0.0, 30), "upright, at column 12");
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
#[derive(Debug, Clone)]
pub struct HoughLines {
    rho_step: f64,
    /// Cosine and sine of each angle, divided by the step.
    directions: Vec<[f32; 2]>,
    /// Votes of three neighbouring angles; a full accumulator would not fit the faster caches.
    votes: [Vec<u32>; 3],
    /// Columns and rows of the voting pixels.
    columns: Vec<f32>,
    rows: Vec<f32>,
}

impl HoughLines {
    /// A detector with steps of `rho_step` pixels, and `angles` angles in half a turn.
    ///
    /// # Errors
    ///
    /// If `rho_step` is not finite and at least 0.1, or `angles` is not 1 to 3600.
    pub fn new(rho_step: f64, angles: usize) -> Result<Self, ImageError> {
        if !(rho_step >= 0.1 && rho_step.is_finite()) {
            let expected = "at least 0.1 and finite";
            return Err(ParameterError::new("step of rho", rho_step, expected).into());
        }
        if !(1..=3600).contains(&angles) {
            let found = angles as f64;
            return Err(ParameterError::new("angles", found, "1 to 3600").into());
        }
        // Accumulated in single precision, as the step's inverse: this reproduces OpenCV's votes.
        let step = (PI / angles as f64) as f32;
        let mut angle = 0.0_f32;
        let inverse = f64::from(1.0 / rho_step as f32);
        let direction = |_| {
            let (sin, cos) = math::sin_cos(f64::from(angle));
            angle += step;
            [(cos * inverse) as f32, (sin * inverse) as f32]
        };
        let directions = (0..angles).map(direction).collect();
        Ok(Self {
            rho_step,
            directions,
            votes: [const { Vec::new() }; 3],
            columns: Vec::new(),
            rows: Vec::new(),
        })
    }

    /// Lines with more than `threshold` votes, most votes first.
    pub fn find(&mut self, edges: GrayView<'_>, threshold: u32) -> Vec<HoughLine> {
        self.gather(edges);
        let (width, height) = edges.size();
        // One entry per `rho` from minus to plus the largest distance, and an empty one at either end.
        let reach = ((width + height) as f64 / self.rho_step).ceil() as usize + 1;
        for votes in &mut self.votes {
            votes.clear();
            votes.resize(2 * reach + 1, 0);
        }
        let mut lines = Vec::new();
        // Peaks of an angle need the votes of the next one; after the last angle there are none.
        for angle in 0..=self.directions.len() {
            self.votes.rotate_left(1);
            let [before, votes, after] = &mut self.votes;
            after.fill(0);
            if let Some(&direction) = self.directions.get(angle) {
                vote(&self.columns, &self.rows, direction, reach as u32, after);
            }
            let Some(angle) = angle.checked_sub(1) else { continue };
            for_each_peak([before, votes, after], threshold, |place| {
                let rho = (place as f64 - reach as f64) * self.rho_step;
                let theta = PI * angle as f64 / self.directions.len() as f64;
                lines.push(HoughLine { rho, theta, votes: votes[place] });
            });
        }
        // A stable sort keeps lines with equal votes in the order of their angles.
        lines.sort_by_key(|line| std::cmp::Reverse(line.votes));
        lines
    }

    /// Collects the voting pixels.
    fn gather(&mut self, edges: GrayView<'_>) {
        self.columns.clear();
        self.rows.clear();
        for y in 0..edges.height() {
            for (piece, start) in edges.row(y).chunks(32).zip((0..).step_by(32)) {
                if piece.iter().all(|&edge| edge == 0) {
                    continue;
                }
                for x in piece.iter().enumerate().filter(|(_, edge)| **edge != 0).map(|(x, _)| x + start) {
                    self.columns.push(x as f32);
                    self.rows.push(y as f32);
                }
            }
        }
    }
}

/// Calls `found` with every index that exceeds the threshold and is a peak among the rows of three angles.
/// The first and last entry of a row have no votes.
fn for_each_peak([before, votes, after]: [&[u32]; 3], threshold: u32, mut found: impl FnMut(usize)) {
    let is_peak = |place: usize| {
        let count = votes[place];
        count > threshold
            && count > votes[place - 1]
            && count >= votes[place + 1]
            && count > before[place]
            && count >= after[place]
    };
    for (piece, start) in votes.chunks(BLOCK).zip((0..).step_by(BLOCK)) {
        if piece.iter().fold(false, |any, &count| any | (count > threshold)) {
            (start..start + piece.len()).filter(|&place| is_peak(place)).for_each(&mut found);
        }
    }
}

/// Number of points, or entries, processed at a time.
const BLOCK: usize = 64;
/// Adding 1.5 * 2^23 to a float rounds it to an integer, halves to even, which then stands in its low bits.
const ROUNDING: f32 = 12_582_912.0;

#[inline(always)]
fn vote_portable(columns: &[f32], rows: &[f32], [cos, sin]: [f32; 2], middle: u32, votes: &mut [u32]) {
    let base = ROUNDING.to_bits().wrapping_sub(middle);
    let mut places = [0_u32; BLOCK];
    for (xs, ys) in columns.chunks(BLOCK).zip(rows.chunks(BLOCK)) {
        for ((place, x), y) in places.iter_mut().zip(xs).zip(ys) {
            *place = (x * cos + y * sin + ROUNDING).to_bits().wrapping_sub(base);
        }
        for &place in &places[..xs.len()] {
            if let Some(count) = votes.get_mut(place as usize) {
                *count += 1;
            }
        }
    }
}

vectorised! {
    fn vote(columns: &[f32], rows: &[f32], direction: [f32; 2], middle: u32, votes: &mut [u32]) {
        vote_portable(columns, rows, direction, middle, votes);
    }
}
