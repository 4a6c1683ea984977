use super::dispatch::{vectorised, vectorised_filter};
use super::view::{flatten, require_size};
use super::{GrayView, GrayViewMut, ImageError, RgbView, RgbViewMut};

/// Thresholds an image: 255 where a pixel is above the threshold, 0 elsewhere (book, Program 11.7).
///
/// ```
/// use roverlab::vision::{GrayView, GrayViewMut, threshold_into};
/// let mut mask = [0; 4];
/// threshold_into(GrayView::new(&[99, 100, 101, 255], 4, 1)?, GrayViewMut::new(&mut mask, 4, 1)?, 100)?;
/// assert_eq!(mask, [0, 0, 255, 255]);
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
///
/// # Errors
///
/// If the sizes differ.
pub fn threshold_into(input: GrayView<'_>, output: GrayViewMut<'_>, threshold: u8) -> Result<(), ImageError> {
    output.require_size(input.size())?;
    let (input, mut output) = flatten(input, output);
    above(input, &mut output, threshold);
    Ok(())
}

/// Draws marks over a gray image: the colour (red, green, blue) where `marks` is not 0, the gray pixel
/// elsewhere (book, section 11.2; `IPOverlayGray` of RoBIOS).
///
/// ```
/// use roverlab::vision::{GrayView, RgbViewMut, overlay_gray_into};
/// let (image, edges) = (GrayView::new(&[10, 20], 2, 1)?, GrayView::new(&[0, 255], 2, 1)?);
/// let mut shown = [0; 6];
/// overlay_gray_into(image, edges, [255, 0, 0], RgbViewMut::new(&mut shown, 2, 1)?)?;
/// assert_eq!(shown, [10, 10, 10, 255, 0, 0]);
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
///
/// # Errors
///
/// If the sizes differ.
pub fn overlay_gray_into(
    base: GrayView<'_>,
    marks: GrayView<'_>,
    colour: impl Into<[u8; 3]>,
    mut output: RgbViewMut<'_>,
) -> Result<(), ImageError> {
    require_size("second image", marks.size(), base.size())?;
    output.require_size(base.size())?;
    mark(base, marks, colour.into(), &mut output);
    Ok(())
}

/// Overlays two images: the pixels of `top`, and those of `base` where `top` is black (`IPOverlay` of
/// RoBIOS).
///
/// ```
/// use roverlab::vision::{RgbView, RgbViewMut, overlay_into};
/// let (base, top) = (RgbView::new(&[1, 2, 3, 4, 5, 6], 2, 1)?, RgbView::new(&[0, 0, 0, 0, 0, 9], 2, 1)?);
/// let mut shown = [0; 6];
/// overlay_into(base, top, RgbViewMut::new(&mut shown, 2, 1)?)?;
/// assert_eq!(shown, [1, 2, 3, 0, 0, 9]);
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
///
/// # Errors
///
/// If the sizes differ.
pub fn overlay_into(
    base: RgbView<'_>,
    top: RgbView<'_>,
    mut output: RgbViewMut<'_>,
) -> Result<(), ImageError> {
    require_size("second image", top.size(), base.size())?;
    output.require_size(base.size())?;
    cover(base, top, &mut output);
    Ok(())
}

#[inline(always)]
pub(super) fn above_portable(input: GrayView<'_>, output: &mut GrayViewMut<'_>, threshold: u8) {
    for y in 0..input.height() {
        for (out, &shade) in output.row_mut(y).iter_mut().zip(input.row(y)) {
            *out = if shade > threshold { 255 } else { 0 };
        }
    }
}

#[inline(always)]
pub(super) fn mark_portable(
    base: GrayView<'_>,
    marks: GrayView<'_>,
    colour: [u8; 3],
    output: &mut RgbViewMut<'_>,
) {
    for y in 0..base.height() {
        let pixels = output.row_mut(y).as_chunks_mut::<3>().0;
        for ((out, &shade), &mark) in pixels.iter_mut().zip(base.row(y)).zip(marks.row(y)) {
            *out = if mark == 0 { [shade; 3] } else { colour };
        }
    }
}

#[inline(always)]
pub(super) fn cover_portable(base: RgbView<'_>, top: RgbView<'_>, output: &mut RgbViewMut<'_>) {
    for y in 0..base.height() {
        let pixels = output.row_mut(y).as_chunks_mut::<3>().0;
        let (below, above) = (base.row(y).as_chunks::<3>().0, top.row(y).as_chunks::<3>().0);
        for ((out, below), above) in pixels.iter_mut().zip(below).zip(above) {
            *out = if *above == [0; 3] { *below } else { *above };
        }
    }
}

vectorised_filter! {
    fn above(input: GrayView<'_>, output: &mut GrayViewMut<'_>, threshold: u8) {
        above_portable(input, output, threshold);
    }
}

vectorised! {
    fn mark(base: GrayView<'_>, marks: GrayView<'_>, colour: [u8; 3], output: &mut RgbViewMut<'_>) {
        mark_portable(base, marks, colour, output);
    }
}

vectorised! {
    fn cover(base: RgbView<'_>, top: RgbView<'_>, output: &mut RgbViewMut<'_>) {
        cover_portable(base, top, output);
    }
}
