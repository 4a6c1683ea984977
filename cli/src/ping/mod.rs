//! The command `ping`.

mod args;
mod campaign;
mod game;
mod job;

pub(crate) use args::Args;
pub(crate) use job::work;
