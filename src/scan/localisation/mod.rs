//! Where a robot is in a world that it knows (book, section 4.3): by matching scans while it drives.

mod hypothesis;
mod localiser;
mod map;
mod parameters;
mod search;
mod surfaces;
#[cfg(test)]
mod tests;

pub use hypothesis::Hypothesis;
pub use localiser::{Localisation, Localiser};
#[cfg(feature = "nav")]
pub(crate) use map::HEIGHT;
pub use map::LocalisationMap;
pub use parameters::LocaliserParameters;
