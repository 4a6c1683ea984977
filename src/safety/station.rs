use super::{Causes, Deadline, Requests, SafetyState};
use crate::ParameterError;

/// Inputs from the operator and the base station in one control period.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[expect(clippy::struct_excessive_bools, reason = "each is a wire of its own")]
pub struct Panel {
    /// Emergency button on board, which cuts the power.
    pub emergency_button: bool,
    /// Button on board that returns control to the driver.
    pub disengage: bool,
    /// Stop button of the base station, physical or on screen.
    pub remote_stop: bool,
    /// Counter of the base station as last received; it must change.
    pub heartbeat: Option<u64>,
    /// Accelerator position, 0 to 1.
    pub accelerator: f64,
    /// Brake position, 0 to 1.
    pub brake: f64,
    /// Force on the steering wheel, as a fraction of the maximum.
    pub steering_force: f64,
    /// Requests of the operator.
    pub requests: Requests,
    /// Somebody has inspected the sensors and confirms that they work. Only the rising edge counts.
    pub sensors_checked: bool,
}

/// The vehicle's heartbeat, sent to the base station in each control period.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Heartbeat {
    /// Counter, incremented in each period.
    pub count: u64,
    /// State of the safety system.
    pub state: SafetyState,
    /// Causes found by the last check.
    pub causes: Causes,
}

/// The remote end: operator, buttons, base station.
///
/// # For implementers
///
/// Return at once, whether or not the vehicle has been heard: `exchange` is part of the safety loop.
/// Return the base station's counter as last received; a counter that stops changing is a lost link.
pub trait Station {
    /// Takes the vehicle's heartbeat and answers with the inputs. `now` is the vehicle's time (s).
    fn exchange(&mut self, now: f64, heartbeat: Heartbeat) -> Panel;
}

impl<F: FnMut(f64, Heartbeat) -> Panel> Station for F {
    fn exchange(&mut self, now: f64, heartbeat: Heartbeat) -> Panel {
        self(now, heartbeat)
    }
}

/// A base station (book, section 14.3). It sends a heartbeat, listens for the vehicle's, and orders a stop
/// when that one is missing. The order stays until it is withdrawn.
///
/// A vehicle that hangs does not call its station. Therefore call [`look`](Self::look) regularly, with the
/// station's own clock. From the first call on, only that clock counts.
///
/// ```
/// use roverlab::safety::{BaseStation, Heartbeat, Causes, SafetyState, Station};
/// let mut station = BaseStation::new(0.5)?;
/// let heartbeat = |count| Heartbeat { count, state: SafetyState::Auto, causes: Causes::NONE };
/// station.look(10.0);
/// assert!(!station.exchange(0.0, heartbeat(1)).remote_stop);
/// assert!(!station.look(10.4));
/// // The heartbeat has been missing for too long.
/// assert!(station.look(10.6));
/// assert!(station.exchange(0.7, heartbeat(2)).remote_stop, "the order stays");
/// station.take_back();
/// assert!(!station.look(10.7) && !station.exchange(0.8, heartbeat(3)).remote_stop);
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone)]
pub struct BaseStation {
    /// Further inputs: buttons and pedals on board, and an additional stop button in `remote_stop`. The
    /// `heartbeat` field is ignored.
    pub panel: Panel,
    vehicle: Deadline,
    last: Option<u64>,
    count: u64,
    stop: bool,
    /// Latest time of the station's own clock (s); `None` until the first [`look`](Self::look), when the
    /// vehicle's time counts.
    time: Option<f64>,
    /// State of the radio link, per direction: vehicle to station, station to vehicle.
    hears: bool,
    is_heard: bool,
}

impl BaseStation {
    /// A station that waits `limit` seconds for a heartbeat.
    ///
    /// # Errors
    ///
    /// If `limit` is not positive and finite.
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

    /// Orders a stop.
    pub fn stop(&mut self) {
        self.stop = true;
    }

    /// Withdraws the order. The vehicle stands until it is armed. If its heartbeat is still missing, the next
    /// [`look`](Self::look) orders a stop again.
    pub fn take_back(&mut self) {
        self.stop = false;
    }

    /// Cuts or restores the radio link in both directions.
    pub fn connect(&mut self, connected: bool) {
        self.connect_each(connected, connected);
    }

    /// Cuts or restores each direction: from the vehicle, and to the vehicle.
    pub fn connect_each(&mut self, hears: bool, is_heard: bool) {
        (self.hears, self.is_heard) = (hears, is_heard);
    }

    /// Checks the vehicle's heartbeat at time `now` of the station's own clock (s). Returns whether the
    /// station orders a stop.
    pub fn look(&mut self, now: f64) -> bool {
        if self.time.is_none() && self.last.is_some() {
            // Earlier heartbeats carry times of another clock.
            self.vehicle.feed(now);
        }
        self.time = Some(now);
        self.judge(now)
    }

    /// Orders a stop if the vehicle was there and its heartbeat is missing.
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
            // Inputs on board need no link; those of the station are lost.
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
        assert!(heard.emergency_button && heard.brake == 0.5, "inputs on board need no link: {heard:?}");
        station.connect(true);
        let heard = station.exchange(0.1, heartbeat(2));
        assert!(heard.remote_stop && heard.heartbeat == Some(1), "{heard:?}");
    }
}
