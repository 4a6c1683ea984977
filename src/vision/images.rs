//! Views of the images of the crate `image` (feature `image`).

use image::{GrayImage, RgbImage};

use super::{GrayView, GrayViewMut, ImageError, RgbView, RgbViewMut};

impl<'a> TryFrom<&'a GrayImage> for GrayView<'a> {
    type Error = ImageError;

    fn try_from(image: &'a GrayImage) -> Result<Self, ImageError> {
        Self::new(image.as_raw(), image.width() as usize, image.height() as usize)
    }
}

impl<'a> TryFrom<&'a RgbImage> for RgbView<'a> {
    type Error = ImageError;

    fn try_from(image: &'a RgbImage) -> Result<Self, ImageError> {
        Self::new(image.as_raw(), image.width() as usize, image.height() as usize)
    }
}

impl<'a> TryFrom<&'a mut GrayImage> for GrayViewMut<'a> {
    type Error = ImageError;

    fn try_from(image: &'a mut GrayImage) -> Result<Self, ImageError> {
        let (width, height) = (image.width() as usize, image.height() as usize);
        Self::new(image, width, height)
    }
}

impl<'a> TryFrom<&'a mut RgbImage> for RgbViewMut<'a> {
    type Error = ImageError;

    fn try_from(image: &'a mut RgbImage) -> Result<Self, ImageError> {
        let (width, height) = (image.width() as usize, image.height() as usize);
        Self::new(image, width, height)
    }
}
