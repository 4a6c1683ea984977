use super::evaluator::Evaluator;
use super::evolution::Evolution;
use super::genome::Genome;
use super::population::Population;
use super::recipe::Recipe;
use crate::io::Result;
use crate::random::Stream;

/// A genetic algorithm (book, section 12.3): each generation is bred from the one before, and the fittest
/// individuals are kept unchanged.
#[derive(Debug)]
pub struct Genetic<G> {
    population: Population<G>,
    recipe: Recipe<G>,
}

impl<G: Genome> Genetic<G> {
    /// A run that starts from `genomes`.
    ///
    /// # Errors
    ///
    /// If there are no genomes, their lengths differ, or the recipe is out of range.
    pub fn new(genomes: Vec<G>, recipe: Recipe<G>, seed: u64) -> Result<Self> {
        Self::resume(Population::new(genomes, seed)?, recipe)
    }

    /// Resumes a run, with the same result as without the interruption.
    ///
    /// # Errors
    ///
    /// As for [`new`](Self::new).
    pub fn resume(population: Population<G>, recipe: Recipe<G>) -> Result<Self> {
        population.validate()?;
        recipe.validate()?;
        Ok(Self { population, recipe })
    }

    fn breed(&mut self) {
        let Population { seed, generation, genomes, fitness, .. } = &self.population;
        let next = generation + 1;
        let mut random = Stream::new(*seed).child("breeding", next);
        let ranking = self.population.ranking();
        let mut offspring: Vec<G> =
            ranking.iter().take(self.recipe.elite).map(|&place| genomes[place].clone()).collect();
        let missing = genomes.len() - offspring.len();
        offspring.extend(self.recipe.breed(genomes, fitness, missing, &mut random));
        self.population.genomes = offspring;
        self.population.fitness.clear();
        self.population.generation = next;
    }
}

impl<G: Genome> Evolution<G> for Genetic<G> {
    fn population(&self) -> &Population<G> {
        &self.population
    }

    /// Breeds the next generation, unless the present one is not yet evaluated, and evaluates it.
    fn step(&mut self, evaluator: &mut dyn Evaluator<G>) -> Result<()> {
        if self.population.is_evaluated() {
            self.breed();
        }
        self.population.evaluate(evaluator)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Arithmetic, Gaussian, Selection, Serial, StopReason, StopRules, Trial};
    use super::*;
    use proptest::prelude::*;

    /// Number of set bits.
    #[allow(clippy::unnecessary_wraps, clippy::ptr_arg, reason = "signature of a fitness function")]
    fn ones(genome: &Vec<u8>, _: Trial) -> Result<f64> {
        Ok(genome.iter().map(|gene| gene.count_ones()).sum::<u32>().into())
    }

    fn zeros(population: usize, seed: u64) -> Genetic<Vec<u8>> {
        Genetic::new(vec![vec![0; 8]; population], Recipe::book(6), seed).unwrap()
    }

    fn run(evolution: &mut Genetic<Vec<u8>>, generations: u64) {
        evolution.run(&mut Serial::new(ones), &StopRules::generations(generations), |_| Ok(())).unwrap();
    }

    #[test]
    fn bits_are_all_set_in_the_end() {
        let mut evolution = zeros(21, 1);
        let rules = StopRules { goal: Some(64.0), ..StopRules::generations(3000) };
        let reason = evolution.run(&mut Serial::new(ones), &rules, |_| Ok(())).unwrap();
        assert_eq!((reason, evolution.best().unwrap().fitness), (StopReason::Goal, 64.0));
    }

    proptest! {
        #![proptest_config(crate::testing::cases(24))]

        #[test]
        fn the_best_never_gets_worse_and_the_size_stays(population in 1..20_usize, seed: u64) {
            let mut evolution = zeros(population, seed);
            run(&mut evolution, 30);
            prop_assert!(evolution.history().windows(2).all(|rows| rows[0].best <= rows[1].best));
            prop_assert_eq!(evolution.population().genomes.len(), population);
            prop_assert_eq!(evolution.history().len(), 30);
            prop_assert_eq!(evolution.history()[29].evaluations, 30 * population as u64);
        }

        #[test]
        fn a_run_in_two_parts_is_the_run(seed: u64, first in 1..20_u64) {
            let mut whole = zeros(9, seed);
            run(&mut whole, 20);
            let mut part = zeros(9, seed);
            run(&mut part, first);
            let mut resumed = Genetic::resume(part.population().clone(), Recipe::book(6)).unwrap();
            run(&mut resumed, 20);
            prop_assert_eq!(whole.population(), resumed.population());
            prop_assert_eq!(whole.population().hash(), resumed.population().hash());
        }
    }

