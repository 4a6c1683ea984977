use std::collections::BTreeSet;
use std::fmt;
use std::ops::ControlFlow;
use std::str::FromStr;

use crate::ParameterError;
use crate::io::control::{Behaviour, Command, Decision, Senses, halts};
use crate::io::{Radio, RadioMessage, Result};
use crate::parameter::{require, require_positive};

/// Parameters of [`RadioRing`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RadioRingParameters {
    /// Time after which an unanswered message is repeated (s).
    pub repetition: f64,
    /// Number of unanswered messages after which a robot counts as gone.
    pub tries: u32,
    /// Control period (s).
    pub period: f64,
}

impl Default for RadioRingParameters {
    /// A robot that loses 20 % of its messages, and as many answers, counts as gone once in 750 million
    /// times.
    fn default() -> Self {
        Self { repetition: 0.1, tries: 20, period: 0.02 }
    }
}

impl RadioRingParameters {
    /// Checks every parameter; the error names the one out of range.
    pub fn validate(&self) -> std::result::Result<(), ParameterError> {
        require_positive("repetition", self.repetition)?;
        require("tries", f64::from(self.tries), self.tries > 0, "at least 1")?;
        require_positive("control period", self.period)
    }
}

/// A ring of robots that pass a count on by radio (book, section 2.13, for any robot numbers): who receives a
/// number sends the next one to the robot that follows in the order of their radio numbers.
///
/// Messages are lost, so each is repeated until it is answered, and a robot that receives one again only
/// answers again. The sender of a number watches over it until the receiver has passed the next one on:
/// a robot that disappears with the count is skipped, and the others go on. A robot joins by calling the
/// others until one of them passes it the count, and [leaves](Self::leave) once nobody depends on it. The
/// count survives unless a robot and its predecessor disappear at once.
///
/// Messages are short texts without a zero byte, which RoBIOS cannot send.
///
/// ```
/// use std::cell::RefCell;
/// use std::rc::Rc;
///
/// use roverlab::drive::{RadioRing, RadioRingParameters};
/// use roverlab::geometry::Pose;
/// use roverlab::io::control::Run;
/// use roverlab::io::sim::{Fleet, SimOptions};
/// use roverlab::world::{RobotPlacement, RobotSpec, Scene, World};
///
/// # fn main() -> roverlab::io::Result<()> {
/// let mut scene = Scene::new(World::walled(2.0, 1.0));
/// for x in [0.5, 1.0, 1.5] {
///     scene.robots.push(RobotPlacement::new(RobotSpec::s4().into(), Pose::new(x, 0.5, 0.0)));
/// }
/// let mut fleet = Fleet::new(&scene, SimOptions { radio_loss: 0.2, ..SimOptions::default() })?;
/// let heard = Rc::new(RefCell::new(Vec::new()));
/// for robot in 0..3 {
///     let mut ring = RadioRing::new(robot == 0, RadioRingParameters::default())?;
///     let mut run = Run::new(&ring, f64::INFINITY)?;
///     let heard = Rc::clone(&heard);
///     fleet.control(robot, 0.02, move |robot| {
///         let flow = run.step(robot, &mut ring)?;
///         heard.borrow_mut().extend(ring.take_heard().into_iter().map(|(_, number)| number));
///         Ok(flow.map_break(|_| ()))
///     })?;
/// }
/// fleet.run_for(10.0)?;
/// let heard = heard.borrow();
/// assert!(heard.len() > 50 && heard.iter().copied().eq(1..=heard.len() as u32));
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct RadioRing {
    parameters: RadioRingParameters,
    /// Highest number that this robot knows to have been received; 0 for none.
    number: u32,
    watched: Option<Watched>,
    /// Robots that have not answered.
    gone: BTreeSet<u32>,
    /// Numbers received, with their times (s), that have not been taken yet.
    heard: Vec<(f64, u32)>,
    is_member: bool,
    is_leaving: bool,
    /// Time of the next call to the others (s).
    call_due: f64,
    repeats: u32,
}

/// The number sent last, until it has been passed on.
#[derive(Debug, Clone, Copy)]
struct Watched {
    number: u32,
    /// Its receiver; none while nobody else is there.
    to: Option<u32>,
    /// Messages since the last answer, and time of the next one (s).
    tries: u32,
    due: f64,
    /// Whether the receiver has it.
    is_received: bool,
}

