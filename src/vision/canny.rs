use super::blocks::in_blocks;
use super::dispatch::vectorised;
use super::{GrayView, GrayViewMut, ImageError};
use crate::ParameterError;

/// Thresholds of [`Canny`] on the gradient magnitude.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct CannyThresholds {
    /// Minimum magnitude `|dx| + |dy|` (exclusive) of every edge pixel.
    pub low: u16,
    /// Magnitude that at least one pixel of an edge must exceed.
    pub high: u16,
}

impl Default for CannyThresholds {
    /// Values of the book (Program 11.8).
    fn default() -> Self {
        Self { low: 50, high: 100 }
    }
}

/// Canny's edge detector (J. Canny, "A computational approach to edge detection", IEEE PAMI 8(6), 1986; book,
/// Program 11.8), as defined by OpenCV. Its buffers are reused from image to image.
///
/// Smooth noisy images first, with [`gaussian_into`](super::gaussian_into). The steps:
///
/// 1. Sobel gradient of each pixel, the image extended by its outermost pixels; the magnitude is
///    `|dx| + |dy|`.
/// 2. Non-maximum suppression. A pixel above `low` stays if its magnitude exceeds that of the first neighbour
///    along the gradient and is at least that of the second. The neighbours are west and east where
///    `|dy| < tan(22.5°) |dx|`, north and south where `|dy| > tan(67.5°) |dx|`, and otherwise diagonal, where
///    it must exceed both. `tan(22.5°)` is `13573 / 32768`, `tan(67.5°)` is that plus 2. Outside the image,
///    magnitudes are 0.
/// 3. Hysteresis. A remaining pixel is an edge, 255, if a chain of 8-connected neighbours leads to a pixel
///    above `high`.
///
/// ```
/// use roverlab::vision::{Canny, CannyThresholds, GrayView, GrayViewMut};
/// let image = [
///     0, 0, 0, 200, 200, 200, //
///     0, 0, 0, 200, 200, 200, //
///     0, 0, 0, 200, 200, 200,
/// ];
/// let mut edges = [0; 18];
/// let (input, output) = (GrayView::new(&image, 6, 3)?, GrayViewMut::new(&mut edges, 6, 3)?);
/// Canny::new().find_into(input, output, CannyThresholds::default())?;
/// assert_eq!(edges[6..12], [0, 0, 255, 0, 0, 0], "an edge is one pixel wide");
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Canny {
    /// Gradients of three rows, used in rotation.
    rows: [Gradients; 3],
    /// Mark of each pixel, with a margin of one pixel on all sides.
    marks: Vec<u8>,
    /// Indices in `marks` of edge pixels whose neighbours are not yet examined.
    open: Vec<usize>,
}

/// Gradients of one row.
#[derive(Debug, Clone, Default)]
struct Gradients {
    dx: Vec<i16>,
    dy: Vec<i16>,
    /// Padded with one 0 on either side.
    magnitude: Vec<u16>,
}

/// Number of pixels searched for strong ones at a time.
const PIECE: usize = 64;
/// Mark of a pixel that is no edge.
const NONE: u8 = 0;
/// Mark of an edge candidate: an edge if connected to a strong pixel.
const WEAK: u8 = 1;
/// Mark of an edge pixel.
const STRONG: u8 = 2;

impl Canny {
    /// A detector without buffers; the first image allocates them.
    pub fn new() -> Self {
        Self::default()
    }

    /// Writes 255 at edges and 0 elsewhere. Linear in the number of pixels.
    ///
    /// # Errors
    ///
    /// If the sizes differ or `low` exceeds `high`.
    pub fn find_into(
        &mut self,
        input: GrayView<'_>,
        mut output: GrayViewMut<'_>,
        thresholds: CannyThresholds,
    ) -> Result<(), ImageError> {
        output.require_size(input.size())?;
        let CannyThresholds { low, high } = thresholds;
        if low > high {
            let expected = "at most the high threshold";
            return Err(ParameterError::new("low threshold", f64::from(low), expected).into());
        }
        self.make_room(input.width(), input.height());
        mark(input, &mut self.rows, &mut self.marks, thresholds);
        self.follow(input.width());
        write(&self.marks, &mut output);
        Ok(())
    }

    fn make_room(&mut self, width: usize, height: usize) {
        for row in &mut self.rows {
            row.dx.resize(width, 0);
            row.dy.resize(width, 0);
            row.magnitude.clear();
            row.magnitude.resize(width + 2, 0);
        }
        self.marks.clear();
        self.marks.resize((width + 2) * (height + 2), NONE);
    }

    /// Promotes all weak pixels that are connected to strong ones.
    fn follow(&mut self, width: usize) {
        let stride = width + 2;
        let neighbours = [
            !stride,
            stride.wrapping_neg(),
            stride.wrapping_neg() + 1,
            !0,
            1,
            stride - 1,
            stride,
            stride + 1,
        ];
        for start in (0..self.marks.len()).step_by(PIECE) {
            let end = (start + PIECE).min(self.marks.len());
            if !self.marks[start..end].contains(&STRONG) {
                continue;
            }
            self.open.extend((start..end).filter(|&place| self.marks[place] == STRONG));
            while let Some(place) = self.open.pop() {
                for offset in neighbours {
                    let next = place.wrapping_add(offset);
                    if self.marks[next] == WEAK {
                        self.marks[next] = STRONG;
                        self.open.push(next);
                    }
                }
            }
        }
    }
}

