//! Images in numpy's memory as views of the library.

use numpy::{
    PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyReadwriteArrayDyn, PyUntypedArray,
    PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use roverlab::vision::{ImageError, View, ViewMut};

use crate::arrays::{shown, state};
use crate::errors::{Failure, Outcome};

/// Pixels from which a kernel lets other threads of Python run.
const LARGE: usize = 1 << 14;

/// An array of bytes whose shape is that of an image of `C` bytes per pixel.
struct Image<'py, const C: usize> {
    array: Bound<'py, PyArrayDyn<u8>>,
    width: usize,
    height: usize,
}

impl<'py, const C: usize> Image<'py, C> {
    fn of(name: &str, object: &Bound<'py, PyAny>) -> Outcome<Self> {
        let Ok(untyped) = object.cast::<PyUntypedArray>() else {
            return Err(Failure::kind(name, object.get_type(), "an ndarray of uint8"));
        };
        let Ok(array) = object.cast::<PyArrayDyn<u8>>() else {
            return Err(Failure::kind(name, format!("an array of {}", untyped.dtype()), "an array of uint8"));
        };
        let (height, width) = match (C, array.shape()) {
            (1, &[height, width]) | (3, &[height, width, 3]) => (height, width),
            (_, shape) => {
                let expected = if C == 1 { "shape (height, width)" } else { "shape (height, width, 3)" };
                return Err(Failure::value(&format!("shape of {name}"), shown(shape), expected));
            }
        };
        Ok(Self { array: array.clone(), width, height })
    }

    /// A new image.
    fn new(py: Python<'py>, (width, height): (usize, usize)) -> Self {
        let shape = if C == 1 { vec![height, width] } else { vec![height, width, C] };
        Self { array: PyArrayDyn::zeros(py, shape, false), width, height }
    }

    /// Bytes from one row to the next, if the rows are a view's: ascending, each without gaps.
    fn stride(&self) -> Option<usize> {
        let strides = self.array.strides();
        let row = self.width * C;
        let dense = strides[1] == C as isize && (C == 1 || strides[2] == 1);
        let stride = if self.height <= 1 { row } else { usize::try_from(strides[0]).ok()? };
        (dense && stride >= row && row > 0 && self.height > 0).then_some(stride)
    }

    /// Number of bytes from the first to the last one of a view.
    fn span(&self, stride: usize) -> usize {
        stride * (self.height - 1) + self.width * C
    }
}

/// An image to read, of which nobody in the package writes meanwhile.
struct Input<'py, const C: usize> {
    image: Image<'py, C>,
    _borrowed: PyReadonlyArrayDyn<'py, u8>,
    /// The pixels in order, if the array's are not.
    ordered: Option<Vec<u8>>,
}

impl<'py, const C: usize> Input<'py, C> {
    fn new(name: &str, object: &Bound<'py, PyAny>) -> Outcome<Self> {
        let image = Image::of(name, object)?;
        let borrowed = image.array.try_readonly();
        let borrowed = borrowed
            .map_err(|error| Failure::value(name, state(&error), "an array that nothing writes to"))?;
        let ordered = image.stride().is_none().then(|| borrowed.as_array().iter().copied().collect());
        Ok(Self { image, _borrowed: borrowed, ordered })
    }

    fn view(&self) -> Result<View<'_, C>, ImageError> {
        let Image { array, width, height } = &self.image;
        match (&self.ordered, self.image.stride()) {
            (None, Some(stride)) => {
                let length = self.image.span(stride);
                #[allow(unsafe_code, reason = "numpy has slices of contiguous arrays only")]
                // SAFETY: `stride` has checked that the array's elements are rows of `width * C` bytes,
                // `stride` bytes apart and ascending, so the first and the last byte of this range are
                // elements of the array, and with it lie in one allocation. The array is alive and borrowed
                // as long as `self`. As its innermost stride is 1, the borrow checker refuses to write to any
                // array in this range.
                let bytes = unsafe { std::slice::from_raw_parts(array.data().cast_const(), length) };
                View::with_stride(bytes, *width, *height, stride)
            }
            (ordered, _) => View::new(ordered.as_deref().unwrap_or_default(), *width, *height),
        }
    }
}

