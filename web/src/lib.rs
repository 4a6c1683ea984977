//! The commands of `roverlab` for a web page: a run is given by a command line, and its display is a stream
//! of [`Message`]s.
//!
//! [`run`] does the work. The WebAssembly module exposes it through the functions in `exports`.

#[cfg(target_family = "wasm")]
mod exports;
mod frame;
mod job;
mod message;
mod overlay;
mod run;
mod scene;

pub use job::{Job, Thing, Wish};
pub use message::{Digest, Message};
pub use run::run;
