use super::dispatch::vectorised;
use super::hue_match::Sectors;
use super::planes::{PIECE, split};
use super::view::require_size;
use super::{HueLimits, HueRange, ImageError, RgbView};

/// Counts, per column, the pixels whose hue is in the range (book, Program 11.9). Hues are on the RoBIOS
/// scale. One pass from colours to histogram.
///
/// ```
/// use roverlab::vision::{HueLimits, HueRange, HueScale, RgbView, hue_histogram_into};
/// let (red, blue) = ([200, 10, 10], [10, 10, 200]);
/// let image = [red, blue, blue, red, red, blue].concat();
/// let range = HueRange::like(red, 10, HueScale::Robios)?;
/// let mut columns = [0; 3];
/// hue_histogram_into(RgbView::new(&image, 3, 2)?, &mut columns, range, HueLimits::default())?;
/// assert_eq!(columns, [2, 1, 0], "red pixels in each column");
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
///
/// # Errors
///
/// If `columns` does not have one entry per column.
pub fn hue_histogram_into(
    input: RgbView<'_>,
    columns: &mut [u32],
    range: HueRange,
    limits: HueLimits,
) -> Result<(), ImageError> {
    require_size("histogram", (columns.len(), 1), (input.width(), 1))?;
    histogram(input, columns, &Sectors::new(range, limits));
    Ok(())
}

/// Number of columns counted at a time.
const STRIP: usize = PIECE;
/// Number of rows whose count fits 16 bits.
const ROWS: usize = 65_535;

#[inline(always)]
pub(super) fn histogram_portable(input: RgbView<'_>, columns: &mut [u32], sectors: &Sectors) {
    let (width, height) = input.size();
    columns.fill(0);
    let (mut red, mut green, mut blue) = ([0; STRIP], [0; STRIP], [0; STRIP]);
    for start in (0..width).step_by(STRIP) {
        let end = (start + STRIP).min(width);
        for top in (0..height).step_by(ROWS) {
            let mut counts = [0_u16; STRIP];
            let counts = &mut counts[..end - start];
            for y in top..(top + ROWS).min(height) {
                let pixels = &input.row(y).as_chunks::<3>().0[start..end];
                split(pixels, &mut red, &mut green, &mut blue);
                let colours = red.iter().zip(&green).zip(&blue);
                for (count, ((&red, &green), &blue)) in counts.iter_mut().zip(colours) {
                    *count += u16::from(sectors.contain([red, green, blue]));
                }
            }
            for (column, &count) in columns[start..end].iter_mut().zip(&*counts) {
                *column += u32::from(count);
            }
        }
    }
}

vectorised! {
    fn histogram(input: RgbView<'_>, columns: &mut [u32], sectors: &Sectors) {
        histogram_portable(input, columns, sectors);
    }
}