#[inline(always)]
fn mark_portable(
    input: GrayView<'_>,
    rows: &mut [Gradients; 3],
    marks: &mut [u8],
    thresholds: CannyThresholds,
) {
    let (width, height) = input.size();
    let stride = width + 2;
    // The first of the three rows is the one above the marked row; the last holds the newest gradients.
    for y in 0..=height {
        rows.rotate_left(1);
        if y < height {
            let row = |dy: isize| input.row((y as isize + dy).clamp(0, height as isize - 1) as usize);
            differentiate(row(-1), row(0), row(1), &mut rows[2]);
        } else {
            rows[2].magnitude.fill(0);
        }
        if y > 0 {
            let marks = &mut marks[y * stride + 1..][..width];
            suppress(rows, marks, thresholds);
        }
    }
}

/// Computes the gradients of a row.
#[inline(always)]
fn differentiate(above: &[u8], row: &[u8], below: &[u8], out: &mut Gradients) {
    let width = row.len();
    if let Some(inner) = width.checked_sub(2) {
        let dx = &mut out.dx[1..][..inner];
        let dy = &mut out.dy[1..][..inner];
        let magnitude = &mut out.magnitude[2..][..inner];
        in_blocks!(dx, dy, magnitude;
            nw in above, n in above[1..], ne in above[2..],
            w in row, e in row[2..],
            sw in below, s in below[1..], se in below[2..] =>
            gradient([nw, n, ne], [w, e], [sw, s, se]));
    }
    for x in [0, width - 1] {
        let (west, east) = (x.saturating_sub(1), (x + 1).min(width - 1));
        let three = |row: &[u8]| [row[west], row[x], row[east]];
        (out.dx[x], out.dy[x], out.magnitude[x + 1]) =
            gradient(three(above), [row[west], row[east]], three(below));
    }
}

#[inline(always)]
fn gradient(above: [u8; 3], [w, e]: [u8; 2], below: [u8; 3]) -> (i16, i16, u16) {
    let (nw, n, ne) = (i16::from(above[0]), i16::from(above[1]), i16::from(above[2]));
    let (sw, s, se) = (i16::from(below[0]), i16::from(below[1]), i16::from(below[2]));
    let (w, e) = (i16::from(w), i16::from(e));
    let dx = (ne - nw) + 2 * (e - w) + (se - sw);
    let dy = (sw - nw) + 2 * (s - n) + (se - ne);
    (dx, dy, dx.unsigned_abs() + dy.unsigned_abs())
}

/// Marks the pixels of the middle row: non-maximum suppression and thresholds.
#[inline(always)]
fn suppress(rows: &[Gradients; 3], marks: &mut [u8], CannyThresholds { low, high }: CannyThresholds) {
    let [above, row, below] = rows;
    let (a, b, c) = (&above.magnitude, &row.magnitude, &below.magnitude);
    in_blocks!(marks;
        dx in row.dx, dy in row.dy,
        nw in a, n in a[1..], ne in a[2..],
        w in b, magnitude in b[1..], e in b[2..],
        sw in c, s in c[1..], se in c[2..] => {
        let (along, up) = (dx.unsigned_abs(), dy.unsigned_abs());
        // `tan(22.5°) |dx|` is an integer only where `dx` is 0, so rounding down keeps the order.
        let flat = ((u32::from(2 * along) * 13_573) >> 16) as u16;
        let (horizontal, vertical) = (up <= flat, up > flat + 2 * along);
        let rising = (dx ^ dy) < 0;
        let (first, second) = (if rising { ne } else { nw }, if rising { sw } else { se } + 1);
        let first = if vertical { n } else { first };
        let second = if vertical { s } else { second };
        let first = if horizontal { w } else { first };
        let second = if horizontal { e } else { second };
        let kept = (magnitude > low) & (magnitude > first) & (magnitude >= second);
        let mark = if magnitude > high { STRONG } else { WEAK };
        if kept { mark } else { NONE }
    });
}

#[inline(always)]
fn write_portable(marks: &[u8], output: &mut GrayViewMut<'_>) {
    let (width, height) = output.size();
    for y in 0..height {
        let marks = &marks[(y + 1) * (width + 2) + 1..][..width];
        for (out, &mark) in output.row_mut(y).iter_mut().zip(marks) {
            *out = if mark == STRONG { 255 } else { 0 };
        }
    }
}

/// The whole detector without processor selection.
#[cfg(test)]
pub(super) fn find_portable(input: GrayView<'_>, output: &mut GrayViewMut<'_>, thresholds: CannyThresholds) {
    let mut canny = Canny::new();
    canny.make_room(input.width(), input.height());
    mark_portable(input, &mut canny.rows, &mut canny.marks, thresholds);
    canny.follow(input.width());
    write_portable(&canny.marks, output);
}

vectorised! {
    fn mark(input: GrayView<'_>, rows: &mut [Gradients; 3], marks: &mut [u8], thresholds: CannyThresholds) {
        mark_portable(input, rows, marks, thresholds);
    }
}

vectorised! {
    fn write(marks: &[u8], output: &mut GrayViewMut<'_>) {
        write_portable(marks, output);
    }
}
