use std::fs::{self, DirBuilder, File, Metadata, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};

/// A temporary folder, which only its user may enter. It is removed when dropped; if the process is killed,
/// by the next one that makes a folder with the same prefix. Its name is the prefix and two numbers.
///
/// ```
/// use roverlab::files::TemporaryFolder;
/// let folder = TemporaryFolder::new("example-")?;
/// std::fs::write(folder.path().join("notes.txt"), "a letter")?;
/// let path = folder.path().to_owned();
/// drop(folder);
/// assert!(!path.exists());
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Debug)]
pub struct TemporaryFolder {
    path: PathBuf,
    /// Locked as long as the folder is used: the system unlocks it whatever ends the process.
    _lock: File,
}

/// File in these folders that is locked.
const LOCK: &str = "lock";
/// Number of names that are tried.
const NAMES: usize = 1000;

impl TemporaryFolder {
    /// A new folder in the system's one for temporary files, with a name that begins with `prefix`.
    pub fn new(prefix: &str) -> io::Result<Self> {
        Self::within(std::env::temp_dir(), prefix)
    }

    /// A new folder in another one. Fails if the prefix leads elsewhere.
    pub fn within(base: impl AsRef<Path>, prefix: &str) -> io::Result<Self> {
        let base = base.as_ref();
        if prefix.contains(std::path::is_separator) {
            let message = format!("prefix of a folder: found `{prefix}`; expected part of a name");
            return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
        }
        let named = |error: io::Error, path: &Path| {
            io::Error::new(
                error.kind(),
                format!("{}: {error}; expected a folder to write to", path.display()),
            )
        };
        for attempt in 0..NAMES {
            let path = base.join(format!("{prefix}{}-{attempt}", std::process::id()));
            if let Some(lock) = create(&path).map_err(|error| named(error, &path))? {
                let folder = Self { path, _lock: lock };
                remove_leftovers(base, prefix, &folder.path);
                return Ok(folder);
            }
        }
        Err(named(io::ErrorKind::AlreadyExists.into(), base))
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for TemporaryFolder {
    fn drop(&mut self) {
        // If removal fails, a later process does it.
        let _ = fs::remove_dir_all(&self.path);
    }
}

/// Creates a folder and locks it; `None` if the name is taken, or another process has just removed it.
fn create(path: &Path) -> io::Result<Option<File>> {
    match private().create(path) {
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => return Ok(None),
        created => created?,
    }
    let name = path.join(LOCK);
    let lock = OpenOptions::new().write(true).create_new(true).open(&name)?;
    let is_ours = lock.try_lock().is_ok() && name.exists();
    Ok(is_ours.then_some(lock))
}

#[cfg(unix)]
fn private() -> DirBuilder {
    use std::os::unix::fs::DirBuilderExt;
    let mut builder = DirBuilder::new();
    builder.mode(0o700);
    builder
}

#[cfg(not(unix))]
fn private() -> DirBuilder {
    DirBuilder::new()
}

/// Removes the folders of processes that were killed: nobody holds their locks. Only folders of the user to
/// whom our own belongs count.
fn remove_leftovers(base: &Path, prefix: &str, own: &Path) {
    let entries = fs::read_dir(base).into_iter().flatten().filter_map(Result::ok);
    let named = entries.filter(|entry| is_name(&entry.file_name().to_string_lossy(), prefix));
    for folder in named.map(|entry| entry.path()).filter(|folder| is_alike(folder, own)) {
        let lock = existing_lock(&folder.join(LOCK));
        if lock.is_ok_and(|lock| lock.try_lock().is_ok()) {
            let _ = fs::remove_dir_all(folder);
        }
    }
}

/// Whether a name is one of a temporary folder. Others' folders hold files `lock` as well.
fn is_name(name: &str, prefix: &str) -> bool {
    let numbers = name.strip_prefix(prefix).and_then(|rest| rest.split_once('-'));
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    numbers.is_some_and(|(process, attempt)| is_number(process) && is_number(attempt))
}

/// Whether something is a folder, and belongs to the user to whom our own belongs.
fn is_alike(folder: &Path, own: &Path) -> bool {
    match (fs::symlink_metadata(folder), fs::symlink_metadata(own)) {
        (Ok(folder), Ok(own)) => folder.is_dir() && have_same_user(&folder, &own),
        _ => false,
    }
}

#[cfg(unix)]
fn have_same_user(one: &Metadata, other: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    one.uid() == other.uid()
}

#[cfg(not(unix))]
fn have_same_user(_one: &Metadata, _other: &Metadata) -> bool {
    true
}

/// Opens a lock that is there, if it is a regular file.
fn existing_lock(name: &Path) -> io::Result<File> {
    if !fs::symlink_metadata(name)?.is_file() {
        return Err(io::ErrorKind::Unsupported.into());
    }
    OpenOptions::new().write(true).open(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_of_killed_runs_are_removed_by_the_next_one() {
        let base = std::env::temp_dir().join(format!("roverlab-folders-{}", std::process::id()));
        fs::create_dir_all(&base).unwrap();
        let alive = TemporaryFolder::within(&base, "robios-").unwrap();
        // A killed run leaves a lock that nobody holds. Others' folders have none.
        let (killed, other) = (base.join("robios-1-0"), base.join("robios-cache"));
        for folder in [&killed, &other] {
            fs::create_dir(folder).unwrap();
            fs::write(folder.join("program0.x"), "text").unwrap();
        }
        fs::write(killed.join(LOCK), "").unwrap();
        let next = TemporaryFolder::within(&base, "robios-").unwrap();
        assert!(!killed.exists() && other.exists() && alive.path().exists() && next.path() != alive.path());
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            assert_eq!(fs::metadata(next.path()).unwrap().permissions().mode() & 0o777, 0o700);
        }
        // What others lay in the way is left alone, and not waited for: locks that are pipes, links or
        // folders.
        #[cfg(unix)]
        {
            let strange = ["robios-2-0", "robios-2-1", "robios-2-2"].map(|name| base.join(name));
            for folder in &strange {
                fs::create_dir(folder).unwrap();
            }
            let pipe = std::process::Command::new("mkfifo").arg(strange[0].join(LOCK)).status().unwrap();
            assert!(pipe.success());
            fs::write(base.join("target"), "").unwrap();
            std::os::unix::fs::symlink(base.join("target"), strange[1].join(LOCK)).unwrap();
            fs::create_dir(strange[2].join(LOCK)).unwrap();
            drop(TemporaryFolder::within(&base, "robios-").unwrap());
            assert!(strange.iter().all(|folder| folder.exists()));
            // Neither do links to folders count.
            std::os::unix::fs::symlink(&strange[0], base.join("robios-2-3")).unwrap();
            assert!(is_alike(&strange[0], next.path()) && !is_alike(&base.join("robios-2-3"), next.path()));
        }
        let gone = next.path().to_owned();
        drop(next);
        assert!(!gone.exists());
        drop(alive);
        fs::remove_dir_all(&base).unwrap();
    }

    /// Only the system's administrator may start programs as another user, so nobody else can try.
    #[cfg(unix)]
    #[test]
    fn another_user_sees_nothing_of_it() {
        use std::os::unix::process::CommandExt;
        use std::process::Command;
        const NOBODY: u32 = 65_534;
        let folder = TemporaryFolder::within(std::env::temp_dir(), "roverlab-seen-").unwrap();
        let file = folder.path().join("memory");
        fs::write(&file, "of one user").unwrap();
        let can = |program: &str, of: &Path| {
            Command::new(program).arg(of).uid(NOBODY).gid(NOBODY).output().map(|done| done.status.success())
        };
        match can("ls", Path::new("/")) {
            Err(error) => assert_eq!(error.kind(), io::ErrorKind::PermissionDenied),
            Ok(begins) => {
                assert!(begins);
                for (program, of) in [("ls", folder.path()), ("cat", &file), ("rm", &file)] {
                    assert!(!can(program, of).unwrap(), "{program}");
                }
                assert_eq!(fs::read(&file).unwrap(), b"of one user");
            }
        }
    }

    /// Others lock their folders too, and forget some: an empty prefix is no leave to remove these.
    #[test]
    fn folders_with_other_names_are_never_removed() {
        let base = std::env::temp_dir().join(format!("roverlab-others-{}", std::process::id()));
        let others = ["cache", "2-0-cache", "-0", "2-", "2.0"].map(|name| base.join(name));
        for folder in &others {
            fs::create_dir_all(folder).unwrap();
            fs::write(folder.join(LOCK), "").unwrap();
        }
        drop(TemporaryFolder::within(&base, "").unwrap());
        assert!(others.iter().all(|folder| folder.exists()));
        for prefix in ["/", "../", "cache/"] {
            let refused = TemporaryFolder::within(&base, prefix).unwrap_err();
            assert_eq!(refused.kind(), io::ErrorKind::InvalidInput);
        }
        fs::remove_dir_all(&base).unwrap();
    }
}
