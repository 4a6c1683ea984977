//! The command `boat`.

mod args;
mod campaign;
mod job;
mod lake;
mod voyage;

pub(crate) use args::Args;
pub(crate) use job::work;
