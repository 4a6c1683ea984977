//! The command `motion`.

mod approach;
mod args;
mod campaign;
mod scene;
mod watch;

pub(crate) use args::Args;
pub(crate) use campaign::campaign;
pub(crate) use watch::work;
