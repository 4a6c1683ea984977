use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::Picture;
use crate::parameter::debug_as_sentence;

/// The files that a picture can be written to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum FileType {
    /// Scalable Vector Graphics: `.svg`.
    Svg,
    /// Portable Network Graphics: `.png`. Needs the feature `png`.
    Png,
}

/// Why a picture could not be saved.
#[derive(thiserror::Error)]
#[non_exhaustive]
pub enum SaveError {
    /// The name does not say which type of file is wanted.
    #[error("{}: a picture of this name; expected a name that ends in .svg or .png", path.display())]
    Extension {
        /// The name.
        path: PathBuf,
    },
    /// This build writes no PNG.
    #[error("{}: a PNG picture, which needs the feature `png`; expected a name that ends in .svg", path.display())]
    NoPng {
        /// The name.
        path: PathBuf,
    },
    /// PNG files do not move.
    #[error("{}: a PNG picture, which does not move; expected a name that ends in .svg", path.display())]
    Still {
        /// The name.
        path: PathBuf,
    },
    /// The picture could not be turned into pixels.
    #[error("{}: the picture cannot be drawn: {reason}", path.display())]
    Draw {
        /// The name.
        path: PathBuf,
        /// What the renderer said.
        reason: String,
    },
    /// The file could not be written. An older file of the name is still there, unchanged.
    #[error("{}: the picture cannot be written: {source}", path.display())]
    Write {
        /// The name.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
}

debug_as_sentence!(SaveError);

impl FileType {
    /// The type that a file's name asks for, without regard to case. Fails if no picture can be saved under it, which
    /// programs can ask before a long run.
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
    /// Saves the picture under a name that ends in `.svg` or, with the feature `png`, in `.png`.
    ///
    /// The file appears whole or not at all. The folder is made if it is missing.
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
    /// Saves the picture as it [moves](Self::to_moving_svg), under a name that ends in `.svg`, in the same way.
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

/// Writes a file beside the one wanted and moves it there once it is complete.
fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let unfinished = path.with_file_name(format!(".{name}.{}.part", std::process::id()));
    let folder = path.parent().unwrap_or(Path::new(""));
    let write = || {
        fs::create_dir_all(folder)?;
        let mut file = File::create(&unfinished)?;
        file.write_all(bytes)?;
        file.sync_all()?;
        fs::rename(&unfinished, path)
    };
    write().inspect_err(|_| {
        // What is half written is of no use; the error that counts is the one being returned.
        let _ = fs::remove_file(&unfinished);
    })
}
