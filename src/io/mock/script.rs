use std::collections::VecDeque;
use std::fmt;

use crate::io::{Error, ErrorKind, Result};

/// The readings of a [`MockRobot`](super::MockRobot)'s sensor.
///
/// A plain value converts to a constant, a vector or an array to a queue.
///
/// ```
/// use roverlab::io::{DistanceSensors, MockRobot, Psd, Script};
/// let mut robot = MockRobot::new()
///     .with_distance(Psd::FRONT, Script::queue([0.5, 0.4]))
///     .with_distance(Psd::LEFT, Script::function(|time| Ok(1.0 + time)));
/// assert_eq!((robot.distance(Psd::FRONT)?, robot.distance(Psd::FRONT)?), (0.5, 0.4));
/// assert!(robot.distance(Psd::FRONT).is_err(), "the script is over");
/// assert_eq!(robot.distance(Psd::LEFT)?, 1.0);
/// # Ok::<(), roverlab::io::Error>(())
/// ```
pub struct Script<T>(Kind<T>);

type Function<T> = Box<dyn FnMut(f64) -> Result<T> + Send>;

enum Kind<T> {
    Constant(T),
    Queue { left: VecDeque<T>, given: usize },
    Function(Function<T>),
}

impl<T> Script<T> {
    /// The same reading every time.
    pub fn constant(value: T) -> Self {
        Self(Kind::Constant(value))
    }

    /// Successive readings; after the last one, reading fails with the kind
    /// [`EndOfLog`](ErrorKind::EndOfLog).
    pub fn queue(readings: impl IntoIterator<Item = T>) -> Self {
        Self(Kind::Queue { left: readings.into_iter().collect(), given: 0 })
    }

    /// Readings from a function of the robot's time (s), which may fail.
    pub fn function(reading: impl FnMut(f64) -> Result<T> + Send + 'static) -> Self {
        Self(Kind::Function(Box::new(reading)))
    }
}

impl<T: Clone> Script<T> {
    /// The next reading; `name` is the sensor's name for error messages.
    pub(super) fn next(&mut self, name: &str, time: f64) -> Result<T> {
        match &mut self.0 {
            Kind::Constant(value) => Ok(value.clone()),
            Kind::Queue { left, given } => {
                let reading = left.pop_front().ok_or_else(|| {
                    let message = format!("the script of the {name} ended after {given} readings");
                    Error::new(ErrorKind::EndOfLog, message)
                })?;
                *given += 1;
                Ok(reading)
            }
            Kind::Function(reading) => reading(time),
        }
    }
}

impl<T> From<T> for Script<T> {
    fn from(value: T) -> Self {
        Self::constant(value)
    }
}

impl<T> From<Vec<T>> for Script<T> {
    fn from(readings: Vec<T>) -> Self {
        Self::queue(readings)
    }
}

impl<T, const N: usize> From<[T; N]> for Script<T> {
    fn from(readings: [T; N]) -> Self {
        Self::queue(readings)
    }
}

impl<T: fmt::Debug> fmt::Debug for Script<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.0 {
            Kind::Constant(value) => f.debug_tuple("Constant").field(value).finish(),
            Kind::Queue { left, given } => {
                f.debug_struct("Queue").field("left", left).field("given", given).finish()
            }
            Kind::Function(_) => f.write_str("Function"),
        }
    }
}
