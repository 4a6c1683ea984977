//! The people around the car: they arm and start it, trigger events, and restart it.

use roverlab::safety::{BaseStation, SafetyState, SupervisedParameters};

/// An event while the car drives.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Event {
    /// The on-board button is pressed.
    Button,
    /// The base station orders a stop.
    Remote,
    /// The radio link breaks.
    Radio,
    /// The program hangs.
    Hang,
    /// The driver presses the brake.
    Pedal,
    /// The driver takes the steering wheel.
    Wheel,
}

impl Event {
    pub(crate) const ALL: [Self; 6] =
        [Self::Button, Self::Remote, Self::Radio, Self::Hang, Self::Pedal, Self::Wheel];

    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Button => "button",
            Self::Remote => "remote",
            Self::Radio => "radio",
            Self::Hang => "hang",
            Self::Pedal => "pedal",
            Self::Wheel => "wheel",
        }
    }

    /// Time within which the car must respond (s): one control period after the event can be noticed.
    pub(crate) fn allowed(self, parameters: &SupervisedParameters) -> f64 {
        let noticed = match self {
            Self::Button | Self::Remote | Self::Pedal | Self::Wheel => 0.0,
            Self::Radio => parameters.heartbeat,
            // The program hangs in its next step.
            Self::Hang => parameters.watchdog + STEP,
        };
        noticed + parameters.period
    }

    /// Starts or ends the event.
    fn set(self, station: &mut BaseStation, on: bool) {
        match self {
            Self::Button => station.panel.emergency_button = on,
            Self::Remote if on => station.stop(),
            Self::Radio if on => station.connect(false),
            // The station takes back its own order.
            Self::Remote => station.take_back(),
            Self::Radio => {
                station.connect(true);
                station.take_back();
            }
            // The program does this by itself.
            Self::Hang => {}
            Self::Pedal => station.panel.brake = if on { 0.6 } else { 0.0 },
            Self::Wheel => station.panel.steering_force = if on { -0.4 } else { 0.0 },
        }
    }
}

/// Period of the driving program (s).
pub(crate) const STEP: f64 = 0.05;

/// Time that the car drives before an event, and stands before it is armed again (s).
const DRIVES: f64 = 5.0;
const STANDS: f64 = 1.0;

/// The crew, with its schedule of events.
#[derive(Debug)]
pub(crate) struct Crew {
    events: Vec<Event>,
    next: usize,
    /// Time that the car has driven, or stood, without interruption (s).
    driven: f64,
    stood: f64,
    /// The current event, and its start.
    pub(crate) now: Option<(Event, f64)>,
    hang: bool,
    /// Time from which all sensors work again (s).
    well: f64,
}

impl Crew {
    pub(crate) fn new(events: Vec<Event>, well: f64) -> Self {
        Self { events, next: 0, driven: 0.0, stood: 0.0, now: None, hang: false, well }
    }

    /// Whether the program is to hang now, once.
    pub(crate) fn lets_hang(&mut self) -> bool {
        std::mem::take(&mut self.hang)
    }

    /// Whether all events have happened, and the car drives again.
    pub(crate) fn is_done(&self) -> bool {
        self.next == self.events.len() && self.now.is_none() && self.driven > 1.0
    }

    /// The crew's actions in a step.
    pub(crate) fn act(
        &mut self,
        station: &mut BaseStation,
        state: SafetyState,
        standing: bool,
        (time, step): (f64, f64),
    ) {
        self.driven = if state == SafetyState::Auto { self.driven + step } else { 0.0 };
        self.stood = if standing && state != SafetyState::Auto { self.stood + step } else { 0.0 };
        if self.driven > DRIVES && self.now.is_none() && self.next < self.events.len() {
            let event = self.events[self.next];
            self.next += 1;
            self.now = Some((event, time));
            event.set(station, true);
            self.hang = event == Event::Hang;
        }
        if self.stood > 0.5 * STANDS
            && let Some((event, _)) = self.now.take()
        {
            event.set(station, false);
        }
        // An inspection would reveal failing sensors, so nobody confirms them.
        station.panel.sensors_checked = self.stood > 0.5 * STANDS && time > self.well;
        // Buttons are pressed and released.
        station.panel.requests.arm = self.stood > STANDS && (self.stood / step).round() as u64 % 20 < 5;
        station.panel.requests.start = state == SafetyState::Armed && self.stood > 1.5 * STANDS;
    }
}
