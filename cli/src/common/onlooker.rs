//! An onlooker of a command, such as a web page, may replace terminal and files.

use std::borrow::Cow;
use std::cell::RefCell;
use std::fmt;
use std::io;
use std::path::Path;

use roverlab::io::sim::Watcher;
use roverlab::picture::Picture;
use roverlab::world::Scene;

/// Observes a command at work.
pub trait Onlooker: fmt::Debug {
    /// Whether it replaces terminal and files. Otherwise it only looks on.
    fn stands_in(&self) -> bool {
        true
    }

    /// Receives a line of output.
    fn told(&mut self, line: &str);

    /// The file with a name, if any.
    fn file(&mut self, name: &str) -> Option<Vec<u8>>;

    /// Receives the scene before robots drive in it, and may change it; robots may have been given the
    /// original as their map.
    fn scene(&mut self, scene: &mut Scene) -> Box<dyn Watcher>;

    /// Receives the picture of the run at its end.
    fn picture(&mut self, picture: &Picture);

    /// Receives the report as text, with the exit status.
    fn reported(&mut self, _status: u8, _summary: &str) {}
}

thread_local! {
    static ONLOOKER: RefCell<Option<Box<dyn Onlooker>>> = const { RefCell::new(None) };
}

/// Runs `work` with an onlooker of this thread, or without one.
pub(crate) fn with<T>(onlooker: Option<Box<dyn Onlooker>>, work: impl FnOnce() -> T) -> T {
    ONLOOKER.set(onlooker);
    let result = work();
    ONLOOKER.set(None);
    result
}

/// Calls the onlooker. `None` without one.
fn ask<T>(question: impl FnOnce(&mut dyn Onlooker) -> T) -> Option<T> {
    ONLOOKER.with_borrow_mut(|onlooker| onlooker.as_mut().map(|onlooker| question(onlooker.as_mut())))
}

/// Whether there is an onlooker.
pub(crate) fn is_there() -> bool {
    ask(|_| ()).is_some()
}

/// Whether there is an onlooker in the place of terminal and files.
pub(crate) fn stands_in() -> bool {
    ask(|onlooker| onlooker.stands_in()).unwrap_or(false)
}

/// Sends a line to the onlooker. Returns whether there is one in the place of the terminal.
pub(crate) fn told(line: impl fmt::Display) -> bool {
    ask(|onlooker| {
        onlooker.told(&line.to_string());
        onlooker.stands_in()
    })
    .unwrap_or(false)
}

/// The onlooker's file, or its absence; `None` without an onlooker in the place of files.
pub(crate) fn file(path: &Path) -> Option<io::Result<Vec<u8>>> {
    if !stands_in() {
        return None;
    }
    ask(|onlooker| onlooker.file(&path.display().to_string()).ok_or(io::ErrorKind::NotFound.into()))
}

/// Shows a scene to the onlooker, who may change it and watch it.
pub(super) fn watched(scene: &Scene) -> (Cow<'_, Scene>, Option<Box<dyn Watcher>>) {
    let shown = ask(|onlooker| {
        let mut scene = scene.clone();
        let watcher = onlooker.scene(&mut scene);
        (scene, watcher)
    });
    match shown {
        Some((scene, watcher)) => (Cow::Owned(scene), Some(watcher)),
        None => (Cow::Borrowed(scene), None),
    }
}

/// Shows the picture of a run to the onlooker.
pub(crate) fn pictured(picture: &Picture) {
    ask(|onlooker| onlooker.picture(picture));
}

/// Shows the report to the onlooker.
pub(crate) fn reported(status: u8, summary: impl FnOnce() -> String) {
    ask(|onlooker| onlooker.reported(status, &summary()));
}
