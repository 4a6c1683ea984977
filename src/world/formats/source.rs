use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use super::error::{FormatError, Location, Notes};
use super::limits::MAX_TEXT_BYTES;

/// A file that was found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SourceFile {
    /// The name by which messages call it, and by which files that it names are looked up.
    pub name: String,
    /// Its content.
    pub bytes: Vec<u8>,
}

/// Where the files come from that a file names.
pub trait FileSource {
    /// Finds and reads the file that `referrer` calls `reference`, if it is at most `limit` bytes long.
    fn read(&mut self, reference: &str, referrer: &str, limit: u64) -> io::Result<SourceFile>;
}

/// Files on disk, looked up as EyeSim does: as written, then from the folder of the file that names it, then from
/// the home folder.
///
/// `\` counts as `/`; a leading `~` and `$HOME` stand for the home folder; EyeSim 6's `%sim%` is dropped, so that
/// what follows it is looked up in all places. Of a path with a drive letter that leads nowhere, the file's name alone
/// is looked up in the folder of the file that names it.
#[derive(Debug, Clone, Default)]
pub struct DiskFiles {
    home: Option<PathBuf>,
}

impl DiskFiles {
    /// With the user's home folder.
    pub fn new() -> Self {
        Self { home: std::env::home_dir() }
    }

    /// With another folder in place of the home folder, or none.
    pub fn with_home(home: Option<PathBuf>) -> Self {
        Self { home }
    }

    fn candidates(&self, reference: &str, referrer: &str) -> Vec<PathBuf> {
        let mut written = reference.replace('\\', "/");
        if let Some(home) = self.home.as_deref().and_then(Path::to_str) {
            written = written.replace("${HOME}", home).replace("$HOME", home);
            if let Some(rest) = written.strip_prefix("~/") {
                written = format!("{home}/{rest}");
            }
        }
        let start = written.get(..5).is_some_and(|start| start.eq_ignore_ascii_case("%sim%"));
        let plain = if start { written[5..].trim_start_matches('/') } else { &written };
        let mut list = vec![PathBuf::from(reference), PathBuf::from(plain)];
        list.extend(Path::new(referrer).parent().map(|folder| folder.join(plain)));
        list.extend(self.home.as_deref().map(|home| home.join(plain)));
        // The path of another machine: the file may have come along with the one that names it.
        let drive = plain.as_bytes().get(1) == Some(&b':');
        let base = plain.rsplit('/').next().filter(|base| drive && !base.is_empty());
        list.extend(base.and_then(|base| Some(Path::new(referrer).parent()?.join(base))));
        list
    }
}

impl FileSource for DiskFiles {
    fn read(&mut self, reference: &str, referrer: &str, limit: u64) -> io::Result<SourceFile> {
        let found = self.candidates(reference, referrer).into_iter().find(|path| path.is_file());
        let path = found.ok_or(io::ErrorKind::NotFound)?;
        Ok(SourceFile { name: path.display().to_string(), bytes: read_limited(&path, limit)? })
    }
}

/// Files in memory, found by the name as written: for tests, and for worlds made by programs.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct MemoryFiles(pub BTreeMap<String, Vec<u8>>);

impl FileSource for MemoryFiles {
    fn read(&mut self, reference: &str, _referrer: &str, limit: u64) -> io::Result<SourceFile> {
        let bytes = self.0.get(reference).ok_or(io::ErrorKind::NotFound)?;
        if bytes.len() as u64 > limit {
            return Err(io::ErrorKind::FileTooLarge.into());
        }
        Ok(SourceFile { name: reference.into(), bytes: bytes.clone() })
    }
}

