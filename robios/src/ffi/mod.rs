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
mod camera;
#[cfg(target_os = "linux")]
mod clock;
mod computing;
mod display;
mod drive;
mod globals;
mod images;
mod keys;
mod lines;
mod memory;
#[cfg(target_os = "linux")]
mod older;
mod radio;
mod real_time;
mod runtime;
mod sensing;
mod sleep;
mod system;
mod threads;
#[cfg(target_os = "linux")]
mod turns;
mod variadic;
mod watch;
