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
//! A *hard* cause is an emergency stop, on board or remote; a *soft* one is a lost heartbeat, a place outside the fence, a
//! program that hangs, or a sensor that is not to be trusted. The worse state always wins. A stop is left only by arming
//! again: a new request, made while the vehicle stands and no cause is left. What counts as a request is its beginning, so
//! that a button that is stuck arms nothing.

mod cause;
mod machine;
mod monitor;
mod stopping;

pub use cause::{Causes, Requests};
pub use machine::{SafetyCore, SafetyInputs, SafetyState};
pub use monitor::{Deadline, Debounce, SignalHealth, SignalLimits, SignalMonitor, is_inside};
pub use stopping::StoppingModel;
