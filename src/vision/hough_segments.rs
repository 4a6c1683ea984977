use crate::ParameterError;
use std::f64::consts::PI;

use super::dispatch::vectorised;
use super::segment_order::Draw;
use super::{GrayView, ImageError, SegmentDefinition};
use crate::geometry::math;

/// A straight line between two pixels, both included.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct LineSegment {
    /// Column and row of one end.
    pub from: (usize, usize),
    /// Column and row of the other end.
    pub to: (usize, usize),
}

/// Parameters of [`HoughSegments`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct SegmentParameters {
    /// Number of votes that starts the search for a line.
    pub threshold: u32,
    /// Minimum extent of a line across or down (pixels).
    pub min_length: usize,
    /// Maximum gap between two pixels of a line (pixels).
    pub max_gap: usize,
    /// Order of the votes, and votes that a line removes.
    pub definition: SegmentDefinition,
}

impl Default for SegmentParameters {
    fn default() -> Self {
        Self { threshold: 50, min_length: 30, max_gap: 5, definition: SegmentDefinition::default() }
    }
}

/// Finds line segments by the votes of pixels in random order: the progressive probabilistic Hough transform
/// (J. Matas, C. Galambos and J. Kittler, "Robust detection of lines using the progressive probabilistic
/// Hough transform", Computer Vision and Image Understanding 78, 2000). Its buffers are reused from image to
/// image.
///
/// Pixels are drawn at random, and each votes for the lines through it. When the leading line of a pixel has
/// enough votes, its pixels are followed to both sides across small gaps and removed from the vote; if they
/// reach far enough, they form a segment, and their votes are withdrawn. OpenCV's deviations are a
/// [`SegmentDefinition`]; with it, the segments equal OpenCV's, one by one, at a distance step of one pixel.
///
/// ```
/// use roverlab::vision::{GrayView, HoughSegments, SegmentParameters};
/// let mut edges = [0; 60 * 40];
/// (10..50).for_each(|column| edges[60 * 20 + column] = 255);
/// let parameters = SegmentParameters { threshold: 20, min_length: 30, max_gap: 2, ..Default::default() };
/// let segments = HoughSegments::new(180)?.find(GrayView::new(&edges, 60, 40)?, parameters);
/// assert_eq!(segments.len(), 1);
/// assert_eq!((segments[0].from, segments[0].to), ((10, 20), (49, 20)));
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
#[derive(Debug, Clone)]
pub struct HoughSegments {
    directions: Vec<[f32; 2]>,
    /// Vote counters. 16 bits suffice for images with a diagonal of up to 23,000 pixels, and halve the
    /// memory, which is much faster. Negative where segments withdrew more votes than were given.
    votes: Vec<i16>,
    /// Remaining edge pixels, and which of them have voted.
    mask: Vec<u8>,
    points: Vec<(u32, u32)>,
    places: Vec<u32>,
    size: (usize, usize),
}

/// Mask value of a pixel that is no edge, or no longer one.
const NO_EDGE: u8 = 0;
/// Mask value of an edge pixel.
const EDGE: u8 = 1;
/// Mask value of an edge pixel that has voted.
const VOTED: u8 = 2;

/// Fractional bits of the fixed-point walk along a line.
const FRACTION: u32 = 16;

impl HoughSegments {
    /// A detector with `angles` angles in half a turn.
    ///
    /// # Errors
    ///
    /// If `angles` is not 1 to 3600.
    pub fn new(angles: usize) -> Result<Self, ImageError> {
        if !(1..=3600).contains(&angles) {
            let found = angles as f64;
            return Err(ParameterError::new("angles", found, "1 to 3600").into());
        }
        // Multiples of a step in single precision reproduce OpenCV's votes.
        let step = f64::from((PI / angles as f64) as f32);
        let direction = |angle: usize| {
            let (sin, cos) = math::sin_cos(step * angle as f64);
            [cos as f32, sin as f32]
        };
        Ok(Self {
            directions: (0..angles).map(direction).collect(),
            votes: Vec::new(),
            mask: Vec::new(),
            points: Vec::new(),
            places: Vec::new(),
            size: (0, 0),
        })
    }

    /// Segments in an edge image (edges: all pixels that are not 0), in the order in which they are found.
    pub fn find(&mut self, edges: GrayView<'_>, parameters: SegmentParameters) -> Vec<LineSegment> {
        self.gather(edges);
        let mut draw = Draw::new(parameters.definition);
        let mut lines = Vec::new();
        for left in (1..=self.points.len()).rev() {
            let drawn = draw.below(left);
            self.points.swap(drawn, left - 1);
            let (x, y) = self.points[left - 1];
            let (x, y) = (x as usize, y as usize);
            if self.mask[y * self.size.0 + x] == NO_EDGE {
                continue;
            }
            let (count, angle) = self.vote(x, y);
            if count >= parameters.threshold.max(1) {
                lines.extend(self.follow((x, y), angle, parameters));
            }
        }
        lines
    }

    fn gather(&mut self, edges: GrayView<'_>) {
        let (width, height) = edges.size();
        self.size = (width, height);
        self.mask.clear();
        self.points.clear();
        for y in 0..height {
            let row = edges.row(y);
            self.mask.extend(row.iter().map(|&edge| if edge == 0 { NO_EDGE } else { EDGE }));
            for (piece, start) in row.chunks(32).zip((0..).step_by(32)) {
                if piece.iter().all(|&edge| edge == 0) {
                    continue;
                }
                let set = piece.iter().enumerate().filter(|(_, edge)| **edge != 0);
                self.points.extend(set.map(|(x, _)| ((start + x) as u32, y as u32)));
            }
        }
        self.votes.clear();
        self.votes.resize(self.stride() * self.directions.len(), 0);
        self.places.resize(self.directions.len(), 0);
    }

