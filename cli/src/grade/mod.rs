//! The command `grade`.

mod args;
mod job;
mod page;
mod place;
mod program;
mod rubric;
mod run;
mod table;
mod workplace;

pub(crate) use args::Args;
pub(crate) use job::work;
