use std::path::PathBuf;
use std::sync::Arc;

use image::RgbaImage;

/// An image that a world's file names: the picture on a floor.
///
/// ```
/// use image::RgbaImage;
/// use roverlab::world::Texture;
/// let carpet = Texture::new("carpet.png", RgbaImage::new(4, 3));
/// assert_eq!(carpet.image.expect("it was given").dimensions(), (4, 3));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    /// Image file as named in the world's file.
    pub file: PathBuf,
    /// Its pixels, once a [`FileSource`](super::formats::FileSource) has found it; this happens when a whole
    /// scene is read, but not when only the text of a world is read.
    pub image: Option<Arc<RgbaImage>>,
}

impl Texture {
    /// An image with its pixels.
    pub fn new(file: impl Into<PathBuf>, image: RgbaImage) -> Self {
        Self { file: file.into(), image: Some(Arc::new(image)) }
    }
}

/// An image that has not been read.
impl From<PathBuf> for Texture {
    fn from(file: PathBuf) -> Self {
        Self { file, image: None }
    }
}

/// An image that has not been read.
impl From<&str> for Texture {
    fn from(file: &str) -> Self {
        PathBuf::from(file).into()
    }
}
