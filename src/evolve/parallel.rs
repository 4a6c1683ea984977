use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use super::evaluator::{Evaluator, Round, Trial};
use crate::io::{Error, ErrorKind, Result};

/// Evaluates individuals in several threads. The result does not depend on their number.
///
/// ```
/// use roverlab::evolve::{Evaluator, Parallel, Round, Serial, Trial};
/// let noisy = |genome: &Vec<f64>, trial: Trial| Ok(genome[0] + trial.random().uniform());
/// let (genomes, round) = (vec![vec![1.0], vec![2.0], vec![3.0]], Round { seed: 1, generation: 0 });
/// let fitness = Parallel::new(2, noisy)?.evaluate(&genomes, round)?;
/// assert_eq!(fitness, Serial::new(noisy).evaluate(&genomes, round)?, "to the bit");
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug)]
pub struct Parallel<F> {
    fitness: F,
    pool: ThreadPool,
}

impl<F> Parallel<F> {
    /// An evaluator that calls a function of genome and trial in `threads` threads; 0 means one per
    /// processor.
    ///
    /// # Errors
    ///
    /// If the threads cannot be started.
    pub fn new(threads: usize, fitness: F) -> Result<Self> {
        let pool = ThreadPoolBuilder::new().num_threads(threads).build().map_err(|error| {
            Error::new(ErrorKind::Other, "the evaluation threads cannot be started").with_source(error)
        })?;
        Ok(Self { fitness, pool })
    }

    /// Number of threads.
    pub fn threads(&self) -> usize {
        self.pool.current_num_threads()
    }
}

impl<G: Sync, F: Fn(&G, Trial) -> Result<f64> + Sync> Evaluator<G> for Parallel<F> {
    fn evaluate(&mut self, genomes: &[G], round: Round) -> Result<Vec<f64>> {
        let Self { fitness, pool } = self;
        let evaluate = |(i, genome): (usize, &G)| fitness(genome, round.trial(i));
        // One at a time, because evaluation times vary.
        pool.install(|| genomes.par_iter().enumerate().with_max_len(1).map(evaluate).collect())
    }
}
