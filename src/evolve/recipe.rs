use super::crossover::{Crossover, OnePoint};
use super::genome::Genome;
use super::mutation::{BitFlip, Mutation};
use super::selection::Selection;
use crate::io::Result;
use crate::random::Stream;

/// How the next individuals come from the present ones.
#[derive(Debug)]
pub struct Recipe<G> {
    /// How parents are chosen.
    pub selection: Selection,
    /// How two parents become two children.
    pub crossover: Box<dyn Crossover<G>>,
    /// How children are changed.
    pub mutation: Box<dyn Mutation<G>>,
    /// Individuals that enter the next generation unchanged, the fittest first.
    pub elite: usize,
}

impl<G: Genome<Gene = u8>> Recipe<G> {
    /// The book's: wheel of fitness, one cut, so many flipped bits in a generation, the best one kept.
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

    /// So many mutated children of parents chosen by fitness.
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
