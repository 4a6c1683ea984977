use std::fmt::Display;
use std::io::{self, Read};
use std::path::Path;

use roverlab::files::open_regular;
use roverlab::io::log::{Attachment, Log};
use roverlab::world::formats::{self, DiskFiles, FileSource, FormatError, Location, Parsed, SourceFile};
use roverlab::world::{RobotSpec, Scene};

use super::{CommonArgs, Failure, onlooker};

/// The first bytes of recordings and bags, and the one behind them.
const MAGIC: &[u8] = b"\x89MCAP0\r\n";
const HEADER: u8 = 1;
/// Length of a recording, at most (bytes).
const MOST: u64 = 4 << 30;

/// Name of an option's file in recordings: that of the option, with the file's extension. A number is no file
/// but a seed, and stays as it is.
pub(crate) fn recorded_name(option: &str, path: &Path) -> String {
    if let Some(seed) = path.to_str().filter(|text| text.parse::<u64>().is_ok()) {
        return seed.to_owned();
    }
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    let plain = !ending.is_empty() && ending.chars().all(|c| c.is_ascii_alphanumeric());
    if plain { format!("{option}.{}", ending.to_ascii_lowercase()) } else { option.to_owned() }
}

/// The bytes of a regular file.
pub(crate) fn regular_bytes(file: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open_regular(file)?.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// The bytes of a recording's file, or the first ones of a file that is none: readers of recordings say so.
pub(crate) fn recording_bytes(file: &Path) -> io::Result<Vec<u8>> {
    let opened = open_regular(file)?;
    let length = opened.metadata()?.len();
    let mut bytes = Vec::new();
    (&opened).take(length.min(MAGIC.len() as u64 + 1)).read_to_end(&mut bytes)?;
    // If its first bytes are damaged, the recording may be recovered from the header behind them.
    if !bytes.starts_with(MAGIC) && bytes.get(MAGIC.len()) != Some(&HEADER) {
        return Ok(bytes);
    }
    if length > MOST {
        return Err(io::Error::other(format!("found {length} bytes, more than the {MOST} that are read")));
    }
    (&opened).take(length - bytes.len() as u64).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// The reason why a file cannot be recorded to; `name` is that of its option or argument.
pub(crate) fn unrecordable(name: impl Display, error: &io::Error) -> Failure {
    let expected = match error.kind() {
        io::ErrorKind::AlreadyExists => ", or --force",
        io::ErrorKind::ResourceBusy => "",
        _ => "; expected a file that can be written",
    };
    Failure::input(format!("{name}: {error}{expected}"))
}

impl CommonArgs {
    /// The bytes of an option's file, from the replayed recording or from disk; they are added to a new
    /// recording. The option must be among the files listed in `command_line`.
    pub(crate) fn read(&self, option: &str, path: &Path) -> Result<Vec<u8>, FormatError> {
        let name = recorded_name(option, path);
        let replayed = path.to_str() == Some(&name);
        let log = self.origin.facts().log.filter(|_| replayed);
        if let Some(log) = log {
            // A file missing from a recording is not searched elsewhere.
            let lost = || {
                FormatError::new(&name, Location::START, "no such file in the recording", "its attachment")
            };
            return log.header().attachment(&name).map(|file| file.data.clone()).ok_or_else(lost);
        }
        let bytes = match onlooker::file(path) {
            Some(file) => file.map_err(|_| {
                let name = path.display().to_string();
                FormatError::new(&name, Location::START, "no such file", "one that was opened here")
            })?,
            None => formats::read_file(path)?,
        };
        self.origin.attach(attachment(&name, &bytes));
        Ok(bytes)
    }

    /// The scene in an option's file, as found by [`read`](Self::read), with its companion files; records its
    /// warnings.
    pub(crate) fn load_scene(&self, option: &str, path: &Path) -> Result<Scene, FormatError> {
        let parsed = self.load(option, path, formats::parse_scene)?;
        Ok(self.origin.scene(path, parsed, self.start))
    }

    /// The robot in the file of an option, with its 3D model where that is found, or the built-in robot of
    /// that name.
    pub(crate) fn load_robot(&self, option: &str, path: &Path) -> Result<Parsed<RobotSpec>, FormatError> {
        let built_in = path.to_str().filter(|_| !path.exists()).and_then(RobotSpec::predefined);
        if let Some(value) = built_in {
            return Ok(Parsed { value, warnings: Vec::new() });
        }
        self.load(option, path, formats::parse_robot_tolerantly)
    }

    /// Reads the file of an option with those that it names; they go into the recording that is made.
    fn load<T>(
        &self,
        option: &str,
        path: &Path,
        parse: impl FnOnce(Vec<u8>, &str, &mut dyn FileSource) -> Result<T, FormatError>,
    ) -> Result<T, FormatError> {
        let bytes = self.read(option, path)?;
        let name = recorded_name(option, path);
        let log = self.origin.facts().log.filter(|log| log.header().attachment(&name).is_some());
        let log = log.filter(|_| path.to_str() == Some(&name));
        let mut files = Companions { main: name, log, disk: DiskFiles::new(), found: Vec::new() };
        let parsed = parse(bytes, &path.display().to_string(), &mut files);
        files.found.into_iter().for_each(|file| self.origin.attach(file));
        parsed
    }
}

fn attachment(name: &str, bytes: &[u8]) -> Attachment {
    let media_type = match name.rsplit('.').next() {
        Some("png") => "image/png",
        Some("jpg" | "jpeg") => "image/jpeg",
        Some("pgm") => "image/x-portable-graymap",
        Some("bmp") => "image/bmp",
        _ => "text/plain",
    };
    Attachment { name: name.into(), media_type: media_type.into(), data: bytes.to_vec() }
}

/// The files named in a file: from a recording in the order of their reading, or from disk.
struct Companions {
    main: String,
    log: Option<Log>,
    disk: DiskFiles,
    found: Vec<Attachment>,
}

impl FileSource for Companions {
    fn read(&mut self, reference: &str, referrer: &str, limit: u64) -> io::Result<SourceFile> {
        let name = format!("{} {:03} {reference}", self.main, self.found.len() + 1);
        if let Some(log) = &self.log {
            let file = log.header().attachment(&name).ok_or(io::ErrorKind::NotFound)?;
            self.found.push(file.clone());
            return Ok(SourceFile { name: reference.into(), bytes: file.data.clone() });
        }
        let file = match onlooker::file(Path::new(reference)) {
            Some(file) => SourceFile { name: reference.into(), bytes: file? },
            None => self.disk.read(reference, referrer, limit)?,
        };
        self.found.push(attachment(&name, &file.bytes));
        Ok(file)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::support::temporary;
    use std::fs::{self, File};

    #[test]
    fn only_recordings_are_read_to_the_end() {
        let path = temporary("sparse.mcap");
        let sparse = |begins: &[u8]| {
            fs::write(&path, begins).unwrap();
            File::options().write(true).open(&path).unwrap().set_len(MOST + 1).unwrap();
            recording_bytes(&path)
        };
        assert_eq!(sparse(b"").unwrap(), [0; 9]);
        let error = sparse(MAGIC).unwrap_err().to_string();
        assert!(error.contains("found 4294967297 bytes, more than the 4294967296"), "{error}");
        for bytes in [b"".as_slice(), b"floor", MAGIC, b"\x89MCAP0\r\n\x01more", b"damaged!\x01more"] {
            fs::write(&path, bytes).unwrap();
            assert_eq!(recording_bytes(&path).unwrap(), bytes);
        }
        fs::write(&path, "Dear all, this is a letter").unwrap();
        assert_eq!(recording_bytes(&path).unwrap(), b"Dear all,");
        fs::remove_file(&path).unwrap();
    }
}
