//! The command `pool-search`.

mod args;
mod campaign;
mod hunt;
mod job;
mod scene;

pub(crate) use args::Args;
pub(crate) use job::work;
