use std::fmt;

use super::Log;
use super::call::{self, Call};
use super::recording::Kind;
use super::stamp::seconds;

/// The first difference between two recordings.
#[derive(Debug, Clone, PartialEq)]
pub struct Difference {
    /// Index of the robot; `None` if the robots' calls are equal and something else differs.
    pub robot: Option<usize>,
    /// Time by the robot's clock (s).
    pub time: f64,
    /// Content of the second recording.
    pub found: String,
    /// Content of the first recording.
    pub expected: String,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.robot {
            Some(robot) => write!(f, "robot {} at {} s: ", robot + 1, self.time)?,
            None => f.write_str("beside the robots' calls: ")?,
        }
        write!(f, "found {}; expected {}", self.found, self.expected)
    }
}

impl Difference {
    /// The first difference between two recordings, if any.
    ///
    /// Calls are compared first, in the order of their time; the rest of the file is compared byte by byte.
    pub fn between(expected: &Log, found: &Log) -> Option<Self> {
        if expected.bytes() == found.bytes() {
            return None;
        }
        let robots = 0..expected.robots().max(found.robots());
        let differences = robots.filter_map(|robot| Self::of_robot(robot, expected, found));
        let first = differences.min_by(|a, b| a.time.total_cmp(&b.time));
        first.or_else(|| {
            let pairs = expected.bytes().iter().zip(found.bytes());
            let place = pairs.take_while(|(a, b)| a == b).count();
            Some(Self {
                robot: None,
                time: 0.0,
                found: format!("{} bytes that differ from byte {place} on", found.bytes().len()),
                expected: format!("{} bytes", expected.bytes().len()),
            })
        })
    }

    fn of_robot(robot: usize, expected: &Log, found: &Log) -> Option<Self> {
        let mut index = 0;
        loop {
            let (a, b) = (expected.event(robot, index), found.event(robot, index));
            index += 1;
            let data = [(expected, a), (found, b)].map(|(log, event)| event.map(|event| log.data(event)));
            let head = |event: Option<&super::recording::Event>| event.map(|event| (event.kind, event.time));
            if data[0] == data[1] && head(a) == head(b) {
                a?;
                continue;
            }
            let event = a.or(b)?;
            let said = |event: Option<&super::recording::Event>, data: Option<&[u8]>| match (event, data) {
                (Some(event), Some(data)) => words(event.kind, data),
                _ => "the end".into(),
            };
            let (found, expected) = (said(b, data[1]), said(a, data[0]));
            return Some(Self { robot: Some(robot), time: seconds(event.time), found, expected });
        }
    }
}

/// Text of a message.
fn words(kind: Kind, data: &[u8]) -> String {
    if kind == Kind::Bulk {
        return format!("a reading of {} bytes {:08x}", data.len(), crc32fast::hash(data));
    }
    let Some(call) = Call::read(data) else { return "a message that is no call".into() };
    let result = match &call.result {
        Ok(result) => format!("({})", result.shown()),
        Err(failure) => format!("the error \"{}\"", failure.error()),
    };
    format!("{} -> {result}", call::shown(call.method, &call.arguments))
}
