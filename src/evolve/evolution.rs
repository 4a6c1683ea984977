use super::evaluator::Evaluator;
use super::genome::Genome;
use super::population::{Individual, Population};
use super::statistics::GenerationStatistics;
use super::stop::{StopReason, StopRules};
use crate::io::Result;

/// A run of evolution, independent of the method.
///
/// # For implementers
///
/// `step` appends one line to the history. After an error it can be called again.
pub trait Evolution<G: Genome> {
    /// The present generation and the history of the run.
    fn population(&self) -> &Population<G>;

    /// Advances by one generation.
    ///
    /// # Errors
    ///
    /// If the evaluation fails.
    fn step(&mut self, evaluator: &mut dyn Evaluator<G>) -> Result<()>;

    /// The fittest individual so far; `None` before the first evaluation.
    fn best(&self) -> Option<&Individual<G>> {
        self.population().best.as_ref()
    }

    /// Statistics of each generation so far.
    fn history(&self) -> &[GenerationStatistics] {
        &self.population().history
    }

    /// Runs until a stop rule applies. `observe` is called after every generation; if it fails, the run ends
    /// with its error and can be resumed.
    ///
    /// # Errors
    ///
    /// If the evaluation or `observe` fails.
    fn run(
        &mut self,
        evaluator: &mut dyn Evaluator<G>,
        rules: &StopRules,
        mut observe: impl FnMut(&Self) -> Result<()>,
    ) -> Result<StopReason>
    where
        Self: Sized,
    {
        loop {
            if self.population().is_evaluated()
                && let Some(reason) = rules.verdict(self.history())
            {
                return Ok(reason);
            }
            self.step(evaluator)?;
            observe(self)?;
        }
    }
}
