use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::files::irregular;

/// The file of a recording, which belongs to one recorder at a time.
///
/// A new file is written in place, so that [`recover`](super::recover) finds in it what was recorded until a
/// crash. In the place of an older recording the new one comes by [`complete`](Self::complete): until then it
/// is beside it, under the name with a dot before it and `.part` behind it. Who wants to record to the same
/// name meanwhile gets an error.
///
/// ```
/// use std::io::Write;
/// use roverlab::io::log::{Header, LogFile, LogWriter};
///
/// # fn main() -> std::io::Result<()> {
/// let path = std::env::temp_dir().join(format!("log-file-{}.mcap", std::process::id()));
/// for _ in 0..2 {
///     let writer = LogWriter::new(LogFile::create(&path)?, &Header::new("nothing", [""; 0]))?;
///     assert!(LogFile::create(&path).is_err(), "somebody records to it");
///     writer.finish()?.complete()?;
/// }
/// std::fs::write(&path, "a letter")?;
/// assert!(LogFile::create(&path).is_err(), "it is no recording");
/// LogFile::replace(&path)?.write_all(b"whatever")?;
/// # std::fs::remove_file(&path)
/// # }
/// ```
#[derive(Debug)]
pub struct LogFile {
    file: BufWriter<File>,
    name: PathBuf,
    /// Path at which it is written instead until it gets its name.
    part: Option<PathBuf>,
    /// The file that has the name until then, which tells others that somebody records.
    named: File,
    sync: bool,
    /// Whether a part of it is of no use.
    whole: bool,
}

/// Bytes that are written at a time.
const BUFFER: usize = 1 << 16;

impl LogFile {
    /// A file of this name. Fails if there is one already that is no recording, or if somebody records to it.
    /// Folders, devices and pipes are always refused.
    pub fn create(path: impl AsRef<Path>) -> io::Result<Self> {
        Self::open(path.as_ref(), false)
    }

    /// A file of this name, in the place of any other. Fails if somebody records to it.
    pub fn replace(path: impl AsRef<Path>) -> io::Result<Self> {
        Self::open(path.as_ref(), true)
    }

    /// Waits at the end of each chunk until it is on the disk, where it stays if the machine stops.
    #[must_use]
    pub fn synced(mut self) -> Self {
        self.sync = true;
        self
    }

    /// Removes the file if it is dropped before [`complete`](Self::complete): what has a source elsewhere is
    /// written whole or not at all.
    #[must_use]
    pub fn whole(mut self) -> Self {
        self.whole = true;
        self
    }

    fn open(path: &Path, any: bool) -> io::Result<Self> {
        // The target of a link is replaced, not the link.
        let path = &fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        let named = claimed(path)?;
        // A link to nothing yet has a target now.
        let path = &fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        let is_new = named.metadata()?.len() == 0;
        if !(is_new || any) {
            is_recording(&named)?;
        }
        let part = (!is_new).then(|| aside(path));
        let file = match &part {
            None => named.try_clone()?,
            Some(part) => created(part, any)
                .map_err(|error| io::Error::new(error.kind(), format!("{}: {error}", part.display())))?,
        };
        let file = BufWriter::with_capacity(BUFFER, file);
        Ok(Self { file, name: path.to_owned(), part, named, sync: false, whole: false })
    }

    /// Ends the file, and gives it its name.
    pub fn complete(mut self) -> io::Result<()> {
        self.flush()?;
        if let Some(part) = &self.part {
            fs::rename(part, &self.name)?;
        }
        self.whole = false;
        Ok(())
    }
}

impl Drop for LogFile {
    fn drop(&mut self) {
        if !self.whole {
            return;
        }
        // What is still buffered is not written. In a folder of others, where nothing can be removed, the
        // file is empty at least. Nobody is left to hear of errors.
        if let Ok(named) = self.named.try_clone() {
            let unfinished = std::mem::replace(&mut self.file, BufWriter::new(named));
            let _ = unfinished.into_parts().0.set_len(0);
        }
        let _ = fs::remove_file(self.part.as_ref().unwrap_or(&self.name));
    }
}

