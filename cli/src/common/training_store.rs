use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use roverlab::files::write_whole;

use super::{Failure, regular_bytes};

/// What is learned so far, in a folder beside the file to be written.
pub(crate) struct TrainingStore {
    folder: PathBuf,
}

/// Where the options and the trainer's state are kept.
const OPTIONS: &str = "options.txt";
const STATE: &str = "state.safetensors";

impl TrainingStore {
    /// Opens the folder, or makes it. Fails if what is in it was learned from other `facts`.
    pub(crate) fn open(out: &Path, facts: &str) -> Result<Self, Failure> {
        let mut name = out.file_name().unwrap_or_default().to_owned();
        name.push(".training");
        let this = Self { folder: out.with_file_name(name) };
        fs::create_dir_all(&this.folder).map_err(|error| this.failure(&error))?;
        let is_new = fs::read_dir(&this.folder).map_err(|error| this.failure(&error))?.next().is_none();
        let (folder, line) = (this.folder.display(), format!("{facts}\n"));
        match this.read(OPTIONS)? {
            None if is_new => this.write(OPTIONS, line.as_bytes())?,
            None => {
                return Err(Failure::input(format!(
                    "{folder}: found a folder of something else; expected none"
                )));
            }
            Some(found) if found == line.as_bytes() => {}
            Some(found) => {
                let found = String::from_utf8_lossy(&found).into_owned();
                let found = found.trim_end();
                return Err(Failure::input(format!(
                    "{folder}: found what was learned with {found}; expected {facts}, or no such folder"
                )));
            }
        }
        Ok(this)
    }

    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    /// The trainer after its last epoch.
    pub(crate) fn state(&self) -> Result<Option<Vec<u8>>, Failure> {
        self.read(STATE)
    }

    pub(crate) fn keep(&self, state: &[u8]) -> Result<(), Failure> {
        self.write(STATE, state)
    }

    /// What was made once: as it was kept, or as it is now.
    pub(crate) fn once(
        &self,
        name: &str,
        now: impl FnOnce() -> Result<Vec<u8>, Failure>,
    ) -> Result<Vec<u8>, Failure> {
        if let Some(bytes) = self.read(name)? {
            return Ok(bytes);
        }
        let bytes = now()?;
        self.write(name, &bytes)?;
        Ok(bytes)
    }

    /// Removes what was kept, that of these names too, and the folder if nothing else is in it.
    pub(crate) fn close(self, names: impl Iterator<Item = String>) -> Result<(), Failure> {
        let unless = |allowed: ErrorKind, done: std::io::Result<()>| match done {
            Err(error) if error.kind() != allowed => Err(self.failure(&error)),
            _ => Ok(()),
        };
        for name in names.chain([STATE, OPTIONS].map(String::from)) {
            unless(ErrorKind::NotFound, fs::remove_file(self.folder.join(name)))?;
        }
        unless(ErrorKind::DirectoryNotEmpty, fs::remove_dir(&self.folder))
    }

    fn read(&self, name: &str) -> Result<Option<Vec<u8>>, Failure> {
        match regular_bytes(&self.folder.join(name)) {
            Ok(bytes) => Ok(Some(bytes)),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            Err(error) => Err(self.failure(&error)),
        }
    }

    fn write(&self, name: &str, bytes: &[u8]) -> Result<(), Failure> {
        write_whole(self.folder.join(name), bytes).map_err(|error| self.failure(&error))
    }

    fn failure(&self, error: &std::io::Error) -> Failure {
        Failure::run(format!("{}: {error}", self.folder.display()))
    }
}
