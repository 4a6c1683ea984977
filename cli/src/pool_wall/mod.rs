//! The command `pool-wall`.

mod args;
mod campaign;
mod job;
mod round;

pub(crate) use args::Args;
pub(crate) use job::work;