impl Write for LogFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    /// Comes at the end of each chunk.
    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()?;
        if self.sync { self.file.get_ref().sync_data() } else { Ok(()) }
    }
}

impl Seek for LogFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

/// The file of a name, new or as it is, which nobody else writes.
fn claimed(path: &Path) -> io::Result<File> {
    loop {
        // A device may have no end, and whoever reads from a pipe may never come.
        if irregular(path).is_some() {
            return Err(strange());
        }
        let file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let message = "found somebody who records to it; expected nobody";
                return Err(io::Error::new(io::ErrorKind::ResourceBusy, message));
            }
            Err(TryLockError::Error(error)) => return Err(error),
        }
        // Whoever had it may have put another one in its place meanwhile.
        if has_name(&file, path)? {
            return Ok(file);
        }
    }
}

#[cfg(unix)]
fn has_name(file: &File, path: &Path) -> io::Result<bool> {
    use std::os::unix::fs::MetadataExt;
    let own = file.metadata()?;
    Ok(fs::metadata(path).is_ok_and(|named| (named.dev(), named.ino()) == (own.dev(), own.ino())))
}

#[cfg(not(unix))]
fn has_name(_: &File, path: &Path) -> io::Result<bool> {
    fs::exists(path)
}

/// Where a file is written whose name an older one has.
fn aside(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!(".{name}.part"))
}

/// A new file in the place of one that a recorder left behind. Others of the folder's users may have put
/// something else there.
fn created(part: &Path, any: bool) -> io::Result<File> {
    match fs::symlink_metadata(part) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => {}
        Err(error) => return Err(error),
        Ok(found) if !found.is_file() => return Err(strange()),
        Ok(_) => {
            if !any {
                is_recording(&File::open(part)?)?;
            }
            fs::remove_file(part)?;
        }
    }
    OpenOptions::new().write(true).create_new(true).open(part)
}

fn strange() -> io::Error {
    io::Error::other("found something that is no regular file")
}

