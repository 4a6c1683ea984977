use super::{ExplorationOutcome, ExplorationStep, Explorer};
use crate::maze::{
    Cell, Direction, Distances, FastPlanner, FloodFill, Maze, Passages, Preference, Route, Unknown,
    WallState, shortest_route,
};

/// Claim that the exploration has to prove.
#[derive(Debug, Clone)]
pub enum Goals {
    /// The route with the fewest steps.
    Steps,
    /// The route with the fewest steps, and the fastest one for a robot.
    StepsAndTime(Box<FastPlanner>),
}

/// Two-phase search, as used by modern micromice: first to the goal by the shortest possible route, then only
/// to unknown walls that could improve the best route, and back to the start.
///
/// The best route is proved when it is equally good with all unknown walls present and with all absent. Until
/// then, the best possible route crosses unknown walls, and the robot looks at the nearest of them. Each look
/// reveals at least one of them, so the search ends.
///
/// ```
/// use roverlab::maze::generate::competition;
/// use roverlab::maze::{
///     Direction, ExplorationOutcome, ExplorationStep, Explorer, Goals, Maze, TwoPhaseExplorer,
/// };
/// let truth = competition(8, 1)?;
/// let mut known = Maze::unexplored(8, 8)?;
/// let mut explorer = TwoPhaseExplorer::new(Goals::Steps);
/// let mut at = (known.start(), known.heading());
/// let outcome = loop {
///     Direction::ALL.map(|side| known.set_wall(at.0, side, truth.wall(at.0, side)));
///     match explorer.next(&known, at) {
///         ExplorationStep::Go(cell) => at.0 = cell,
///         ExplorationStep::Finished(outcome) => break outcome,
///     }
/// };
/// assert_eq!(outcome, ExplorationOutcome::Optimal);
/// assert!(known.unknown_walls() > 0, "some walls need not be seen");
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone)]
pub struct TwoPhaseExplorer {
    goals: Goals,
    reached: bool,
    verdict: Option<ExplorationOutcome>,
    flood: FloodFill,
}

impl TwoPhaseExplorer {
    /// A search that proves `goals`.
    pub fn new(goals: Goals) -> Self {
        Self { goals, reached: false, verdict: None, flood: FloodFill::default() }
    }

    /// Result proved so far.
    pub fn verdict(&self) -> Option<ExplorationOutcome> {
        self.verdict
    }

    /// First phase: the next cell to look around in, on the shortest possible route to the goal.
    fn seek(&mut self, maze: &Maze, cell: Cell) -> Option<ExplorationStep> {
        if maze.is_goal(cell) {
            self.reached = true;
            return None;
        }
        let to_goal = self.distances(maze, maze.goals().collect());
        if to_goal.get(cell).is_none() {
            self.reached = true;
            self.verdict = Some(ExplorationOutcome::Unreachable);
            return None;
        }
        Some(ExplorationStep::Go(descend(maze, &to_goal, cell)))
    }

    /// Steps to a set of cells; unknown walls count as open.
    fn distances(&mut self, maze: &Maze, cells: Vec<Cell>) -> Distances {
        self.flood.run(&Passages::new(maze, Unknown::Open), cells).clone()
    }

    /// A possible route that is better than the best certain one; `None` if the best is proved.
    fn doubtful(&mut self, maze: &Maze) -> Option<Route> {
        let route = |unknown| shortest_route(maze, unknown, Preference::Steps);
        let steps = |route: &Option<Route>| route.as_ref().map(Route::steps);
        let possible = route(Unknown::Open);
        if steps(&possible) != steps(&route(Unknown::Closed)) {
            return possible;
        }
        let Goals::StepsAndTime(planner) = &mut self.goals else { return None };
        let possible = planner.plan(maze, Unknown::Open)?;
        let sure = planner.plan(maze, Unknown::Closed);
        let proved = sure.is_some_and(|sure| sure.time <= possible.time + TIE);
        if proved { None } else { Some(possible.route) }
    }

    /// Second phase: the nearest cell from which an unknown wall of an unproved route is visible.
    fn prove(&mut self, maze: &Maze, cell: Cell) -> Option<ExplorationStep> {
        let Some(route) = self.doubtful(maze) else {
            let sure = shortest_route(maze, Unknown::Closed, Preference::Steps);
            self.verdict = Some(if sure.is_some() {
                ExplorationOutcome::Optimal
            } else {
                ExplorationOutcome::Unreachable
            });
            return None;
        };
        let mut flood = FloodFill::default();
        let near = flood.run(&Passages::new(maze, Unknown::Closed), [cell]);
        let nearest = vantages(maze, &route).filter_map(|cell| Some((near.get(cell)?, cell))).min();
        // The first unknown wall of the route is always reachable.
        nearest.map(|(_, cell)| ExplorationStep::Go(cell))
    }
}

/// Difference below which two runs count as equally fast (s): the rounding error of planning.
const TIE: f64 = 5e-4;

/// Cells on either side of the unknown walls of a route.
fn vantages<'a>(maze: &'a Maze, route: &'a Route) -> impl Iterator<Item = Cell> + 'a {
    let unknown = move |&(cell, side): &(Cell, Direction)| maze.wall(cell, side) == WallState::Unknown;
    let walls = route.cells().zip(route.moves().iter().copied()).filter(unknown);
    walls.flat_map(move |(cell, side)| [Some(cell), maze.neighbour(cell, side)]).flatten()
}

/// Descends along distances through walls known to be absent, up to the first cell with an unknown wall.
fn descend(maze: &Maze, distances: &Distances, from: Cell) -> Cell {
    let mut cell = from;
    loop {
        let here = distances.get(cell);
        let nearer = |next: &Cell| distances.get(*next).is_some_and(|steps| here > Some(steps));
        let sides = Direction::ALL.into_iter();
        let next = sides.filter_map(|side| maze.passage(cell, side, Unknown::Closed)).find(nearer);
        match next {
            Some(next) => cell = next,
            None => return cell,
        }
        if !maze.is_known(cell) || maze.is_goal(cell) {
            return cell;
        }
    }
}

impl Explorer for TwoPhaseExplorer {
    fn next(&mut self, maze: &Maze, (cell, _): (Cell, Direction)) -> ExplorationStep {
        if !self.reached
            && let Some(step) = self.seek(maze, cell)
        {
            return step;
        }
        if self.verdict.is_none()
            && let Some(step) = self.prove(maze, cell)
        {
            return step;
        }
        match self.verdict {
            Some(verdict) if cell == maze.start() => ExplorationStep::Finished(verdict),
            _ => ExplorationStep::Go(maze.start()),
        }
    }
}
