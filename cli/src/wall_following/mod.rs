//! The command `wall-following`.

mod args;
mod campaign;
mod corners;
mod drive;
mod job;
mod measure;
mod picture;

pub(crate) use args::{Args, Controller};
pub(crate) use campaign::campaign;
#[cfg(test)]
pub(crate) use campaign::{Row, rows, text};
pub(crate) use job::work;
pub(crate) use measure::{Errors, Watch};
