//! Views of the images of the crate `image` (feature `image`).

use image::{GrayImage, RgbImage};

use super::{Error, GrayView, GrayViewMut, RgbView, RgbViewMut};

impl<'a> TryFrom<&'a GrayImage> for GrayView<'a> {
    type Error = Error;

    fn try_from(image: &'a GrayImage) -> Result<Self, Error> {
        Self::new(image.as_raw(), image.width() as usize, image.height() as usize)
    }
}

impl<'a> TryFrom<&'a RgbImage> for RgbView<'a> {
    type Error = Error;

    fn try_from(image: &'a RgbImage) -> Result<Self, Error> {
        Self::new(image.as_raw(), image.width() as usize, image.height() as usize)
    }
}

impl<'a> TryFrom<&'a mut GrayImage> for GrayViewMut<'a> {
    type Error = Error;

    fn try_from(image: &'a mut GrayImage) -> Result<Self, Error> {
        let (width, height) = (image.width() as usize, image.height() as usize);
        Self::new(image, width, height)
    }
}

impl<'a> TryFrom<&'a mut RgbImage> for RgbViewMut<'a> {
    type Error = Error;

    fn try_from(image: &'a mut RgbImage) -> Result<Self, Error> {
        let (width, height) = (image.width() as usize, image.height() as usize);
        Self::new(image, width, height)
    }
}
