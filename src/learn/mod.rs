//! Training of networks (feature `learn`; book, section 13.6).
//!
//! A [`Trainer`] fits the weights of a [`Network`](crate::vision::network::Network) to [`Examples`], which
//! may differ each time that they are looked at. Gradients come from the crate `candle-core`; this module
//! adds the order of the work, so that equal seeds give equal weights on one kind of processor, whatever the
//! number of threads and of interruptions.
//!
//! ```
//! use roverlab::learn::{Examples, Loss, Trainer, TrainerOptions};
//! use roverlab::random::Stream;
//!
//! /// Points of the plane, and whether they are on one side of a line.
//! struct Sides;
//!
//! impl Examples for Sides {
//!     fn count(&self) -> usize {
//!         256
//!     }
//!
//!     fn write(&self, _index: usize, random: &mut Stream, input: &mut [f32]) -> f32 {
//!         input.fill_with(|| random.between(-1.0, 1.0) as f32);
//!         f32::from(input[0] > input[1])
//!     }
//! }
//!
//! let options = TrainerOptions { loss: Loss::Classes, ..TrainerOptions::default() };
//! let mut trainer = Trainer::new("1x2x1 dense8 dense2".parse()?, options)?;
//! let first = trainer.epoch(&Sides, 0.01)?;
//! let last = (0..20).map(|_| trainer.epoch(&Sides, 0.01)).last().unwrap()?;
//! assert!(last < 0.5 * first);
//!
//! let mut network = trainer.network();
//! let sides = network.run(&[0.8, -0.5])?;
//! assert!(sides[1] > sides[0]);
//! # Ok::<(), roverlab::learn::TrainingError>(())
//! ```

mod checkpoint;
mod gradient;
mod signs;
#[cfg(test)]
mod tests;
mod trainer;

pub use gradient::Loss;
pub use trainer::{Examples, Trainer, TrainerOptions, TrainingError};
