use std::path::{Path, PathBuf};
use std::{fs, io};

use super::Picture;
use crate::files::write_whole;
use crate::parameter::debug_as_sentence;

/// File formats of pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum FileType {
    /// Scalable Vector Graphics: `.svg`.
    Svg,
    /// Portable Network Graphics: `.png`. Needs the feature `png`.
    Png,
}

/// Reason why a picture could not be saved.
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum SaveError {
    /// The name's extension is not that of a picture format.
    #[error("{}: unknown picture format; expected a name that ends in .svg or .png", path.display())]
    Extension {
        /// Name of the file.
        path: PathBuf,
    },
    /// This build cannot write PNG.
    #[error("{}: PNG pictures need the feature `png`; expected a name that ends in .svg", path.display())]
    NoPng {
        /// Name of the file.
        path: PathBuf,
    },
    /// PNG files cannot be animated.
    #[error("{}: PNG pictures cannot be animated; expected a name that ends in .svg", path.display())]
    Still {
        /// Name of the file.
        path: PathBuf,
    },
    /// Rendering failed.
    #[error("{}: cannot render the picture: {reason}", path.display())]
    Draw {
        /// Name of the file.
        path: PathBuf,
        /// Message of the renderer.
        reason: String,
    },
    /// The file could not be written. An older file of that name is unchanged.
    #[error("{}: cannot write the picture: {source}", path.display())]
    Write {
        /// Name of the file.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
}

debug_as_sentence!(SaveError);

impl FileType {
    /// The format given by a file name's extension, ignoring case. Fails if no picture can be saved under the
    /// name; check this before a long run.
    ///
    /// ```
    /// use roverlab::picture::FileType;
    /// assert_eq!(FileType::of("run.SVG").unwrap(), FileType::Svg);
    /// assert!(FileType::of("run.gif").unwrap_err().to_string().contains(".svg or .png"));
    /// ```
    pub fn of(path: impl AsRef<Path>) -> Result<Self, SaveError> {
        let path = path.as_ref();
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        match extension.as_str() {
            "svg" => Ok(FileType::Svg),
            "png" if cfg!(feature = "png") => Ok(FileType::Png),
            "png" => Err(SaveError::NoPng { path: path.to_owned() }),
            _ => Err(SaveError::Extension { path: path.to_owned() }),
        }
    }
}

impl Picture {
    /// Saves the picture to a file ending in `.svg` or, with the feature `png`, in `.png`.
    ///
    /// The file is written completely or not at all. Missing folders are created. Fails for other names and
    /// if rendering or writing fails.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<(), SaveError> {
        let path = path.as_ref();
        let bytes = match FileType::of(path)? {
            FileType::Svg => self.to_svg().into_bytes(),
            FileType::Png => png(self, path)?,
        };
        replace(path, &bytes).map_err(|source| SaveError::Write { path: path.to_owned(), source })
    }
}

impl Picture {
    /// Saves the [animated](Self::to_moving_svg) picture to a file ending in `.svg`, in the same way.
    pub fn save_moving(&self, path: impl AsRef<Path>) -> Result<(), SaveError> {
        let path = path.as_ref();
        match FileType::of(path)? {
            FileType::Svg => {}
            FileType::Png => return Err(SaveError::Still { path: path.to_owned() }),
        }
        let written = replace(path, self.to_moving_svg().as_bytes());
        written.map_err(|source| SaveError::Write { path: path.to_owned(), source })
    }
}

#[cfg(feature = "png")]
fn png(picture: &Picture, path: &Path) -> Result<Vec<u8>, SaveError> {
    super::raster::png(&picture.to_svg()).map_err(|reason| SaveError::Draw { path: path.to_owned(), reason })
}

#[cfg(not(feature = "png"))]
fn png(_: &Picture, path: &Path) -> Result<Vec<u8>, SaveError> {
    Err(SaveError::NoPng { path: path.to_owned() })
}

/// Writes a file whole, with its folder.
fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    fs::create_dir_all(path.parent().unwrap_or(Path::new("")))?;
    write_whole(path, bytes)
}
