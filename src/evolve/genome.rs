use std::fmt::Debug;

/// A number that genomes are made of.
pub trait Gene: Copy + PartialEq + Debug + Send + Sync + Into<f64> + 'static {
    /// Its bytes, most significant first, for hashes and for other processes.
    fn write(self, bytes: &mut Vec<u8>);

    /// The gene at the front of `bytes`, and the rest.
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

/// What evolves: a string of genes, all of one length in a population.
///
/// Byte strings and real vectors are genomes; a type of one's own is one as soon as it can show its genes.
pub trait Genome: Clone + Debug + Send + Sync + 'static {
    /// One number of it.
    type Gene: Gene;

    /// A genome of these genes; `None` if there cannot be one.
    fn from_genes(genes: Vec<Self::Gene>) -> Option<Self>;

    /// The genes.
    fn genes(&self) -> &[Self::Gene];

    /// The genes, to change them.
    fn genes_mut(&mut self) -> &mut [Self::Gene];

    /// All genes as bytes.
    fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.genes().iter().for_each(|gene| gene.write(&mut bytes));
        bytes
    }

    /// The genome that [`to_bytes`](Self::to_bytes) made these bytes of; `None` for any other bytes.
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
