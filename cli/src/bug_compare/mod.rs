//! The command `bug-compare`.

mod args;
mod boundaries;
mod campaign;
mod contest;
mod job;
mod picture;
mod ride;
mod statistics;
mod table;

pub(crate) use args::Args;
#[cfg(test)]
pub(crate) use boundaries::Boundaries;
pub(crate) use job::work;
#[cfg(test)]
pub(crate) use statistics::interval;
