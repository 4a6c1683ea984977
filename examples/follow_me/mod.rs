//! What the example `follow_me` is made of.

#![allow(dead_code, unused_imports, reason = "example and tests use their own parts of this")]

mod campaign;
mod job;
mod scene;
mod swarm;

pub(crate) use campaign::{Row, campaign, rows, text};
pub(crate) use job::{Args, work};
pub(crate) use scene::{Mode, hall, lidarbot};
pub(crate) use swarm::{SwarmRun, run};
