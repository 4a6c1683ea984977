//! Size limits of files. Each is far above any real file, and keeps a broken file from filling the memory.

// Metres of any coordinate or length, and degrees of any angle.
pub(super) use crate::geometry::units::{FARTHEST as MAX_DEGREES, FARTHEST as MAX_METRES};

/// Bytes of a text file.
pub(super) const MAX_TEXT_BYTES: u64 = 16 << 20;
/// Bytes in an image file.
pub(super) const MAX_IMAGE_BYTES: u64 = 256 << 20;
/// Words in a line.
pub(super) const MAX_WORDS: usize = 100;
/// Walls of a world.
pub(super) const MAX_WALLS: usize = 1_000_000;
/// Poses on the stack of a world file.
pub(super) const MAX_PUSHES: usize = 1_000;
/// Cells in a maze.
pub(super) const MAX_MAZE_CELLS: usize = 1_000_000;
/// Robots and objects placed by a simulation script.
pub(super) const MAX_PLACED: usize = 100_000;
/// Non-empty lines in a simulation script.
pub(super) const MAX_STATEMENTS: usize = 200_000;
/// Files named by a simulation script.
pub(super) const MAX_DEFINITIONS: usize = 1_000;
/// Solid parts and sensors of a robot or an object.
pub(super) const MAX_PARTS: usize = 10_000;
/// Bytes in a text file of a grid with one byte per cell.
pub(super) const MAX_GRID_BYTES: u64 = 64 << 20;
/// Queries in a scenario file.
pub(super) const MAX_QUERIES: usize = 1_000_000;
/// Triangles in a 3D model.
pub(super) const MAX_FACES: usize = 200_000;
