use std::fmt::Debug;

use super::genome::Genome;
use crate::random::Stream;

/// Changes the children of a generation at random.
///
/// # For implementers
///
/// Draw from `random` alone, and keep genes within their bounds and genomes at their length.
pub trait Mutation<G>: Debug + Send + Sync {
    /// Changes some of the children.
    fn mutate(&self, children: &mut [G], random: &mut Stream);
}

/// Flips single bits, each in a random gene of a random child (book, section 12.3).
///
/// ```
/// use roverlab::evolve::{BitFlip, Mutation};
/// use roverlab::random::Stream;
/// let mut children = vec![vec![0_u8; 4]; 10];
/// BitFlip { count: 1 }.mutate(&mut children, &mut Stream::new(1));
/// assert_eq!(children.iter().flatten().map(|gene| gene.count_ones()).sum::<u32>(), 1);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct BitFlip {
    /// Number of bits flipped per generation, over all children.
    pub count: usize,
}

impl<G: Genome<Gene = u8>> Mutation<G> for BitFlip {
    fn mutate(&self, children: &mut [G], random: &mut Stream) {
        for _ in 0..self.count {
            let child = random.below(children.len());
            let Some(child) = children.get_mut(child) else { return };
            let position = random.below(child.genes().len());
            let bit = random.below(8);
            if let Some(gene) = child.genes_mut().get_mut(position) {
                *gene ^= 1 << bit;
            }
        }
    }
}

/// Adds normal noise to the genes of real vectors and keeps them within bounds.
#[derive(Debug, Clone, Copy)]
pub struct Gaussian {
    /// Probability that a gene changes.
    pub probability: f64,
    /// Standard deviation of a change.
    pub sigma: f64,
    /// Minimum value of a gene.
    pub low: f64,
    /// Maximum value of a gene.
    pub high: f64,
}

impl<G: Genome<Gene = f64>> Mutation<G> for Gaussian {
    fn mutate(&self, children: &mut [G], random: &mut Stream) {
        for gene in children.iter_mut().flat_map(G::genes_mut) {
            if random.chance(self.probability) {
                // Not `clamp`, which panics if the bounds are swapped.
                *gene = (*gene + self.sigma * random.normal()).max(self.low).min(self.high);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flip_changes_one_bit_of_all() {
        for seed in 0..50 {
            let mut children = vec![vec![0b1010_1010_u8; 7]; 4];
            BitFlip { count: 1 }.mutate(&mut children, &mut Stream::new(seed));
            let flipped: u32 = children.iter().flatten().map(|gene| (gene ^ 0b1010_1010).count_ones()).sum();
            assert_eq!(flipped, 1);
        }
    }

    #[test]
    fn nobody_and_empty_genomes_stay_as_they_are() {
        let mut random = Stream::new(1);
        BitFlip { count: 9 }.mutate(&mut Vec::<Vec<u8>>::new(), &mut random);
        let mut empty = vec![Vec::<u8>::new()];
        BitFlip { count: 9 }.mutate(&mut empty, &mut random);
        assert_eq!(empty, [Vec::<u8>::new()]);
    }

    #[test]
    fn noise_has_its_deviation_and_stays_within_bounds() {
        let mut children = vec![vec![0.0; 20_000]];
        let noise = Gaussian { probability: 0.5, sigma: 0.2, low: -0.5, high: 0.5 };
        noise.mutate(&mut children, &mut Stream::new(1));
        let genes = &children[0];
        let changed = genes.iter().filter(|gene| **gene != 0.0).count() as f64 / 20_000.0;
        let variance = genes.iter().map(|gene| gene * gene).sum::<f64>() / 20_000.0;
        assert!(
            (changed - 0.5).abs() < 0.02 && (variance - 0.5 * 0.04).abs() < 0.002,
            "{changed} {variance}"
        );
        assert!(genes.iter().all(|gene| gene.abs() <= 0.5));
    }
}
