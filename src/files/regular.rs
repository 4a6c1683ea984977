use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Folders of the system: what is in them counts as a regular file, but reading it may block, or never end.
#[cfg(unix)]
const SYSTEM: [&str; 2] = ["/proc", "/sys"];

/// What is wrong with a file that exists and is no regular one: a device may have no end, and whoever is at
/// the other end of a FIFO may never come.
///
/// ```
/// use roverlab::files::irregular;
/// assert_eq!(irregular("src"), Some("is a folder"));
/// assert_eq!((irregular("src/lib.rs"), irregular("no-such-file")), (None, None));
/// ```
pub fn irregular(file: impl AsRef<Path>) -> Option<&'static str> {
    let file = file.as_ref();
    let kind = fs::metadata(file).ok()?.file_type();
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        if kind.is_fifo() {
            return Some("is a FIFO");
        }
        if kind.is_socket() {
            return Some("is a socket");
        }
        let is_in_system =
            || fs::canonicalize(file).is_ok_and(|file| SYSTEM.iter().any(|folder| file.starts_with(folder)));
        if kind.is_file() && is_in_system() {
            return Some("is a file of the system");
        }
    }
    match () {
        () if kind.is_file() => None,
        () if kind.is_dir() => Some("is a folder"),
        () => Some("is a device"),
    }
}

/// Opens a regular file for reading. Fails for anything that is [`irregular`], and never blocks.
///
/// ```
/// use roverlab::files::open_regular;
/// assert!(open_regular("src/lib.rs").is_ok());
/// assert_eq!(open_regular("src").unwrap_err().to_string(), "is a folder");
/// ```
pub fn open_regular(file: impl AsRef<Path>) -> io::Result<File> {
    let file = file.as_ref();
    irregular(file).map_or_else(|| File::open(file), |wrong| Err(refusal(file, wrong)))
}

fn refusal(file: &Path, wrong: &str) -> io::Error {
    let kind = if file.is_dir() { io::ErrorKind::IsADirectory } else { io::ErrorKind::Unsupported };
    io::Error::new(kind, wrong)
}

/// Writes a file completely or not at all: under a new name beside it first, which it then gives up for its
/// own. A link is replaced, not followed. Fails if something [`irregular`] has the name.
///
/// ```
/// use std::fs;
/// let file = std::env::temp_dir().join(format!("whole-{}.txt", std::process::id()));
/// fs::write(&file, "a letter")?;
/// roverlab::files::write_whole(&file, b"another one")?;
/// assert_eq!(fs::read(&file)?, b"another one");
/// # fs::remove_file(&file)?;
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn write_whole(file: impl AsRef<Path>, bytes: &[u8]) -> io::Result<()> {
    let file = file.as_ref();
    if let Some(wrong) = irregular(file) {
        return Err(refusal(file, wrong));
    }
    let (unfinished, mut new) = create_beside(file)?;
    // The data must be on the disk before the name is.
    let written = new.write_all(bytes).and_then(|()| new.sync_all());
    written.and_then(|()| fs::rename(&unfinished, file)).inspect_err(|_| {
        // An incomplete file is useless; the error to report is the one being returned.
        let _ = fs::remove_file(&unfinished);
    })
}

/// Number of names that are tried for a new file.
const NAMES: usize = 1000;

/// A new file in the same folder, so that it can be renamed. Others of the folder's users may have put
/// something else in its place: that stays as it is.
fn create_beside(file: &Path) -> io::Result<(PathBuf, File)> {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let mut taken = io::ErrorKind::AlreadyExists.into();
    for number in 0..NAMES {
        let beside = file.with_file_name(format!(".{name}.{number}.part"));
        match OpenOptions::new().write(true).create_new(true).open(&beside) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => taken = error,
            opened => return opened.map(|new| (beside, new)),
        }
    }
    Err(taken)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("roverlab-files-{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        folder
    }

    /// What others laid in the way of a new file, or in its place, is neither followed nor written to.
    #[cfg(unix)]
    #[test]
    fn links_stay_what_they_are() {
        use std::os::unix::fs::symlink;
        let folder = folder("links");
        let (file, other) = (folder.join("picture.svg"), folder.join("other"));
        fs::write(&other, "of others").unwrap();
        let taken = [0, 1, 2].map(|number| folder.join(format!(".picture.svg.{number}.part")));
        for place in taken.iter().chain([&file]) {
            symlink(&other, place).unwrap();
        }
        write_whole(&file, b"whole").unwrap();
        assert_eq!(
            (fs::read(&other).unwrap(), fs::read(&file).unwrap()),
            (b"of others".into(), b"whole".into())
        );
        let is_link = |place: &PathBuf| fs::symlink_metadata(place).unwrap().is_symlink();
        assert!(!is_link(&file) && taken.iter().all(is_link));
        fs::remove_dir_all(folder).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn what_may_block_is_neither_read_nor_replaced() {
        let folder = folder("irregular");
        let (pipe, link) = (folder.join("pipe"), folder.join("link"));
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        std::os::unix::fs::symlink("/dev/zero", &link).unwrap();
        for (file, wrong) in [(pipe.as_path(), "is a FIFO"), (&link, "is a device"), (&folder, "is a folder")]
        {
            assert_eq!(open_regular(file).unwrap_err().to_string(), wrong);
            assert_eq!(write_whole(file, b"whole").unwrap_err().to_string(), wrong);
        }
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 2, "no temporary file is left");
        fs::remove_dir_all(folder).unwrap();
        if Path::new("/proc/self").exists() {
            assert_eq!(irregular("/proc/self/status"), Some("is a file of the system"));
            assert_eq!(irregular("/proc/self/cwd/Cargo.toml"), None);
        }
    }
}
