use crate::io::{Error, Result};
use crate::random::Stream;

/// Maximum number of individuals in a tournament.
const LARGEST: usize = 10_000;

/// Selection of parents.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Selection {
    /// Roulette wheel (book, section 12.3): the probability is proportional to the fitness. Negative fitness
    /// counts as 0; if no fitness is positive, all are equally likely.
    Wheel,
    /// Tournament: the fittest of `size` individuals drawn at random.
    Tournament {
        /// Tournament size, 1 to 10,000.
        size: usize,
    },
    /// Linear ranking: the fittest is selected `pressure` times as often as the average, the least fit
    /// `2 - pressure` times. Equal fitness shares its ranks.
    Rank {
        /// Selection pressure, from 1 (uniform) to 2.
        pressure: f64,
    },
}

impl Selection {
    /// Checks the parameters.
    ///
    /// # Errors
    ///
    /// If one is out of range.
    pub fn validate(&self) -> Result<()> {
        match *self {
            Selection::Tournament { size } if !(1..=LARGEST).contains(&size) => {
                Err(Error::invalid_input("tournament size", size, &format!("1 to {LARGEST}")))
            }
            Selection::Rank { pressure } if !(1.0..=2.0).contains(&pressure) => {
                Err(Error::invalid_input("rank pressure", pressure, "1 to 2"))
            }
            _ => Ok(()),
        }
    }

    /// Prepares the selection for the given fitness values.
    pub fn among(self, fitness: &[f64]) -> Selector<'_> {
        let cumulative = match self {
            Selection::Wheel => running_sums(fitness.iter().map(|f| f.max(0.0))),
            Selection::Tournament { .. } => Vec::new(),
            Selection::Rank { pressure } => running_sums(rank_weights(fitness, pressure).into_iter()),
        };
        Selector { selection: self, fitness, cumulative }
    }
}

/// Selects parents of one generation.
#[derive(Debug, Clone)]
pub struct Selector<'a> {
    selection: Selection,
    fitness: &'a [f64],
    /// Running sums of the weights.
    cumulative: Vec<f64>,
}

impl Selector<'_> {
    /// Draws the index of a parent; 0 if there are no individuals.
    pub fn select(&self, random: &mut Stream) -> usize {
        if self.fitness.is_empty() {
            return 0;
        }
        match self.selection {
            Selection::Tournament { size } => self.tournament(size, random),
            Selection::Wheel | Selection::Rank { .. } => self.spin(random),
        }
    }

    fn tournament(&self, size: usize, random: &mut Stream) -> usize {
        let mut best = random.below(self.fitness.len());
        for _ in 1..size.min(LARGEST) {
            let rival = random.below(self.fitness.len());
            if self.fitness[rival] > self.fitness[best] {
                best = rival;
            }
        }
        best
    }

    fn spin(&self, random: &mut Stream) -> usize {
        let total = self.cumulative.last().copied().unwrap_or(0.0);
        if !(total > 0.0 && total.is_finite()) {
            return random.below(self.fitness.len());
        }
        let stop = total * random.uniform();
        self.cumulative.partition_point(|sum| *sum <= stop).min(self.fitness.len() - 1)
    }
}

fn running_sums(weights: impl Iterator<Item = f64>) -> Vec<f64> {
    weights
        .scan(0.0, |sum, weight| {
            *sum += weight;
            Some(*sum)
        })
        .collect()
}

/// Weight of each individual by its rank.
fn rank_weights(fitness: &[f64], pressure: f64) -> Vec<f64> {
    let mut order: Vec<usize> = (0..fitness.len()).collect();
    order.sort_by(|&a, &b| fitness[a].total_cmp(&fitness[b]));
    let last = (fitness.len().max(2) - 1) as f64;
    let mut weights = vec![0.0; fitness.len()];
    let mut begin = 0;
    for equals in order.chunk_by(|&a, &b| fitness[a] == fitness[b]) {
        let rank = begin as f64 + 0.5 * (equals.len() - 1) as f64;
        for &individual in equals {
            weights[individual] = (2.0 - pressure) + 2.0 * (pressure - 1.0) * rank / last;
        }
        begin += equals.len();
    }
    weights
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative frequency of each individual in many draws.
    fn shares(selection: Selection, fitness: &[f64]) -> Vec<f64> {
        let selector = selection.among(fitness);
        let mut random = Stream::new(5);
        let mut counts = vec![0.0; fitness.len()];
        for _ in 0..40_000 {
            counts[selector.select(&mut random)] += 1.0 / 40_000.0;
        }
        counts
    }

    fn near(found: &[f64], expected: &[f64]) -> bool {
        found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 0.01)
    }

    #[test]
    fn the_wheel_is_proportional_to_fitness() {
        assert!(near(&shares(Selection::Wheel, &[1.0, 2.0, 5.0]), &[0.125, 0.25, 0.625]));
    }

    #[test]
    fn fitness_of_zero_or_less_is_never_chosen_while_any_is_above() {
        assert!(near(&shares(Selection::Wheel, &[-3.0, 2.0, 0.0]), &[0.0, 1.0, 0.0]));
    }

    #[test]
    fn without_fitness_or_with_equal_fitness_all_are_alike() {
        let third = [1.0 / 3.0; 3];
        for fitness in [[0.0; 3], [-1.0; 3], [7.0; 3]] {
            for selection in
                [Selection::Wheel, Selection::Rank { pressure: 1.8 }, Selection::Tournament { size: 3 }]
            {
                assert!(near(&shares(selection, &fitness), &third), "{selection:?} {fitness:?}");
            }
        }
    }

    #[test]
    fn ranks_count_and_not_how_far_apart_they_are() {
        let expected = [0.2 / 3.0, 1.0 / 3.0, 1.8 / 3.0];
        assert!(near(&shares(Selection::Rank { pressure: 1.8 }, &[-1e9, 3.0, 4.0]), &expected));
    }

    #[test]
    fn the_fittest_wins_every_tournament_that_it_is_in() {
        // Probabilities that the better of two draws is the lowest, the middle, the highest.
        let expected = [1.0 / 9.0, 3.0 / 9.0, 5.0 / 9.0];
        assert!(near(&shares(Selection::Tournament { size: 2 }, &[1.0, 2.0, 9.0]), &expected));
    }

    #[test]
    fn among_nobody_nobody_is_selected() {
        for selection in
            [Selection::Tournament { size: 2 }, Selection::Wheel, Selection::Rank { pressure: 1.5 }]
        {
            assert_eq!(selection.among(&[]).select(&mut Stream::new(1)), 0);
        }
    }

    #[test]
    fn settings_out_of_range_are_named() {
        let text = |selection: Selection| selection.validate().unwrap_err().to_string();
        assert_eq!(text(Selection::Tournament { size: 0 }), "tournament size is 0; expected 1 to 10000");
        assert_eq!(text(Selection::Rank { pressure: f64::NAN }), "rank pressure is NaN; expected 1 to 2");
    }
}
