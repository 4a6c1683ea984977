//! Traffic signs in images (book, section 13.5): where they are, and of which class.
//!
//! [`SignTrainer`] learns from pictures in which signs are marked, [`SignFinder`] finds signs in others. Both
//! describe what they see by histograms of oriented gradients, as the book does; the classifiers are linear.
//! A [`network`](super::network) that has learned from [`SignPatches`] tells classes better.

mod area;
mod descriptor;
mod detector;
mod finder;
mod linear;
mod model;
mod patch;
#[cfg(test)]
mod tests;
mod trainer;

#[cfg(feature = "weights")]
pub use super::WeightsError;
pub use area::Area;
pub use descriptor::SignDescriptor;
pub use finder::{FoundSign, SignFinder};
pub use linear::{LinearClassifier, LinearTraining};
pub use model::SignModel;
pub use patch::{SignPatch, SignPatches};
pub use trainer::SignTrainer;