    #[test]
    fn seeds_give_different_runs() {
        let (mut one, mut two) = (zeros(9, 1), zeros(9, 2));
        run(&mut one, 5);
        run(&mut two, 5);
        assert_ne!(one.population().hash(), two.population().hash());
    }

    #[test]
    fn real_vectors_find_a_maximum() {
        let mut random = Stream::new(2);
        let genomes = (0..30).map(|_| (0..3).map(|_| random.between(-5.0, 5.0)).collect()).collect();
        let recipe = Recipe {
            selection: Selection::Rank { pressure: 1.8 },
            crossover: Box::new(Arithmetic),
            mutation: Box::new(Gaussian { probability: 0.3, sigma: 0.3, low: -5.0, high: 5.0 }),
            elite: 2,
        };
        let mut evolution: Genetic<Vec<f64>> = Genetic::new(genomes, recipe, 1).unwrap();
        let bowl = |x: &Vec<f64>, _: Trial| Ok(-x.iter().map(|x| (x - 1.0) * (x - 1.0)).sum::<f64>());
        evolution.run(&mut Serial::new(bowl), &StopRules::generations(150), |_| Ok(())).unwrap();
        assert!(evolution.best().unwrap().fitness > -0.02, "{:?}", evolution.best());
    }

    #[test]
    fn what_cannot_be_evolved_is_named() {
        let text = |genomes: Vec<Vec<u8>>| Genetic::new(genomes, Recipe::book(1), 1).unwrap_err().to_string();
        assert_eq!(text(vec![]), "population is empty; expected at least one individual");
        let unequal = text(vec![vec![1, 2], vec![1, 2], vec![3]]);
        assert_eq!(unequal, "length of genome 2 is 1; expected 2 genes, as the first has");
    }

    #[test]
    fn a_fitness_that_is_no_number_ends_the_run_and_names_its_place() {
        let mut evolution = zeros(4, 1);
        let mut broken = Serial::new(|_: &Vec<u8>, trial: Trial| {
            Ok(if trial.round.generation == 2 && trial.index == 3 { f64::NAN } else { 1.0 })
        });
        let error = evolution.run(&mut broken, &StopRules::generations(9), |_| Ok(())).unwrap_err();
        let expected = "fitness of individual 3 in generation 2 is NaN; expected a finite number";
        assert_eq!(error.to_string(), expected);
        // The earlier generations are kept.
        assert_eq!(evolution.history().len(), 2);
    }

    #[test]
    fn an_evaluator_that_forgets_somebody_is_found_out() {
        struct Forgetful;
        impl Evaluator<Vec<u8>> for Forgetful {
            fn evaluate(&mut self, _: &[Vec<u8>], _: super::super::Round) -> Result<Vec<f64>> {
                Ok(vec![1.0])
            }
        }
        let error = zeros(4, 1).step(&mut Forgetful).unwrap_err();
        assert_eq!(error.to_string(), "fitness of the population is 1 values; expected 4 values");
    }

    #[test]
    fn zero_negative_and_equal_fitness_evolve_on() {
        for value in [0.0, -3.0, 5.0] {
            let mut evolution = zeros(7, 1);
            let mut flat = Serial::new(|_: &Vec<u8>, _: Trial| Ok(value));
            evolution.run(&mut flat, &StopRules::generations(50), |_| Ok(())).unwrap();
            assert!(evolution.history()[49].diversity > 0.0);
        }
    }

    #[test]
    fn more_elite_than_individuals_keeps_them_all() {
        let recipe = Recipe { elite: 99, ..Recipe::book(5) };
        let mut evolution = Genetic::new(vec![vec![1_u8], vec![2], vec![3]], recipe, 1).unwrap();
        run(&mut evolution, 4);
        let mut genes: Vec<u8> = evolution.population().genomes.concat();
        genes.sort_unstable();
        assert_eq!(genes, [1, 2, 3]);
    }
}
