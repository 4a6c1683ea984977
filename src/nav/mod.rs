//! Navigation to a goal (chapter 10).
//!
//! [`Reachability`] is the planner that knows the whole world: it says whether a goal can be reached at all, and how
//! long the way is. The algorithms that see the world through a robot's sensors alone are judged by it.

mod reachability;

pub use reachability::{Path, Reachability};
