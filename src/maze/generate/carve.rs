use crate::ParameterError;
use crate::maze::{Cell, Direction, Maze, WallState};
use crate::random::Stream;

/// A perfect maze: exactly one path joins any two cells. A depth-first walk removes walls on its way to new
/// cells.
///
/// # Errors
///
/// If a side is not 1 to 256 cells.
///
/// ```
/// use roverlab::maze::generate::perfect;
/// use roverlab::maze::{Unknown, distances_from_start};
/// let maze = perfect(8, 6, 1)?;
/// assert_eq!(distances_from_start(&maze, Unknown::Closed).reached(), 48, "every cell");
/// assert_eq!(maze, perfect(8, 6, 1)?, "deterministic in the seed");
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
pub fn perfect(width: usize, height: usize, seed: u64) -> Result<Maze, ParameterError> {
    let mut maze = Maze::filled(width, height, WallState::Present)?;
    let mut stream = Stream::new(seed).child("perfect maze", 0);
    let mut met = vec![false; maze.cell_count()];
    carve(&mut maze, &mut met, &mut stream, Cell::default());
    Ok(maze)
}

/// A perfect maze with a random `part` (0 to 1, clamped) of its inner walls removed, so that many paths lead
/// to most cells.
///
/// # Errors
///
/// If a side is not 1 to 256 cells.
///
/// ```
/// use roverlab::maze::generate::{braided, perfect};
/// let (all, fewer) = (perfect(8, 6, 1)?, braided(8, 6, 0.5, 1)?);
/// assert!(fewer.wall_count() < all.wall_count());
/// assert_eq!(braided(8, 6, 0.0, 1)?, all);
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
pub fn braided(width: usize, height: usize, part: f64, seed: u64) -> Result<Maze, ParameterError> {
    let mut maze = perfect(width, height, seed)?;
    let mut stream = Stream::new(seed).child("braided maze", 0);
    let mut walls = inner_walls(&maze);
    stream.shuffle(&mut walls);
    let count = (part.clamp(0.0, 1.0) * walls.len() as f64).round() as usize;
    for &(cell, side) in &walls[..count] {
        maze.set_wall(cell, side, WallState::Absent);
    }
    Ok(maze)
}

/// Walks from a cell into unvisited cells, and removes the walls in between.
pub(super) fn carve(maze: &mut Maze, met: &mut [bool], stream: &mut Stream, from: Cell) {
    met[maze.index(from)] = true;
    let mut way = vec![from];
    while let Some(&cell) = way.last() {
        let new = |side: &Direction| maze.neighbour(cell, *side).is_some_and(|next| !met[maze.index(next)]);
        let sides: Vec<Direction> = Direction::ALL.into_iter().filter(new).collect();
        let Some(&side) = sides.get(stream.below(sides.len())) else {
            way.pop();
            continue;
        };
        maze.set_wall(cell, side, WallState::Absent);
        if let Some(next) = maze.neighbour(cell, side) {
            met[maze.index(next)] = true;
            way.push(next);
        }
    }
}

/// Walls between cells, each listed once.
pub(super) fn inner_walls(maze: &Maze) -> Vec<(Cell, Direction)> {
    let sides = |cell| [Direction::North, Direction::East].map(|side| (cell, side));
    let inner = |&(cell, side): &(Cell, Direction)| {
        maze.wall(cell, side) == WallState::Present && maze.neighbour(cell, side).is_some()
    };
    maze.cells().flat_map(sides).filter(inner).collect()
}