/// An image to write, which nobody else in the package uses meanwhile.
struct Output<'py, const C: usize> {
    image: Image<'py, C>,
    borrowed: PyReadwriteArrayDyn<'py, u8>,
    /// Stands in for an array whose rows are no view's.
    ordered: Option<Vec<u8>>,
}

impl<'py, const C: usize> Output<'py, C> {
    fn new(py: Python<'py>, out: Option<&Bound<'py, PyAny>>, size: (usize, usize)) -> Outcome<Self> {
        let image = match out {
            Some(out) => Image::of("out", out)?,
            None => Image::new(py, size),
        };
        if (image.width, image.height) != size {
            let found = format!("{} x {}", image.height, image.width);
            return Err(Failure::value(
                "size of out",
                found,
                &format!("{} x {}, as the image", size.1, size.0),
            ));
        }
        let borrowed = image.array.try_readwrite();
        let expected = "a writable array in memory apart from the image";
        let borrowed = borrowed.map_err(|error| Failure::value("out", state(&error), expected))?;
        let ordered = image.stride().is_none().then(|| vec![0; size.0 * size.1 * C]);
        Ok(Self { image, borrowed, ordered })
    }

    fn view(&mut self) -> Result<ViewMut<'_, C>, ImageError> {
        let Image { array, width, height } = &self.image;
        match (&mut self.ordered, self.image.stride()) {
            (None, Some(stride)) => {
                let length = self.image.span(stride);
                #[allow(unsafe_code, reason = "numpy has slices of contiguous arrays only")]
                // SAFETY: as in `Input::view`; the array is writable, the borrow checker keeps every other
                // array off this range, and `self` is borrowed as long as the slice.
                let bytes = unsafe { std::slice::from_raw_parts_mut(array.data(), length) };
                ViewMut::with_stride(bytes, *width, *height, stride)
            }
            (ordered, _) => ViewMut::new(ordered.as_deref_mut().unwrap_or_default(), *width, *height),
        }
    }

    /// The array, with all pixels written.
    fn finish(mut self) -> Bound<'py, PyArrayDyn<u8>> {
        if let Some(ordered) = &self.ordered {
            let mut array = self.borrowed.as_array_mut();
            array.iter_mut().zip(ordered).for_each(|(cell, byte)| *cell = *byte);
        }
        self.image.array
    }
}

/// The image that a kernel makes of another one, in `out` or in a new array.
pub(crate) fn filter<'py, const C: usize, const D: usize>(
    image: &Bound<'py, PyAny>,
    out: Option<&Bound<'py, PyAny>>,
    kernel: impl FnOnce(View<'_, C>, ViewMut<'_, D>) -> Result<(), ImageError> + Send,
) -> Outcome<Bound<'py, PyArrayDyn<u8>>> {
    let input = Input::<C>::new("image", image)?;
    let size = (input.image.width, input.image.height);
    let mut output = Output::<D>::new(image.py(), out, size)?;
    let (from, to) = (input.view()?, output.view()?);
    released(image.py(), size, || kernel(from, to))?;
    Ok(output.finish())
}

/// The image that a kernel makes of two, in `out` or in a new array.
pub(crate) fn combine<'py>(
    images: [&Bound<'py, PyAny>; 2],
    out: Option<&Bound<'py, PyAny>>,
    kernel: impl FnOnce([View<'_, 1>; 2], ViewMut<'_, 1>) -> Result<(), ImageError> + Send,
) -> Outcome<Bound<'py, PyArrayDyn<u8>>> {
    let (first, second) = (Input::<1>::new("first", images[0])?, Input::<1>::new("second", images[1])?);
    let size = (first.image.width, first.image.height);
    let py = images[0].py();
    let mut output = Output::<1>::new(py, out, size)?;
    let (from, to) = ([first.view()?, second.view()?], output.view()?);
    released(py, size, || kernel(from, to))?;
    Ok(output.finish())
}

/// Runs a kernel, and other threads of Python meanwhile if the image is large.
fn released<T: Send>(
    py: Python<'_>,
    (width, height): (usize, usize),
    kernel: impl FnOnce() -> T + Send,
) -> T {
    if width * height >= LARGE { py.detach(kernel) } else { kernel() }
}
