//! The command `survey`.

mod args;
mod campaign;
mod floor;
mod job;
mod map;
mod tour;

pub(crate) use args::Args;
pub(crate) use job::work;