/// Fails if a file is no recording, nor the beginning of one.
fn is_recording(file: &File) -> io::Result<()> {
    let mut begins = Vec::new();
    file.take(mcap::MAGIC.len() as u64).read_to_end(&mut begins)?;
    if mcap::MAGIC.starts_with(&begins) {
        return Ok(());
    }
    let message = "found a file that is no recording; expected one, or a new name";
    Err(io::Error::new(io::ErrorKind::AlreadyExists, message))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(name: &str) -> PathBuf {
        let path = std::env::temp_dir().join(format!("roverlab-log-file-{}-{name}", std::process::id()));
        let _ = (fs::remove_file(&path), fs::remove_file(aside(&path)));
        path
    }

    fn written(path: &Path, bytes: &[u8]) -> io::Result<LogFile> {
        let mut file = LogFile::create(path)?;
        file.write_all(bytes)?;
        file.flush()?;
        Ok(file)
    }

    #[test]
    fn a_new_file_is_written_in_place_and_an_old_one_stays_until_the_end() {
        let path = path("old");
        let old = written(&path, mcap::MAGIC).unwrap();
        assert_eq!(fs::read(&path).unwrap(), mcap::MAGIC);
        assert_eq!(LogFile::create(&path).unwrap_err().kind(), io::ErrorKind::ResourceBusy);
        assert_eq!(LogFile::replace(&path).unwrap_err().kind(), io::ErrorKind::ResourceBusy);
        old.complete().unwrap();
        let new = written(&path, b"new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), mcap::MAGIC);
        assert_eq!(LogFile::create(&path).unwrap_err().kind(), io::ErrorKind::ResourceBusy);
        new.synced().complete().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert!(!aside(&path).exists());
        fs::remove_file(path).unwrap();
    }

    #[test]
    fn what_is_not_whole_goes_and_an_older_file_stays() {
        let path = path("whole");
        // Somebody has it open still, as if it could not be removed.
        let mut file = written(&path, mcap::MAGIC).unwrap().whole();
        let opened = File::open(&path).unwrap();
        file.write_all(b"buffered").unwrap();
        drop(file);
        assert!(!path.exists() && opened.metadata().unwrap().len() == 0);
        written(&path, mcap::MAGIC).unwrap().whole().complete().unwrap();
        drop(written(&path, b"new").unwrap().whole());
        assert_eq!(fs::read(&path).unwrap(), mcap::MAGIC);
        assert!(!aside(&path).exists());
        #[cfg(unix)]
        {
            let link = super::tests::path("link");
            fs::remove_file(&path).unwrap();
            std::os::unix::fs::symlink(&path, &link).unwrap();
            drop(written(&link, mcap::MAGIC).unwrap().whole());
            assert!(!path.exists() && link.is_symlink());
            written(&link, mcap::MAGIC).unwrap().whole().complete().unwrap();
            fs::remove_file(&link).unwrap();
        }
        fs::remove_file(path).unwrap();
    }

    #[test]
    fn what_is_no_recording_stays() {
        let path = path("letter");
        fs::write(&path, "a letter").unwrap();
        assert_eq!(LogFile::create(&path).unwrap_err().kind(), io::ErrorKind::AlreadyExists);
        assert_eq!(fs::read(&path).unwrap(), b"a letter");
        fs::write(&path, &mcap::MAGIC[..3]).unwrap();
        fs::write(aside(&path), "another letter").unwrap();
        assert_eq!(LogFile::create(&path).unwrap_err().kind(), io::ErrorKind::AlreadyExists);
        assert_eq!(fs::read(aside(&path)).unwrap(), b"another letter");
        let mut file = LogFile::replace(&path).unwrap();
        file.write_all(b"whatever").unwrap();
        file.complete().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"whatever");
        fs::remove_file(path).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn links_and_pipes_in_its_place_are_refused() {
        let (path, other) = (path("place"), path("linked"));
        fs::write(&path, mcap::MAGIC).unwrap();
        fs::write(&other, mcap::MAGIC).unwrap();
        std::os::unix::fs::symlink(&other, aside(&path)).unwrap();
        let refused = |path: &Path| {
            let errors =
                [LogFile::create(path), LogFile::replace(path)].map(|file| file.unwrap_err().to_string());
            assert!(errors.iter().all(|error| error.contains("no regular file")), "{errors:?}");
            errors
        };
        assert!(refused(&path)[0].contains(aside(&path).to_str().unwrap()));
        assert_eq!(fs::read(&other).unwrap(), mcap::MAGIC);
        let pipe = |path: &Path| {
            fs::remove_file(path).unwrap();
            assert!(std::process::Command::new("mkfifo").arg(path).status().unwrap().success());
        };
        pipe(&aside(&path));
        refused(&path);
        pipe(&path);
        refused(&path);
        refused(Path::new("/dev/null"));
        for file in [&path, &aside(&path), &other] {
            fs::remove_file(file).unwrap();
        }
    }

    /// A part that a killed recorder left is written anew.
    #[test]
    fn what_a_recorder_left_is_written_anew() {
        let path = path("left");
        fs::write(&path, mcap::MAGIC).unwrap();
        fs::write(aside(&path), [mcap::MAGIC, mcap::MAGIC].concat()).unwrap();
        written(&path, b"new").unwrap().complete().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        fs::remove_file(path).unwrap();
    }

    /// Of several recorders that begin at the same moment, one gets the file, and the others hear that.
    #[test]
    fn one_of_several_recorders_gets_the_file() {
        let path = path("several");
        for round in 0..50 {
            let all = std::sync::Barrier::new(4);
            let files: Vec<_> = std::thread::scope(|scope| {
                let threads = [(); 4].map(|()| {
                    scope.spawn(|| {
                        all.wait();
                        LogFile::create(&path)
                    })
                });
                threads.map(|thread| thread.join().unwrap()).into_iter().filter_map(Result::ok).collect()
            });
            assert_eq!(files.len(), 1, "round {round}");
            for mut file in files {
                file.write_all(mcap::MAGIC).unwrap();
                file.complete().unwrap();
            }
        }
        fs::remove_file(path).unwrap();
    }
}