/// Messages and their receivers, sent by a [`RadioRing`] in one step.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct RingMessages(Vec<(u32, RingMessage)>);

/// A message of a [`RadioRing`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum RingMessage {
    /// A number is passed on.
    Count(u32),
    /// The number has been received.
    Have(u32),
    /// The number has been received, and the next one passed on.
    Done(u32),
    /// A robot wants to join.
    Hello,
}

impl fmt::Display for RingMessage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Count(number) => write!(f, "count {number}"),
            Self::Have(number) => write!(f, "have {number}"),
            Self::Done(number) => write!(f, "done {number}"),
            Self::Hello => f.write_str("hello"),
        }
    }
}

impl FromStr for RingMessage {
    type Err = ();

    fn from_str(text: &str) -> std::result::Result<Self, ()> {
        let (word, number) = text.split_once(' ').unwrap_or((text, "0"));
        let number = number.parse().map_err(|_| ())?;
        match word {
            "count" => Ok(Self::Count(number)),
            "have" => Ok(Self::Have(number)),
            "done" => Ok(Self::Done(number)),
            "hello" => Ok(Self::Hello),
            _ => Err(()),
        }
    }
}

/// Observation of a [`RadioRing`].
#[derive(Debug, Clone, Default)]
pub struct RingObservation {
    /// Number of this robot.
    pub id: u32,
    /// Numbers of all robots.
    pub peers: Vec<u32>,
    /// Messages received since the last step.
    pub messages: Vec<RadioMessage>,
}

/// Outcome of a [`RadioRing`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum RingOutcome {
    /// The robot has left as it was asked to.
    Left,
    /// The time limit came first.
    TimedOut,
    /// The observer stopped the run.
    Stopped,
}

halts!(RingOutcome { Left: "the robot has left the ring" });

impl RadioRing {
    /// Creates a robot of a ring. One of them begins the count. Fails for parameters out of range.
    pub fn new(begins: bool, parameters: RadioRingParameters) -> Result<Self> {
        parameters.validate()?;
        let first = Watched { number: 1, to: None, tries: 0, due: f64::NEG_INFINITY, is_received: false };
        Ok(Self {
            parameters,
            number: 0,
            watched: begins.then_some(first),
            gone: BTreeSet::new(),
            heard: Vec::new(),
            is_member: begins,
            is_leaving: false,
            call_due: f64::NEG_INFINITY,
            repeats: 0,
        })
    }

    /// Leaves the ring as soon as nobody depends on this robot. A number that it receives until then is still
    /// passed on.
    pub fn leave(&mut self) {
        self.is_leaving = true;
    }

    /// The numbers received since the last call, with their times (s).
    pub fn take_heard(&mut self) -> Vec<(f64, u32)> {
        std::mem::take(&mut self.heard)
    }

    /// Number of repeated messages.
    pub fn repeats(&self) -> u32 {
        self.repeats
    }

    /// The robot that follows in the ring, without those that are gone.
    fn next(&self, seen: &RingObservation) -> Option<u32> {
        let others =
            || seen.peers.iter().copied().filter(move |peer| *peer != seen.id && !self.gone.contains(peer));
        others().filter(|peer| *peer > seen.id).min().or_else(|| others().min())
    }

    /// Takes a number that is new, and has the next one sent.
    fn take(&mut self, time: f64, number: u32) {
        self.number = number;
        self.is_member = true;
        self.heard.push((time, number));
        let next = Watched { number: number + 1, to: None, tries: 0, due: time, is_received: false };
        self.watched = Some(next);
    }

