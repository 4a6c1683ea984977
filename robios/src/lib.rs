//! RoBIOS-7 over roverlab's simulator: the shared library `libeyesim` that C and Python programs for EyeBot robots and
//! for EyeSim are linked against, and what the runner of such programs needs.
//!
//! A program's robot lives in virtual time. Every call takes a tenth of a millisecond of it, calls that wait take as
//! long as they wait, and nothing takes real time: a program that drives for a minute is done in milliseconds. The
//! functions of the system that sleep or tell the time are replaced too (see `ffi::clock`).
//!
//! # How it is put together
//!
//! [`robios`] is the meaning of every function, in safe Rust, for one robot. It asks for what the world has to answer
//! through a [`link`]: a world in the same process, or, for programs that share a world, one in the runner's process,
//! with the requests and replies of [`ask`] as bytes on a local socket ([`wire`]). The private module `ffi` is the
//! thin layer that C calls: it checks pointers, holds the one robot behind a lock, and lets no panic out.
//!
//! # What the functions do that a simulated robot has no counterpart for
//!
//! | functions | what they do |
//! |---|---|
//! | `SERInit`, `SERSend`, `SERReceive`, ... | every port is looped back: it receives what was sent to it |
//! | `DIGITALSetup`, `DIGITALRead`, `DIGITALWrite` | outputs read what was written; inputs read 1 with a pull-up resistor and 0 without |
//! | `ANALOGRead`, `ANALOGVoltage` | 8.20 V of supply on channel 0; 0 on all others |
//! | `ANALOGRecord`, `ANALOGTransfer`, `AUMicrophone` | silence |
//! | `AUBeep`, `AUPlay` | counted in the report; a sound takes half a second for `AUDone` |
//! | `IRTVGet`, `IRTVRead` | what the script of the keys says; `AUTO` presses OK for a program that waits |
//! | `SERVOSet` | steering and camera follow; positions of other servos are remembered (`SERVOGet`) |
//! | `MOTORPID`, `MOTORPIDOff`, `VWControl`, `VWControlOff` | accepted, without effect |
//! | `SERVORange`, `OSMachineSpeed`, ... | accepted, fixed values |
//! | `PSDGetRaw` | as `PSDGet`, in millimetres |
//! | `OSExecute` | runs the command by the system's shell; at most 127 bytes of its output are handed back |
//!
//! # Conventions
//!
//! Functions return 0 when they succeed and 1 when they fail, unless RoBIOS says otherwise: null pointers, numbers out
//! of range, sensors that the robot lacks, and calls after a `fork` or from within a signal handler that has
//! interrupted another call. `SIMGetRobot` and `SIMSetRobot` take headings as world files do: 0 along the x axis,
//! counter-clockwise; what was read can be set. Robots are numbered from 1 as they were placed, for the radio too, and
//! objects behind them, as EyeSim does where robots are placed first. A number that this gives to a robot means an object
//! by its own count in `SIMGetObject`, and one that it gives to an object a robot behind all objects in `SIMGetRobot`.

pub mod ask;
mod ffi;
pub mod files;
pub mod keyboard;
pub mod keys;
pub mod link;
pub mod plan;
pub mod process;
pub mod report;
pub mod robios;
pub mod screen;
pub mod wire;
