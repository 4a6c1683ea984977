//! Files that a user names.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use roverlab::files::irregular;

/// Maximum length of a text that is read (bytes).
const LONGEST: u64 = 16 << 20;

/// Refuses what is neither a regular file nor a folder: whoever opens a FIFO may wait for ever, and a device
/// may have no end. What is not there is left to whoever opens it.
pub(crate) fn require_regular(file: &Path) -> Result<(), String> {
    match irregular(file).filter(|_| !file.is_dir()) {
        None => Ok(()),
        Some(wrong) => Err(format!("{}: {wrong}; expected a regular file", file.display())),
    }
}

/// Reads a regular file of limited length; messages end with what is expected.
pub(crate) fn read_text(file: &Path, expected: &str) -> Result<String, String> {
    require_regular(file)?;
    let failed = |error: &io::Error| format!("{}: {error}; expected {expected}", file.display());
    let mut text = String::new();
    let read = File::open(file).and_then(|file| file.take(LONGEST + 1).read_to_string(&mut text));
    read.map_err(|error| failed(&error))?;
    if text.len() as u64 > LONGEST {
        return Err(failed(&io::ErrorKind::FileTooLarge.into()));
    }
    Ok(text)
}

/// The beginning of a regular file.
#[cfg(not(target_family = "wasm"))]
pub(crate) fn read_beginning(file: &Path, most: u64) -> io::Result<Vec<u8>> {
    require_regular(file).map_err(io::Error::other)?;
    let mut bytes = Vec::new();
    File::open(file)?.take(most).read_to_end(&mut bytes)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn only_regular_files_are_read() {
        let folder = std::env::temp_dir().join(format!("regular-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let (text, long, pipe) = (folder.join("text"), folder.join("long"), folder.join("pipe"));
        fs::write(&text, "PSDGet local 0.5").unwrap();
        File::create(&long).unwrap().set_len(LONGEST + 1).unwrap();
        assert_eq!(read_text(&text, "costs").as_deref(), Ok("PSDGet local 0.5"));
        assert_eq!(read_beginning(&text, 3).unwrap(), b"PSD");
        assert!(read_text(&long, "costs").unwrap_err().ends_with("; expected costs"));
        assert!(read_text(&folder, "costs").unwrap_err().ends_with("; expected costs"));
        assert!(read_text(&folder.join("nothing"), "costs").unwrap_err().ends_with("; expected costs"));
        #[cfg(unix)]
        {
            assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
            for (file, found) in [(pipe.as_path(), "is a FIFO"), (Path::new("/dev/zero"), "is a device")] {
                let message = format!("{}: {found}; expected a regular file", file.display());
                assert_eq!(read_text(file, "costs"), Err(message));
                assert!(read_beginning(file, 3).is_err());
            }
        }
        fs::remove_dir_all(&folder).unwrap();
    }
}
