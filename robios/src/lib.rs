//! RoBIOS-7 over roverlab's simulator: the shared library `libeyesim` that C and Python programs for EyeBot robots and
//! for EyeSim are linked against, and what the runner of such programs needs.
//!
//! A program's robot lives in virtual time. Calls take of it what they do on EyeSim, whose frames serve one
//! request of each robot (see [`costs`]), calls that wait take as long as they wait, and nothing takes real
//! time: a program that drives for a minute is done in milliseconds. The functions of the system that sleep
//! or tell the time are replaced too (see `ffi::clock`).
//!
//! # How it is put together
//!
//! [`robios`] is the meaning of every function, in safe Rust, for one robot. It asks for what the world has
//! to answer through a [`link`]: a world in the same process, or, for programs that share a world, one in the
//! runner's process, with the requests and replies of [`ask`] as bytes ([`wire`]) in a [`memory`] that both
//! share, which also holds the [`report`]. What was read once is not asked for again before the world moves
//! on. The private module `ffi` is the thin layer that C calls: it checks pointers, holds the one robot
//! behind a lock, and lets no panic out.
//!
//! # What the functions do that a simulated robot has no counterpart for
//!
//! | functions | what they do |
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
//! Functions return 0 when they succeed and 1 when they fail, unless RoBIOS says otherwise: null pointers,
//! numbers out of range, sensors that the robot lacks, and calls after a `fork` or from within a signal
//! handler that has interrupted another call. `SIMGetRobot` and `SIMSetRobot` take headings as world files
//! do: 0 along the x axis, counter-clockwise; what was read can be set. Robots and objects are numbered from
//! 1 in one row, as they were placed; a robot has its number for the radio too. A number that is no robot's
//! counts robots alone in `SIMGetRobot` and `RADIOSend`, and one that is no object's counts objects alone in
//! `SIMGetObject`. What `SIMSetRobot` and `SIMSetObject` move is there 10 ms after their frame, or after the
//! call where calls are free, and for all programs at the same time; of several that move one thing at once,
//! the robot that was placed last prevails.
//!
//! A program's outcome, its time and its `collisions` are those at its end. Its robot drives on until it stands or
//! its time is over: pose and path are those at that end, and what it touched meanwhile is counted in
//! `collisions_after_end`.

pub mod ask;
pub mod costs;
mod ffi;
pub mod keyboard;
pub mod keys;
pub mod link;
pub mod memory;
pub mod plan;
pub mod process;
pub mod report;
pub mod robios;
pub mod screen;
mod walker;
pub mod wire;
