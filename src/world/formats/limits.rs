//! How large a file may be. Each limit is far beyond any real file and keeps a broken one from filling the memory.

// Metres of any coordinate or length, and degrees of any angle.
pub(super) use crate::geometry::units::{FARTHEST as MAX_DEGREES, FARTHEST as MAX_METRES};

/// Bytes of a text file.
pub(super) const MAX_TEXT_BYTES: u64 = 16 << 20;
/// Bytes of an image file.
pub(super) const MAX_IMAGE_BYTES: u64 = 256 << 20;
/// Words in a line.
pub(super) const MAX_WORDS: usize = 100;
/// Walls of a world.
pub(super) const MAX_WALLS: usize = 1_000_000;
/// Poses pushed on the stack of a world file.
pub(super) const MAX_PUSHES: usize = 1_000;
/// Cells of a maze.
pub(super) const MAX_MAZE_CELLS: usize = 1_000_000;
/// Robots and objects placed by a simulation script.
pub(super) const MAX_PLACED: usize = 100_000;
/// Lines of a simulation script that say something.
pub(super) const MAX_STATEMENTS: usize = 200_000;
/// Files named by a simulation script.
pub(super) const MAX_DEFINITIONS: usize = 1_000;
/// Solid parts and sensors of a robot or an object.
pub(super) const MAX_PARTS: usize = 10_000;
/// Bytes of a text file that draws a grid: one for each cell.
pub(super) const MAX_GRID_BYTES: u64 = 64 << 20;
/// Queries of a scenario file.
pub(super) const MAX_QUERIES: usize = 1_000_000;
/// Triangles of a 3D model.
pub(super) const MAX_FACES: usize = 200_000;
