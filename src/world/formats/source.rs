use std::collections::BTreeMap;
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};

use super::error::{FormatError, Location, Notes};
use super::limits::MAX_TEXT_BYTES;
use crate::files::open_regular;

/// A file that was read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SourceFile {
    /// Its name in messages, to which names in the file are relative.
    pub name: String,
    /// Its content.
    pub bytes: Vec<u8>,
}

/// Source of files named in other files.
///
/// # For implementers
///
/// Read no more than `limit` bytes: descriptions may name any file. Fail with
/// [`std::io::ErrorKind::NotFound`] for a file that does not exist.
pub trait FileSource {
    /// Finds and reads the file that `referrer` calls `reference`, up to a length of `limit` bytes.
    fn read(&mut self, reference: &str, referrer: &str, limit: u64) -> io::Result<SourceFile>;
}

/// Files on disk, relative to the file that names them.
///
/// The name as written is tried first, from the folder of the file that names it. Then follow the places of
/// EyeSim's own installation, and places of files copied without the installation's folders: the rest of the
/// name after `..` from that folder and the three above it; ever shorter ends of the name in that folder; and
/// the same in EyeSim's folders for the kind of file, such as `texture` or `objects`, in that folder or up to
/// three above it. Last are the working folder and the home folder. Case may differ.
///
/// `\` counts as `/`; a leading `~` and `$HOME` mean the home folder. EyeSim 6's `%sim%` is dropped, as is an
/// invalid drive letter.
///
/// ```
/// use roverlab::world::formats::DiskFiles;
/// let files = DiskFiles::with_home(None);
/// // A name in `src/lib.rs`, in different case.
/// let found = files.find("KINEMATICS/mod.rs", "src/lib.rs").expect("it is there");
/// assert!(found.ends_with("kinematics/mod.rs"));
/// assert_eq!(files.find("nowhere.wld", "src/lib.rs"), None);
/// ```
#[derive(Debug, Clone, Default)]
pub struct DiskFiles {
    home: Option<PathBuf>,
}

impl DiskFiles {
    /// Uses the user's home folder.
    pub fn new() -> Self {
        Self { home: std::env::home_dir() }
    }

    /// Uses a different home folder, or none.
    pub fn with_home(home: Option<PathBuf>) -> Self {
        Self { home }
    }

    /// The name with `/` as separator and the home folder inserted.
    fn plain(&self, reference: &str) -> String {
        let mut written = reference.replace('\\', "/");
        if let Some(home) = self.home.as_deref().and_then(Path::to_str) {
            written = written.replace("${HOME}", home).replace("$HOME", home);
            if let Some(rest) = written.strip_prefix("~/") {
                written = format!("{home}/{rest}");
            }
        }
        let old = written.get(..5).is_some_and(|start| start.eq_ignore_ascii_case("%sim%"));
        if old { written[5..].trim_start_matches('/').into() } else { written }
    }

    /// Path of the file that `referrer` calls `reference`.
    pub fn find(&self, reference: &str, referrer: &str) -> Option<PathBuf> {
        let plain = self.plain(reference);
        let folder = Path::new(referrer).parent().unwrap_or(Path::new(""));
        let exact = |places: &[PathBuf]| places.iter().find(|path| path.is_file()).cloned();
        exact(&[folder.join(reference), folder.join(&plain)])
            .or_else(|| in_any_case(folder, Path::new(&plain)))
            .or_else(|| installed(folder, &plain))
            .or_else(|| exact(&[PathBuf::from(&plain)]))
            .or_else(|| exact(&[self.home.as_deref()?.join(&plain)]))
    }
}

/// Number of folders above the referring file's folder that belong to the same installation.
const LEVELS: usize = 3;

