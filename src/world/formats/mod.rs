//! Readers and writers of the file formats.
//!
//! Every reader returns a [`Parsed`] value with its [`Warning`]s, or a [`FormatError`] with file, line,
//! column, found and expected text. Files are in millimetres and degrees; values are in SI units.

mod args;
pub mod bitmap;
pub mod course;
pub mod elevation_grid;
mod error;
pub mod esobj;
mod image_file;
mod lexer;
mod limits;
mod load;
pub mod maz;
mod model;
pub mod movingai;
mod number;
pub mod robi;
pub mod ros_map;
pub mod sim;
mod source;
mod terrain_file;
mod water;
pub mod wld;
mod world_file;
mod yaml;
mod yaml_events;

pub use error::{FormatError, Location, Parsed, Warning};
pub use load::{
    load_object, load_robot, load_robot_tolerantly, load_scene, parse_robot, parse_robot_tolerantly,
    parse_scene, parse_scene_tolerantly, read_file,
};
pub use source::{DiskFiles, FileSource, MemoryFiles, SourceFile, in_any_case};

pub(crate) use lexer::shown;
use source::stem;
pub(crate) use yaml_events::YamlEvents;
