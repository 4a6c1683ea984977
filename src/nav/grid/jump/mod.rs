//! Jump point search, online and prepared.

mod online;
mod planes;
mod prepared;
mod search;

pub use online::JumpPointSearch;
pub use prepared::PreparedJumps;
