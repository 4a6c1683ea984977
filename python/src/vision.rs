//! Kernels on images. Each takes an array of any strides, and copies only those that have no rows of pixels
//! side by side.

use numpy::PyArrayDyn;
use pyo3::prelude::*;
use roverlab::vision::{
    Border, Canny, CannyThresholds, GaussianKernel, GrayWeights, HueLimits, HueScale, SobelScale,
    absolute_difference_into, gaussian_into, gray_into, hue_into, laplace_into, laplace_saturated_into,
    sobel_l1_into, sobel_l2_into, threshold_into,
};

use crate::arrays::Natural;
use crate::errors::{Failure, Outcome};
use crate::image::{combine, filter};

type Made<'py> = Outcome<Bound<'py, PyArrayDyn<u8>>>;

/// The value that a name stands for.
fn chosen<T: Copy>(parameter: &str, name: &str, values: &[(&str, T)]) -> Outcome<T> {
    let found = values.iter().find(|(known, _)| *known == name);
    found.map(|(_, value)| *value).ok_or_else(|| {
        let names: Vec<&str> = values.iter().map(|(known, _)| *known).collect();
        Failure::value(parameter, format!("{name:?}"), &names.join(" or "))
    })
}

fn border_of(name: &str) -> Outcome<Border> {
    chosen("border", name, &[("zero", Border::Zero), ("mirror", Border::Mirror)])
}

/// Gray levels of a colour image.
///
/// Parameters
/// ----------
/// image : ndarray of uint8, shape (height, width, 3)
///     Red, green and blue.
/// out : ndarray of uint8, shape (height, width), optional
///     Where to write; otherwise a new array.
/// weights : str
///     ``robios``: (red + blue) / 4 + green / 2; ``rec601``: 0.299 red + 0.587 green + 0.114 blue.
#[pyfunction]
#[pyo3(signature = (image, out = None, *, weights = "robios"))]
pub(crate) fn gray<'py>(
    image: &Bound<'py, PyAny>,
    out: Option<&Bound<'py, PyAny>>,
    weights: &str,
) -> Made<'py> {
    let weights =
        chosen("weights", weights, &[("robios", GrayWeights::Robios), ("rec601", GrayWeights::Rec601)])?;
    filter::<3, 1>(image, out, |input, output| gray_into(input, output, weights))
}

/// Magnitude of the Sobel gradient, at most 255.
///
/// Parameters
/// ----------
/// image : ndarray of uint8, shape (height, width)
///     Gray levels.
/// out : ndarray of uint8, shape (height, width), optional
///     Where to write; otherwise a new array.
/// norm : str
///     ``l1``: the sum of the absolute values in x and y; ``l2``: the root of the sum of the squares.
/// thirds : bool
///     Whether to write a third of the magnitude, as RoBIOS does.
/// border : str
///     ``zero``: the outermost pixels are 0; ``mirror``: the image is mirrored about them.
#[pyfunction]
#[pyo3(signature = (image, out = None, *, norm = "l1", thirds = false, border = "zero"))]
pub(crate) fn sobel<'py>(
    image: &Bound<'py, PyAny>,
    out: Option<&Bound<'py, PyAny>>,
    norm: &str,
    thirds: bool,
    border: &str,
) -> Made<'py> {
    let scale = if thirds { SobelScale::Third } else { SobelScale::Full };
    let (sum, border) = (chosen("norm", norm, &[("l1", true), ("l2", false)])?, border_of(border)?);
    filter::<1, 1>(image, out, |input, output| {
        if sum {
            sobel_l1_into(input, output, scale, border)
        } else {
            sobel_l2_into(input, output, scale, border)
        }
    })
}

/// Laplace operator of four neighbours.
///
/// Parameters
/// ----------
/// image : ndarray of uint8, shape (height, width)
///     Gray levels.
/// out : ndarray of uint8, shape (height, width), optional
///     Where to write; otherwise a new array.
/// positive : bool
///     Whether to write the positive part, which marks the dark side of edges, and not the absolute value.
/// border : str
///     ``zero`` or ``mirror``, as in `sobel`.
#[pyfunction]
#[pyo3(signature = (image, out = None, *, positive = false, border = "zero"))]
pub(crate) fn laplace<'py>(
    image: &Bound<'py, PyAny>,
    out: Option<&Bound<'py, PyAny>>,
    positive: bool,
    border: &str,
) -> Made<'py> {
    let border = border_of(border)?;
    filter::<1, 1>(image, out, |input, output| {
        if positive {
            laplace_saturated_into(input, output, border)
        } else {
            laplace_into(input, output, border)
        }
    })
}

