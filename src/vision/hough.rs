use crate::ParameterError;
use std::f64::consts::PI;

use super::dispatch::vectorised;
use super::{GrayView, ImageError};
use crate::geometry::math;

/// A straight line: all points with `x cos(theta) + y sin(theta) = rho`, in pixels from the centre of the upper left
/// pixel, x to the right and y down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HoughLine {
    /// Pixels from the origin, negative on the other side.
    pub rho: f64,
    /// The direction of the line's normal in radians, at least 0 and less than pi.
    pub theta: f64,
    /// Pixels on the line.
    pub votes: u32,
}

/// Finds straight lines by votes (R. O. Duda and P. E. Hart, "Use of the Hough transformation to detect lines and
/// curves in pictures", CACM 15(1), 1972). It keeps its memory from one image to the next.
///
/// Each pixel that is not 0 votes, for each of the angles, for the line through it, its `rho` rounded to a multiple of
/// the step. A line has more votes than the threshold, more than the next smaller `rho` and angle, and at least as
/// many as the next larger ones.
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
    /// The votes of three neighbouring angles; all of them would not fit the faster caches.
    votes: [Vec<u32>; 3],
    /// Columns and rows of the pixels that vote.
    columns: Vec<f32>,
    rows: Vec<f32>,
}

impl HoughLines {
    /// Lines at multiples of `rho_step` pixels from the origin, and at so many angles in half a turn.
    pub fn new(rho_step: f64, angles: usize) -> Result<Self, ImageError> {
        if !(rho_step >= 0.1 && rho_step.is_finite()) {
            let expected = "at least 0.1 and finite";
            return Err(ParameterError::new("step of rho", rho_step, expected).into());
        }
        if !(1..=3600).contains(&angles) {
            let found = angles as f64;
            return Err(ParameterError::new("angles", found, "1 to 3600").into());
        }
        // Angles in single precision, each the one before and a step, and so the step's inverse: those are the votes of OpenCV.
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

    /// The lines with more than `threshold` votes, those with most votes first.
    pub fn find(&mut self, edges: GrayView<'_>, threshold: u32) -> Vec<HoughLine> {
        self.gather(edges);
        let (width, height) = edges.size();
        // Votes for `rho` from minus to plus the largest distance, and an empty place on either side.
        let reach = ((width + height) as f64 / self.rho_step).ceil() as usize + 1;
        for votes in &mut self.votes {
            votes.clear();
            votes.resize(2 * reach + 1, 0);
        }
        let mut lines = Vec::new();
        // Peaks of an angle are found when the votes of the next one are there; behind the last, there are none.
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
        // Stable, so that lines with equally many votes keep the order of their angles.
        lines.sort_by_key(|line| std::cmp::Reverse(line.votes));
        lines
    }

    /// Collects the pixels that vote.
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

/// Calls `found` with every place that has more votes than the threshold and is a peak among the rows of three angles. The
/// first and the last place of a row have no votes.
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

/// Points whose places are reckoned together, and places that are looked through together.
const BLOCK: usize = 64;
/// Adding one and a half times 2^23 to a float rounds it to a whole number, halves to even ones, which then stands in
/// its bits above those of the sum's own.
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
