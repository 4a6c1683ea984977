//! EyeSim's simulation scripts (`.sim`): a world, and the robots, objects and marks in it.
//!
//! | line | meaning |
//! |---|---|
//! | `world FILE` | a `.wld` or `.maz`, or the `.yaml` of a ROS map; without it, a box of 2000 by 2000 mm |
//! | `world FILE` | `.wld`, `.maz`, or the `.yaml` of a ROS map; default: a box of 2000 by 2000 mm |
//! | `settings [VIS] [TRACE]` | display options |
//! | `robot FILE`, `robi FILE` | defines the robot of a `.robi` |
//! | `object FILE`, `obj FILE` | defines the object of an `.esObj` |
//! | `ROBOT X Y [Z] PHI [PROGRAM]` | places a robot; PHI counter-clockwise from the x axis |
//! | `ROBOT LETTER [PHI] [PROGRAM]` | places one at each such letter of the maze |
//! | `OBJECT X Y [Z] PHI` | places an object |
//!
//! The robots of [`RobotSpec::PREDEFINED`](crate::world::RobotSpec::PREDEFINED) and the objects of
//! [`ObjectKind::PREDEFINED`](crate::world::ObjectKind::PREDEFINED) are always known, and replace missing
//! files of their names, as do the worlds of [`World::PREDEFINED`](crate::world::World::PREDEFINED). The
//! names `S4`, `LabBot` and `Omni` are reserved. Names are those stated in the files or the files' own names,
//! case-insensitive. Lines of EyeSim 6 and lines that begin with an unknown word are skipped with a warning.
//!
//! A robot at a letter without PHI has the letter's heading (see [`maz`](super::maz)). Other letters imply a
//! random heading from a stream with a fixed seed, which makes it repeatable; [`SimFile::resolve`] accepts
//! another seed.
//!
//! [`parse`] fails at the first invalid line; [`parse_tolerantly`] warns and continues, like EyeSim.
//!
//! [`SimFile`] is the script as written; [`Scene`](crate::world::Scene) is the described scene, including the
//! files that it names.
//!
//! ```
//! use roverlab::world::formats::{MemoryFiles, sim};
//! let text = "S4 400 400 90 drive.x\nCan 1000 1000 0\nmarker 1600 1600 0 180 0\n";
//! let script: sim::SimFile = sim::parse_document(text, "room.sim")?.value;
//! assert_eq!(sim::parse_document(&sim::print(&script), "again.sim")?.value, script);
//! let mut files = MemoryFiles::default();
//! let scene = sim::parse(text, "room.sim", &mut files)?.value;
//! assert_eq!((scene.robots.len(), scene.world.objects.len(), scene.world.markers.len()), (1, 1, 1));
//! let wrong = "S4 400 here 90\n";
//! assert!(sim::parse(wrong, "room.sim", &mut files).is_err());
//! assert_eq!(sim::parse_tolerantly(wrong, "room.sim", &mut files)?.warnings.len(), 1);
//! # Ok::<(), roverlab::world::formats::FormatError>(())
//! ```

mod definitions;
mod document;
mod read;
mod resolve;
#[cfg(test)]
mod tests;
mod write;

pub use document::{Position, SimFile, Statement};
pub use read::parse_document;
pub(super) use resolve::parse_with;
pub use resolve::{HEADING_SEED, parse, parse_tolerantly};
pub use write::print;
