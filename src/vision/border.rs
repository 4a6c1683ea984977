use super::view::{GrayView, GrayViewMut};

/// What a kernel does at the border of an image, where neighbours are missing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Border {
    /// The output's outermost pixels are 0, as the book has it.
    #[default]
    Zero,
    /// The image is continued by its mirror image about the outermost pixels (`dcb|abcd|cba`), as OpenCV does.
    Mirror,
}

/// The index in `0..n` that stands for `i` in an image continued by mirrors about its outermost pixels.
#[inline]
pub(super) fn mirrored(i: isize, n: usize) -> usize {
    let period = 2 * (n as isize - 1);
    if period == 0 {
        return 0;
    }
    let i = i.rem_euclid(period);
    i.min(period - i) as usize
}

/// Applies a function of 3 x 3 pixels, rows from the top, to every pixel.
#[inline(always)]
pub(super) fn stencil(
    input: GrayView<'_>,
    output: &mut GrayViewMut<'_>,
    border: Border,
    point: impl Fn([[u8; 3]; 3]) -> u8,
) {
    let (width, height) = input.size();
    for y in 0..height {
        let out = output.row_mut(y);
        if border == Border::Zero && (y == 0 || y + 1 == height) {
            out.fill(0);
            continue;
        }
        let above = input.row(mirrored(y as isize - 1, height));
        let row = input.row(y);
        let below = input.row(mirrored(y as isize + 1, height));
        if let Some(inner) = width.checked_sub(2) {
            let out = &mut out[1..][..inner];
            let (a, b, c) = (&above[..inner + 2], &row[..inner + 2], &below[..inner + 2]);
            let (a1, a2, b1, b2, c1, c2) = (&a[1..], &a[2..], &b[1..], &b[2..], &c[1..], &c[2..]);
            for x in 0..inner {
                out[x] = point([[a[x], a1[x], a2[x]], [b[x], b1[x], b2[x]], [c[x], c1[x], c2[x]]]);
            }
        }
        for x in [0, width - 1] {
            let (west, east) = (mirrored(x as isize - 1, width), mirrored(x as isize + 1, width));
            out[x] = match border {
                Border::Zero => 0,
                Border::Mirror => point([
                    [above[west], above[x], above[east]],
                    [row[west], row[x], row[east]],
                    [below[west], below[x], below[east]],
                ]),
            };
        }
    }
}
