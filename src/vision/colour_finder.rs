use super::{
    CameraGeometry, Components, GrayView, GrayViewMut, HueLimits, HueRange, HueScale, ImageError, NO_HUE,
    RgbView, hue, hue_histogram_into, hue_match_into, maximum,
};
use crate::geometry::Point;

/// How a colour is located in an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FindMethod {
    /// The column with the most matching pixels (Programs 11.9 and 11.10).
    Histogram,
    /// The largest connected group of matching pixels.
    #[default]
    Blob,
}

/// Detection of a colour in an image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sighting {
    /// Column of its centre (pixels).
    pub column: f64,
    /// Its first and last column.
    pub columns: (usize, usize),
    /// Number of matching pixels: of the largest group, or of the fullest column.
    pub pixels: u32,
    /// Bearing of its centre from the camera; positive to the left of straight ahead (rad).
    pub bearing: f64,
    /// Position of its foot on the floor, in the robot frame (m), if the foot is visible.
    pub place: Option<Point>,
    /// Whether it reaches the last rows of the image, as near objects do.
    pub at_the_bottom: bool,
}

/// Finds a taught hue in images. Its buffers are reused from image to image.
///
/// ```
/// use roverlab::vision::{CameraGeometry, ColourFinder, FindMethod, RgbView};
/// let mut image = [90; 3 * 40 * 30];
/// for (row, column) in (5..10).flat_map(|row| (30..36).map(move |column| (row, column))) {
///     image[3 * (40 * row + column)..][..3].copy_from_slice(&[200, 20, 20]);
/// }
/// let camera = CameraGeometry { field_of_view: 1.0, height: 0.1, ahead: 0.0 };
/// let mut finder = ColourFinder::new(42, 10, FindMethod::Blob, camera)?;
/// let found = finder.find(RgbView::new(&image, 40, 30)?)?.expect("a red box");
/// assert_eq!((found.columns, found.pixels), ((30, 35), 30));
/// assert!(found.bearing < 0.0, "to the right of straight ahead");
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
#[derive(Debug, Clone)]
pub struct ColourFinder {
    /// Matching hues.
    pub range: HueRange,
    /// Minimum saturation and intensity of a pixel.
    pub limits: HueLimits,
    /// Method of location.
    pub method: FindMethod,
    /// Minimum number of pixels of a group; a column needs an eighth of it.
    pub min_pixels: u32,
    /// Projection of the camera.
    pub camera: CameraGeometry,
    columns: Vec<u32>,
    mask: Vec<u8>,
    components: Components,
}

impl ColourFinder {
    /// Limits under which a hue is still recognised at a quarter of the room's light.
    pub const LIMITS: HueLimits = HueLimits { min_saturation: 128, min_intensity: 6 };

    /// A finder of the hues less than `tolerance` away from `hue`, on the RoBIOS scale.
    ///
    /// # Errors
    ///
    /// If `hue` is not a hue or `tolerance` is 0.
    pub fn new(
        hue: u8,
        tolerance: u8,
        method: FindMethod,
        camera: CameraGeometry,
    ) -> Result<Self, ImageError> {
        Ok(Self {
            range: HueRange::around(hue, tolerance, HueScale::Robios)?,
            limits: Self::LIMITS,
            method,
            min_pixels: 12,
            camera,
            columns: Vec::new(),
            mask: Vec::new(),
            components: Components::new(),
        })
    }

