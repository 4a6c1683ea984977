//! What the examples `distbug` and `distbug_campaign` are made of: the behaviour in a simulated world, watched.

#![allow(dead_code, unused_imports, reason = "each of the two uses its own part of this")]

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
pub(crate) use campaign::{CampaignArgs, campaign, trials};
pub(crate) use course::scene;
pub(crate) use drive::{Drive, Ending, Event, Happening, Options, drive, sim_options};
pub(crate) use job::work;
pub(crate) use save::save;
pub(crate) use table::text;
pub(crate) use trial::{Judgement, Run, Trial, trial};
