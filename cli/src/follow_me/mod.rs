//! The command `follow-me`.

mod campaign;
mod job;
mod scene;
mod swarm;

pub(crate) use campaign::campaign;
#[cfg(test)]
pub(crate) use campaign::{Row, rows, text};
pub(crate) use job::{Args, work};
