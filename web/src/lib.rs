//! The commands of `roverlab` for a web page: a run is given by a command line, and its display is a stream
//! of [`Message`]s. The feature `programs` has RoBIOS instead, for programs in Python.
//!
//! `run` does the work. The WebAssembly module exposes it through the functions in `exports`.

mod camera;
mod digest;
#[cfg(target_family = "wasm")]
mod exports;
mod job;
mod mouth;
#[cfg(all(target_family = "wasm", feature = "programs"))]
mod program;
mod run;

pub use digest::Digest;
pub use job::{Job, Thing, Wish};
pub use roverlab_view::Message;
pub use run::run;
