use super::ImageError;

/// A borrowed image of `C` bytes per pixel, with at least one pixel.
///
/// ```
/// use roverlab::vision::{GrayView, RgbView};
/// let bytes = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12];
/// let gray = GrayView::new(&bytes, 4, 3)?;
/// assert_eq!(gray.region((1, 1), 2, 2)?.row(0), [6, 7]);
/// assert_eq!(RgbView::new(&bytes, 2, 2)?.row(1), [7, 8, 9, 10, 11, 12]);
/// assert!(GrayView::new(&bytes, 5, 3).is_err(), "three bytes short");
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
///
/// ```
/// use roverlab::vision::View;
/// let pixels: Vec<u8> = (0..12).collect();
/// let gray = View::<1>::new(&pixels, 4, 3)?;
/// assert_eq!(gray.region((1, 1), 2, 2)?.row(0), [5, 6]);
/// assert!(View::<3>::new(&pixels, 4, 3).is_err(), "colours take three bytes a pixel");
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct View<'a, const C: usize> {
    data: &'a [u8],
    shape: Shape,
}

/// A borrowed, writable image of `C` bytes per pixel, with at least one pixel.
///
/// ```
/// use roverlab::vision::{GrayView, GrayViewMut, threshold_into};
/// let mut mask = [0; 12];
/// let corner = GrayViewMut::new(&mut mask, 4, 3)?.region((2, 1), 2, 2)?;
/// threshold_into(GrayView::new(&[9, 1, 1, 9], 2, 2)?, corner, 5)?;
/// assert_eq!(mask, [0, 0, 0, 0, 0, 0, 255, 0, 0, 0, 0, 255]);
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
///
/// ```
/// use roverlab::vision::ViewMut;
/// let mut pixels = vec![0; 12];
/// let mut gray = ViewMut::<1>::new(&mut pixels, 4, 3)?;
/// gray.row_mut(2).fill(9);
/// assert_eq!(&pixels[8..], [9; 4]);
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
#[derive(Debug)]
pub struct ViewMut<'a, const C: usize> {
    data: &'a mut [u8],
    shape: Shape,
}

/// A gray image.
pub type GrayView<'a> = View<'a, 1>;
/// An image of red, green and blue.
pub type RgbView<'a> = View<'a, 3>;
/// A writable gray image.
pub type GrayViewMut<'a> = ViewMut<'a, 1>;
/// A writable image of red, green and blue.
pub type RgbViewMut<'a> = ViewMut<'a, 3>;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Shape {
    width: usize,
    height: usize,
    /// Bytes from one row to the next.
    stride: usize,
}

impl Shape {
    /// The shape, if its bytes do not exceed `found`.
    fn new(
        width: usize,
        height: usize,
        stride: usize,
        channels: usize,
        found: usize,
    ) -> Result<Self, ImageError> {
        if width == 0 || height == 0 {
            return Err(ImageError::Empty { width, height });
        }
        let row = width.saturating_mul(channels);
        if stride < row {
            return Err(ImageError::Stride { stride, row });
        }
        let expected = stride.saturating_mul(height - 1).saturating_add(row);
        if found < expected {
            return Err(ImageError::Truncated { found, expected });
        }
        Ok(Self { width, height, stride })
    }

    /// Byte offset and shape of a part.
    fn region(
        &self,
        (x, y): (usize, usize),
        width: usize,
        height: usize,
        channels: usize,
    ) -> Result<(usize, Self), ImageError> {
        if width == 0 || height == 0 {
            return Err(ImageError::Empty { width, height });
        }
        let end = (x.saturating_add(width), y.saturating_add(height));
        if end.0 > self.width || end.1 > self.height {
            return Err(ImageError::Region { end, size: (self.width, self.height) });
        }
        Ok((y * self.stride + x * channels, Self { width, height, stride: self.stride }))
    }

    /// The shape as one long row, if rows are contiguous.
    fn flat(self, channels: usize) -> Self {
        if self.stride == self.width * channels {
            let width = self.width * self.height;
            Self { width, height: 1, stride: width * channels }
        } else {
            self
        }
    }
}

impl<'a, const C: usize> View<'a, C> {
    /// An image with contiguous rows.
    ///
    /// # Errors
    ///
    /// If the image has no pixels or `data` is too short.
    pub fn new(data: &'a [u8], width: usize, height: usize) -> Result<Self, ImageError> {
        Self::with_stride(data, width, height, width.saturating_mul(C))
    }

    /// An image with `stride` bytes from one row to the next. Data after the last row is not accessed.
    ///
    /// # Errors
    ///
    /// If the image has no pixels, the stride is shorter than a row, or `data` is too short.
    pub fn with_stride(
        data: &'a [u8],
        width: usize,
        height: usize,
        stride: usize,
    ) -> Result<Self, ImageError> {
        Ok(Self { data, shape: Shape::new(width, height, stride, C, data.len())? })
    }

    /// A part of the image with the given upper left pixel (column, row) and size.
    ///
    /// # Errors
    ///
    /// If the part is empty or exceeds the image.
    pub fn region(&self, corner: (usize, usize), width: usize, height: usize) -> Result<Self, ImageError> {
        let (start, shape) = self.shape.region(corner, width, height, C)?;
        Ok(Self { data: &self.data[start..], shape })
    }

