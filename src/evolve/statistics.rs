use super::genome::Genome;

/// Statistics of a generation.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "checkpoint", derive(serde::Serialize, serde::Deserialize))]
pub struct GenerationStatistics {
    /// Index of the generation, from 0.
    pub generation: u64,
    /// Number of evaluations since the start, this generation included.
    pub evaluations: u64,
    /// Maximum fitness.
    pub best: f64,
    /// Mean fitness.
    pub mean: f64,
    /// Minimum fitness.
    pub worst: f64,
    /// Diversity of the genomes: standard deviation of a gene over the individuals, averaged over the genes.
    pub diversity: f64,
}

impl GenerationStatistics {
    pub(super) fn new<G: Genome>(generation: u64, evaluations: u64, genomes: &[G], fitness: &[f64]) -> Self {
        Self {
            generation,
            evaluations,
            best: fitness.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            mean: fitness.iter().sum::<f64>() / fitness.len() as f64,
            worst: fitness.iter().copied().fold(f64::INFINITY, f64::min),
            diversity: diversity(genomes),
        }
    }
}

/// The generations as comma-separated values with a header line.
///
/// ```
/// use roverlab::evolve::{Evolution, Genetic, Recipe, Serial, StopRules, Trial, table};
/// let fitness = |genome: &Vec<u8>, _: Trial| Ok(f64::from(genome[0]));
/// let mut evolution = Genetic::new(vec![vec![3_u8], vec![5], vec![7]], Recipe::book(0), 1)?;
/// evolution.run(&mut Serial::new(fitness), &StopRules::generations(1), |_| Ok(()))?;
/// let text = table(evolution.history());
/// assert!(text.starts_with("generation,evaluations,best,mean,worst,diversity\n0,3,7,5,3,1.63"));
/// # Ok::<(), roverlab::io::Error>(())
/// ```
pub fn table(history: &[GenerationStatistics]) -> String {
    let head = "generation,evaluations,best,mean,worst,diversity\n".to_owned();
    history.iter().fold(head, |text, row| {
        let GenerationStatistics { generation, evaluations, best, mean, worst, diversity } = row;
        text + &format!("{generation},{evaluations},{best},{mean},{worst},{diversity}\n")
    })
}

fn diversity<G: Genome>(genomes: &[G]) -> f64 {
    let length = genomes.first().map_or(0, |genome| genome.genes().len());
    let deviation = |position: usize| {
        let values = || genomes.iter().map(|genome| genome.genes()[position].into());
        let count = genomes.len() as f64;
        let mean: f64 = values().sum::<f64>() / count;
        (values().map(|value: f64| (value - mean) * (value - mean)).sum::<f64>() / count).sqrt()
    };
    (0..length).map(deviation).sum::<f64>() / length.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_generation_in_numbers() {
        let genomes = [vec![1_u8, 10], vec![3, 10], vec![1, 10], vec![3, 10]];
        let row = GenerationStatistics::new(4, 20, &genomes, &[2.0, -1.0, 5.0, 0.0]);
        assert_eq!((row.best, row.mean, row.worst, row.diversity), (5.0, 1.5, -1.0, 0.5));
        let expected = "generation,evaluations,best,mean,worst,diversity\n4,20,5,1.5,-1,0.5\n";
        assert_eq!(table(&[row]), expected);
    }
}
