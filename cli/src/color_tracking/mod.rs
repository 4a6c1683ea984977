//! The command `color-tracking`.

mod args;
mod campaign;
mod drive;
mod job;
mod scene;

pub(crate) use args::{Args, Job};
pub(crate) use campaign::campaign;
pub(crate) use job::work;
