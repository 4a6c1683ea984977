//! Evolution (book, chapter 12): genetic algorithms for any fitness function.
//!
//! A population of genomes is evaluated, and the next one is bred from it: [`Genetic`] replaces whole
//! generations, [`SteadyState`] a few individuals at a time, and [`CmaEs`] adapts a normal distribution of
//! real vectors. A [`Recipe`] combines [`Selection`], [`Crossover`] and [`Mutation`]; the book's is
//! [`Recipe::book`].
//!
//! Fitness is maximised. An [`Evaluator`] computes it: in this thread ([`Serial`]), in several (`Parallel`,
//! feature `rayon`), or in other processes ([`Processes`]). All random numbers come from streams named after
//! generation and individual. The result therefore depends only on the seed, not on who evaluates what or on
//! interruptions (`checkpoint`, feature of that name).
//!
//! # Example
//!
//! Tunes the tangent scale of a spline, so that the path from A to B is short but its curvature stays below 4
//! 1/m:
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
