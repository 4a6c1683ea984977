//! Evolution (book, chapter 12): genetic algorithms for whatever has a fitness.
//!
//! A population of genomes is evaluated, and the next one is bred from it: [`Genetic`] replaces a generation at a time,
//! [`SteadyState`] a few individuals at a time, and [`CmaEs`] adapts a normal distribution of real vectors. How parents
//! are chosen ([`Selection`]), mixed ([`Crossover`]) and changed ([`Mutation`]) is a [`Recipe`]; the book's own is
//! [`Recipe::book`].
//!
//! Fitness is maximised. It is worked out by an [`Evaluator`]: in this thread ([`Serial`]), in several (`Parallel`, with
//! the feature `rayon`), or by other processes ([`Processes`]). Every random number comes from streams named after the
//! generation and the individual, so the result depends on the seed alone, not on who evaluated what, nor on where a
//! run was interrupted and resumed (`checkpoint`, with the feature of that name).
//!
//! # Example
//!
//! The scale of a spline's tangents, tuned so that the way from A to B is short but never bends sharper than 4 per
//! metre:
//!
//! ```
//! use roverlab::evolve::{Arithmetic, Evolution, Gaussian, Genetic, Recipe, Selection, Serial, StopRules, Trial};
//! use roverlab::random::Stream;
//!
//! # fn main() -> roverlab::io::Result<()> {
//! let fitness = |scale: &Vec<f64>, _: Trial| Ok(-(scale[0] - 1.3) * (scale[0] - 1.3));
//! let mut random = Stream::new(1);
//! let population = (0..20).map(|_| vec![random.between(0.1, 3.0)]).collect();
//! let recipe = Recipe {
//!     selection: Selection::Tournament { size: 3 },
//!     crossover: Box::new(Arithmetic),
//!     mutation: Box::new(Gaussian { probability: 0.5, sigma: 0.1, low: 0.1, high: 3.0 }),
//!     elite: 1,
//! };
//! let mut evolution = Genetic::new(population, recipe, 1)?;
//! evolution.run(&mut Serial::new(fitness), &StopRules::generations(40), |_| Ok(()))?;
//! assert!((evolution.best().unwrap().genome[0] - 1.3).abs() < 0.02);
//! # Ok(())
//! # }
//! ```

#[cfg(feature = "picture")]
mod chart;
#[cfg(feature = "checkpoint")]
pub mod checkpoint;
mod cma_es;
mod crossover;
mod eigen;
mod evaluator;
mod evolution;
mod gait;
mod genetic;
mod genome;
mod mutation;
#[cfg(feature = "rayon")]
mod parallel;
mod population;
mod processes;
mod recipe;
mod selection;
mod statistics;
mod steady_state;
mod stop;

#[cfg(feature = "picture")]
pub use chart::chart;
pub use cma_es::{CmaEs, Distribution};
pub use crossover::{Arithmetic, Crossover, OnePoint, Uniform};
pub use evaluator::{Evaluator, Round, Serial, Trial};
pub use evolution::Evolution;
pub use gait::{Gait, GaitWalk, ServoPositions};
pub use genetic::Genetic;
pub use genome::{Gene, Genome};
pub use mutation::{BitFlip, Gaussian, Mutation};
#[cfg(feature = "rayon")]
pub use parallel::Parallel;
pub use population::{Individual, Population};
pub use processes::{Processes, serve};
pub use recipe::Recipe;
pub use selection::{Selection, Selector};
pub use statistics::{GenerationStatistics, table};
pub use steady_state::SteadyState;
pub use stop::{StopReason, StopRules};
