use crate::ParameterError;
use crate::parameter::debug_as_sentence;

/// Weights that cannot be read or written.
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WeightsError {
    /// The file is none of the format, or something is missing.
    #[error("weights: {0}")]
    File(String),
    /// The weights do not belong together.
    #[error("weights: {0}")]
    Parameter(#[from] ParameterError),
}

debug_as_sentence!(WeightsError);

impl WeightsError {
    /// The error of the format's reader.
    #[allow(clippy::needless_pass_by_value, reason = "it maps errors")]
    pub(super) fn of(error: safetensors::SafeTensorError) -> Self {
        Self::File(error.to_string())
    }
}
