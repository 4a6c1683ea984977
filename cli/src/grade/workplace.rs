use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use roverlab::files::TemporaryFolder;

/// A folder for one run, removed with all that is in it.
#[derive(Debug)]
pub(super) struct Workplace {
    folder: TemporaryFolder,
    /// What was there before the run.
    known: BTreeSet<String>,
}

/// Largest file that is copied beside a program (bytes).
const MOST: u64 = 10_000_000;

impl Workplace {
    /// Creates an empty folder.
    pub(super) fn new() -> io::Result<Self> {
        Ok(Self { folder: TemporaryFolder::new("roverlab-grade-")?, known: BTreeSet::new() })
    }

    pub(super) fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Copies a program and the files beside its source text, without other programs to grade. Returns its
    /// new place.
    pub(super) fn bring(&mut self, program: &Path, source: &Path, others: &[PathBuf]) -> io::Result<PathBuf> {
        let beside =
            source.parent().into_iter().flat_map(|folder| fs::read_dir(folder).into_iter().flatten());
        for entry in beside.flatten() {
            let file = entry.path();
            let fits = entry.metadata().is_ok_and(|about| about.is_file() && about.len() <= MOST);
            if fits && !others.contains(&file) {
                fs::copy(&file, self.path().join(entry.file_name()))?;
            }
        }
        let own = self.path().join(program.file_name().unwrap_or_default());
        fs::copy(program, &own)?;
        self.known = names(self.path()).into_iter().collect();
        Ok(own)
    }

    /// Names of the files that have come since.
    pub(super) fn written(&self) -> Vec<String> {
        names(self.path()).into_iter().filter(|name| !self.known.contains(name)).collect()
    }
}

/// Names of a folder's files, in order.
fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut names: Vec<String> =
        entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}
