use super::evaluator::{Evaluator, check_fitness};
use super::evolution::Evolution;
use super::genome::Genome;
use super::population::Population;
use super::recipe::Recipe;
use crate::io::{Error, Result};
use crate::random::Stream;

/// A steady-state genetic algorithm: a few children at a time replace the least fit individuals, if they are
/// at least as fit (D. Whitley, "The GENITOR algorithm and selection pressure", ICGA 1989).
///
/// One such replacement counts as a generation; the first one evaluates the whole population. The elite of
/// the recipe is ignored, because the fittest always stay.
///
/// ```
/// use roverlab::evolve::{Evolution, Recipe, Serial, SteadyState, StopRules, Trial};
/// let ones = |genome: &Vec<u8>, _: Trial| Ok(genome.iter().map(|gene| f64::from(gene.count_ones())).sum());
/// let mut evolution = SteadyState::new(vec![vec![0_u8; 2]; 20], Recipe::book(1), 2, 1)?;
/// evolution.run(&mut Serial::new(ones), &StopRules::generations(400), |_| Ok(()))?;
/// assert_eq!(evolution.best().expect("an individual").fitness, 16.0, "all 16 bits are set");
/// assert!(evolution.history().windows(2).all(|pair| pair[0].worst <= pair[1].worst), "none gets worse");
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug)]
pub struct SteadyState<G> {
    population: Population<G>,
    recipe: Recipe<G>,
    children: usize,
}

impl<G: Genome> SteadyState<G> {
    /// A run that starts from `genomes` and breeds `children` children at a time.
    ///
    /// # Errors
    ///
    /// If there are no genomes, their lengths differ, the recipe is out of range, or `children` is 0.
    pub fn new(genomes: Vec<G>, recipe: Recipe<G>, children: usize, seed: u64) -> Result<Self> {
        Self::resume(Population::new(genomes, seed)?, recipe, children)
    }

    /// Resumes a run.
    ///
    /// # Errors
    ///
    /// As for [`new`](Self::new).
    pub fn resume(population: Population<G>, recipe: Recipe<G>, children: usize) -> Result<Self> {
        population.validate()?;
        recipe.validate()?;
        if children == 0 {
            return Err(Error::invalid_input("children at a time", children, "at least 1"));
        }
        Ok(Self { population, recipe, children })
    }

    /// Replaces the least fit individual by a child that is at least as fit.
    fn place(&mut self, genome: G, fitness: f64) {
        let Some(&last) = self.population.ranking().last() else { return };
        if fitness >= self.population.fitness[last] {
            self.population.genomes[last] = genome;
            self.population.fitness[last] = fitness;
        }
    }
}

impl<G: Genome> Evolution<G> for SteadyState<G> {
    fn population(&self) -> &Population<G> {
        &self.population
    }

    /// Evaluates the initial population first; afterwards breeds and places children.
    fn step(&mut self, evaluator: &mut dyn Evaluator<G>) -> Result<()> {
        if !self.population.is_evaluated() {
            return self.population.evaluate(evaluator);
        }
        let mut round = self.population.round();
        round.generation += 1;
        let Population { seed, genomes, fitness, .. } = &self.population;
        let mut random = Stream::new(*seed).child("breeding", round.generation);
        let children = self.recipe.breed(genomes, fitness, self.children, &mut random);
        let found = evaluator.evaluate(&children, round)?;
        check_fitness(&found, children.len(), round)?;
        for (genome, fitness) in children.into_iter().zip(found) {
            self.place(genome, fitness);
        }
        self.population.generation = round.generation;
        self.population.note(self.children);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Serial, StopRules, Trial};
    use super::*;

    #[test]
    fn nobody_is_replaced_by_somebody_less_fit() {
        let ones = |genome: &Vec<u8>, _: Trial| Ok(f64::from(genome[0].count_ones()));
        let genomes: Vec<Vec<u8>> = (0..12).map(|gene| vec![gene]).collect();
        let mut evolution = SteadyState::new(genomes, Recipe::book(2), 2, 3).unwrap();
        evolution.run(&mut Serial::new(ones), &StopRules::generations(200), |_| Ok(())).unwrap();
        let history = &evolution.population().history;
        assert!(
            history.windows(2).all(|rows| rows[0].worst <= rows[1].worst && rows[0].best <= rows[1].best)
        );
        assert_eq!(evolution.best().unwrap().fitness, 8.0);
        assert_eq!(history[199].evaluations, 12 + 199 * 2);
    }

    #[test]
    fn no_children_is_an_error() {
        let error = SteadyState::new(vec![vec![1_u8]], Recipe::book(2), 0, 3).unwrap_err();
        assert_eq!(error.to_string(), "children at a time is 0; expected at least 1");
    }
}
