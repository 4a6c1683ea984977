//! The command `navigate`.

mod args;
mod campaign;
mod course;
mod drive;
mod job;
mod picture;

pub(crate) use args::Args;
pub(crate) use campaign::campaign;
#[cfg(test)]
pub(crate) use campaign::trials;
pub(crate) use job::work;
