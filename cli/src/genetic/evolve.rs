use roverlab::evolve::{
    Arithmetic, CmaEs, Evolution, Gaussian, Genetic, Population, Recipe, Selection, Serial, SteadyState,
    StopRules, Trial,
};
use roverlab::io::Result;
use roverlab::random::Stream;

use super::Method;

/// Size of the population.
const INDIVIDUALS: usize = 20;

/// Evolves numbers with minimum cost. Genes lie between 0 and 1, whatever they encode.
pub(crate) fn evolve(
    method: Method,
    genes: usize,
    generations: u32,
    seed: u64,
    cost: impl Fn(&[f64], Trial) -> Result<f64>,
) -> Result<Population<Vec<f64>>> {
    let mut evaluator = Serial::new(|genes: &Vec<f64>, trial: Trial| Ok(-cost(&inside(genes), trial)?));
    let mut random = Stream::new(seed);
    let first = (0..INDIVIDUALS).map(|_| (0..genes).map(|_| random.uniform()).collect()).collect();
    let recipe = Recipe {
        selection: Selection::Tournament { size: 3 },
        crossover: Box::new(Arithmetic),
        mutation: Box::new(Gaussian { probability: 0.5, sigma: 0.05, low: 0.0, high: 1.0 }),
        elite: 1,
    };
    let mut evolution: Box<dyn Evolution<Vec<f64>>> = match method {
        Method::Genetic => Box::new(Genetic::new(first, recipe, seed)?),
        Method::SteadyState => Box::new(SteadyState::new(first, recipe, 2, seed)?),
        Method::CmaEs => {
            Box::new(CmaEs::new(vec![0.5; genes], 0.2, CmaEs::usual_individuals(genes).max(8), seed)?)
        }
    };
    while StopRules::generations(generations.into()).verdict(evolution.history()).is_none() {
        evolution.step(&mut evaluator)?;
    }
    Ok(evolution.population().clone())
}

/// Genes clamped to their bounds, which the evolution strategy does not know.
pub(crate) fn inside(genes: &[f64]) -> Vec<f64> {
    genes.iter().map(|gene| gene.clamp(0.0, 1.0)).collect()
}
