//! Behaviours of the library that drive a robot of a simulation.

use std::ops::ControlFlow;
use std::sync::{Mutex, MutexGuard, PoisonError};

use pyo3::prelude::*;
use roverlab::geometry::Twist;
use roverlab::io::sim::FleetRobot;
use roverlab::io::{Drive, Result};

use crate::errors::{Failure, Outcome};
use crate::robot::Robot;

/// What a behaviour decides at a time, from what a robot senses: a command, or the sentence of its outcome.
pub(crate) type Decision<C = Twist> = Result<ControlFlow<String, C>>;

/// Decides on a velocity once, and remembers the end.
pub(crate) fn decide(
    py: Python<'_>,
    robot: &Robot,
    ended: &Mutex<Option<String>>,
    step: impl FnOnce(f64, &mut FleetRobot<'_>) -> Decision,
) -> Outcome<(f64, f64)> {
    let twist = command(py, robot, ended, step)?.unwrap_or(Twist::STOP);
    Ok((twist.linear, twist.angular))
}

/// Decides once, and remembers the end, after which there is no command.
pub(crate) fn command<C>(
    py: Python<'_>,
    robot: &Robot,
    ended: &Mutex<Option<String>>,
    step: impl FnOnce(f64, &mut FleetRobot<'_>) -> Decision<C>,
) -> Outcome<Option<C>> {
    if outcome(ended).is_some() {
        return Ok(None);
    }
    let time = robot.clock(py);
    match robot.call(py, |robot| step(time, robot))? {
        ControlFlow::Continue(command) => Ok(Some(command)),
        ControlFlow::Break(sentence) => {
            *outcome(ended) = Some(sentence);
            Ok(None)
        }
    }
}

/// The sentence of the outcome, once there is one.
pub(crate) fn outcome(ended: &Mutex<Option<String>>) -> MutexGuard<'_, Option<String>> {
    ended.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Decides and drives every `period` seconds until the behaviour ends or the time is over, and stops the
/// robot.
pub(crate) fn run(
    py: Python<'_>,
    robot: &Robot,
    times: (f64, f64),
    ended: &Mutex<Option<String>>,
    mut decide: impl FnMut() -> Outcome<(f64, f64)>,
) -> Outcome<Option<String>> {
    let act = || {
        let (linear, angular) = decide()?;
        robot.call(py, |robot| robot.set_speed(Twist::new(linear, angular)))
    };
    let outcome = acting(py, robot, times, ended, act)?;
    robot.call(py, |robot| robot.stop())?;
    Ok(outcome)
}

/// Decides and tells the robot every `period` seconds until the behaviour ends or the time is over.
pub(crate) fn acting(
    py: Python<'_>,
    robot: &Robot,
    (period, time_limit): (f64, f64),
    ended: &Mutex<Option<String>>,
    mut act: impl FnMut() -> Outcome<()>,
) -> Outcome<Option<String>> {
    if time_limit.is_nan() {
        return Err(Failure::value("time_limit", time_limit, "a number of seconds"));
    }
    let start = robot.clock(py);
    while robot.clock(py) - start < time_limit {
        act()?;
        if outcome(ended).is_some() {
            break;
        }
        robot.rest(py, period)?;
        py.check_signals()?;
    }
    Ok(outcome(ended).clone())
}