    /// Handles a message; returns the answer.
    fn answer(&mut self, time: f64, from: u32, message: RingMessage) -> Option<RingMessage> {
        self.gone.remove(&from);
        match message {
            // A newcomer must not take an old number for a new one.
            RingMessage::Hello => Some(RingMessage::Done(self.number)),
            RingMessage::Count(number) => {
                if number > self.number {
                    self.take(time, number);
                }
                let is_passed =
                    self.watched.is_none_or(|watched| watched.number != number + 1 || watched.is_received);
                Some(if is_passed { RingMessage::Done(number) } else { RingMessage::Have(number) })
            }
            RingMessage::Have(number) | RingMessage::Done(number) => {
                self.number = self.number.max(number);
                if let Some(watched) = self.watched.as_mut().filter(|watched| watched.number == number) {
                    (watched.is_received, watched.tries) = (true, 0);
                    if message == RingMessage::Done(number) {
                        self.watched = None;
                    }
                }
                None
            }
        }
    }

    /// The number that is watched over, if it is time to send it.
    fn repeated(&mut self, time: f64, seen: &RingObservation) -> Option<(u32, RingMessage)> {
        let mut watched = self.watched.filter(|watched| watched.due <= time)?;
        if watched.tries >= self.parameters.tries {
            self.gone.extend(watched.to);
            (watched.to, watched.tries, watched.is_received) = (None, 0, false);
        }
        if watched.to.is_none() {
            watched.to = self.next(seen);
            if watched.to.is_none() {
                // Nobody answers: all are asked again.
                self.gone.clear();
            }
        } else {
            self.repeats += 1;
        }
        watched.tries += 1;
        watched.due = time + self.parameters.repetition;
        self.watched = Some(watched);
        watched.to.map(|to| (to, RingMessage::Count(watched.number)))
    }
}

impl Behaviour for RadioRing {
    type Observation = RingObservation;
    type Command = RingMessages;
    type Outcome = RingOutcome;

    fn period(&self) -> f64 {
        self.parameters.period
    }

    fn step(&mut self, time: f64, seen: &RingObservation) -> Decision<Self> {
        let mut messages = Vec::new();
        for RadioMessage { from, data } in &seen.messages {
            // Other programs may use the radio too.
            let message: Option<RingMessage> =
                std::str::from_utf8(data).ok().and_then(|text| text.parse().ok());
            let answer = message.and_then(|message| self.answer(time, *from, message));
            messages.extend(answer.map(|answer| (*from, answer)));
        }
        if self.is_leaving && self.watched.is_none() {
            return Ok(ControlFlow::Break(RingOutcome::Left));
        }
        messages.extend(self.repeated(time, seen));
        if !self.is_member && time >= self.call_due {
            self.call_due = time + self.parameters.repetition;
            let others = seen.peers.iter().filter(|peer| **peer != seen.id);
            messages.extend(others.map(|&peer| (peer, RingMessage::Hello)));
        }
        Ok(ControlFlow::Continue(RingMessages(messages)))
    }
}

impl<R: Radio + ?Sized> Senses<R> for RadioRing {
    fn prepare(&mut self, robot: &mut R) -> Result<()> {
        // What came before the robot joined does not concern it.
        while robot.receive()?.is_some() {}
        Ok(())
    }

    fn sense(&mut self, robot: &mut R, _time: f64, seen: &mut RingObservation) -> Result<()> {
        seen.id = robot.radio_id()?;
        seen.peers = robot.radio_peers()?;
        seen.messages.clear();
        while let Some(message) = robot.receive()? {
            seen.messages.push(message);
        }
        Ok(())
    }
}

impl<R: Radio + ?Sized> Command<R> for RingMessages {
    fn apply(&self, robot: &mut R) -> Result<()> {
        self.0.iter().try_for_each(|(to, message)| robot.send(*to, message.to_string().as_bytes()))
    }

    fn stop(_robot: &mut R) -> Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;
    use proptest::prelude::*;

    /// Robots with any numbers, and a radio that loses messages.
    struct Net {
        robots: Vec<(u32, RadioRing)>,
        mail: Vec<(u32, RadioMessage)>,
        stream: Stream,
        loss: f64,
        time: f64,
        heard: Vec<u32>,
        known: Vec<u32>,
    }

    impl Net {
        fn new(known: &[u32], present: usize, loss: f64, seed: u64) -> Self {
            let robots = known[..present].iter().map(|&id| (id, ring(id == known[0]))).collect();
            let stream = Stream::new(seed);
            Self { robots, mail: Vec::new(), stream, loss, time: 0.0, heard: Vec::new(), known: known.into() }
        }

