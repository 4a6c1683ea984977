//! RoBIOS-7 on roverlab's simulator: the shared library `libeyesim`, against which C and Python programs for
//! EyeBot robots and for EyeSim are linked, and the parts needed by their runner.
//!
//! A program's robot lives in virtual time. Calls take as long as on EyeSim, which serves one request per
//! robot and frame (see [`costs`]), waiting calls take as long as they wait, and nothing takes real time: a
//! program that drives for a minute is done in milliseconds. The system's functions that sleep or read the
//! time are replaced too (see `ffi::clock`).
//!
//! # Structure
//!
//! [`robios`] implements every function in safe Rust, for one robot. It sends requests to the world through a
//! [`link`]: a world in the same process or, for programs that share a world, one in the runner's process. In
//! the latter case the requests and replies of [`ask`] travel as bytes ([`wire`]) in a shared [`memory`],
//! which also holds the [`report`]. Readings are cached until the world moves on. The private module `ffi` is
//! the thin C layer: it checks pointers, holds the single robot behind a lock, and catches panics.
//!
//! # Functions without a counterpart in the simulated robot
//!
//! | functions | behaviour |
//! |---|---|
//! | `SERInit`, `SERSend`, `SERReceive`, ... | every port is looped back: it receives what was sent to it |
//! | `DIGITALSetup`, `DIGITALRead`, `DIGITALWrite` | outputs read what was written; inputs read 1 with a pull-up resistor and 0 without |
//! | `ANALOGRead`, `ANALOGVoltage` | 8.20 V of supply on channel 0; the inertial unit on the channels of the `inertial` line of a `.robi`, in tenths of degrees, tenths of degrees per second and mm/s²; the depth in mm on that of a `depth_sensor` line; 0 on all others |
//! | `ANALOGRecord`, `ANALOGTransfer`, `AUMicrophone` | silence |
//! | `AUBeep`, `AUPlay` | counted in the report, a file that is missing with a warning; a sound takes half a second for `AUDone` |
//! | `IRTVGet`, `IRTVRead` | what the script of the keys says; `AUTO` presses OK for a program that waits |
//! | `SERVOSet` | steering, camera and Starman's limbs follow; positions of other servos are remembered (`SERVOGet`) |
//! | `MOTORPID`, `MOTORPIDOff`, `VWControl`, `VWControlOff` | accepted, without effect |
//! | `SERVORange`, `OSMachineSpeed`, ... | accepted, fixed values |
//! | `PSDGetRaw` | as `PSDGet`, in millimetres |
//! | `OSExecute` | runs the command by the system's shell; at most 127 bytes of its output are handed back |
//!
//! # Conventions
//!
//! Functions return 0 on success and 1 on failure, unless RoBIOS defines otherwise. Failures are null
//! pointers, numbers out of range, missing sensors, and calls after a `fork` or from a signal handler that
//! interrupted another call. `SIMGetRobot` and `SIMSetRobot` use the headings of world files: 0 along the x
//! axis, counter-clockwise; a pose that was read can be set. Robots and objects are numbered from 1 in the
//! order of their placement, in one sequence; a robot has the same number on the radio. A number that is not
//! a robot's counts robots alone in `SIMGetRobot` and `RADIOSend`; one that is not an object's counts objects
//! alone in `SIMGetObject`. `SIMSetRobot` and `SIMSetObject` take effect 10 ms after their frame (or after
//! the call where calls are free), for all programs at the same time. If several move the same thing at once,
//! the robot placed last prevails.
//!
//! A program's outcome, time and `collisions` are those at its end. Its robot then drives on until it stands
//! or the time is over: pose and path are those at that point, and contacts in between are counted in
//! `collisions_after_end`.

#![cfg_attr(target_family = "wasm", allow(dead_code, reason = "a page has neither threads nor processes"))]
#![cfg_attr(not(feature = "c"), allow(dead_code, reason = "a runner without the C functions needs less"))]

pub mod ask;
pub mod costs;
#[cfg(feature = "c")]
mod ffi;
mod files;
pub mod identity;
#[cfg(not(target_family = "wasm"))]
pub mod keyboard;
pub mod keys;
pub mod link;
#[cfg_attr(target_family = "wasm", path = "memory_of_page.rs")]
pub mod memory;
#[cfg(all(target_family = "wasm", feature = "c"))]
pub mod page;
pub mod plan;
#[cfg(not(target_family = "wasm"))]
pub mod process;
#[cfg(not(target_family = "wasm"))]
pub mod remote;
pub mod report;
pub mod robios;
#[cfg(not(target_family = "wasm"))]
pub mod runner;
pub mod screen;
pub mod seat;
pub mod showing;
pub mod verdict;
#[cfg_attr(target_family = "wasm", path = "no_walker.rs")]
mod walker;
pub mod wire;
