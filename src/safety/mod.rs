//! The safety system of a car that drives by wire (book, sections 14.2 and 14.3).
//!
//! [`SafetyCore`] decides in which of five states a vehicle is. It is a plain state machine: no memory is allocated,
//! nothing can panic, and its files compile without the standard library.
//!
//! ```text
//!                 arm                start
//!   ┌────────┐ ─────────▶ ┌───────┐ ─────────▶ ┌──────┐
//!   │ Manual │            │ Armed │            │ Auto │
//!   └────────┘ ◀───────── └───────┘            └──────┘
//!       ▲        driver,     ▲  ╲                │  │
//!       │        disarm      │   ╲ soft cause    │  │
//!       └────────────────────┼────╲──────────────┘  │ soft cause
//!          driver, disarm    │     ▼                ▼
//!                            │  ┌──────────────────────┐
//!                      arm   ├──│       SafeStop       │
//!                            │  └──────────────────────┘
//!                            │            │ hard cause
//!                            │            ▼
//!                            │  ┌──────────────────────┐   hard cause, from
//!                            └──│    EmergencyStop     │ ◀ every other state
//!                               └──────────────────────┘
//! ```
//!
//! | state | hard cause | soft cause | driver, or disarm | start | arm, standing, no cause |
//! |---|---|---|---|---|---|
//! | `Manual` | `EmergencyStop` | | `Manual` | | `Armed` |
//! | `Armed` | `EmergencyStop` | `SafeStop` | `Manual` | `Auto` | |
//! | `Auto` | `EmergencyStop` | `SafeStop` | `Manual` | | |
//! | `SafeStop` | `EmergencyStop` | `SafeStop` | `SafeStop` | | `Armed` |
//! | `EmergencyStop` | `EmergencyStop` | `EmergencyStop` | `EmergencyStop` | | `Armed` |
//!
//! Of the columns that apply and have an entry, the one farthest to the left decides; without one, the state stays. A *hard*
//! cause is an emergency stop, on board or remote; a *soft* one is a lost heartbeat, a place outside the fence, a program that
//! hangs, or a sensor that is not to be trusted. The worse state always wins. A stop is left only by arming again: a new
//! request, made while the vehicle stands and no cause is left. What counts as a request is its beginning, so that a button that
//! is stuck arms nothing, even if it was stuck before the power came.
//!
//! What a sensor was found at stays a cause until somebody vouches for the sensor ([`Panel::sensors_checked`]).
//!
//! [`Supervised`] puts any robot under this system: it looks at buttons, heartbeats, fence, pedals, program and sensors in every
//! control period, and brakes; its documentation says what it notices, how soon, and what it cannot. [`StoppingModel`] says how far it goes until it stands, with the [`SpeedError`] of what it measures. [`BaseStation`] is its other end.

mod cause;
#[cfg(test)]
mod claim_tests;
mod health;
mod machine;
mod monitor;
mod parameters;
mod station;
mod stopping;
mod supervised;
mod supervised_robot;
#[cfg(test)]
mod supervised_tests;

pub use cause::{Causes, Requests};
pub use health::HealthLimits;
pub use machine::{SafetyCore, SafetyInputs, SafetyState};
pub use monitor::{Deadline, Debounce, SignalHealth, SignalLimits, SignalMonitor, is_inside};
pub use parameters::SupervisedParameters;
pub use station::{BaseStation, Heartbeat, Panel, Station};
pub use stopping::{SpeedError, StoppingModel};
pub use supervised::{StopRecord, Supervised};
