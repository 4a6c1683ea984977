//! The other end of the radio link: the base station with its crew, and a camera that sees how far the car truly goes.

use roverlab::ParameterError;
use roverlab::geometry::Pose;
use roverlab::safety::{BaseStation, Causes, Heartbeat, Panel, SafetyState, Station};

use super::crew::{Crew, Event};
use crate::common::{DEADMAN, StageTruth};

/// What the car did about something: it stopped, or the driver got it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Answer {
    /// What had happened, and when, if anything had that it had not answered before.
    pub(crate) event: Option<(Event, f64)>,
    /// When the state changed, by the car's clock, to what, and why.
    pub(crate) time: f64,
    pub(crate) state: SafetyState,
    pub(crate) causes: Causes,
}

impl Answer {
    /// Seconds from the event to this.
    pub(crate) fn reaction(&self) -> Option<f64> {
        self.event.map(|(_, time)| self.time - time)
    }
}

/// A stop as the camera saw it.
#[derive(Debug, Clone)]
pub(crate) struct SeenStop {
    pub(crate) answer: Answer,
    /// The speed when it began.
    pub(crate) speed: f64,
    /// Whether nobody had looked for so long that the car had stopped by itself: it began with the last look before.
    pub(crate) alone: bool,
    /// Where it began, and where the car stood, and how far it had gone at both.
    pub(crate) places: [Pose; 2],
    pub(crate) metres: [f64; 2],
}

/// What the camera saw at a time.
#[derive(Debug, Clone, Copy, Default)]
struct Look {
    time: f64,
    pose: Pose,
    metres: f64,
    speed: f64,
}

/// The base station.
pub(crate) struct Base {
    station: BaseStation,
    pub(crate) crew: Crew,
    truth: StageTruth,
    last: Look,
    before: Look,
    /// Whether the car of the last stop has not stood yet.
    open: bool,
    pub(crate) stops: Vec<SeenStop>,
    /// How often the driver got the car while it drove by itself.
    pub(crate) takeovers: Vec<Answer>,
    /// When the car asked last, by its own clock, and the last event that it has answered.
    asked: f64,
    answered: Option<(Event, f64)>,
    /// When the state changed, and to what.
    pub(crate) states: Vec<(f64, SafetyState)>,
}

/// Metres per second below which the car stands.
const STANDING: f64 = 0.005;

impl Base {
    pub(crate) fn new(crew: Crew, truth: StageTruth, heartbeat: f64) -> Result<Self, ParameterError> {
        Ok(Self {
            station: BaseStation::new(heartbeat)?,
            crew,
            truth,
            last: Look::default(),
            before: Look::default(),
            open: false,
            stops: Vec::new(),
            takeovers: Vec::new(),
            asked: 0.0,
            answered: None,
            states: vec![(0.0, SafetyState::Manual)],
        })
    }

    fn look(&mut self) -> Look {
        let (Ok(time), Ok(truth)) = (self.truth.time(), self.truth.robot(0)) else { return self.last };
        let passed = (time - self.last.time).max(1e-6);
        let speed = (truth.path_length - self.last.metres).abs() / passed;
        Look { time, pose: truth.pose, metres: truth.path_length, speed }
    }

    /// Takes in the state that the car has had since the last look.
    fn note(&mut self, heartbeat: Heartbeat, look: Look) {
        let before = self.states.last().map_or(SafetyState::Manual, |(_, state)| *state);
        if heartbeat.state != before {
            self.states.push((self.last.time, heartbeat.state));
        }
        if heartbeat.state.severity() > before.severity() {
            self.note_stop(heartbeat);
        } else if (before, heartbeat.state) == (SafetyState::Auto, SafetyState::Manual) {
            let answer = self.answer(heartbeat);
            self.takeovers.push(answer);
        }
        if let Some(stop) = self.stops.last_mut().filter(|_| self.open) {
            (stop.places[1], stop.metres[1]) = (look.pose, look.metres);
            self.open = look.speed > STANDING;
        }
    }

    fn note_stop(&mut self, heartbeat: Heartbeat) {
        let alone = self.last.time - self.before.time >= DEADMAN;
        let Look { pose, metres, speed, .. } = if alone { self.before } else { self.last };
        let answer = self.answer(heartbeat);
        self.stops.push(SeenStop { answer, speed, alone, places: [pose; 2], metres: [metres; 2] });
        self.open = true;
    }

    fn answer(&mut self, Heartbeat { state, causes, .. }: Heartbeat) -> Answer {
        let event = self.crew.now.filter(|now| self.answered != Some(*now));
        self.answered = event.or(self.answered);
        Answer { event, time: self.asked, state, causes }
    }
}

impl Station for Base {
    fn exchange(&mut self, now: f64, heartbeat: Heartbeat) -> Panel {
        let look = self.look();
        self.note(heartbeat, look);
        self.asked = now;
        let passed = look.time - self.last.time;
        if passed > 0.0 {
            self.before = self.last;
        }
        self.last = look;
        self.crew.act(&mut self.station, heartbeat.state, look.speed < STANDING, (now, passed));
        self.station.exchange(now, heartbeat)
    }
}
