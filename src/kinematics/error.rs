/// Why a drive's geometry makes no sense.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{parameter} is {value}; expected {expected}")]
pub struct GeometryError {
    parameter: &'static str,
    value: f64,
    expected: &'static str,
}

/// Fails unless a parameter is a finite number above zero.
pub(super) fn positive(parameter: &'static str, value: f64) -> Result<(), GeometryError> {
    require(parameter, value, value.is_finite() && value > 0.0, "a positive, finite number")
}

pub(super) fn require(
    parameter: &'static str,
    value: f64,
    good: bool,
    expected: &'static str,
) -> Result<(), GeometryError> {
    if good { Ok(()) } else { Err(GeometryError { parameter, value, expected }) }
}
