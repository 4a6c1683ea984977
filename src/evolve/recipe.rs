use super::crossover::{Crossover, OnePoint};
use super::genome::Genome;
use super::mutation::{BitFlip, Mutation};
use super::selection::Selection;
use crate::io::Result;
use crate::random::Stream;

/// Recipe for the next individuals.
#[derive(Debug)]
pub struct Recipe<G> {
    /// Selection of parents.
    pub selection: Selection,
    /// Recombination of two parents.
    pub crossover: Box<dyn Crossover<G>>,
    /// Mutation of the children.
    pub mutation: Box<dyn Mutation<G>>,
    /// Number of the fittest individuals that enter the next generation unchanged.
    pub elite: usize,
}

impl<G: Genome<Gene = u8>> Recipe<G> {
    /// The book's recipe: roulette wheel, one-point crossover, `mutations` flipped bits per generation, elite
    /// of one.
    pub fn book(mutations: usize) -> Self {
        Self {
            selection: Selection::Wheel,
            crossover: Box::new(OnePoint),
            mutation: Box::new(BitFlip { count: mutations }),
            elite: 1,
        }
    }
}

impl<G: Genome> Recipe<G> {
    pub(super) fn validate(&self) -> Result<()> {
        self.selection.validate()
    }

    /// Breeds `count` mutated children.
    pub(super) fn breed(&self, parents: &[G], fitness: &[f64], count: usize, random: &mut Stream) -> Vec<G> {
        let selector = self.selection.among(fitness);
        let mut children = Vec::with_capacity(count + 1);
        while children.len() < count {
            let mut a = parents[selector.select(random)].clone();
            let mut b = parents[selector.select(random)].clone();
            self.crossover.cross(&mut a, &mut b, random);
            children.extend([a, b]);
        }
        children.truncate(count);
        self.mutation.mutate(&mut children, random);
        children
    }
}
