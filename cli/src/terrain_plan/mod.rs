//! The command `terrain-plan`.

mod args;
mod campaign;
mod job;

pub(crate) use args::Args;
pub(crate) use job::work;
