use std::collections::BTreeMap;

use super::answer::Answers;
use super::call::{self, Call};
use super::recording::Kind;
use super::stamp::{nanoseconds, seconds};
use super::values::Values;
use super::{Log, LogError};
use crate::io::{Clock, Error, ErrorKind, Key, Result};

/// A robot that answers from a recording by time, whatever the program does: for trying another algorithm on
/// recorded inputs.
///
/// It has its own clock: waiting advances it, and each call takes some time. A sensor returns its last
/// recorded reading up to that time, or its first one if that is later; a sensor that was never read returns
/// an error. Commands are recorded without effect; [`report`](OpenLoop::report) compares them with the
/// original ones. After the end of the recording every call fails with [`EndOfLog`](ErrorKind::EndOfLog).
///
/// ```
/// use roverlab::geometry::{Pose, Twist};
/// use roverlab::io::log::{Header, Log, LogWriter, OpenLoop};
/// use roverlab::io::sim::{SimOptions, Simulation};
/// use roverlab::io::{Clock, Drive, Odometry};
/// use roverlab::world::{RobotSpec, Scene, World};
/// let scene = Scene::with_robot(World::empty(2.0, 2.0), RobotSpec::s4(), Pose::default());
/// let simulation = Simulation::new(&scene, SimOptions::ideal())?;
/// let writer = LogWriter::new(Vec::new(), &Header::new("straight", ["--speed 0.2"]))?;
/// let mut robot = writer.recorder(simulation.robot(0)?, 0);
/// robot.set_speed(Twist::new(0.2, 0.0))?;
/// robot.wait(2.0)?;
/// let end = robot.pose()?;
/// drop(robot);
/// // Another program: it gets the recorded readings, whatever it commands.
/// let mut again = OpenLoop::new(&Log::read(writer.finish()?)?, 0)?;
/// again.set_speed(Twist::new(0.3, 0.0))?;
/// again.wait(1.0)?;
/// assert_eq!(again.pose()?, end, "the only pose that was asked for");
/// let report = again.report();
/// assert_eq!((report.recorded, report.given, report.same), (1, 1, 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct OpenLoop {
    log: Log,
    robot: usize,
    /// Clock, and end of the recording (ns).
    time: u64,
    end: u64,
    /// Recorded answers to each query, ordered by time.
    answers: BTreeMap<String, Vec<Answer>>,
    recorded: Vec<RecordedCommand>,
    commands: Vec<RecordedCommand>,
}

/// A recorded answer: its event and the event of its bulk data.
#[derive(Debug, Clone, Copy)]
struct Answer {
    time: u64,
    event: usize,
    bulk: Option<usize>,
}

/// A command of a program.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordedCommand {
    /// Time by the robot's clock (s).
    pub time: f64,
    /// Name of the call, such as `set_speed`.
    pub method: String,
    /// Its numbers, in metres, radians and seconds.
    pub numbers: Vec<f64>,
    /// All arguments as text.
    pub arguments: String,
}

/// Comparison of a program's commands with the recorded ones.
#[derive(Debug, Clone, PartialEq)]
pub struct OpenLoopReport {
    /// Number of recorded commands.
    pub recorded: usize,
    /// Number of the program's commands.
    pub given: usize,
    /// Number of leading commands equal to the bit, whatever their time.
    pub same: usize,
    /// The first differing pair of commands, recorded and new; either may be missing.
    pub first_difference: Option<(Option<RecordedCommand>, Option<RecordedCommand>)>,
    /// Largest difference of a number between corresponding commands, by method.
    pub largest: BTreeMap<String, f64>,
}

/// Duration of a call (ns), as in the simulator.
const CALL: u64 = 100_000;

/// Calls that are queries; all others are commands.
const QUESTIONS: [&str; 22] = [
    "speed",
    "pose",
    "remaining",
    "is_done",
    "is_stalled",
    "distance",
    "scan_into",
    "cursor",
    "display_size",
    "pixel",
    "screenshot",
    "read_touch",
    "radio_id",
    "radio_peers",
    "encoder",
    "attitude",
    "turn_rates",
    "acceleration",
    "depth",
    "resolution",
    "image_into",
    "wait_done",
];

/// Queries with events as answers: a key press is gone once read.
const EVENTS: [&str; 3] = ["read_key", "wait_key", "receive"];

impl OpenLoop {
    /// Creates a robot from a recording, by its index, at the time of its first call. Fails if the recording
    /// has no such robot.
    pub fn new(log: &Log, robot: usize) -> std::result::Result<Self, LogError> {
        if robot >= log.robots() {
            return Err(LogError::NoRobot { index: robot, robots: log.robots() });
        }
        let mut new = Self {
            log: log.clone(),
            robot,
            time: 0,
            end: 0,
            answers: BTreeMap::new(),
            recorded: Vec::new(),
            commands: Vec::new(),
        };
        new.index();
        Ok(new)
    }

    /// Sets the clock to a time of the recording (s).
    pub fn seek(&mut self, time: f64) {
        self.time = nanoseconds(time);
    }

    /// Compares the commands so far with the recorded ones.
    pub fn report(&self) -> OpenLoopReport {
        let alike = |a: &RecordedCommand, b: &RecordedCommand| {
            let bits =
                |command: &RecordedCommand| command.numbers.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            a.method == b.method && a.arguments == b.arguments && bits(a) == bits(b)
        };
        let pairs = || self.recorded.iter().zip(&self.commands);
        let same = pairs().take_while(|(a, b)| alike(a, b)).count();
        let next = (self.recorded.get(same).cloned(), self.commands.get(same).cloned());
        let mut largest = BTreeMap::new();
        for (a, b) in pairs().filter(|(a, b)| a.method == b.method) {
            let numbers = a.numbers.iter().zip(&b.numbers).map(|(a, b)| (a - b).abs());
            let entry = largest.entry(a.method.clone()).or_insert(0.0_f64);
            *entry = numbers.fold(*entry, f64::max);
        }
        OpenLoopReport {
            recorded: self.recorded.len(),
            given: self.commands.len(),
            same,
            first_difference: (next.0.is_some() || next.1.is_some()).then_some(next),
            largest,
        }
    }

