use std::fs;
use std::path::{Path, PathBuf};

/// A temporary folder of this run, removed at its end.
#[derive(Debug)]
pub(crate) struct WorkFolder(PathBuf);

impl WorkFolder {
    pub(crate) fn new() -> Result<Self, String> {
        let base = std::env::temp_dir();
        for attempt in 0..100 {
            let path = base.join(format!("robios-{}-{attempt}", std::process::id()));
            match fs::create_dir(&path) {
                Ok(()) => return Ok(Self(path)),
                Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {}
                Err(error) => {
                    return Err(format!("{}: {error}; expected a folder to write to", path.display()));
                }
            }
        }
        Err(format!("{}: no name is free for a folder", base.display()))
    }

    /// Path of a file in it.
    pub(crate) fn file(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    /// Path of the folder.
    pub(crate) fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for WorkFolder {
    fn drop(&mut self) {
        // If removal fails, the system cleans up later.
        let _ = fs::remove_dir_all(&self.0);
    }
}
