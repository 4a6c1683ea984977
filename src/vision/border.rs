use super::blocks::in_blocks;
use super::view::{GrayView, GrayViewMut};

/// Treatment of the image border, where a kernel lacks neighbours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Border {
    /// The outermost pixels of the output are 0, as in the book.
    #[default]
    Zero,
    /// The image is mirrored about its outermost pixels (`dcb|abcd|cba`), as in OpenCV.
    Mirror,
}

/// Index in `0..n` that corresponds to `i` in an image mirrored about its outermost pixels.
#[inline]
pub(super) fn mirrored(i: isize, n: usize) -> usize {
    let last = n as isize - 1;
    let once = last - (last - i.abs()).abs();
    if once >= 0 {
        return once as usize;
    }
    // Farther out than the image is wide. Divisions are slow, and some kernels call this for every row.
    if last == 0 {
        return 0;
    }
    let i = i.rem_euclid(2 * last);
    i.min(2 * last - i) as usize
}

/// Applies a function of 3 x 3 pixels, rows from the top, to every pixel. Its result is at most 255.
///
/// The function must be `#[inline(always)]`, which a closure is not; otherwise it is not compiled for the
/// selected processor.
#[inline(always)]
pub(super) fn stencil(
    input: GrayView<'_>,
    output: &mut GrayViewMut<'_>,
    border: Border,
    point: impl Fn([[u16; 3]; 3]) -> u16 + Copy,
) {
    let (width, height) = input.size();
    let last = width - 1;
    let (west, east) = (mirrored(-1, width), mirrored(width as isize, width));
    for y in 0..height {
        let out = output.row_mut(y);
        if border == Border::Zero && (y == 0 || y + 1 == height) {
            out.fill(0);
            continue;
        }
        let above = input.row(mirrored(y as isize - 1, height));
        let below = input.row(mirrored(y as isize + 1, height));
        let rows = [above, input.row(y), below];
        if width > 2 {
            inner(rows, &mut out[1..last], point);
        }
        match border {
            Border::Zero => (out[0], out[last]) = (0, 0),
            Border::Mirror => {
                out[0] = point(taken(rows, [west, 0, west])) as u8;
                out[last] = point(taken(rows, [east, last, east])) as u8;
            }
        }
    }
}

/// All pixels of a row except the first and the last, two at a time. The 16-bit words `x - 1`, `x` and
/// `x + 1`, `x + 2` hold all that `x` and `x + 1` need; a mask and a shift separate them. Widening byte by
/// byte would take longer than the computation.
#[inline(always)]
fn inner([above, row, below]: [&[u8]; 3], out: &mut [u8], point: impl Fn([[u16; 3]; 3]) -> u16) {
    let n = out.len();
    let (pairs, odd) = out.as_chunks_mut::<2>();
    let (a, b, c) = (words(above), words(row), words(below));
    let (a2, b2, c2) = (words(&above[2..]), words(&row[2..]), words(&below[2..]));
    in_blocks!(pairs; a in a, b in b, c in c, a2 in a2, b2 in b2, c2 in c2 => {
        let (a, b, c) = (u16::from_le_bytes(a), u16::from_le_bytes(b), u16::from_le_bytes(c));
        let (a2, b2, c2) = (u16::from_le_bytes(a2), u16::from_le_bytes(b2), u16::from_le_bytes(c2));
        let first = point([[a & 255, a >> 8, a2 & 255], [b & 255, b >> 8, b2 & 255], [c & 255, c >> 8, c2 & 255]]);
        let second = point([[a >> 8, a2 & 255, a2 >> 8], [b >> 8, b2 & 255, b2 >> 8], [c >> 8, c2 & 255, c2 >> 8]]);
        (first | (second << 8)).to_le_bytes()
    });
    if let [odd] = odd {
        *odd = point(taken([above, row, below], [n - 1, n, n + 1])) as u8;
    }
}

/// Pixels of three columns.
#[inline(always)]
fn taken([a, b, c]: [&[u8]; 3], [w, x, e]: [usize; 3]) -> [[u16; 3]; 3] {
    let pixel = u16::from;
    [
        [pixel(a[w]), pixel(a[x]), pixel(a[e])],
        [pixel(b[w]), pixel(b[x]), pixel(b[e])],
        [pixel(c[w]), pixel(c[x]), pixel(c[e])],
    ]
}

#[inline(always)]
fn words(row: &[u8]) -> &[[u8; 2]] {
    row.as_chunks().0
}
