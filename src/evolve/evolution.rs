use super::evaluator::Evaluator;
use super::genome::Genome;
use super::population::{Individual, Population};
use super::statistics::GenerationStatistics;
use super::stop::{StopReason, StopRules};
use crate::io::Result;

/// A run of evolution, whatever the method.
pub trait Evolution<G: Genome> {
    /// The present generation, and all that was before.
    fn population(&self) -> &Population<G>;

    /// Goes on by a generation.
    fn step(&mut self, evaluator: &mut dyn Evaluator<G>) -> Result<()>;

    /// The fittest individual so far; `None` before the first evaluation.
    fn best(&self) -> Option<&Individual<G>> {
        self.population().best.as_ref()
    }

    /// A row for each generation so far.
    fn history(&self) -> &[GenerationStatistics] {
        &self.population().history
    }

    /// Goes on until a rule says stop. `observe` is called after every generation, with the run as it is then; when it
    /// fails, the run ends with its error and can be gone on with.
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
