use super::carve::{carve, inner_walls};
use crate::ParameterError;
use crate::maze::{Cell, Direction, Maze, WallState};
use crate::random::Stream;

/// A maze that follows the rules of micromouse competitions: a start in the lower left corner with walls on
/// three sides, a goal of four cells around the centre with one entrance, a wall at every post except that of
/// the goal, and several paths to most cells.
///
/// `side` is rounded up to an even number of at least 6.
///
/// ```
/// use roverlab::maze::generate::competition;
/// use roverlab::maze::{Cell, Direction, Preference, Unknown, WallState, shortest_route};
/// let maze = competition(16, 1)?;
/// assert_eq!(maze.wall(Cell::new(0, 0), Direction::East), WallState::Present, "the start has one exit");
/// assert_eq!(maze.goals().count(), 4);
/// assert!(shortest_route(&maze, Unknown::Closed, Preference::Steps).is_some());
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
///
/// # Errors
///
/// If `side` exceeds 256.
pub fn competition(side: usize, seed: u64) -> Result<Maze, ParameterError> {
    let side = side.max(6).checked_next_multiple_of(2).unwrap_or(side);
    let mut maze = Maze::filled(side, side, WallState::Present)?;
    let mut stream = Stream::new(seed).child("competition maze", 0);
    let goals = maze.centre();
    let mut met = vec![false; maze.cell_count()];
    for &goal in &goals {
        met[maze.index(goal)] = true;
    }
    // The start is left out as well; its only exit is then opened to the north.
    met[0] = true;
    carve(&mut maze, &mut met, &mut stream, Cell::new(0, 1));
    maze.set_wall(Cell::default(), Direction::North, WallState::Absent);
    join_goal(&mut maze, &goals, &mut stream);
    braid(&mut maze, &goals, &mut stream);
    Ok(maze)
}

fn join_goal(maze: &mut Maze, goals: &[Cell], stream: &mut Stream) {
    let mut entrances = Vec::new();
    for &goal in goals {
        for side in Direction::ALL {
            match maze.neighbour(goal, side) {
                Some(other) if maze.is_goal(other) => maze.set_wall(goal, side, WallState::Absent),
                _ => entrances.push((goal, side)),
            }
        }
    }
    let (cell, side) = entrances[stream.below(entrances.len())];
    maze.set_wall(cell, side, WallState::Absent);
}

/// Removes walls whose posts keep other walls, except at the start and the goal.
fn braid(maze: &mut Maze, goals: &[Cell], stream: &mut Stream) {
    /// Fraction of the inner walls that may be removed.
    const PART: f64 = 0.15;
    let mut walls = inner_walls(maze);
    stream.shuffle(&mut walls);
    let keep = |cell: Option<Cell>| cell.is_some_and(|cell| goals.contains(&cell) || cell == Cell::default());
    let mut left = (PART * walls.len() as f64) as usize;
    for (cell, side) in walls {
        if left == 0 {
            return;
        }
        if keep(Some(cell)) || keep(maze.neighbour(cell, side)) {
            continue;
        }
        maze.set_wall(cell, side, WallState::Absent);
        let (x, y) = (usize::from(cell.x) + 1, usize::from(cell.y) + 1);
        let ends = if side == Direction::North { [(x - 1, y), (x, y)] } else { [(x, y - 1), (x, y)] };
        if ends.iter().any(|&post| !has_wall(maze, post)) {
            maze.set_wall(cell, side, WallState::Present);
        } else {
            left -= 1;
        }
    }
}

/// Whether a wall touches the post at the lower left corner of a cell, which may be one beyond the edge.
fn has_wall(maze: &Maze, (x, y): (usize, usize)) -> bool {
    let cell = |dx: usize, dy: usize| {
        let (x, y) = (x.checked_sub(dx)?, y.checked_sub(dy)?);
        Some(Cell::new(x as u16, y as u16)).filter(|&cell| maze.contains(cell))
    };
    let wall =
        |cell: Option<Cell>, side| cell.is_some_and(|cell| maze.wall(cell, side) == WallState::Present);
    wall(cell(0, 0), Direction::South)
        || wall(cell(0, 0), Direction::West)
        || wall(cell(1, 1), Direction::North)
        || wall(cell(1, 1), Direction::East)
        || wall(cell(1, 0), Direction::South)
        || wall(cell(0, 1), Direction::West)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maze::{Preference, Unknown, defects, distances_from_start, shortest_route};

    #[test]
    fn competition_mazes_keep_the_rules() {
        for seed in 0..30 {
            let maze = competition(16, seed).unwrap();
            assert_eq!(defects(&maze), []);
            let start = |side| maze.wall(Cell::default(), side);
            assert_eq!(
                (start(Direction::North), start(Direction::East)),
                (WallState::Absent, WallState::Present)
            );
            assert_eq!(distances_from_start(&maze, Unknown::Closed).reached(), 256);
            let entrances = maze.goals().flat_map(|goal| Direction::ALL.map(|side| (goal, side)));
            let open = entrances.filter(|&(goal, side)| {
                maze.passage(goal, side, Unknown::Closed).is_some_and(|next| !maze.is_goal(next))
            });
            assert_eq!(open.count(), 1);
            for post in (0..=16).flat_map(|x| (0..=16).map(move |y| (x, y))) {
                assert_eq!(has_wall(&maze, post), post != (8, 8), "{post:?} of maze {seed}");
            }
            assert!(shortest_route(&maze, Unknown::Closed, Preference::Steps).is_some());
        }
    }
}