/// Canny's edges: 255 at edges, which are one pixel wide, and 0 elsewhere.
///
/// Parameters
/// ----------
/// image : ndarray of uint8, shape (height, width)
///     Gray levels.
/// low, high : int
///     Gradient that every pixel of an edge exceeds, and one that at least one pixel of it exceeds: the sum
///     of the absolute values in x and y, 0 to 65535.
/// out : ndarray of uint8, shape (height, width), optional
///     Where to write; otherwise a new array.
#[pyfunction]
#[pyo3(signature = (image, low = 50, high = 100, out = None))]
pub(crate) fn canny<'py>(
    image: &Bound<'py, PyAny>,
    low: u16,
    high: u16,
    out: Option<&Bound<'py, PyAny>>,
) -> Made<'py> {
    let thresholds = CannyThresholds { low, high };
    filter::<1, 1>(image, out, |input, output| Canny::new().find_into(input, output, thresholds))
}

/// A smoothed image. It is mirrored at the border.
///
/// Parameters
/// ----------
/// image : ndarray of uint8, shape (height, width)
///     Gray levels.
/// size : int
///     Side of the kernel in pixels: 3, 5 or 7.
/// sigma : float, optional
///     Standard deviation (pixels); without it, the binomial kernel of this size.
/// out : ndarray of uint8, shape (height, width), optional
///     Where to write; otherwise a new array.
#[pyfunction]
#[pyo3(
    signature = (image, size = Natural::of(3), sigma = None, out = None),
    text_signature = "(image, size=3, sigma=None, out=None)"
)]
pub(crate) fn gaussian<'py>(
    image: &Bound<'py, PyAny>,
    size: Natural,
    sigma: Option<f64>,
    out: Option<&Bound<'py, PyAny>>,
) -> Made<'py> {
    let kernel = match (size.index("size")?, sigma) {
        (3, None) => GaussianKernel::THREE,
        (5, None) => GaussianKernel::FIVE,
        (7, None) => GaussianKernel::SEVEN,
        (size, sigma) => GaussianKernel::new(size, sigma.unwrap_or(1.0))?,
    };
    filter::<1, 1>(image, out, |input, output| gaussian_into(input, output, kernel))
}

/// 255 where the gray level is above `level`, and 0 elsewhere.
///
/// Parameters
/// ----------
/// image : ndarray of uint8, shape (height, width)
///     Gray levels.
/// level : int
///     The threshold, 0 to 255.
/// out : ndarray of uint8, shape (height, width), optional
///     Where to write; otherwise a new array.
#[pyfunction]
#[pyo3(signature = (image, level, out = None))]
pub(crate) fn threshold<'py>(
    image: &Bound<'py, PyAny>,
    level: Natural,
    out: Option<&Bound<'py, PyAny>>,
) -> Made<'py> {
    let level = level.byte("level")?;
    filter::<1, 1>(image, out, |input, output| threshold_into(input, output, level))
}

/// Hue of each pixel.
///
/// Parameters
/// ----------
/// image : ndarray of uint8, shape (height, width, 3)
///     Red, green and blue.
/// out : ndarray of uint8, shape (height, width), optional
///     Where to write; otherwise a new array.
/// scale : str
///     ``robios``: a circle of 252, red is 42; ``opencv``: a circle of 180, red is 0.
///
/// Returns
/// -------
/// ndarray of uint8, shape (height, width)
///     The hues; 255 for pixels that are gray, pale (saturation below a half) or dark (gray level below 26).
#[pyfunction]
#[pyo3(signature = (image, out = None, *, scale = "robios"))]
pub(crate) fn hue<'py>(image: &Bound<'py, PyAny>, out: Option<&Bound<'py, PyAny>>, scale: &str) -> Made<'py> {
    let scale = chosen("scale", scale, &[("robios", HueScale::Robios), ("opencv", HueScale::OpenCv)])?;
    filter::<3, 1>(image, out, |input, output| hue_into(input, output, scale, HueLimits::default()))
}

/// Absolute difference of two gray images, pixel by pixel.
///
/// Parameters
/// ----------
/// first, second : ndarray of uint8, shape (height, width)
///     The images.
/// out : ndarray of uint8, shape (height, width), optional
///     Where to write; otherwise a new array.
#[pyfunction]
#[pyo3(signature = (first, second, out = None))]
pub(crate) fn absolute_difference<'py>(
    first: &Bound<'py, PyAny>,
    second: &Bound<'py, PyAny>,
    out: Option<&Bound<'py, PyAny>>,
) -> Made<'py> {
    combine([first, second], out, |[first, second], output| absolute_difference_into(first, second, output))
}
