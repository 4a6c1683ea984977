use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use roverlab::geometry::Pose;
use roverlab::io::log::{Attachment, Log};
use roverlab::world::Scene;
use roverlab::world::formats::Parsed;

use super::supervision::Stops;
use super::trip::within;

/// Identity of a run: its program and relevant options, and the recording that it replays.
///
/// Set once the command line has been parsed; shared by copies.
#[derive(Debug, Clone, Default)]
pub(crate) struct Origin {
    facts: Arc<OnceLock<Facts>>,
    trouble: Arc<Mutex<Vec<String>>>,
    warnings: Arc<Mutex<Vec<String>>>,
    files: Arc<Mutex<Vec<Attachment>>>,
    staged: Arc<AtomicBool>,
    stops: Stops,
}

/// Facts about a run from its command line.
#[derive(Debug, Clone, Default)]
pub(crate) struct Facts {
    /// Name of the command.
    pub(crate) program: String,
    /// Options that affect the run, in the order of `--help`.
    pub(crate) options: Vec<String>,
    /// Options that decide about a campaign's results, with the names of files as given.
    pub(crate) settings: Vec<String>,
    /// Input files among them, by option.
    pub(crate) inputs: Vec<(String, PathBuf)>,
    /// The replayed recording.
    pub(crate) log: Option<Log>,
}

impl Origin {
    /// Sets the facts, once.
    pub(crate) fn set(&self, facts: Facts) {
        let _ = self.facts.set(facts);
    }

    pub(crate) fn facts(&self) -> Facts {
        self.facts.get().cloned().unwrap_or_default()
    }

    /// Adds a file of the run. All files must be read before the robots are taken, as a recording begins with
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

    /// Files of the run.
    pub(crate) fn files(&self) -> Vec<Attachment> {
        self.files.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Records a warning about the input.
    pub(crate) fn warn(&self, warning: String) {
        self.warnings.lock().unwrap_or_else(PoisonError::into_inner).push(warning);
    }

    /// A scene that was read from a file, with a run's start if that is given. Records the warnings of the
    /// file, and one of things so far from the start that maps and pictures omit them.
    pub(crate) fn scene(&self, file: &Path, parsed: Parsed<Scene>, start: Option<Pose>) -> Scene {
        parsed.warnings.iter().for_each(|warning| self.warn(warning.to_string()));
        let mut scene = parsed.value;
        scene.world.start = start.or(scene.world.start);
        let strays = scene.world.strays();
        if strays > 0 {
            self.warn(format!(
                "{}: walls and objects that reach far out of the rest, which is {}: {strays}; maps and \
                 pictures leave them out",
                file.display(),
                within(&scene.world.site())
            ));
        }
        scene
    }

    /// Prints the warnings about the input, once.
    pub(crate) fn tell_warnings(&self) {
        for warning in self.warnings.lock().unwrap_or_else(PoisonError::into_inner).drain(..) {
            // Without standard error nobody can be informed.
            let _ = writeln!(std::io::stderr(), "{warning}");
        }
    }

    /// Records that there is a stage, and therefore a recording.
    pub(crate) fn set_staged(&self) {
        self.tell_warnings();
        self.staged.store(true, Ordering::Relaxed);
    }

    /// Whether there is a stage.
    pub(crate) fn is_staged(&self) -> bool {
        self.staged.load(Ordering::Relaxed)
    }

    /// Actions of the safety systems.
    pub(crate) fn stops(&self) -> &Stops {
        &self.stops
    }

    /// Records a problem with a recording. The run continues, but the program reports it and fails.
    pub(crate) fn note(&self, trouble: String) {
        self.trouble.lock().unwrap_or_else(PoisonError::into_inner).push(trouble);
    }

    /// Takes the recorded problems.
    pub(crate) fn take_trouble(&self) -> Vec<String> {
        std::mem::take(&mut *self.trouble.lock().unwrap_or_else(PoisonError::into_inner))
    }
}