    /// Locates the colour in an image or a view; `None` if too few pixels match.
    ///
    /// # Errors
    ///
    /// If the image has no pixels.
    pub fn find<'a>(
        &mut self,
        image: impl TryInto<RgbView<'a>, Error: Into<ImageError>>,
    ) -> Result<Option<Sighting>, ImageError> {
        let image = image.try_into().map_err(Into::into)?;
        match self.method {
            FindMethod::Histogram => self.by_histogram(image),
            FindMethod::Blob => self.by_blob(image),
        }
    }

    fn by_histogram(&mut self, image: RgbView<'_>) -> Result<Option<Sighting>, ImageError> {
        self.columns.resize(image.width(), 0);
        hue_histogram_into(image, &mut self.columns, self.range, self.limits)?;
        let Some((peak, most)) = maximum(&self.columns).filter(|&(_, most)| 8 * most >= self.min_pixels)
        else {
            return Ok(None);
        };
        // Neighbouring columns that are at least half as full as the fullest.
        let full = |count: &&u32| 2 * **count >= most;
        let left = peak - self.columns[..peak].iter().rev().take_while(full).count();
        let right = peak + self.columns[peak + 1..].iter().take_while(full).count();
        let column = 0.5 * (left + right) as f64;
        let foot = self.lowest(image, peak);
        Ok(Some(self.sighting(image, (left, right), (column, foot), most)))
    }

    /// Last matching row of a column.
    fn lowest(&self, image: RgbView<'_>, column: usize) -> usize {
        let matches = |row: &usize| {
            let pixel = image.row(*row).as_chunks().0[column];
            self.range.contains(hue(pixel, HueScale::Robios, self.limits))
        };
        (0..image.height()).rev().find(matches).unwrap_or(0)
    }

    fn by_blob(&mut self, image: RgbView<'_>) -> Result<Option<Sighting>, ImageError> {
        let (width, height) = image.size();
        self.mask.resize(width * height, 0);
        let mask = GrayViewMut::new(&mut self.mask, width, height)?;
        hue_match_into(image, mask, self.range, HueScale::Robios, self.limits)?;
        let mask = GrayView::new(&self.mask, width, height)?;
        let largest = self.components.largest(mask, self.min_pixels as usize);
        let Some(blob) = largest else { return Ok(None) };
        let columns = (blob.min.0, blob.max.0);
        Ok(Some(self.sighting(image, columns, (blob.centroid.0, blob.max.1), blob.area as u32)))
    }

    /// The detection for a range of columns, a centre column and the last row.
    fn sighting(
        &self,
        image: RgbView<'_>,
        columns: (usize, usize),
        (column, foot): (f64, usize),
        pixels: u32,
    ) -> Sighting {
        let (width, height) = (image.width() as u32, image.height() as u32);
        let at_the_bottom = foot + 3 >= image.height();
        let on_the_floor = || self.camera.floor(column, foot as f64 + 0.5, (width, height));
        let place = if at_the_bottom { None } else { on_the_floor() };
        let bearing = self.camera.bearing(column, width);
        Sighting { column, columns, pixels, bearing, place, at_the_bottom }
    }
}

/// The most frequent hue in the middle of an image (a quarter of its width and height), to learn an object
/// held before the camera. Counts are smoothed over neighbouring hues. `None` if less than an eighth of the
/// pixels has that hue.
///
/// ```
/// use roverlab::vision::{HueLimits, RgbView, teach_hue};
/// let ball = [20, 20, 200].repeat(40 * 30);
/// assert_eq!(teach_hue(RgbView::new(&ball, 40, 30)?, HueLimits::default())?, Some(210), "blue");
/// let wall = [90, 90, 90].repeat(40 * 30);
/// assert_eq!(teach_hue(RgbView::new(&wall, 40, 30)?, HueLimits::default())?, None);
/// # Ok::<(), roverlab::vision::ImageError>(())
/// ```
///
/// # Errors
///
/// If the image has no pixels.
pub fn teach_hue<'a>(
    image: impl TryInto<RgbView<'a>, Error: Into<ImageError>>,
    limits: HueLimits,
) -> Result<Option<u8>, ImageError> {
    /// Number of hues of the RoBIOS circle.
    const CIRCLE: usize = 252;
    /// Half-width of the smoothing window (hues).
    const REACH: usize = 4;
    let view = image.try_into().map_err(Into::into)?;
    let (width, height) = view.size();
    let (across, down) = ((width / 4).max(1), (height / 4).max(1));
    let part = view.region(((width - across) / 2, (height - down) / 2), across, down)?;
    let mut counts = [0_u32; CIRCLE];
    for y in 0..down {
        for &pixel in part.row(y).as_chunks::<3>().0 {
            let hue = hue(pixel, HueScale::Robios, limits);
            if hue != NO_HUE {
                counts[usize::from(hue) % CIRCLE] += 1;
            }
        }
    }
    // Nearer hues weigh more, so that a single hue yields itself.
    let around = |hue: usize, weight: &dyn Fn(usize) -> u32| {
        let near = (0..=2 * REACH).map(|step| (step, (hue + CIRCLE + step - REACH) % CIRCLE));
        near.map(|(step, place)| weight(step.abs_diff(REACH)) * counts[place]).sum::<u32>()
    };
    let near_first = |distance: usize| (REACH + 1 - distance) as u32;
    let Some(best) = (0..CIRCLE).max_by_key(|&hue| around(hue, &near_first)) else { return Ok(None) };
    let pixels = around(best, &|_| 1) as usize;
    Ok((8 * pixels >= across * down).then_some(best as u8))
}
