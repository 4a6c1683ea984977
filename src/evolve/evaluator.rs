use crate::io::{Error, Result};
use crate::random::Stream;

/// Identity of a generation's trials, independent of who evaluates them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Round {
    /// Seed of the run.
    pub seed: u64,
    /// Index of the generation, from 0.
    pub generation: u64,
}

impl Round {
    /// Trial of an individual in this generation.
    pub fn trial(self, index: usize) -> Trial {
        Trial { round: self, index }
    }
}

/// One evaluation of one individual.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Trial {
    /// Its generation.
    pub round: Round,
    /// Index of the individual in its generation.
    pub index: usize,
}

impl Trial {
    /// The random stream of this trial, for a fitness with random effects.
    pub fn random(self) -> Stream {
        Stream::new(self.round.seed)
            .child("generation", self.round.generation)
            .child("trial", self.index as u64)
    }
}

/// Computes the fitness of individuals.
///
/// # For implementers
///
/// Return one number per genome, in order. The result may depend on the genome and its [`Trial`] alone,
/// not on order or threads.
pub trait Evaluator<G> {
    /// Returns the fitness of each genome, in order. Greater is fitter.
    ///
    /// # Errors
    ///
    /// If an individual cannot be evaluated.
    fn evaluate(&mut self, genomes: &[G], round: Round) -> Result<Vec<f64>>;
}

/// Evaluates individuals one after another, in the calling thread.
#[derive(Debug, Clone)]
pub struct Serial<F> {
    fitness: F,
}

impl<F> Serial<F> {
    /// An evaluator that calls a function of genome and trial.
    pub fn new(fitness: F) -> Self {
        Self { fitness }
    }
}

impl<G, F: FnMut(&G, Trial) -> Result<f64>> Evaluator<G> for Serial<F> {
    fn evaluate(&mut self, genomes: &[G], round: Round) -> Result<Vec<f64>> {
        genomes.iter().enumerate().map(|(i, genome)| (self.fitness)(genome, round.trial(i))).collect()
    }
}

/// Checks that there is one finite fitness per individual.
pub(super) fn check_fitness(fitness: &[f64], individuals: usize, round: Round) -> Result<()> {
    if fitness.len() != individuals {
        let found = format!("{} values", fitness.len());
        return Err(Error::invalid_input(
            "fitness of the population",
            found,
            &format!("{individuals} values"),
        ));
    }
    match fitness.iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(i) => {
            let name = format!("fitness of individual {i} in generation {}", round.generation);
            Err(Error::invalid_input(&name, fitness[i], "a finite number"))
        }
    }
}
