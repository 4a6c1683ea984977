//! Shortest routes by steps and by turns (book, section 9.7).

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::{Cell, Direction, Maze, Unknown};

/// Criterion for the best route.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Preference {
    /// Fewest steps, then fewest turns.
    Steps,
    /// Fewest turns, then fewest steps.
    Turns,
    /// Smallest sum of steps and turns, then fewest steps.
    StepsAndTurns,
}

impl Preference {
    /// Costs of a step and of a turn. No route has as many of either as the larger weight.
    const fn weights(self) -> (u64, u64) {
        /// More than the number of cells of a route in the largest maze, so that two costs fit into one
        /// number.
        const MANY: u64 = 1 << 24;
        match self {
            Self::Steps => (MANY, 1),
            Self::Turns => (1, MANY),
            Self::StepsAndTurns => (MANY + 1, MANY),
        }
    }
}

/// A path from cell to cell.
///
/// ```
/// use roverlab::maze::{Cell, Direction, Route};
/// let moves = vec![Direction::North, Direction::North, Direction::East];
/// let route = Route::new(Cell::new(0, 0), Direction::North, moves);
/// assert_eq!((route.steps(), route.turns(), route.end()), (3, 1, Cell::new(1, 2)));
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Route {
    start: Cell,
    heading: Direction,
    moves: Vec<Direction>,
}

impl Route {
    /// The route of a sequence of moves, for a robot that initially faces `heading`.
    pub fn new(start: Cell, heading: Direction, moves: Vec<Direction>) -> Self {
        Self { start, heading, moves }
    }

    /// First cell.
    pub fn start(&self) -> Cell {
        self.start
    }

    /// Initial heading.
    pub fn heading(&self) -> Direction {
        self.heading
    }

    /// Direction of each step.
    pub fn moves(&self) -> &[Direction] {
        &self.moves
    }

    /// Number of steps.
    pub fn steps(&self) -> usize {
        self.moves.len()
    }

    /// Number of changes of direction; a first step that is not straight ahead counts.
    pub fn turns(&self) -> usize {
        let before = std::iter::once(&self.heading).chain(&self.moves);
        before.zip(&self.moves).filter(|(before, now)| before != now).count()
    }

    /// All cells on the route, both ends included.
    pub fn cells(&self) -> impl Iterator<Item = Cell> + '_ {
        let mut cell = self.start;
        std::iter::once(cell).chain(self.moves.iter().map(move |direction| {
            let (dx, dy) = direction.step();
            cell = Cell::new((i32::from(cell.x) + dx) as u16, (i32::from(cell.y) + dy) as u16);
            cell
        }))
    }

    /// Last cell.
    pub fn end(&self) -> Cell {
        self.cells().last().unwrap_or(self.start)
    }
}

/// The best route from the start to the goal; `None` if the goal is unreachable.
///
/// # Complexity
///
/// Dijkstra's algorithm over cells and headings: O(n log n) for n cells.
pub fn shortest_route(maze: &Maze, unknown: Unknown, preference: Preference) -> Option<Route> {
    shortest_route_between(maze, unknown, preference, (maze.start(), maze.heading()), |cell| {
        maze.is_goal(cell)
    })
}

