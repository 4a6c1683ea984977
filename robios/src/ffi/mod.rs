//! The C interface. Every function checks its pointers, goes through [`runtime::enter`], and returns a code;
//! the implementation is in [`robios`](crate::robios).
//!
//! As usual in C, non-null pointers must refer to memory of the size stated in the header, which nobody else
//! uses during the call.

#![allow(unsafe_code, non_snake_case, non_upper_case_globals)]
#![allow(clippy::redundant_closure_for_method_calls, reason = "all calls of the robot look alike")]

mod actuators;
#[cfg(target_os = "linux")]
mod alarm;
#[cfg(target_os = "linux")]
mod c11;
mod camera;
#[cfg(target_os = "linux")]
mod cancelling;
#[cfg(target_os = "linux")]
mod clock;
#[cfg(not(target_family = "wasm"))]
mod computing;
#[cfg(target_os = "linux")]
mod conditions;
mod display;
mod drive;
mod globals;
mod images;
mod keys;
mod lines;
#[cfg(target_os = "linux")]
mod locks;
mod memory;
mod older;
#[cfg(target_os = "linux")]
mod original;
mod radio;
#[cfg(not(target_family = "wasm"))]
mod real_time;
#[cfg_attr(target_family = "wasm", path = "page/runtime.rs")]
pub(crate) mod runtime;
mod sensing;
#[cfg_attr(target_family = "wasm", path = "page/sleep.rs")]
mod sleep;
#[cfg(not(target_family = "wasm"))]
mod sleepers;
mod system;
#[cfg(target_os = "linux")]
mod tasks;
#[cfg(not(target_family = "wasm"))]
mod threads;
#[cfg(target_os = "linux")]
mod turns;
mod variadic;
#[cfg(not(target_family = "wasm"))]
mod watch;