        /// One control period of all; returns who has left.
        fn step(&mut self) -> Vec<u32> {
            let mut sent = Vec::new();
            let mut left = Vec::new();
            for (id, ring) in &mut self.robots {
                let messages =
                    self.mail.iter().filter(|(to, _)| to == id).map(|(_, message)| message.clone()).collect();
                let seen = RingObservation { id: *id, peers: self.known.clone(), messages };
                match ring.step(self.time, &seen).unwrap() {
                    ControlFlow::Continue(RingMessages(messages)) => {
                        sent.extend(messages.into_iter().map(|(to, message)| (*id, to, message)));
                    }
                    ControlFlow::Break(_) => left.push(*id),
                }
                self.heard.extend(ring.take_heard().into_iter().map(|(_, number)| number));
            }
            self.robots.retain(|(id, _)| !left.contains(id));
            sent.retain(|_| !self.stream.chance(self.loss));
            let mail = |(from, to, message): (u32, u32, RingMessage)| {
                (to, RadioMessage { from, data: message.to_string().into_bytes() })
            };
            self.mail = sent.into_iter().map(mail).collect();
            self.time += 0.02;
            left
        }
    }

    fn ring(begins: bool) -> RadioRing {
        RadioRing::new(begins, RadioRingParameters::default()).unwrap()
    }

    proptest! {
        #![proptest_config(crate::testing::cases(32))]
        #[test]
        fn each_number_is_heard_once_in_rings_that_change(
            ids in prop::collection::btree_set(1..250u32, 3..10), seed in any::<u64>(), loss in 0.0..0.25f64,
        ) {
            let ids: Vec<u32> = ids.into_iter().collect();
            // The last one joins later, and the second one leaves.
            let mut net = Net::new(&ids, ids.len() - 1, loss, seed);
            let mut left = Vec::new();
            for step in 0..4000 {
                if step == 500 {
                    net.robots.push((ids[ids.len() - 1], ring(false)));
                }
                if step == 900 {
                    net.robots[1].1.leave();
                }
                left.extend(net.step());
            }
            prop_assert_eq!(left, vec![ids[1]]);
            prop_assert!(net.heard.len() > 200, "{}", net.heard.len());
            prop_assert!(net.heard.iter().copied().eq(1..=net.heard.len() as u32), "{:?}", net.heard);
            let newcomer = &net.robots.last().unwrap().1;
            prop_assert!(newcomer.is_member && newcomer.number > 20);
        }

        #[test]
        fn messages_are_read_as_written(number in any::<u32>()) {
            for message in [RingMessage::Count(number), RingMessage::Have(number), RingMessage::Done(number), RingMessage::Hello] {
                prop_assert_eq!(message.to_string().parse::<RingMessage>(), Ok(message));
            }
        }
    }

    #[test]
    fn a_robot_that_disappears_with_the_count_is_skipped() {
        for seed in 1..=20 {
            let mut net = Net::new(&[3, 8, 200], 3, 0.2, seed);
            while net.heard.len() < 30 || net.robots[1].1.watched.is_none_or(|watched| watched.is_received) {
                net.step();
            }
            net.robots.remove(1);
            let before = net.heard.len();
            for _ in 0..1000 {
                net.step();
            }
            assert!(net.heard.len() > before + 50, "seed {seed}");
            // What the lost robot had and nobody else may be heard twice.
            let mut numbers = net.heard.clone();
            numbers.dedup();
            assert!(numbers.windows(2).all(|pair| pair[1] == pair[0] + 1), "seed {seed}: {numbers:?}");
        }
    }

    #[test]
    fn other_texts_are_ignored() {
        let mut robot = ring(false);
        let data = b"count x".to_vec();
        let messages = vec![RadioMessage { from: 2, data }, RadioMessage { from: 2, data: vec![255] }];
        let seen = RingObservation { id: 1, peers: vec![1, 2], messages };
        let hello = RingMessages(vec![(2, RingMessage::Hello)]);
        assert_eq!(robot.step(0.0, &seen).unwrap(), ControlFlow::Continue(hello));
        let parameters = RadioRingParameters { tries: 0, ..RadioRingParameters::default() };
        assert!(RadioRing::new(false, parameters).is_err());
    }
}