    /// Number of columns and rows.
    pub fn size(&self) -> (usize, usize) {
        (self.shape.width, self.shape.height)
    }

    /// Number of columns.
    #[inline]
    pub fn width(&self) -> usize {
        self.shape.width
    }

    /// Number of rows.
    #[inline]
    pub fn height(&self) -> usize {
        self.shape.height
    }

    /// Bytes of a row.
    ///
    /// # Panics
    ///
    /// If there is no such row.
    #[inline]
    pub fn row(&self, y: usize) -> &'a [u8] {
        assert!(y < self.shape.height, "row {y} of {}", self.shape.height);
        &self.data[y * self.shape.stride..][..self.shape.width * C]
    }

    /// The image as one long row where possible, for kernels on single pixels.
    #[inline]
    pub(super) fn flat(self) -> Self {
        Self { shape: self.shape.flat(C), ..self }
    }

    /// Bytes and shape; [`of`](Self::of) is the inverse.
    pub(super) fn parts(self) -> (&'a [u8], Shape) {
        (self.data, self.shape)
    }

    #[inline(always)]
    pub(super) fn of(data: &'a [u8], shape: Shape) -> Self {
        Self { data, shape }
    }

    /// Whether rows are contiguous.
    pub(super) fn is_flat(&self) -> bool {
        self.shape.stride == self.shape.width * C
    }
}

impl<'a, const C: usize> ViewMut<'a, C> {
    /// An image with contiguous rows.
    ///
    /// # Errors
    ///
    /// If the image has no pixels or `data` is too short.
    pub fn new(data: &'a mut [u8], width: usize, height: usize) -> Result<Self, ImageError> {
        Self::with_stride(data, width, height, width.saturating_mul(C))
    }

    /// An image with `stride` bytes from one row to the next. Data between and after the rows is not
    /// accessed.
    ///
    /// # Errors
    ///
    /// If the image has no pixels, the stride is shorter than a row, or `data` is too short.
    pub fn with_stride(
        data: &'a mut [u8],
        width: usize,
        height: usize,
        stride: usize,
    ) -> Result<Self, ImageError> {
        let shape = Shape::new(width, height, stride, C, data.len())?;
        Ok(Self { data, shape })
    }

    /// A part of the image with the given upper left pixel (column, row) and size.
    ///
    /// # Errors
    ///
    /// If the part is empty or exceeds the image.
    pub fn region(self, corner: (usize, usize), width: usize, height: usize) -> Result<Self, ImageError> {
        let (start, shape) = self.shape.region(corner, width, height, C)?;
        Ok(Self { data: &mut self.data[start..], shape })
    }

    /// Number of columns and rows.
    pub fn size(&self) -> (usize, usize) {
        (self.shape.width, self.shape.height)
    }

    /// Number of columns.
    #[inline]
    pub fn width(&self) -> usize {
        self.shape.width
    }

    /// Number of rows.
    #[inline]
    pub fn height(&self) -> usize {
        self.shape.height
    }

    /// Bytes of a row.
    ///
    /// # Panics
    ///
    /// If there is no such row.
    #[inline]
    pub fn row_mut(&mut self, y: usize) -> &mut [u8] {
        assert!(y < self.shape.height, "row {y} of {}", self.shape.height);
        &mut self.data[y * self.shape.stride..][..self.shape.width * C]
    }

    #[inline]
    pub(super) fn flat(self) -> Self {
        Self { shape: self.shape.flat(C), ..self }
    }

    /// Bytes and shape; [`of`](Self::of) is the inverse.
    pub(super) fn parts(&mut self) -> (&mut [u8], Shape) {
        (&mut *self.data, self.shape)
    }

    #[inline(always)]
    pub(super) fn of(data: &'a mut [u8], shape: Shape) -> Self {
        Self { data, shape }
    }

    pub(super) fn is_flat(&self) -> bool {
        self.shape.stride == self.shape.width * C
    }

    /// Splits the image into bands of `rows` rows each; the last one may be shorter.
    #[cfg(feature = "rayon")]
    pub(super) fn into_bands(self, rows: usize) -> Vec<Self> {
        let Shape { width, height, stride } = self.shape;
        let parts = self.data.chunks_mut(rows * stride).zip((0..height).step_by(rows));
        parts
            .map(|(data, top)| Self { data, shape: Shape { width, height: rows.min(height - top), stride } })
            .collect()
    }

    /// Checks that the output has the expected size.
    pub(super) fn require_size(&self, expected: (usize, usize)) -> Result<(), ImageError> {
        require_size("output", self.size(), expected)
    }
}

/// Checks the size of an image.
pub(super) fn require_size(
    what: &'static str,
    found: (usize, usize),
    expected: (usize, usize),
) -> Result<(), ImageError> {
    if found == expected { Ok(()) } else { Err(ImageError::Size { what, found, expected }) }
}

/// Input and output as one long row each, if both are contiguous; for kernels on single pixels.
#[inline]
pub(super) fn flatten<'a, 'b, const C: usize, const D: usize>(
    input: View<'a, C>,
    output: ViewMut<'b, D>,
) -> (View<'a, C>, ViewMut<'b, D>) {
    if input.is_flat() && output.is_flat() { (input.flat(), output.flat()) } else { (input, output) }
}
