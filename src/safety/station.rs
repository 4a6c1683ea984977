use super::{Causes, Deadline, Requests, SafetyState};
use crate::ParameterError;

/// What people and the base station tell a vehicle's safety system in one control period.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[expect(clippy::struct_excessive_bools, reason = "each is a wire of its own")]
pub struct Panel {
    /// The button on board that takes the power away.
    pub emergency_button: bool,
    /// The button on board that gives the wheel back to the driver.
    pub disengage: bool,
    /// A stop button of the base station, real or on the screen.
    pub remote_stop: bool,
    /// The base station's counter, as far as it was heard; it has to change.
    pub heartbeat: Option<u64>,
    /// How far the accelerator is pressed, 0 to 1.
    pub accelerator: f64,
    /// How far the brake is pressed, 0 to 1.
    pub brake: f64,
    /// The force on the steering wheel, as a share of the greatest.
    pub steering_force: f64,
    /// What people ask for.
    pub requests: Requests,
    /// Somebody has looked at the sensors and vouches for them: those that were found at fault are trusted again. What counts is
    /// when it rises.
    pub sensors_checked: bool,
}

/// What a vehicle tells its base station in each control period: the heartbeat's other direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Heartbeat {
    /// Counts up.
    pub count: u64,
    /// The state of the safety system.
    pub state: SafetyState,
    /// What was wrong when it got into that state, or still is.
    pub causes: Causes,
}

/// Whoever sits at the other end: people, buttons, the base station.
pub trait Station {
    /// Hears the vehicle's heartbeat and answers. `now` is the time in seconds.
    fn exchange(&mut self, now: f64, heartbeat: Heartbeat) -> Panel;
}

impl<F: FnMut(f64, Heartbeat) -> Panel> Station for F {
    fn exchange(&mut self, now: f64, heartbeat: Heartbeat) -> Panel {
        self(now, heartbeat)
    }
}

/// A base station (book, section 14.3): it has a heartbeat of its own, listens to the vehicle's, and orders a stop when that is
/// missing; the order stays until it is taken back.
///
/// A vehicle that hangs does not ask it anything. So the station has to be [looked](Self::look) at again and again by a clock of
/// its own, from where the people are who should know; from the first look on, that clock alone counts.
///
/// ```
/// use roverlab::safety::{BaseStation, Heartbeat, Causes, SafetyState, Station};
/// let mut station = BaseStation::new(0.5)?;
/// let heartbeat = |count| Heartbeat { count, state: SafetyState::Auto, causes: Causes::NONE };
/// station.look(10.0);
/// assert!(!station.exchange(0.0, heartbeat(1)).remote_stop);
/// assert!(!station.look(10.4));
/// // No heartbeat for too long: nobody is there.
/// assert!(station.look(10.6));
/// assert!(station.exchange(0.7, heartbeat(2)).remote_stop, "an order stays");
/// station.take_back();
/// assert!(!station.look(10.7) && !station.exchange(0.8, heartbeat(3)).remote_stop);
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone)]
pub struct BaseStation {
    /// What is told beside heartbeat and stop: buttons and pedals on board, and `remote_stop` for another button of the station.
    /// Its heartbeat is the station's own.
    pub panel: Panel,
    vehicle: Deadline,
    last: Option<u64>,
    count: u64,
    stop: bool,
    /// What the station's own clock showed last; without one, it goes by what the vehicle says.
    time: Option<f64>,
    /// Whether the vehicle's heartbeat reaches it, and whether what it says reaches the vehicle.
    hears: bool,
    is_heard: bool,
}

impl BaseStation {
    /// A station that waits so many seconds for a heartbeat. Fails unless that is a positive, finite number.
    pub fn new(limit: f64) -> Result<Self, ParameterError> {
        Ok(Self {
            panel: Panel::default(),
            vehicle: Deadline::new(limit)?,
            last: None,
            count: 0,
            stop: false,
            time: None,
            hears: true,
            is_heard: true,
        })
    }

    /// Somebody presses a stop button.
    pub fn stop(&mut self) {
        self.stop = true;
    }

    /// Somebody takes the order back. The vehicle stands until it is armed. While its heartbeat is missing, the next look orders
    /// it anew.
    pub fn take_back(&mut self) {
        self.stop = false;
    }

    /// Cuts or mends the radio link, in both directions.
    pub fn connect(&mut self, connected: bool) {
        self.connect_each(connected, connected);
    }

    /// Cuts or mends each direction: whether the station hears the vehicle, and whether it is heard.
    pub fn connect_each(&mut self, hears: bool, is_heard: bool) {
        (self.hears, self.is_heard) = (hears, is_heard);
    }

    /// Looks whether the vehicle is still there, at a time in seconds of the station's own clock. Whether the station orders a
    /// stop.
    pub fn look(&mut self, now: f64) -> bool {
        if self.time.is_none() && self.last.is_some() {
            // What was heard so far was heard by another clock.
            self.vehicle.feed(now);
        }
        self.time = Some(now);
        self.judge(now)
    }

    /// Orders a stop if a vehicle that was there is no more.
    fn judge(&mut self, now: f64) -> bool {
        self.stop |= self.last.is_some() && self.vehicle.is_over(now);
        self.stop
    }
}

impl Station for BaseStation {
    fn exchange(&mut self, now: f64, heartbeat: Heartbeat) -> Panel {
        let now = self.time.unwrap_or(now);
        if self.hears && self.last != Some(heartbeat.count) {
            self.last = Some(heartbeat.count);
            self.vehicle.feed(now);
        }
        self.judge(now);
        if !self.is_heard {
            // What is on board is there all the same; nothing of the station's own comes through.
            return Panel { heartbeat: None, remote_stop: false, ..self.panel };
        }
        self.count += 1;
        Panel { heartbeat: Some(self.count), remote_stop: self.stop || self.panel.remote_stop, ..self.panel }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_of_a_station_comes_through_a_broken_link() {
        let mut station = BaseStation::new(0.5).unwrap();
        let heartbeat = |count| Heartbeat { count, state: SafetyState::Auto, causes: Causes::NONE };
        station.panel = Panel { remote_stop: true, heartbeat: Some(7), brake: 0.5, ..Panel::default() };
        station.panel.emergency_button = true;
        station.stop();
        station.connect(false);
        let heard = station.exchange(0.0, heartbeat(1));
        assert!(!heard.remote_stop && heard.heartbeat.is_none(), "{heard:?}");
        assert!(heard.emergency_button && heard.brake == 0.5, "what is on board needs no link: {heard:?}");
        station.connect(true);
        let heard = station.exchange(0.1, heartbeat(2));
        assert!(heard.remote_stop && heard.heartbeat == Some(1), "{heard:?}");
    }
}
