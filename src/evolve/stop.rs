use super::statistics::GenerationStatistics;

/// When to stop. A run has at least one generation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StopRules {
    /// Maximum number of generations, the first included.
    pub generations: u64,
    /// Fitness that ends the run.
    pub goal: Option<f64>,
    /// Number of generations without improvement that ends the run.
    pub stagnation: Option<u64>,
}

/// Why a run stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StopReason {
    /// The maximum number of generations was reached.
    Generations,
    /// The goal was reached.
    Goal,
    /// The best fitness stagnated.
    Stagnation,
}

impl StopRules {
    /// Stops only after a number of generations.
    pub fn generations(generations: u64) -> Self {
        Self { generations, goal: None, stagnation: None }
    }

    /// The rule that stops a run with this history, if any.
    pub fn verdict(&self, history: &[GenerationStatistics]) -> Option<StopReason> {
        let last = history.last()?;
        if self.goal.is_some_and(|goal| history.iter().any(|row| row.best >= goal)) {
            return Some(StopReason::Goal);
        }
        if last.generation + 1 >= self.generations {
            return Some(StopReason::Generations);
        }
        let (mut record, mut since) = (f64::NEG_INFINITY, 0);
        for row in history {
            if row.best > record {
                (record, since) = (row.best, row.generation);
            }
        }
        self.stagnation
            .is_some_and(|patience| last.generation - since >= patience)
            .then_some(StopReason::Stagnation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn history(best: &[f64]) -> Vec<GenerationStatistics> {
        best.iter()
            .zip(0..)
            .map(|(&best, generation)| GenerationStatistics {
                generation,
                evaluations: 0,
                best,
                mean: 0.0,
                worst: 0.0,
                diversity: 0.0,
            })
            .collect()
    }

    #[test]
    fn each_rule_stops_when_it_says() {
        let rules = StopRules { generations: 10, goal: Some(5.0), stagnation: Some(3) };
        assert_eq!(rules.verdict(&[]), None);
        assert_eq!(rules.verdict(&history(&[1.0, 2.0, 1.0, 2.0])), None);
        assert_eq!(rules.verdict(&history(&[1.0, 2.0, 1.0, 2.0, 0.0])), Some(StopReason::Stagnation));
        assert_eq!(rules.verdict(&history(&[1.0, 5.0])), Some(StopReason::Goal));
        let growing: Vec<f64> = (0..10).map(|i| 0.1 * f64::from(i)).collect();
        assert_eq!(rules.verdict(&history(&growing)), Some(StopReason::Generations));
        assert_eq!(rules.verdict(&history(&growing[..9])), None);
    }
}
