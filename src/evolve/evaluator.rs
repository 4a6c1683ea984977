use crate::io::{Error, Result};
use crate::random::Stream;

/// What makes the trials of one generation: they are the same whoever carries them out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Round {
    /// The seed of the run.
    pub seed: u64,
    /// The generation, from 0.
    pub generation: u64,
}

impl Round {
    /// The trial of an individual of this generation.
    pub fn trial(self, index: usize) -> Trial {
        Trial { round: self, index }
    }
}

/// One evaluation of one individual.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Trial {
    /// The generation that it belongs to.
    pub round: Round,
    /// The individual's place in its generation.
    pub index: usize,
}

impl Trial {
    /// This trial's own random numbers, for a fitness that has to do with chance.
    pub fn random(self) -> Stream {
        Stream::new(self.round.seed)
            .child("generation", self.round.generation)
            .child("trial", self.index as u64)
    }
}

/// Whoever finds out how fit individuals are.
pub trait Evaluator<G> {
    /// The fitness of each genome, in the same order. Greater is fitter.
    fn evaluate(&mut self, genomes: &[G], round: Round) -> Result<Vec<f64>>;
}

/// Evaluates one individual after the other, in the caller's thread.
#[derive(Debug, Clone)]
pub struct Serial<F> {
    fitness: F,
}

impl<F> Serial<F> {
    /// An evaluator by a function of genome and trial.
    pub fn new(fitness: F) -> Self {
        Self { fitness }
    }
}

impl<G, F: FnMut(&G, Trial) -> Result<f64>> Evaluator<G> for Serial<F> {
    fn evaluate(&mut self, genomes: &[G], round: Round) -> Result<Vec<f64>> {
        genomes.iter().enumerate().map(|(i, genome)| (self.fitness)(genome, round.trial(i))).collect()
    }
}

/// Fails unless there is one number for each individual.
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
