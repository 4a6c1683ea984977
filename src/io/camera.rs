use image::{GrayImage, RgbImage};

use super::{Error, Result};

/// Images that a camera takes in a second. Who asks more often gets the same image again.
pub(super) const FRAME_RATE: f64 = 30.0;

/// The size of a camera's images.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub enum Resolution {
    /// 160 x 120 pixels.
    #[default]
    Qqvga,
    /// 320 x 240 pixels.
    Qvga,
    /// 640 x 480 pixels.
    Vga,
    /// 1296 x 730 pixels.
    Cam1Mp,
    /// 1920 x 1080 pixels.
    CamHd,
    /// 2592 x 1944 pixels.
    Cam5Mp,
}

impl Resolution {
    /// All resolutions in RoBIOS's order.
    pub const ALL: [Self; 6] = [Self::Qqvga, Self::Qvga, Self::Vga, Self::Cam1Mp, Self::CamHd, Self::Cam5Mp];

    /// The resolution with these columns and rows. Fails if there is none.
    pub fn of(dimensions: (u32, u32)) -> Result<Self> {
        let found = Self::ALL.into_iter().find(|resolution| resolution.dimensions() == dimensions);
        found.ok_or_else(|| {
            let (width, height) = dimensions;
            Error::invalid_input(
                "image size",
                format!("{width} x {height}"),
                "one of RoBIOS's, such as 320 x 240",
            )
        })
    }

    /// Number of columns and rows.
    ///
    /// ```
    /// use roverlab::io::Resolution;
    /// assert_eq!(Resolution::Qvga.dimensions(), (320, 240));
    /// ```
    pub const fn dimensions(self) -> (u32, u32) {
        match self {
            Self::Qqvga => (160, 120),
            Self::Qvga => (320, 240),
            Self::Vga => (640, 480),
            Self::Cam1Mp => (1296, 730),
            Self::CamHd => (1920, 1080),
            Self::Cam5Mp => (2592, 1944),
        }
    }
}

/// A camera (book, section 11.1).
///
/// Images are RGB with 8 bits per channel, top row first. [`Servos`](super::Servos) turn a camera on a
/// pan-tilt head.
///
/// # For implementers
///
/// `image_into` must leave an image of the current resolution, whatever size it receives.
/// `set_resolution` fails for a resolution that the camera lacks.
#[auto_impl::auto_impl(&mut, Box)]
#[ambassador::delegatable_trait]
pub trait Camera {
    /// Sets the size of later images. Initially [`Resolution::Qqvga`].
    fn set_resolution(&mut self, resolution: Resolution) -> Result<()>;

    /// Current image size.
    fn resolution(&mut self) -> Result<Resolution>;

    /// Captures an image into an existing one; its memory is reused if the size matches.
    fn image_into(&mut self, image: &mut RgbImage) -> Result<()>;

    /// Captures an image.
    fn image(&mut self) -> Result<RgbImage> {
        let mut image = RgbImage::default();
        self.image_into(&mut image)?;
        Ok(image)
    }

    /// Captures a grayscale image: `(red + blue) / 4 + green / 2`, as in RoBIOS.
    fn gray_image(&mut self) -> Result<GrayImage> {
        let image = self.image()?;
        let gray = image.pixels().map(|pixel| {
            let [red, green, blue] = pixel.0.map(u16::from);
            ((red + blue) / 4 + green / 2) as u8
        });
        let (width, height) = image.dimensions();
        // One gray level per pixel, so the buffer fits.
        Ok(GrayImage::from_raw(width, height, gray.collect()).unwrap_or_default())
    }
}
