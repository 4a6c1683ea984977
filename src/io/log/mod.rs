//! Recordings: every run can be saved as an MCAP file, which viewers open and which replays bit for bit.
//!
//! A [`LogWriter`] writes the file; its [`recorder`](LogWriter::recorder) wraps any robot. [`Log`] reads it,
//! and [`Replay`] is a robot that answers from it: a program that makes the recorded calls gets the recorded
//! answers, and the first deviating call fails with an error that names it.
//!
//! Equal runs give equal files, byte for byte: times are those of the robots, never of the machine, and file
//! names are not stored. The schemas are the open ones of [MCAP](https://mcap.dev) and Foxglove, so that
//! viewers and other programs can read the files:
//!
//! | topic | schema | content |
//! |---|---|---|
//! | `/robot1/calls` | `roverlab.Call` | every call with its arguments, and its result or error |
//! | `/robot1/lidar` | `foxglove.LaserScan` | scans |
//! | `/robot1/camera` | `foxglove.RawImage` | camera images |
//! | `/robot1/lcd` | `foxglove.RawImage` | the display, at most once a second, after changes |
//! | `/robot1/odometry` | `foxglove.PoseInFrame` | pose by odometry |
//! | `/robot1/transforms` | `foxglove.FrameTransform` | the same as a transform for viewers |
//! | `/scene` | `foxglove.SceneUpdate` | walls, objects and marks |
//! | `/robot1/truth` | `roverlab.Call` | queries of the ground truth |
//!
//! Topics number robots from 1. [`Log::messages`] has what is on them, [`RobotMessages`] writes the same for a
//! run that is not recorded. A metadata record named `roverlab` contains the [`Header`].
//!
//! ```
//! use roverlab::geometry::{Pose, Twist};
//! use roverlab::io::log::{Difference, Header, Log, LogWriter, Replay};
//! use roverlab::io::sim::{SimOptions, Simulation};
//! use roverlab::io::{Clock, Drive, Odometry, Result};
//! use roverlab::world::{RobotSpec, Scene, World};
//! fn program(robot: &mut (impl Clock + Drive + Odometry)) -> Result<Pose> {
//!     robot.set_speed(Twist::new(0.2, 0.5))?;
//!     robot.wait(1.0)?;
//!     robot.pose()
//! }
//! let scene = Scene::with_robot(World::empty(2.0, 2.0), RobotSpec::s4(), Pose::default());
//! let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 1))?;
//! let writer = LogWriter::new(Vec::new(), &Header::new("circle", ["--seed 1"]))?;
//! let mut robot = writer.recorder(simulation.robot(0)?, 0);
//! let end = program(&mut robot)?;
//! drop(robot);
//! let log = Log::read(writer.finish()?)?;
//! assert_eq!(program(&mut Replay::new(&log, 0)?)?, end, "to the bit");
//! assert_eq!(Difference::between(&log, &log), None);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod answer;
mod answers;
mod bag;
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
mod sight;
mod stamp;
mod topics;
mod truth;
mod values;
mod viewer;
mod wire;
mod writer;

pub use bag::{McapChannel, visit_messages};
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
pub use sight::{LogMessage, Seen, Sight};
pub use truth::{RecordedTruth, ReplayTruth};
pub use viewer::{RobotMessages, RobotTopic, Topic, scene_message};
pub use writer::LogWriter;

pub use super::{FleetIo, FleetStep, GroundTruth};

#[cfg(test)]
mod tests;
