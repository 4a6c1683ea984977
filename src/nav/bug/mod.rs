//! The bug family: sensor-based ways to a goal, with a proof when there is none (book, sections 10.1 and 10.2).

mod body;
mod distbug;
mod engine;
mod family;
mod kind;
mod leave_rule;
mod memory;
mod panorama;
mod parameters;
mod plain;
mod progress;
mod report;
mod strategy;
mod tangent;
mod tour;
mod wall_ends;

pub use distbug::DistBug;
pub use family::{Bug, Guarantee, PathBound};
pub use kind::{BugKind, UnknownBug};
pub use memory::{Alg1, Alg2, Rev1, Rev2};
pub use parameters::BugParameters;
pub use plain::{Bug2, Class1, OneBug};
pub use report::{BugEvent, BugOutcome, BugPhase};
pub use tangent::TangentBug;
pub use tour::{Bug1, LeaveBug};

/// What DistBug goes by.
pub type DistBugParameters = BugParameters;
/// How a run of DistBug ended.
pub type DistBugOutcome = BugOutcome;
/// What a robot that runs DistBug is doing.
pub type DistBugPhase = BugPhase;
/// Something worth telling that happened in a step of DistBug.
pub type DistBugEvent = BugEvent;
