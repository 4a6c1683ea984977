//! The command `distbug`: the behaviour in a simulated world, observed, and a campaign through many of them.

mod args;
mod campaign;
mod course;
mod drive;
mod job;
mod picture;
mod save;
mod table;
mod trial;

pub(crate) use args::Args;
#[cfg(test)]
pub(crate) use campaign::trials;
pub(crate) use course::scene;
pub(crate) use drive::{Drive, Event, Happening, Options, drive, ending, sim_options};
pub(crate) use job::work;
pub(crate) use save::save;
#[cfg(test)]
pub(crate) use table::text;
#[cfg(test)]
pub(crate) use trial::trial;
