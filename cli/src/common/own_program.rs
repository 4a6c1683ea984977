//! The file of this program, for the processes of it that commands start.

use std::path::PathBuf;
use std::sync::OnceLock;
use std::{env, io};

static FILE: OnceLock<PathBuf> = OnceLock::new();

/// Sets the file by which this program is started if it is part of another one. The first one counts.
pub(crate) fn set_own_program(file: PathBuf) {
    let _ = FILE.set(file);
}

/// The file by which this program is started.
pub(crate) fn own_program() -> io::Result<PathBuf> {
    FILE.get().map_or_else(env::current_exe, |file| Ok(file.clone()))
}
