//! Recordings: any run becomes an MCAP file, which viewers open and which plays back to the bit.
//!
//! A [`LogWriter`] writes the file; its [`recorder`](LogWriter::recorder) wraps any robot. [`Log`] reads it, and
//! [`Replay`] is a robot made of it: a program that does what the recorded one did sees what that one saw, and the
//! first call that differs is an error that names it.
//!
//! The same run gives the same file, byte for byte: it holds the robots' time, never that of the machine, and no names
//! of files. What it holds is in the open schemas of [MCAP](https://mcap.dev) and Foxglove, so that viewers and other
//! programs read it too:
//!
//! | topic | schema | what |
//! |---|---|---|
//! | `/robot1/calls` | `roverlab.Call` | every call with its arguments, and its result or error |
//! | `/robot1/lidar` | `foxglove.LaserScan` | scans |
//! | `/robot1/camera` | `foxglove.RawImage` | camera images |
//! | `/robot1/lcd` | `foxglove.RawImage` | the display, once a second when it has changed |
//! | `/robot1/odometry` | `foxglove.PoseInFrame` | where odometry takes the robot to be |
//! | `/robot1/transforms` | `foxglove.FrameTransform` | the same for the viewer's frames |
//! | `/scene` | `foxglove.SceneUpdate` | walls, objects and marks |
//! | `/robot1/truth` | `roverlab.Call` | what a simulator was asked about the truth |
//!
//! Robots are numbered from 1 in topics. A metadata record named `roverlab` holds the [`Header`].

mod answer;
mod answers;
mod call;
mod determinism;
mod difference;
mod entry;
mod error;
mod file;
mod fleet;
mod header;
mod lengths;
mod messages;
mod open_loop;
mod parts;
mod player;
mod port;
mod position;
mod reader;
mod recorder;
mod recording;
mod recover;
mod replay;
mod scene;
mod schema;
mod shadow;
mod stamp;
mod topics;
mod truth;
mod values;
mod wire;
mod writer;

pub use determinism::{Indeterminate, check_determinism};
pub use difference::Difference;
pub use entry::Entry;
pub use error::LogError;
pub use file::LogFile;
pub use fleet::{RecordedFleet, ReplayFleet};
pub use header::{Attachment, Compression, Header, SCHEMA_VERSION};
pub use open_loop::{OpenLoop, OpenLoopReport, RecordedCommand};
pub use player::Player;
pub use recorder::Recorder;
pub use recording::Log;
pub use recover::{Recovery, recover};
pub use replay::Replay;
pub use truth::{RecordedTruth, ReplayTruth};
pub use writer::LogWriter;

pub use super::{FleetIo, FleetStep, GroundTruth};

#[cfg(test)]
mod tests;
