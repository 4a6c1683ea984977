//! The example `color_tracking`, in parts that the tests run too.

mod args;
mod campaign;
mod drive;
mod job;
mod scene;

pub(crate) use args::{Args, Job};
pub(crate) use campaign::campaign;
pub(crate) use job::work;
