//! The programs of the project, which share the extension's code.

use std::ffi::OsString;
use std::io::Write;
use std::path::PathBuf;

use pyo3::prelude::*;
use robios_runner::runner::Place;

/// Runs a command line of the program `roverlab`.
///
/// Parameters
/// ----------
/// program : str
///     The file by which the program is started, for processes of it that it starts.
/// words : list of str
///     The command line; the first word is the program's name.
///
/// Returns
/// -------
/// int
///     Exit status: 0 success, 1 failure, 2 wrong input.
#[pyfunction]
pub(crate) fn run_roverlab(py: Python<'_>, program: PathBuf, words: Vec<OsString>) -> u8 {
    py.detach(|| flushed(roverlab_cli::main_at(program, words)))
}

/// Runs a command line of the program `robios`.
///
/// Parameters
/// ----------
/// program : str
///     The file by which the program is started.
/// home : str
///     Folder with `include`, `bin`, `python`, and `lib` with the library.
/// words : list of str
///     The command line; the first word is the program's name.
///
/// Returns
/// -------
/// int
///     Exit status: 0 every program ended properly, 1 one did not or touched something, 2 wrong input.
#[pyfunction]
pub(crate) fn run_robios(py: Python<'_>, program: PathBuf, home: PathBuf, words: Vec<OsString>) -> u8 {
    py.detach(|| flushed(robios_runner::runner::main_at(Place { program, home }, words)))
}

/// Writes what is left in the buffer of standard output, which nobody else does at the end of this process.
fn flushed(status: u8) -> u8 {
    // A reader that has closed the pipe is told by the status.
    let _ = std::io::stdout().flush();
    status
}
