use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use roverlab::io::log::{Attachment, Log};

use super::supervision::Stops;

/// What a run is: the program and the options that affect it, and the recording that it replays.
///
/// The command line sets it when it has been read. Copies share it.
#[derive(Debug, Clone, Default)]
pub(crate) struct Origin {
    facts: Arc<OnceLock<Facts>>,
    trouble: Arc<Mutex<Vec<String>>>,
    warnings: Arc<Mutex<Vec<String>>>,
    files: Arc<Mutex<Vec<Attachment>>>,
    staged: Arc<AtomicBool>,
    stops: Stops,
}

/// What is known about a run from its command line.
#[derive(Debug, Clone, Default)]
pub(crate) struct Facts {
    /// The command's name.
    pub(crate) program: String,
    /// The options that affect the run, in the order of `--help`.
    pub(crate) options: Vec<String>,
    /// What is replayed.
    pub(crate) log: Option<Log>,
}

impl Origin {
    /// Sets what is known, once.
    pub(crate) fn set(&self, facts: Facts) {
        let _ = self.facts.set(facts);
    }

    pub(crate) fn facts(&self) -> Facts {
        self.facts.get().cloned().unwrap_or_default()
    }

    /// Takes in a file that belongs to the run. All must be read before the robots are taken: a recording begins with
    /// them.
    pub(crate) fn attach(&self, file: Attachment) {
        let mut files = self.files.lock().unwrap_or_else(PoisonError::into_inner);
        if files.contains(&file) {
            return;
        }
        if self.is_staged() {
            self.note(format!(
                "{}: was read when the robots drove; expected it before, for recordings",
                file.name
            ));
        }
        files.push(file);
    }

    /// The files that belong to the run.
    pub(crate) fn files(&self) -> Vec<Attachment> {
        self.files.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Notes something odd about the input.
    pub(crate) fn warn(&self, warning: String) {
        self.warnings.lock().unwrap_or_else(PoisonError::into_inner).push(warning);
    }

    /// Tells what is odd about the input, once.
    pub(crate) fn tell_warnings(&self) {
        for warning in self.warnings.lock().unwrap_or_else(PoisonError::into_inner).drain(..) {
            // Without standard error there is nobody left to tell.
            let _ = writeln!(std::io::stderr(), "{warning}");
        }
    }

    /// Notes that there was a stage, so that there is a recording.
    pub(crate) fn set_staged(&self) {
        self.tell_warnings();
        self.staged.store(true, Ordering::Relaxed);
    }

    /// Whether there was a stage.
    pub(crate) fn is_staged(&self) -> bool {
        self.staged.load(Ordering::Relaxed)
    }

    /// What safety systems have done.
    pub(crate) fn stops(&self) -> &Stops {
        &self.stops
    }

    /// Notes what went wrong with a recording. The run goes on, but the program reports it and fails.
    pub(crate) fn note(&self, trouble: String) {
        self.trouble.lock().unwrap_or_else(PoisonError::into_inner).push(trouble);
    }

    /// What has been noted.
    pub(crate) fn take_trouble(&self) -> Vec<String> {
        std::mem::take(&mut *self.trouble.lock().unwrap_or_else(PoisonError::into_inner))
    }
}
