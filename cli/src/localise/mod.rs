//! The command `localise`.

mod campaign;
mod drive;
mod job;
mod picture;
mod worlds;

pub(crate) use campaign::campaign;
#[cfg(test)]
pub(crate) use campaign::{Row, rows, text};
pub(crate) use drive::Finding;
pub(crate) use job::{Args, work};
