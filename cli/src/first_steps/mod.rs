//! The command `first-steps`.

mod args;
mod campaign;
mod job;
mod scene;

pub(crate) use args::Args;
pub(crate) use job::work;
