use super::values::Values;
use crate::io::Result;

/// What a recording answers to a call of a robot's.
pub(super) trait Answers {
    /// `take` makes the answer of the recorded result and of the bulk before it.
    fn answer<T>(
        &mut self,
        method: &str,
        arguments: &Values,
        take: impl FnOnce(&Values, &[u8]) -> Option<T>,
    ) -> Result<T>;
}