/// Finds a file that is not at its named place in the folders of EyeSim's installation, or copied without
/// them.
fn installed(folder: &Path, plain: &str) -> Option<PathBuf> {
    let bare = plain.trim_start_matches(|c: char| c.is_ascii_alphabetic()).strip_prefix(':').unwrap_or(plain);
    let parts: Vec<&str> = bare.split('/').filter(|part| !matches!(*part, "" | "." | "..")).collect();
    let tails: Vec<PathBuf> = (0..parts.len()).map(|from| parts[from..].iter().collect()).collect();
    let whole = tails.first()?;
    let mut above = vec![folder.to_owned()];
    // Folders may be relative, so their ancestors are expressed with `..`.
    above.extend((1..=LEVELS).map(|level| folder.join(["..", "../..", "../../.."][level - 1])));
    let by_root = above.iter().find_map(|root| in_any_case(root, whole));
    let brought = || tails.iter().find_map(|tail| in_any_case(folder, tail));
    let by_kind = || {
        above.iter().find_map(|root| {
            kind_folders(whole)
                .iter()
                .find_map(|kind| tails.iter().find_map(|tail| in_any_case(root, &Path::new(kind).join(tail))))
        })
    };
    by_root.or_else(brought).or_else(by_kind)
}

/// Folders in which EyeSim and its users keep files of a kind.
fn kind_folders(file: &Path) -> &'static [&'static str] {
    let ending = file.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    match ending.to_ascii_lowercase().as_str() {
        "png" | "jpg" | "jpeg" | "bmp" | "asc" => {
            &["texture", "textures", "heightmap", "worlds/texture", "worlds/heightmap"]
        }
        "esobj" => &["objects", "object"],
        "obj" | "mtl" => &["objects", "object", "robots", "robot"],
        "robi" => &["robots", "robot"],
        "wld" | "maz" => &["worlds", "worlds/small", "worlds/aquatic", "world"],
        _ => &[],
    }
}

/// The file at a path relative to a folder; names may differ in case.
///
/// ```
/// use std::path::Path;
/// use roverlab::world::formats::in_any_case;
///
/// assert_eq!(in_any_case(Path::new("src"), Path::new("LIB.RS")), Some("src/lib.rs".into()));
/// assert_eq!(in_any_case(Path::new(""), Path::new("src")), None);
/// ```
pub fn in_any_case(folder: &Path, path: &Path) -> Option<PathBuf> {
    let mut place = folder.to_owned();
    for part in path.components() {
        match part {
            Component::Normal(name) if !place.join(name).exists() => {
                let here = if place.as_os_str().is_empty() { Path::new(".") } else { &place };
                let entries = std::fs::read_dir(here).ok()?.filter_map(Result::ok);
                let mut names: Vec<_> = entries.map(|entry| entry.file_name()).collect();
                names.sort();
                let wanted = name.to_string_lossy();
                let found = names.into_iter().find(|n| n.to_string_lossy().eq_ignore_ascii_case(&wanted))?;
                place.push(found);
            }
            part => place.push(part),
        }
    }
    place.is_file().then_some(place)
}

impl FileSource for DiskFiles {
    fn read(&mut self, reference: &str, referrer: &str, limit: u64) -> io::Result<SourceFile> {
        // What has the name and is no file is refused by its kind.
        let beside = || {
            let (plain, folder) = (self.plain(reference), Path::new(referrer).parent()?);
            Some(folder.join(&plain)).filter(|place| !plain.is_empty() && place.exists())
        };
        let path = self.find(reference, referrer).or_else(beside).ok_or(io::ErrorKind::NotFound)?;
        Ok(SourceFile { name: path.display().to_string(), bytes: read_limited(&path, limit)? })
    }
}

/// Source of referenced files, with the policy for missing or broken ones.
pub(super) struct Files<'a> {
    source: &'a mut dyn FileSource,
    /// Whether errors become warnings.
    pub(super) tolerant: bool,
}

impl<'a> Files<'a> {
    pub(super) fn new(source: &'a mut dyn FileSource, tolerant: bool) -> Self {
        Self { source, tolerant }
    }

    /// The source, for formats that name files themselves.
    pub(super) fn source(&mut self) -> &mut dyn FileSource {
        self.source
    }

    /// Reads the file called `reference` at a location in another file.
    pub(super) fn read(
        &mut self,
        reference: &str,
        named: (&str, Location),
        limit: u64,
    ) -> Result<SourceFile, FormatError> {
        self.read_if_there(reference, named, limit)?.ok_or_else(|| missing(reference, named))
    }

