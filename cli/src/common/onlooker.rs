//! Who looks on while a command works, in place of a terminal and of files: a page in a browser, say.

use std::borrow::Cow;
use std::cell::RefCell;
use std::fmt;
use std::io;
use std::path::Path;

use roverlab::io::sim::Watcher;
use roverlab::picture::Picture;
use roverlab::world::Scene;

/// Looks on while a command works.
pub trait Onlooker: fmt::Debug {
    /// A line that a person is told.
    fn told(&mut self, line: &str);

    /// The file of a name, if there is one.
    fn file(&mut self, name: &str) -> Option<Vec<u8>>;

    /// The scene in which robots are about to drive. It may be changed; who drives in it may have been told of it before.
    fn scene(&mut self, scene: &mut Scene) -> Box<dyn Watcher>;

    /// The picture of the run, when it is over.
    fn picture(&mut self, picture: &Picture);
}

thread_local! {
    static ONLOOKER: RefCell<Option<Box<dyn Onlooker>>> = const { RefCell::new(None) };
}

/// Does something while somebody looks on at what this thread does, or nobody.
pub(crate) fn with<T>(onlooker: Option<Box<dyn Onlooker>>, work: impl FnOnce() -> T) -> T {
    ONLOOKER.set(onlooker);
    let result = work();
    ONLOOKER.set(None);
    result
}

/// Asks or tells who looks on. `None` if nobody does.
fn ask<T>(question: impl FnOnce(&mut dyn Onlooker) -> T) -> Option<T> {
    ONLOOKER.with_borrow_mut(|onlooker| onlooker.as_mut().map(|onlooker| question(onlooker.as_mut())))
}

/// Whether somebody looks on.
pub(crate) fn is_there() -> bool {
    ask(|_| ()).is_some()
}

/// Tells a line to who looks on. Returns whether somebody does.
pub(crate) fn told(line: impl fmt::Display) -> bool {
    ask(|onlooker| onlooker.told(&line.to_string())).is_some()
}

/// The file that somebody who looks on has, or lacks; `None` if nobody looks on.
pub(crate) fn file(path: &Path) -> Option<io::Result<Vec<u8>>> {
    ask(|onlooker| onlooker.file(&path.display().to_string()).ok_or(io::ErrorKind::NotFound.into()))
}

/// Shows a scene to who looks on, who may change it and watches what happens there.
pub(crate) fn watched(scene: &Scene) -> (Cow<'_, Scene>, Option<Box<dyn Watcher>>) {
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

/// Shows the picture of a run to who looks on. Returns whether somebody does.
pub(crate) fn pictured(picture: impl FnOnce() -> Picture) -> bool {
    is_there() && {
        let picture = picture();
        ask(|onlooker| onlooker.picture(&picture)).is_some()
    }
}
