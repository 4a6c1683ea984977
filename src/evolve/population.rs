use super::evaluator::{Evaluator, Round, check_fitness};
use super::genome::Genome;
use super::statistics::GenerationStatistics;
use crate::io::{Error, Result};

/// A genome with its fitness.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct Individual<G> {
    /// Its genome.
    pub genome: G,
    /// Its fitness.
    pub fitness: f64,
}

/// State of a run, sufficient to resume it.
///
/// ```
/// use roverlab::evolve::Population;
/// let mut population = Population::new(vec![vec![1_u8], vec![2], vec![3]], 1)?;
/// population.fitness = vec![0.5, 2.0, 1.0];
/// assert_eq!(population.ranking(), [1, 2, 0], "the fittest first");
/// assert!(Population::<Vec<u8>>::new(Vec::new(), 1).is_err(), "an empty population");
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct Population<G> {
    /// Seed of the run.
    pub seed: u64,
    /// Index of the generation, from 0.
    pub generation: u64,
    /// The individuals' genomes.
    pub genomes: Vec<G>,
    /// Fitness of each individual; empty until they are evaluated.
    pub fitness: Vec<f64>,
    /// Fittest individual of all generations so far.
    pub best: Option<Individual<G>>,
    /// Statistics of each evaluated generation.
    pub history: Vec<GenerationStatistics>,
}

impl<G: Genome> Population<G> {
    /// The initial population of a run.
    ///
    /// # Errors
    ///
    /// If there are no genomes, or their lengths differ.
    pub fn new(genomes: Vec<G>, seed: u64) -> Result<Self> {
        let population =
            Self { seed, generation: 0, genomes, fitness: Vec::new(), best: None, history: Vec::new() };
        population.validate()?;
        Ok(population)
    }

    /// Checks that the run can be resumed.
    ///
    /// # Errors
    ///
    /// If there are no genomes, their lengths differ, fitness values are missing, or history and best
    /// individual do not fit the run.
    pub fn validate(&self) -> Result<()> {
        let Some(first) = self.genomes.first() else {
            return Err(Error::invalid_input("population", "empty", "at least one individual"));
        };
        let length = first.genes().len();
        if let Some(i) = self.genomes.iter().position(|genome| genome.genes().len() != length) {
            let found = self.genomes[i].genes().len();
            return Err(Error::invalid_input(
                &format!("length of genome {i}"),
                found,
                &format!("{length} genes, as the first has"),
            ));
        }
        if self.is_evaluated() {
            check_fitness(&self.fitness, self.genomes.len(), self.round())?;
        }
        self.validate_past(length)
    }

    /// Checks that there is a row per generation, and a best individual once there are any.
    fn validate_past(&self, length: usize) -> Result<()> {
        let rows = self.generation.saturating_add(u64::from(self.is_evaluated()));
        let numbered = self.history.iter().zip(0..).all(|(row, generation)| row.generation == generation);
        if self.history.len() as u64 != rows || !numbered {
            let found = format!("{} rows", self.history.len());
            return Err(Error::invalid_input(
                "history",
                found,
                &format!("one for each of {rows} generations"),
            ));
        }
        let best = self.best.as_ref().map(|best| best.genome.genes().len());
        let expected = (rows > 0).then_some(length);
        if best != expected {
            let words =
                |length: Option<usize>| length.map_or("none".into(), |genes| format!("one of {genes} genes"));
            return Err(Error::invalid_input("best individual", words(best), &words(expected)));
        }
        Ok(())
    }

    /// Whether this generation is evaluated.
    pub fn is_evaluated(&self) -> bool {
        !self.fitness.is_empty()
    }

    /// Identity of the present generation's trials.
    pub fn round(&self) -> Round {
        Round { seed: self.seed, generation: self.generation }
    }

    /// Indices of the individuals, fittest first; ties keep their order.
    pub fn ranking(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.fitness.len()).collect();
        order.sort_by(|&a, &b| self.fitness[b].total_cmp(&self.fitness[a]));
        order
    }

    /// FNV-1a hash of all genes and fitness values.
    pub fn hash(&self) -> u64 {
        let mut hash = 0xcbf2_9ce4_8422_2325_u64;
        let mut mix = |bytes: &[u8]| {
            for byte in bytes {
                hash = (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
            }
        };
        self.genomes.iter().for_each(|genome| mix(&genome.to_bytes()));
        self.fitness.iter().for_each(|fitness| mix(&fitness.to_bits().to_be_bytes()));
        hash
    }

    pub(super) fn evaluations(&self) -> u64 {
        self.history.last().map_or(0, |row| row.evaluations)
    }

    /// Evaluates all individuals.
    pub(super) fn evaluate(&mut self, evaluator: &mut dyn Evaluator<G>) -> Result<()> {
        let fitness = evaluator.evaluate(&self.genomes, self.round())?;
        check_fitness(&fitness, self.genomes.len(), self.round())?;
        self.fitness = fitness;
        self.note(self.genomes.len());
        Ok(())
    }

    /// Records the generation after `evaluated` new evaluations: statistics and fittest individual.
    pub(super) fn note(&mut self, evaluated: usize) {
        let evaluations = self.evaluations() + evaluated as u64;
        let row = GenerationStatistics::new(self.generation, evaluations, &self.genomes, &self.fitness);
        self.history.push(row);
        let fittest = self.ranking()[0];
        if self.best.as_ref().is_none_or(|best| self.fitness[fittest] > best.fitness) {
            let genome = self.genomes[fittest].clone();
            self.best = Some(Individual { genome, fitness: self.fitness[fittest] });
        }
    }
}
