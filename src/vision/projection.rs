use super::dispatch::vectorised;
use super::view::require_size;
use super::{Error, GrayView};

/// The sums of all columns and of all rows (book, section 11.4, where the image is one of matches).
///
/// Fails unless there is one sum for each column and row.
pub fn projections_into(input: GrayView<'_>, columns: &mut [u32], rows: &mut [u32]) -> Result<(), Error> {
    require_size("pair of projections", (columns.len(), rows.len()), input.size())?;
    project(input, columns, rows);
    Ok(())
}

/// The first place of the largest value, and the value (book, Program 11.10); `None` if there is none above 0.
pub fn maximum(histogram: &[u32]) -> Option<(usize, u32)> {
    let largest = histogram.iter().copied().max().filter(|&value| value > 0)?;
    histogram.iter().position(|&value| value == largest).map(|place| (place, largest))
}

/// Columns that are summed up together: their sums fit the fastest cache, and long rows are read at a stretch.
const STRIP: usize = 4096;
/// Rows of bytes whose sum fits 16 bits.
const ROWS: usize = 257;

#[inline(always)]
pub(super) fn project_portable(input: GrayView<'_>, columns: &mut [u32], rows: &mut [u32]) {
    let (width, height) = input.size();
    columns.fill(0);
    rows.fill(0);
    for start in (0..width).step_by(STRIP) {
        let end = (start + STRIP).min(width);
        for top in (0..height).step_by(ROWS) {
            let mut sums = [0_u16; STRIP];
            let sums = &mut sums[..end - start];
            let bottom = (top + ROWS).min(height);
            for (y, total) in (top..bottom).zip(&mut rows[top..bottom]) {
                let row = &input.row(y)[start..end];
                for (sum, &shade) in sums.iter_mut().zip(row) {
                    *sum += u16::from(shade);
                }
                *total += row.iter().map(|&shade| u32::from(shade)).sum::<u32>();
            }
            for (column, &sum) in columns[start..end].iter_mut().zip(&*sums) {
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
