//! The commands of `roverlab` for a page in a browser: a run is a command line, and what a window shows of it is a
//! stream of [`Message`]s.
//!
//! [`run`] does the work. The module that a browser loads has it behind the few functions of `exports`.

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
