use roverlab::maze::files::MazeFile;
use roverlab::maze::{
    Cell, Direction, Maze, Preference, Route, Unknown, distances_from_start, shortest_route,
};

use super::{Args, picture, scene};
use crate::common::{Failure, Outcome, Report};

/// Plans the route through a maze.
pub(crate) fn plan(args: &Args) -> Result<Report, Failure> {
    let file = scene::maze(args)?;
    // Turns are counted for a robot that faces north, like the reference answers.
    let mut maze = file.maze.clone();
    maze.set_start(maze.start(), Direction::North);
    let best = |preference| shortest_route(&maze, Unknown::Closed, preference);
    let (short, straight) = (best(Preference::Steps), best(Preference::Turns));
    let outcome = Outcome::verdict(if short.is_some() { "planned" } else { "unreachable" });
    for defect in &file.defects {
        args.common.tell(format_args!("defect: {defect}"));
    }
    let report = with_maze(Report::new(outcome), args, &file);
    let report = with_routes(report, short.as_ref(), straight.as_ref());
    let draw = || picture::of_plan(&file, short.as_ref(), straight.as_ref());
    Ok(args.common.draw(report, "micromouse.svg", draw))
}

/// Adds the content of the maze file.
pub(crate) fn with_maze(report: Report, args: &Args, file: &MazeFile) -> Report {
    let maze = &file.maze;
    report
        .field("maze", args.maze.as_ref().or(args.common.world.as_ref()))
        .field("format", scene::name(file.format))
        .field("width", maze.width())
        .field("height", maze.height())
        .field("start", pair(maze.start()))
        .field("start_heading", maze.heading().to_string())
        .field("goals", maze.goals().map(pair).collect::<Vec<_>>())
        .field("defects", file.defects.iter().map(ToString::to_string).collect::<Vec<_>>())
        .field("reachable_cells", reachable(maze))
}

fn with_routes(report: Report, short: Option<&Route>, straight: Option<&Route>) -> Report {
    let number = |value: Option<usize>| value.map_or(-1, |value| value as i64);
    let letters =
        |route: &Route| route.moves().iter().map(|direction| direction.letter()).collect::<String>();
    report
        .field("shortest_steps", number(short.map(Route::steps)))
        .field("min_turns", number(short.map(Route::turns)))
        .field("fewest_turns", number(straight.map(Route::turns)))
        .field("fewest_turns_steps", number(straight.map(Route::steps)))
        .field("route", short.map(letters))
}

fn reachable(maze: &Maze) -> usize {
    distances_from_start(maze, Unknown::Closed).reached()
}

fn pair(cell: Cell) -> [u16; 2] {
    [cell.x, cell.y]
}
