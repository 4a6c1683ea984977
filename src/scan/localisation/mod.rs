//! Localisation in a known world (book, section 4.3): scan matching while driving.

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
