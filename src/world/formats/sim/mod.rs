//! EyeSim's simulation scripts (`.sim`): a world, and the robots, objects and marks in it.
//!
//! | line | meaning |
//! |---|---|
//! | `world FILE` | a `.wld` or `.maz`, or the `.yaml` of a ROS map; without it, a box of 2000 by 2000 mm |
//! | `settings [VIS] [TRACE]` | what to show |
//! | `robot FILE`, `robi FILE` | makes a `.robi` known |
//! | `object FILE`, `obj FILE` | makes an `.esObj` known |
//! | `ROBOT X Y [Z] PHI [PROGRAM]` | places a robot; PHI counter-clockwise from the x axis |
//! | `ROBOT LETTER [PHI] [PROGRAM]` | places one at each such letter of the maze |
//! | `OBJECT X Y [Z] PHI` | places an object |
//! | `marker X Y [R G B [A]]` | a mark on the floor |
//!
//! The robots of [`RobotSpec::PREDEFINED`](crate::world::RobotSpec::PREDEFINED) and the objects of
//! [`ObjectKind::PREDEFINED`](crate::world::ObjectKind::PREDEFINED) are always known, and stand in for files
//! of their names that do not exist, as the worlds of [`World::PREDEFINED`](crate::world::World::PREDEFINED)
//! do; the names `S4`, `LabBot` and `Omni` are reserved. Names are those that the files state or the files'
//! own names, in any case. Lines of EyeSim 6 and lines that begin with an unknown word are skipped with a
//! warning.
//!
//! A robot at a letter without PHI heads where the letter says (see [`maz`](super::maz)). Letters that say nothing
//! mean a random heading: it is drawn from a stream of random numbers with a fixed seed, so that it is the same each
//! time; [`SimFile::resolve`] takes another seed.
//!
//! [`parse`] fails at the first line that makes no sense; [`parse_tolerantly`] warns of it and goes on, as EyeSim does.
//!
//! [`SimFile`] is the script as written; [`Scene`](crate::world::Scene) is what it describes, with the files that it
//! names.
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
