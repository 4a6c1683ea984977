//! The command `summit`.

mod args;
mod campaign;
mod climb;
mod job;

pub(crate) use args::Args;
pub(crate) use campaign::campaign;
#[cfg(test)]
pub(crate) use campaign::trials;
pub(crate) use job::work;
