//! The command `ramp`.

mod args;
mod campaign;
mod cross;
mod edges;
mod job;

pub(crate) use args::Args;
pub(crate) use campaign::campaign;
#[cfg(test)]
pub(crate) use campaign::trials;
pub(crate) use job::work;
