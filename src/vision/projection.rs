use super::dispatch::vectorised;
use super::view::require_size;
use super::{GrayView, ImageError};

/// Sums of all columns and of all rows (book, section 11.4, for a mask).
///
/// ```
/// use roverlab::vision::{GrayView, maximum, projections_into};
/// let matches = [0, 255, 0, 0, 255, 255];
/// let (mut columns, mut rows) = ([0; 3], [0; 2]);
/// projections_into(GrayView::new(&matches, 3, 2)?, &mut columns, &mut rows)?;
/// assert_eq!((columns, rows), ([0, 510, 255], [255, 510]));
/// assert_eq!(maximum(&columns), Some((1, 510)), "the object is in column 1");
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
///
/// # Errors
///
/// If there is not one sum per column and row.
pub fn projections_into(
    input: GrayView<'_>,
    columns: &mut [u32],
    rows: &mut [u32],
) -> Result<(), ImageError> {
    require_size("pair of projections", (columns.len(), rows.len()), input.size())?;
    project(input, columns, rows);
    Ok(())
}

/// Index and value of the first maximum (book, Program 11.10); `None` if no value is above 0.
pub fn maximum(histogram: &[u32]) -> Option<(usize, u32)> {
    let largest = histogram.iter().copied().max().filter(|&value| value > 0)?;
    histogram.iter().position(|&value| value == largest).map(|place| (place, largest))
}

/// Number of pixels per block. Pairs are added as 16-bit words and separated by a shift, so that nothing
/// moves between lanes.
const BLOCK: usize = 64;
/// Number of blocks summed at a time: their sums fit the L1 cache, and row sums fit 16 bits.
const STRIP: usize = 64;
/// Number of rows of bytes whose sum fits 16 bits.
const ROWS: usize = 257;

/// Column sums of a block: even columns, then odd ones.
type Sums = [[u16; BLOCK / 2]; 2];

#[inline(always)]
pub(super) fn project_portable(input: GrayView<'_>, columns: &mut [u32], rows: &mut [u32]) {
    columns.fill(0);
    rows.fill(0);
    for (strip, columns) in columns.chunks_mut(STRIP * BLOCK).enumerate() {
        let start = strip * STRIP * BLOCK;
        for (part, rows) in rows.chunks_mut(ROWS).enumerate() {
            let mut sums = [[[0; BLOCK / 2]; 2]; STRIP];
            for (y, total) in (part * ROWS..).zip(rows) {
                *total += add_row(&input.row(y)[start..start + columns.len()], &mut sums);
            }
            add_columns(&sums, columns);
        }
    }
}

/// Adds a row to its column sums and returns the row sum.
#[inline(always)]
fn add_row(row: &[u8], sums: &mut [Sums; STRIP]) -> u32 {
    let (blocks, rest) = row.as_chunks::<BLOCK>();
    let mut totals = [0_u16; BLOCK / 2];
    for (block, [evens, odds]) in blocks.iter().zip(&mut *sums) {
        let (words, _) = block.as_chunks::<2>();
        for i in 0..BLOCK / 2 {
            let word = u16::from_le_bytes(words[i]);
            let (even, odd) = (word & 0xff, word >> 8);
            evens[i] += even;
            odds[i] += odd;
            totals[i] += even + odd;
        }
    }
    for (i, &shade) in rest.iter().enumerate() {
        sums[blocks.len()][i % 2][i / 2] += u16::from(shade);
    }
    let rest = rest.iter().map(|&shade| u32::from(shade)).sum::<u32>();
    rest + totals.iter().map(|&total| u32::from(total)).sum::<u32>()
}

#[inline(always)]
fn add_columns(sums: &[Sums; STRIP], columns: &mut [u32]) {
    for (columns, [evens, odds]) in columns.chunks_mut(BLOCK).zip(sums) {
        for ((pair, even), odd) in columns.chunks_mut(2).zip(evens).zip(odds) {
            for (column, &sum) in pair.iter_mut().zip([even, odd]) {
                *column += u32::from(sum);
            }
        }
    }
}

vectorised! {
    fn project(input: GrayView<'_>, columns: &mut [u32], rows: &mut [u32]) {
        project_portable(input, columns, rows);
    }
}