    /// Maximum distance of a line from the first pixel: the diagonal, in whole pixels.
    fn reach(&self) -> usize {
        let (width, height) = self.size;
        (width * width + height * height).isqrt() + 1
    }

    /// Number of counters per angle: distances from minus to plus the maximum.
    fn stride(&self) -> usize {
        2 * self.reach() + 1
    }

    /// Lets a pixel vote. Returns the highest count among its lines, and the angle of that line.
    fn vote(&mut self, x: usize, y: usize) -> (u32, usize) {
        self.mask[y * self.size.0 + x] = VOTED;
        self.reckon(x, y);
        let (mut most, mut best) = (0_i16, 0);
        for (angle, &place) in self.places.iter().enumerate() {
            let count = &mut self.votes[place as usize];
            *count = count.saturating_add(1);
            if *count > most {
                (most, best) = (*count, angle);
            }
        }
        (most as u32, best)
    }

    fn take_back(&mut self, x: usize, y: usize) {
        self.reckon(x, y);
        for &place in &self.places {
            let count = &mut self.votes[place as usize];
            *count = count.saturating_sub(1);
        }
    }

    /// Accumulator indices of a pixel's lines.
    fn reckon(&mut self, x: usize, y: usize) {
        let (stride, middle) = (self.stride() as u32, self.reach() as u32);
        places_of([x as f32, y as f32], &self.directions, stride, middle, &mut self.places);
    }

    /// Follows a line's pixels to both sides and removes them from the image. Returns the segment if it is
    /// long enough.
    fn follow(
        &mut self,
        start: (usize, usize),
        angle: usize,
        parameters: SegmentParameters,
    ) -> Option<LineSegment> {
        let [cos, sin] = self.directions[angle];
        let walk = Walk::new(start, (-sin, cos));
        let ends = [1, -1].map(|side| self.last_on(&walk, side, parameters.max_gap));
        let [from, to] = ends.map(|steps| walk.pixel(steps));
        let reach = (from.0.abs_diff(to.0)).max(from.1.abs_diff(to.1)) as usize;
        let is_long = reach >= parameters.min_length;
        for step in ends[1]..=ends[0] {
            let (x, y) = walk.pixel(step);
            let (x, y) = (x as usize, y as usize);
            let place = y * self.size.0 + x;
            let taken = match std::mem::replace(&mut self.mask[place], NO_EDGE) {
                VOTED => true,
                EDGE => parameters.definition == SegmentDefinition::OpenCv,
                _ => false,
            };
            if taken && is_long {
                self.take_back(x, y);
            }
        }
        let pixel = |(x, y): (i64, i64)| (x as usize, y as usize);
        is_long.then(|| LineSegment { from: pixel(from), to: pixel(to) })
    }

    /// Last step to one side that has a pixel of the line.
    fn last_on(&self, walk: &Walk, side: i64, max_gap: usize) -> i64 {
        let (mut step, mut last, mut gap) = (0, 0, 0);
        loop {
            step += side;
            let (x, y) = walk.pixel(step);
            if x < 0 || y < 0 || x >= self.size.0 as i64 || y >= self.size.1 as i64 {
                return last;
            }
            if self.mask[y as usize * self.size.0 + x as usize] == NO_EDGE {
                gap += 1;
                if gap > max_gap {
                    return last;
                }
            } else {
                (last, gap) = (step, 0);
            }
        }
    }
}

/// A fixed-point walk along a line, one pixel per step along its longer axis.
struct Walk {
    x: i64,
    y: i64,
    /// Fixed-point increments per step.
    dx: i64,
    dy: i64,
}

impl Walk {
    fn new((x, y): (usize, usize), direction: (f32, f32)) -> Self {
        let one = (1_u32 << FRACTION) as f32;
        let longer = direction.0.abs().max(direction.1.abs());
        let step = |part: f32| (part * one / longer).round_ties_even() as i64;
        let half = 1_i64 << (FRACTION - 1);
        let middle = |place: usize| ((place as i64) << FRACTION) + half;
        Self { x: middle(x), y: middle(y), dx: step(direction.0), dy: step(direction.1) }
    }

    fn pixel(&self, step: i64) -> (i64, i64) {
        ((self.x + step * self.dx) >> FRACTION, (self.y + step * self.dy) >> FRACTION)
    }
}

/// Adding 1.5 * 2^23 to a float rounds it to an integer, which then stands in its low bits.
const ROUNDING: f32 = 12_582_912.0;

#[inline(always)]
fn places_of_portable(
    [x, y]: [f32; 2],
    directions: &[[f32; 2]],
    stride: u32,
    middle: u32,
    places: &mut [u32],
) {
    let base = ROUNDING.to_bits().wrapping_sub(middle);
    for ((place, [cos, sin]), angle) in places.iter_mut().zip(directions).zip(0_u32..) {
        *place = (x * cos + y * sin + ROUNDING).to_bits().wrapping_sub(base) + angle * stride;
    }
}

vectorised! {
    fn places_of(point: [f32; 2], directions: &[[f32; 2]], stride: u32, middle: u32, places: &mut [u32]) {
        places_of_portable(point, directions, stride, middle, places);
    }
}
