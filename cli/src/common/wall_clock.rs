//! The wall clock: duration of a run, pacing, and progress. No result may depend on it.

use std::fmt::Display;
use std::io::{IsTerminal, Write};
use std::time::Duration;
#[cfg(not(target_family = "wasm"))]
use std::time::Instant;

/// Measures wall-clock time; in browsers, where Rust has no clock, no time passes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stopwatch(#[cfg(not(target_family = "wasm"))] Instant);

impl Stopwatch {
    #[allow(clippy::disallowed_methods, reason = "for reports, pacing and progress; no result depends on it")]
    pub(crate) fn start() -> Self {
        Self(
            #[cfg(not(target_family = "wasm"))]
            Instant::now(),
        )
    }

    pub(crate) fn elapsed(&self) -> Duration {
        #[cfg(not(target_family = "wasm"))]
        return self.0.elapsed();
        #[cfg(target_family = "wasm")]
        Duration::ZERO
    }

    pub(crate) fn seconds(&self) -> f64 {
        self.elapsed().as_secs_f64()
    }
}

/// Keeps simulated time from running ahead of the wall clock.
#[derive(Debug)]
pub(crate) struct Pacer(Stopwatch);

impl Pacer {
    pub(crate) fn start() -> Self {
        Self(Stopwatch::start())
    }

    /// Sleeps until `time` seconds have passed since the start.
    pub(crate) fn keep(&self, time: f64) {
        let ahead = time - self.0.seconds();
        if let Ok(pause) = Duration::try_from_secs_f64(ahead) {
            std::thread::sleep(pause);
        }
    }
}

/// Shows the progress of long work on one line of standard error, if that is a terminal.
#[derive(Debug)]
pub(crate) struct Progress {
    terminal: bool,
    since: Stopwatch,
    next: f64,
    shown: bool,
}

impl Progress {
    /// Time before the first output, and between two (s).
    const PATIENCE: f64 = 2.0;
    const INTERVAL: f64 = 0.2;

    pub(crate) fn start() -> Self {
        let terminal = std::io::stderr().is_terminal();
        Self { terminal, since: Stopwatch::start(), next: Self::PATIENCE, shown: false }
    }

    /// Shows a state, unless one was shown just now; only then evaluates `text`.
    pub(crate) fn show<T: Display>(&mut self, text: impl FnOnce() -> T) {
        if !self.terminal || self.since.seconds() < self.next {
            return;
        }
        self.next = self.since.seconds() + Self::INTERVAL;
        self.shown = true;
        let mut err = std::io::stderr();
        // A failure to show progress is no reason to stop.
        let _ = write!(err, "\r\x1b[K{}", text()).and_then(|()| err.flush());
    }

    /// Removes the line, so that other output can be written.
    pub(crate) fn clear(&mut self) {
        if std::mem::take(&mut self.shown) {
            let _ = write!(std::io::stderr(), "\r\x1b[K");
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.clear();
    }
}
