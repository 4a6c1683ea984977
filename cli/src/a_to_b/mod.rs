//! The command `a-to-b`.

mod args;
mod campaign;
mod chase;
mod drive;
mod job;
mod picture;
mod scene;
mod table;

pub(crate) use args::Args;
pub(crate) use campaign::campaign;
#[cfg(test)]
pub(crate) use campaign::{Row, rows};
pub(crate) use job::work;
#[cfg(test)]
pub(crate) use table::text;
