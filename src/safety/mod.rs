//! The safety system of a car that drives by wire (book, sections 14.2 and 14.3).
//!
//! [`SafetyCore`] holds the state of the vehicle, one of five. It is a plain state machine: it allocates no
//! memory, cannot panic, and compiles without the standard library.
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
//! In each row, the leftmost column that applies and has an entry decides; if none does, the state stays. A
//! *hard* cause is an emergency stop, on board or remote. A *soft* cause is a lost heartbeat, a position
//! outside the fence, a program that hangs, or a faulty sensor. The more severe state wins. Only arming
//! leaves a stop: a new request while the vehicle stands and no cause is active. A request counts on its
//! rising edge, so a stuck button arms nothing, even if it was stuck before power-on.
//!
//! A sensor fault remains a cause until somebody confirms the sensors ([`Panel::sensors_checked`]).
//!
//! [`Supervised`] wraps any robot. In every control period it checks buttons, heartbeats, fence, pedals,
//! program and sensors, and brakes if necessary; its documentation lists what it detects, how soon, and what
//! it cannot detect. [`StoppingModel`] bounds the stopping distance, including the [`SpeedError`].
//! [`BaseStation`] is the remote end.
//!
//! [`CliffGuard`] keeps any robot from driving over edges, with distance sensors that look down (book, section
//! 7.4).

mod cause;
#[cfg(test)]
mod claim_tests;
mod cliff_guard;
#[cfg(test)]
mod cliff_guard_tests;
mod cliff_parameters;
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
pub use cliff_guard::CliffGuard;
pub use cliff_parameters::CliffGuardParameters;
pub use health::HealthLimits;
pub use machine::{SafetyCore, SafetyInputs, SafetyState};
pub use monitor::{Deadline, Debounce, SignalHealth, SignalLimits, SignalMonitor, is_inside};
pub use parameters::SupervisedParameters;
pub use station::{BaseStation, Heartbeat, Panel, Station};
pub use stopping::{SpeedError, StoppingModel};
pub use supervised::{StopRecord, Supervised};
