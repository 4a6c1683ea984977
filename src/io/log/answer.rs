use super::values::Values;
use crate::io::Result;

/// A recording that answers a robot's calls.
pub(super) trait Answers {
    /// `take` builds the answer from the recorded result and its bulk data.
    fn answer<T>(
        &mut self,
        method: &str,
        arguments: &Values,
        take: impl FnOnce(&Values, &[u8]) -> Option<T>,
    ) -> Result<T>;
}
