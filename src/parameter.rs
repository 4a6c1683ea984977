use std::borrow::Cow;
use std::fmt;

/// An invalid parameter: its name, its value and what is expected.
///
/// Constructors return it, or an error that contains it; it also converts to
#[cfg_attr(feature = "io", doc = "[`io::Error`](crate::io::Error).")]
#[cfg_attr(not(feature = "io"), doc = "an error of robots.")]
///
/// ```
/// use roverlab::kinematics::Ackermann;
/// let error = Ackermann::new(f64::NAN, 0.4, 0.5).unwrap_err();
/// assert_eq!(error.name(), "wheelbase");
/// assert_eq!(error.to_string(), "wheelbase is NaN; expected a positive, finite number");
/// ```
#[derive(Clone, PartialEq, thiserror::Error)]
#[error("{name} is {value}; expected {expected}")]
pub struct ParameterError {
    name: Cow<'static, str>,
    value: f64,
    expected: Cow<'static, str>,
}

impl ParameterError {
    /// An error from name, value and expectation.
    pub fn new(
        name: impl Into<Cow<'static, str>>,
        value: f64,
        expected: impl Into<Cow<'static, str>>,
    ) -> Self {
        Self { name: name.into(), value, expected: expected.into() }
    }

    /// Name of the parameter.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its value; integers are converted.
    pub fn value(&self) -> f64 {
        self.value
    }

    /// What is expected.
    pub fn expected(&self) -> &str {
        &self.expected
    }

    /// Prefixes the name with that of a whole: `robot S4: track`.
    #[must_use]
    pub(crate) fn of(self, whole: &str) -> Self {
        Self { name: format!("{whole}: {}", self.name).into(), ..self }
    }
}

/// Implements `Debug` of error types as their sentence, because a `main` that returns an error prints that.
macro_rules! debug_as_sentence {
    ($($error:ty),+ $(,)?) => {$(
        impl std::fmt::Debug for $error {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                crate::parameter::write_with_causes(self, f)
            }
        }
    )+};
}
pub(crate) use debug_as_sentence;

debug_as_sentence!(ParameterError);

/// Writes an error and its causes, one per line, without repeating what has been said.
pub(crate) fn write_with_causes(error: &dyn std::error::Error, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let mut said = error.to_string();
    f.write_str(&said)?;
    for cause in std::iter::successors(error.source(), |error| error.source()) {
        let sentence = cause.to_string();
        if !said.contains(&sentence) {
            write!(f, "\n  caused by: {sentence}")?;
            said = sentence;
        }
    }
    Ok(())
}

/// Fails unless there are as many of something as expected.
pub(crate) fn require_count(name: &'static str, found: usize, expected: usize) -> Result<(), ParameterError> {
    if found == expected {
        Ok(())
    } else {
        Err(ParameterError::new(name, found as f64, expected.to_string()))
    }
}

/// Returns an error unless a parameter is good.
pub(crate) fn require(
    name: &'static str,
    value: f64,
    good: bool,
    expected: impl Into<Cow<'static, str>>,
) -> Result<(), ParameterError> {
    if good { Ok(()) } else { Err(ParameterError::new(name, value, expected)) }
}

/// Returns an error unless a parameter is finite.
pub(crate) fn require_finite(name: &'static str, value: f64) -> Result<(), ParameterError> {
    require(name, value, value.is_finite(), "a finite number")
}

/// Returns an error unless a parameter is positive and finite.
pub(crate) fn require_positive(name: &'static str, value: f64) -> Result<(), ParameterError> {
    require(name, value, value.is_finite() && value > 0.0, "a positive, finite number")
}

/// Returns an error unless a parameter is positive and at most `most`.
pub(crate) fn require_up_to(name: &'static str, value: f64, most: f64) -> Result<(), ParameterError> {
    require(name, value, value > 0.0 && value <= most, format!("more than 0 and at most {most}"))
}

/// Returns an error unless a parameter is finite and at least 0.
pub(crate) fn require_not_negative(name: &'static str, value: f64) -> Result<(), ParameterError> {
    require(name, value, value.is_finite() && value >= 0.0, "a finite number of at least 0")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Clone, PartialEq, thiserror::Error)]
    #[error("the track has no width")]
    struct Outer(#[source] ParameterError);

    debug_as_sentence!(Outer);

    #[test]
    fn a_main_that_fails_prints_sentences() {
        let error = ParameterError::new("width", 0.0, "more than 0");
        assert_eq!(format!("{error:?}"), "width is 0; expected more than 0");
        let both = "the track has no width\n  caused by: width is 0; expected more than 0";
        assert_eq!(format!("{:?}", Outer(error)), both);
    }

    #[cfg(feature = "io")]
    #[test]
    fn a_cause_that_says_the_same_is_not_printed_again() {
        use crate::io::Error;
        let error = Error::from(ParameterError::new("width", 0.0, "more than 0"));
        assert_eq!(format!("{error:?}"), "width is 0; expected more than 0");
        assert_eq!(format!("{:?}", Error::unsupported("lidar")), "the robot has no lidar");
    }
}
