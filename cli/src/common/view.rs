//! The page beside a run: `--view`.

use std::cell::Cell;
use std::io::{ErrorKind, Write};
use std::rc::Rc;

use roverlab::io::sim::Watcher;
use roverlab::picture::Picture;
use roverlab::world::Scene;
use roverlab_view::serve::{Beside, Opening};

use super::{CommonArgs, Failure, Onlooker, Printed, onlooker};

/// Options of the page beside a run.
#[derive(Debug, Clone, Default, clap::Args)]
pub(crate) struct ViewArgs {
    /// Show the run in a page, whose local address is printed: at this port, or at a free one.
    #[arg(
        long, value_name = "PORT", num_args = 0..=1, require_equals = true, default_missing_value = "0",
        conflicts_with_all = ["replay", "robios"]
    )]
    pub(crate) view: Option<u16>,

    /// Start before anybody has opened the page of --view.
    #[arg(long, requires = "view")]
    pub(crate) no_wait: bool,
}

/// Does a command's work with the page beside it, if the options ask for one.
pub(super) fn beside(
    common: &CommonArgs,
    work: impl FnOnce() -> Result<Printed, Failure>,
) -> Result<Printed, Failure> {
    let Some(port) = common.view.view else { return work() };
    let facts = common.origin.facts();
    let words = [vec![facts.program.replace('_', "-")], facts.options].concat();
    let page = open(&Opening { port, command: words.join(" ") }, "--view")?;
    let page = Rc::new(page);
    announce(page.address());
    let begun = Rc::new(Cell::new(false));
    let viewer = Viewer { page: Rc::clone(&page), waits: !common.view.no_wait, begun: Rc::clone(&begun) };
    let result = onlooker::with(Some(Box::new(viewer)), || {
        let printed = work()?;
        if begun.get() { Ok(printed) } else { Err(nothing_to_see()) }
    });
    if let Err(failure) = &result {
        page.ended(failure.status(), "", &failure.to_string());
    }
    result
}

fn nothing_to_see() -> Failure {
    Failure::input("--view: found no simulated robot that drives here; expected a run of one, or of a fleet")
}

/// Opens the page for an option.
fn open(opening: &Opening, option: &str) -> Result<Beside, Failure> {
    Beside::open(opening).map_err(|error| port_failure(option, opening.port, &error))
}

/// The error for a port that cannot be listened on.
pub(crate) fn port_failure(option: &str, port: u16, error: &std::io::Error) -> Failure {
    let found =
        if error.kind() == ErrorKind::AddrInUse { "one that is taken".into() } else { error.to_string() };
    Failure::input(format!("{option}={port}: found {found}; expected a free port, or none"))
}

/// Prints the address of a page.
pub(crate) fn announce(address: &str) {
    // In one piece, for programs that read it. Without standard error nobody can be informed.
    let _ = std::io::stderr().write_all(format!("view: {address}\n").as_bytes());
}

/// The page as onlooker, beside terminal and files.
#[derive(Debug)]
struct Viewer {
    page: Rc<Beside>,
    /// Whether the first robots wait for somebody who looks.
    waits: bool,
    begun: Rc<Cell<bool>>,
}

impl Onlooker for Viewer {
    fn stands_in(&self) -> bool {
        false
    }

    fn told(&mut self, line: &str) {
        self.page.told(line);
    }

    fn file(&mut self, _name: &str) -> Option<Vec<u8>> {
        None
    }

    fn scene(&mut self, scene: &mut Scene) -> Box<dyn Watcher> {
        let watcher = self.page.scene(scene);
        if self.waits && !self.begun.replace(true) {
            self.page.wait();
        }
        self.begun.set(true);
        watcher
    }

    fn picture(&mut self, picture: &Picture) {
        self.page.picture(picture);
    }

    fn reported(&mut self, status: u8, summary: &str) {
        self.page.ended(status, summary, "");
    }
}
