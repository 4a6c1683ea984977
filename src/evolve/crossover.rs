use std::fmt::Debug;

use super::genome::Genome;
use crate::random::Stream;

/// Recombines two parents into two children.
///
/// # For implementers
///
/// Draw from `random` alone, and keep genomes at their length.
pub trait Crossover<G>: Debug + Send + Sync {
    /// Turns copies of two parents of equal length into children, in place.
    fn cross(&self, a: &mut G, b: &mut G, random: &mut Stream);
}

/// One-point crossover: swaps all genes behind a random cut (book, section 12.3). The cut is never at an end,
/// so each child has genes of both parents. Genomes with a single gene stay as they are.
///
/// ```
/// use roverlab::evolve::{Crossover, OnePoint};
/// use roverlab::random::Stream;
/// let (mut a, mut b) = (vec![0_u8; 6], vec![1_u8; 6]);
/// OnePoint.cross(&mut a, &mut b, &mut Stream::new(1));
/// assert_eq!((a[0], a[5], b[0], b[5]), (0, 1, 1, 0));
/// assert_eq!(a.windows(2).filter(|pair| pair[0] != pair[1]).count(), 1, "one cut");
/// ```
#[derive(Debug, Clone, Copy, Default)]
pub struct OnePoint;

impl<G: Genome> Crossover<G> for OnePoint {
    fn cross(&self, a: &mut G, b: &mut G, random: &mut Stream) {
        let length = a.genes().len();
        if length > 1 {
            let cut = 1 + random.below(length - 1);
            a.genes_mut()[cut..].swap_with_slice(&mut b.genes_mut()[cut..]);
        }
    }
}

/// Uniform crossover: swaps each gene with a probability.
///
/// ```
/// use roverlab::evolve::{Crossover, Uniform};
/// use roverlab::random::Stream;
/// let (mut a, mut b) = (vec![0_u8; 1000], vec![1_u8; 1000]);
/// Uniform { probability: 0.3 }.cross(&mut a, &mut b, &mut Stream::new(1));
/// let swapped = a.iter().filter(|&&gene| gene == 1).count();
/// assert!((250..350).contains(&swapped), "about 300 of 1000 genes");
/// assert!(a.iter().zip(&b).all(|(a, b)| a + b == 1), "no gene is lost");
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Uniform {
    /// Probability, 0 to 1; 0.5 mixes most.
    pub probability: f64,
}

impl<G: Genome> Crossover<G> for Uniform {
    fn cross(&self, a: &mut G, b: &mut G, random: &mut Stream) {
        for (a, b) in a.genes_mut().iter_mut().zip(b.genes_mut()) {
            if random.chance(self.probability) {
                std::mem::swap(a, b);
            }
        }
    }
}

/// Arithmetic crossover of real vectors: each child lies at a random point between its parents, and the two
/// are symmetric about the midpoint.
#[derive(Debug, Clone, Copy, Default)]
pub struct Arithmetic;

impl<G: Genome<Gene = f64>> Crossover<G> for Arithmetic {
    fn cross(&self, a: &mut G, b: &mut G, random: &mut Stream) {
        let part = random.uniform();
        for (a, b) in a.genes_mut().iter_mut().zip(b.genes_mut()) {
            (*a, *b) = (*a + part * (*b - *a), *b + part * (*a - *b));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn children(crossover: &dyn Crossover<Vec<u8>>, length: usize, seed: u64) -> (Vec<u8>, Vec<u8>) {
        let (mut a, mut b) = (vec![0; length], vec![1; length]);
        crossover.cross(&mut a, &mut b, &mut Stream::new(seed));
        (a, b)
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn every_gene_goes_to_one_of_the_children(length in 0..40_usize, seed: u64) {
            for crossover in [&OnePoint as &dyn Crossover<_>, &Uniform { probability: 0.5 }] {
                let (a, b) = children(crossover, length, seed);
                prop_assert!(a.iter().zip(&b).all(|(a, b)| a + b == 1));
            }
        }

        #[test]
        fn one_point_makes_one_change_of_parent(length in 2..40_usize, seed: u64) {
            let (a, _) = children(&OnePoint, length, seed);
            prop_assert_eq!(a.windows(2).filter(|pair| pair[0] != pair[1]).count(), 1);
        }

        #[test]
        fn mixed_children_lie_between_their_parents_and_keep_their_sum(x in -5.0..5.0f64, y in -5.0..5.0f64, seed: u64) {
            let (mut a, mut b) = (vec![x], vec![y]);
            Arithmetic.cross(&mut a, &mut b, &mut Stream::new(seed));
            prop_assert!((a[0] + b[0] - x - y).abs() < 1e-12);
            prop_assert!(a[0] >= x.min(y) - 1e-12 && a[0] <= x.max(y) + 1e-12);
        }
    }

    #[test]
    fn every_cut_occurs() {
        let cuts: std::collections::BTreeSet<usize> = (0..200)
            .map(|seed| children(&OnePoint, 5, seed).0.iter().take_while(|gene| **gene == 0).count())
            .collect();
        assert_eq!(cuts.into_iter().collect::<Vec<_>>(), [1, 2, 3, 4]);
    }
}