/// Reads a regular file of at most `limit` bytes.
pub(super) fn read_limited(path: &Path, limit: u64) -> io::Result<Vec<u8>> {
    // A pipe or a device would block or never end.
    if path.is_dir() {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    if path.exists() && !path.is_file() {
        return Err(io::ErrorKind::Unsupported.into());
    }
    let mut bytes = Vec::new();
    File::open(path)?.take(limit + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > limit {
        return Err(io::ErrorKind::FileTooLarge.into());
    }
    Ok(bytes)
}

/// The error for a file that could not be read, placed where it is named.
pub(super) fn unreadable(error: &io::Error, name: &str, file: &str, at: Location, limit: u64) -> FormatError {
    let name = super::lexer::shown(name);
    let (found, expected) = match error.kind() {
        io::ErrorKind::NotFound => (format!("{name}, which does not exist"), "a file that exists".into()),
        io::ErrorKind::FileTooLarge => {
            (format!("{name}, a larger file"), format!("a file of at most {} MiB", limit >> 20))
        }
        kind => (format!("{name}, which cannot be read ({kind})"), "a readable file".into()),
    };
    FormatError::new(file, at, found, expected)
}

/// The text of a file: UTF-8, or Latin-1 with a warning.
pub(super) fn decode(bytes: Vec<u8>, notes: &mut Notes<'_>) -> Result<String, FormatError> {
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) || bytes.contains(&0) {
        return Err(FormatError::new(
            notes.file,
            Location::START,
            "bytes that are no text",
            "a text file in UTF-8",
        ));
    }
    String::from_utf8(bytes).or_else(|error| {
        let valid = error.utf8_error().valid_up_to();
        let bytes = error.into_bytes();
        let line = bytes[..valid].split(|&b| b == b'\n').count();
        notes.warn(Location { line, column: 1 }, "not UTF-8; read as Latin-1");
        Ok(bytes.into_iter().map(char::from).collect())
    })
}

/// Refuses a text that is too long.
pub(super) fn check_length(text: &str, file: &str) -> Result<(), FormatError> {
    if text.len() as u64 <= MAX_TEXT_BYTES {
        return Ok(());
    }
    let expected = format!("a file of at most {} MiB", MAX_TEXT_BYTES >> 20);
    Err(FormatError::new(file, Location::START, "a larger file", expected))
}

/// The name of a file without folders and ending: the name of robots and objects that state none.
pub(super) fn stem(file: &str) -> String {
    let name = file.rsplit(['/', '\\']).next().unwrap_or(file);
    Path::new(name).file_stem().map_or_else(|| name.into(), |stem| stem.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder that goes away with the test.
    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Self {
            let folder = std::env::temp_dir().join(format!("roverlab-{name}-{}", std::process::id()));
            for inner in ["home/worlds", "project/scripts"] {
                std::fs::create_dir_all(folder.join(inner)).unwrap();
            }
            Self(folder)
        }

        fn write(&self, name: &str, text: &str) {
            std::fs::write(self.0.join(name), text).unwrap();
        }
    }

    impl Drop for Folder {
        fn drop(&mut self) {
            let _ = std::fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn files_are_looked_up_in_order() {
        let folder = Folder::new("look-up");
        folder.write("home/worlds/a.wld", "home");
        folder.write("home/worlds/b.wld", "home");
        folder.write("project/b.wld", "project");
        folder.write("project/scripts/b.wld", "scripts");
        let mut files = DiskFiles::with_home(Some(folder.0.join("home")));
        let script = folder.0.join("project/scripts/x.sim").display().to_string();
        let mut read = |reference: &str| {
            let found = files.read(reference, &script, 100);
            found.map(|file| String::from_utf8(file.bytes).unwrap()).map_err(|error| error.kind())
        };
        let absolute = folder.0.join("project/b.wld").display().to_string();
        for (reference, expected) in [
            (absolute.as_str(), "project"),
            ("b.wld", "scripts"),
            (r"..\b.wld", "project"),
            (r"./../scripts\b.wld", "scripts"),
            ("worlds/a.wld", "home"),
            ("$HOME/worlds/b.wld", "home"),
            (r"${HOME}\worlds\b.wld", "home"),
            ("~/worlds/b.wld", "home"),
            (r"%sim%\worlds\a.wld", "home"),
            ("%SIM%b.wld", "scripts"),
            (r"C:\worlds\b.wld", "scripts"),
        ] {
            assert_eq!(read(reference).as_deref(), Ok(expected), "{reference}");
        }
        for nowhere in ["c.wld", r"C:\worlds\c.wld", r"C:\", "worlds", "", "%sim%", "%€"] {
            assert_eq!(read(nowhere), Err(io::ErrorKind::NotFound), "{nowhere}");
        }
    }

    #[test]
    fn long_files_and_folders_are_refused() {
        let folder = Folder::new("limits");
        folder.write("home/long", "12345");
        let kind =
            |path: &str, limit| read_limited(&folder.0.join(path), limit).map_err(|error| error.kind());
        assert_eq!(kind("home/long", 5), Ok(b"12345".to_vec()));
        assert_eq!(kind("home/long", 4), Err(io::ErrorKind::FileTooLarge));
        assert_eq!(kind("home", 4), Err(io::ErrorKind::IsADirectory));
    }

    #[test]
    fn old_files_are_latin_1() {
        let mut notes = Notes::new("x.sim");
        assert_eq!(decode(b"# ok\n# K\xe4fig".to_vec(), &mut notes).unwrap(), "# ok\n# K\u{e4}fig");
        let warnings = notes.finish(()).warnings;
        assert_eq!(warnings[0].to_string(), "x.sim:2:1: not UTF-8; read as Latin-1");
    }
}
