use std::fmt::Debug;

/// A number in a genome.
///
/// # For implementers
///
/// `read` must invert `write` to the bit: checkpoints and other processes rely on it.
pub trait Gene: Copy + PartialEq + Debug + Send + Sync + Into<f64> + 'static {
    /// Appends its bytes, most significant first, for hashes and other processes.
    fn write(self, bytes: &mut Vec<u8>);

    /// Reads the gene at the front of `bytes` and returns it with the rest.
    fn read(bytes: &[u8]) -> Option<(Self, &[u8])>;
}

impl Gene for u8 {
    fn write(self, bytes: &mut Vec<u8>) {
        bytes.push(self);
    }

    fn read(bytes: &[u8]) -> Option<(Self, &[u8])> {
        bytes.split_first().map(|(gene, rest)| (*gene, rest))
    }
}

impl Gene for f64 {
    fn write(self, bytes: &mut Vec<u8>) {
        bytes.extend(self.to_bits().to_be_bytes());
    }

    fn read(bytes: &[u8]) -> Option<(Self, &[u8])> {
        let (gene, rest) = bytes.split_first_chunk()?;
        Some((f64::from_bits(u64::from_be_bytes(*gene)), rest))
    }
}

/// A string of genes; all genomes of a population have the same length.
///
/// Byte strings and real vectors are genomes. Implement the trait for other types that consist of genes.
///
/// # For implementers
///
/// `from_genes` must accept whatever `genes` returns.
pub trait Genome: Clone + Debug + Send + Sync + 'static {
    /// Type of one gene.
    type Gene: Gene;

    /// A genome of these genes; `None` if they are invalid.
    fn from_genes(genes: Vec<Self::Gene>) -> Option<Self>;

    /// Its genes.
    fn genes(&self) -> &[Self::Gene];

    /// Its genes, mutable.
    fn genes_mut(&mut self) -> &mut [Self::Gene];

    /// All genes as bytes.
    fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.genes().iter().for_each(|gene| gene.write(&mut bytes));
        bytes
    }

    /// Inverse of [`to_bytes`](Self::to_bytes); `None` if the bytes are invalid.
    fn from_bytes(mut bytes: &[u8]) -> Option<Self> {
        let mut genes = Vec::new();
        while !bytes.is_empty() {
            let (gene, rest) = Self::Gene::read(bytes)?;
            genes.push(gene);
            bytes = rest;
        }
        Self::from_genes(genes)
    }
}

impl<G: Gene> Genome for Vec<G> {
    type Gene = G;

    fn from_genes(genes: Vec<G>) -> Option<Self> {
        Some(genes)
    }

    fn genes(&self) -> &[G] {
        self
    }

    fn genes_mut(&mut self) -> &mut [G] {
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn bytes_give_the_genome_back(bytes: Vec<u8>, numbers in prop::collection::vec(-1e9..1e9f64, 0..9)) {
            prop_assert_eq!(Vec::<u8>::from_bytes(&bytes.to_bytes()), Some(bytes));
            prop_assert_eq!(Vec::<f64>::from_bytes(&numbers.to_bytes()), Some(numbers));
        }
    }

    #[test]
    fn half_a_number_is_no_genome() {
        assert_eq!(Vec::<f64>::from_bytes(&[0; 12]), None);
    }
}