/// The best route from a cell and heading to the nearest cell that satisfies `goal`; `None` if none is
/// reachable.
///
/// ```
/// use roverlab::maze::{Cell, Direction, Maze, Preference, Unknown, shortest_route_between};
/// let (maze, from) = (Maze::open(4, 4)?, (Cell::new(3, 3), Direction::West));
/// let home = |cell| cell == Cell::new(0, 0);
/// let route = shortest_route_between(&maze, Unknown::Closed, Preference::Turns, from, home);
/// let route = route.expect("an open way");
/// assert_eq!((route.steps(), route.turns()), (6, 1));
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
pub fn shortest_route_between(
    maze: &Maze,
    unknown: Unknown,
    preference: Preference,
    (start, heading): (Cell, Direction),
    goal: impl Fn(Cell) -> bool,
) -> Option<Route> {
    let (step, turn) = preference.weights();
    let state = |cell: Cell, heading: Direction| 4 * maze.index(cell) + heading as usize;
    let mut costs = vec![u64::MAX; 4 * maze.cell_count()];
    let mut before = vec![Direction::North; costs.len()];
    let first = state(start, heading);
    costs[first] = 0;
    let mut open = BinaryHeap::from([Reverse((0, first))]);
    while let Some(Reverse((cost, here))) = open.pop() {
        if cost > costs[here] {
            continue;
        }
        let (cell, facing) = (maze.cell_at(here / 4), Direction::ALL[here % 4]);
        if goal(cell) {
            return Some(trace(
                maze,
                &before,
                (start, heading),
                (cell, facing),
                costs[here] / step.max(turn),
            ));
        }
        for direction in Direction::ALL {
            let Some(next) = maze.passage(cell, direction, unknown) else { continue };
            let cost = cost + step + if direction == facing { 0 } else { turn };
            let there = state(next, direction);
            if cost < costs[there] {
                (costs[there], before[there]) = (cost, facing);
                open.push(Reverse((cost, there)));
            }
        }
    }
    None
}

/// Reconstructs the route to a state, backwards from its end.
fn trace(
    maze: &Maze,
    before: &[Direction],
    start: (Cell, Direction),
    (mut cell, mut facing): (Cell, Direction),
    capacity: u64,
) -> Route {
    let mut moves = Vec::with_capacity(capacity as usize);
    while (cell, facing) != start {
        moves.push(facing);
        let previous = before[4 * maze.index(cell) + facing as usize];
        let Some(back) = maze.neighbour(cell, facing.opposite()) else { break };
        (cell, facing) = (back, previous);
    }
    moves.reverse();
    Route::new(start.0, start.1, moves)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maze::WallState;

    #[test]
    fn an_empty_maze_needs_one_turn() {
        let maze = Maze::open(16, 16).unwrap();
        let route = shortest_route(&maze, Unknown::Closed, Preference::Steps).unwrap();
        assert_eq!((route.steps(), route.turns(), route.end()), (14, 1, Cell::new(7, 7)));
    }

    #[test]
    fn a_start_in_the_goal_is_a_route_of_no_steps() {
        let maze = Maze::open(1, 1).unwrap();
        let route = shortest_route(&maze, Unknown::Closed, Preference::Turns).unwrap();
        assert_eq!((route.steps(), route.turns()), (0, 0));
    }

    #[test]
    fn a_closed_goal_has_no_route_and_an_unknown_one_may_have() {
        let maze = Maze::unexplored(4, 4).unwrap();
        assert_eq!(shortest_route(&maze, Unknown::Closed, Preference::Steps), None);
        assert_eq!(shortest_route(&maze, Unknown::Open, Preference::Steps).unwrap().steps(), 2);
    }

    #[test]
    fn preferences_differ_where_they_should() {
        // Three routes to the goal: a staircase, one around the lower corner and past the goal, one around
        // the upper corner.
        let mut maze = Maze::filled(7, 7, WallState::Present).unwrap();
        maze.set_goals([Cell::new(4, 4)]);
        for way in ["NENENENE", "EEEEENNNNW", "NNNNNNEEEESS"] {
            let mut cell = maze.start();
            for letter in way.chars() {
                let direction =
                    Direction::ALL.into_iter().find(|side| format!("{side:?}").starts_with(letter)).unwrap();
                maze.set_wall(cell, direction, WallState::Absent);
                cell = maze.neighbour(cell, direction).unwrap();
            }
            assert!(maze.is_goal(cell));
        }
        let route = |preference| {
            let route = shortest_route(&maze, Unknown::Closed, preference).unwrap();
            (route.steps(), route.turns())
        };
        assert_eq!(route(Preference::Steps), (8, 7));
        assert_eq!(route(Preference::StepsAndTurns), (10, 3));
        assert_eq!(route(Preference::Turns), (12, 2));
    }
}
