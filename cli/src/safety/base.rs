//! The other end of the radio link: the base station with its crew, and a camera that measures the car's true
//! motion.

use roverlab::ParameterError;
use roverlab::geometry::Pose;
use roverlab::safety::{BaseStation, Causes, Heartbeat, Panel, SafetyState, Station};

use super::crew::{Crew, Event};
use crate::common::{DEADMAN, StageTruth};

/// The car's response to an event: it stopped, or the driver took over.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Answer {
    /// The unanswered event and its time, if any.
    pub(crate) event: Option<(Event, f64)>,
    /// Time of the state change by the car's clock, the new state, and its causes.
    pub(crate) time: f64,
    pub(crate) state: SafetyState,
    pub(crate) causes: Causes,
}

impl Answer {
    /// Reaction time since the event (s).
    pub(crate) fn reaction(&self) -> Option<f64> {
        self.event.map(|(_, time)| self.time - time)
    }
}

/// A stop as seen by the camera.
#[derive(Debug, Clone)]
pub(crate) struct SeenStop {
    pub(crate) answer: Answer,
    /// Speed at its start (m/s).
    pub(crate) speed: f64,
    /// Whether the looks had paused for so long that the car stopped by itself; the stop then began with the
    /// last look before.
    pub(crate) alone: bool,
    /// Start and end pose, and distance travelled at both (m).
    pub(crate) places: [Pose; 2],
    pub(crate) metres: [f64; 2],
}

/// Observation of the camera at a time.
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
    /// Whether the car has not come to rest in the last stop yet.
    open: bool,
    pub(crate) stops: Vec<SeenStop>,
    /// Takeovers by the driver from autonomous driving.
    pub(crate) takeovers: Vec<Answer>,
    /// Time of the car's last request by its own clock, and the last answered event.
    asked: f64,
    answered: Option<(Event, f64)>,
    /// Times of state changes, and the new states.
    pub(crate) states: Vec<(f64, SafetyState)>,
}

/// Speed below which the car stands (m/s).
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

    /// Records the car's state since the last look.
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