    /// Like [`read`](Self::read); `None` if the file does not exist.
    pub(super) fn read_if_there(
        &mut self,
        reference: &str,
        (referrer, at): (&str, Location),
        limit: u64,
    ) -> Result<Option<SourceFile>, FormatError> {
        match self.source.read(reference, referrer, limit) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(unreadable(&error, reference, referrer, at, limit)),
            Ok(found) => Ok(Some(found)),
        }
    }

    /// Passes a result on, or converts its error to a warning that ends with the workaround.
    pub(super) fn get_over<T>(
        &self,
        result: Result<T, FormatError>,
        instead: &str,
        notes: &mut Notes<'_>,
    ) -> Result<Option<T>, FormatError> {
        match result {
            Err(error) if self.tolerant => {
                notes.get_over(error, instead);
                Ok(None)
            }
            result => result.map(Some),
        }
    }
}

/// Files in memory, found by the exact name: for tests and for worlds made by programs.
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

/// Reads a regular file of up to `limit` bytes.
pub(super) fn read_limited(path: &Path, limit: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open_regular(path)?.take(limit + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > limit {
        return Err(io::ErrorKind::FileTooLarge.into());
    }
    Ok(bytes)
}

/// The error for a file that could not be read, located where it is named.
pub(super) fn unreadable(error: &io::Error, name: &str, file: &str, at: Location, limit: u64) -> FormatError {
    let name = super::lexer::shown(name);
    let (found, expected) = match error.kind() {
        io::ErrorKind::NotFound => (format!("{name}, which does not exist"), "a file that exists".into()),
        io::ErrorKind::FileTooLarge => {
            (format!("{name}, a larger file"), format!("a file of at most {} MiB", limit >> 20))
        }
        // In the words of `open_regular`.
        io::ErrorKind::IsADirectory | io::ErrorKind::Unsupported => {
            (format!("{name}, which {error}"), "a regular file".into())
        }
        kind => (format!("{name}, which cannot be read ({kind})"), "a readable file".into()),
    };
    FormatError::new(file, at, found, expected)
}

/// The error for a missing file, located where it is named.
pub(super) fn missing(name: &str, (file, at): (&str, Location)) -> FormatError {
    unreadable(&io::ErrorKind::NotFound.into(), name, file, at, 0)
}

/// Text of a file: UTF-8, or Latin-1 with a warning.
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

/// Rejects a text that is too long.
pub(super) fn check_length(text: &str, file: &str) -> Result<(), FormatError> {
    if text.len() as u64 <= MAX_TEXT_BYTES {
        return Ok(());
    }
    let expected = format!("a file of at most {} MiB", MAX_TEXT_BYTES >> 20);
    Err(FormatError::new(file, Location::START, "a larger file", expected))
}

/// Name of a file without folder and extension, the default name of robots and objects.
pub(super) fn stem(file: &str) -> String {
    let name = file.rsplit(['/', '\\']).next().unwrap_or(file);
    Path::new(name).file_stem().map_or_else(|| name.into(), |stem| stem.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A temporary folder, removed after the test.
    struct Folder(PathBuf);

    impl Folder {
        fn new(name: &str) -> Self {
            let folder = std::env::temp_dir().join(format!("roverlab-{name}-{}", std::process::id()));
            for inner in ["home/worlds", "project/scripts", "project/worlds/texture", "project/object/sign"] {
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
            ("B.WLD", "scripts"),
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
        // Without the installation's folders, or from another of its folders.
        folder.write("project/scripts/picture.PNG", "beside");
        folder.write("project/worlds/texture/carpet.jpg", "installed");
        folder.write("project/object/sign/sign.esObj", "renamed");
        for (reference, expected) in [
            ("../texture/picture.png", "beside"),
            ("../../../worlds/texture/carpet.jpg", "installed"),
            ("../texture/Carpet.jpg", "installed"),
            ("../../objects/sign/Sign.esObj", "renamed"),
            (r"D:\eyesim\objects\sign\sign.esObj", "renamed"),
        ] {
            assert_eq!(read(reference).as_deref(), Ok(expected), "{reference}");
        }
        for nowhere in ["c.wld", r"C:\worlds\c.wld", r"C:\", "", "%sim%", "%€"] {
            assert_eq!(read(nowhere), Err(io::ErrorKind::NotFound), "{nowhere}");
        }
        assert_eq!(read(r"..\worlds"), Err(io::ErrorKind::IsADirectory));
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