    /// The program's commands so far.
    pub fn commands(&self) -> &[RecordedCommand] {
        &self.commands
    }

    fn index(&mut self) {
        let log = self.log.clone();
        let mut bulk = None;
        let mut first = None;
        for index in 0.. {
            let Some(event) = log.event(self.robot, index) else { break };
            match event.kind {
                Kind::Truth | Kind::Start => {}
                Kind::Bulk => bulk = Some(index),
                Kind::Call => {
                    let bulk = bulk.take();
                    first = first.or(Some(event.time));
                    self.end = self.end.max(event.time);
                    let Some(call) = Call::read(log.data(event)) else { continue };
                    let nothing =
                        call.result.as_ref().is_ok_and(|result| result.integers.first() == Some(&0));
                    if nothing && matches!(call.method, "read_key" | "receive") {
                        // The absence of an event is not an event.
                    } else if is_command(call.method) {
                        self.recorded.push(command(event.time, call.method, &call.arguments));
                    } else {
                        let question = call::shown(call.method, &call.arguments);
                        let answer = Answer { time: event.time, event: index, bulk };
                        self.answers.entry(question).or_default().push(answer);
                    }
                }
            }
        }
        self.time = first.unwrap_or(0);
    }

    /// Advances the clock by a call; fails after the end of the recording.
    fn pass(&mut self, method: &str) -> Result<()> {
        if self.time > self.end {
            let message = format!("the recording has ended before the call {method}");
            return Err(Error::new(ErrorKind::EndOfLog, message));
        }
        self.time = self.time.saturating_add(CALL);
        Ok(())
    }

    /// Records a command.
    fn obey(&mut self, method: &str, arguments: &Values) -> Result<()> {
        let time = self.time;
        self.pass(method)?;
        self.commands.push(command(time, method, arguments));
        Ok(())
    }

    /// Reading of a sensor at the current time.
    fn ask<T>(
        &mut self,
        method: &str,
        arguments: &Values,
        take: impl FnOnce(&Values, &[u8]) -> Option<T>,
    ) -> Result<T> {
        let now = self.time;
        self.pass(method)?;
        let question = call::shown(method, arguments);
        let unread =
            || Error::new(ErrorKind::Unsupported, format!("the recording has no answer to {question}"));
        let happens = EVENTS.contains(&method);
        let answer =
            if happens { self.next_event(&question, now, method) } else { self.reading(&question, now) };
        let Some(answer) = answer else {
            // No key was pressed and no message came so far.
            return if happens {
                take(&Values::of(&None::<Key>), &[]).ok_or_else(unread)
            } else {
                Err(unread())
            };
        };
        if matches!(method, "wait_done" | "wait_key") {
            self.time = self.time.max(answer.time);
        }
        let log = self.log.clone();
        let data = |index: Option<usize>| {
            index.and_then(|index| log.event(self.robot, index)).map_or(&[][..], |event| log.data(event))
        };
        let call = Call::read(data(Some(answer.event))).ok_or_else(unread)?;
        match call.result {
            Ok(result) => take(&result, data(answer.bulk)).ok_or_else(unread),
            Err(failure) => Err(failure.error()),
        }
    }

    /// The last answer up to a time, or the first one if all are later.
    fn reading(&self, question: &str, now: u64) -> Option<Answer> {
        let answers = self.answers.get(question)?;
        let later = answers.partition_point(|answer| answer.time <= now);
        answers.get(later.saturating_sub(1)).copied()
    }

    /// The oldest unread event, if it has happened by now or the program waits for it.
    fn next_event(&mut self, question: &str, now: u64, method: &str) -> Option<Answer> {
        let events = self.answers.get_mut(question)?;
        events.first().filter(|event| event.time <= now || method == "wait_key")?;
        Some(events.remove(0))
    }
}

impl Answers for OpenLoop {
    fn answer<T>(
        &mut self,
        method: &str,
        arguments: &Values,
        take: impl FnOnce(&Values, &[u8]) -> Option<T>,
    ) -> Result<T> {
        if !is_command(method) {
            return self.ask(method, arguments, take);
        }
        self.obey(method, arguments)?;
        take(&Values::default(), &[]).ok_or_else(|| Error::new(ErrorKind::Other, "a command has no answer"))
    }
}

fn is_command(method: &str) -> bool {
    !QUESTIONS.contains(&method) && !EVENTS.contains(&method) && !matches!(method, "now" | "wait")
}

fn command(time: u64, method: &str, arguments: &Values) -> RecordedCommand {
    RecordedCommand {
        time: seconds(time),
        method: method.into(),
        numbers: arguments.numbers.clone(),
        arguments: arguments.shown(),
    }
}

impl Clock for OpenLoop {
    fn now(&mut self) -> Result<f64> {
        let now = seconds(self.time);
        self.pass("now")?;
        Ok(now)
    }

    fn wait(&mut self, seconds: f64) -> Result<()> {
        crate::parameter::require_finite("waiting time", seconds)?;
        self.pass("wait")?;
        self.time = self.time.saturating_add(nanoseconds(seconds.max(0.0)));
        Ok(())
    }

    fn peek_time(&mut self) -> Result<f64> {
        Ok(seconds(self.time))
    }
}
