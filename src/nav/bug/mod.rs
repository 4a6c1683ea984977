//! The bug family: sensor-based navigation to a goal, with a proof when no way exists (book, sections 10.1
//! and 10.2).

mod alg1;
mod alg2;
mod algorithm;
mod body;
mod bug1;
mod bug2;
mod circumnavigation;
mod class1;
mod distbug;
mod doubt;
mod engine;
mod first_leave;
mod hit_point_memory;
mod kind;
mod leave_bug;
mod leave_rule;
mod one_bug;
mod panorama;
mod parameters;
mod progress;
mod report;
mod rev1;
mod rev2;
mod strategy;
mod tangent;
mod wall_ends;

pub use alg1::Alg1;
pub use alg2::Alg2;
pub use algorithm::{Bug, Guarantee, PathBound};
pub use bug1::Bug1;
pub use bug2::Bug2;
pub use class1::Class1;
pub use distbug::DistBug;
pub use kind::{BugKind, UnknownBug};
pub use leave_bug::LeaveBug;
pub use one_bug::OneBug;
pub use parameters::BugParameters;
pub use report::{BugEvent, BugOutcome, BugPhase};
pub use rev1::Rev1;
pub use rev2::Rev2;
pub use tangent::TangentBug;
