use roverlab::geometry::Pose;
use roverlab::io::sim::NoiseModel;
use roverlab::maze::{
    Exploration, Maze, MazeRunner, MazeRunnerParameters, Preference, RecursiveExplorer, Rig, Route, Unknown,
    shortest_route,
};

use super::place::{Place, unexplored};
use crate::common::{CommonArgs, Failure, Outcome, Report, millimetres, rounded};
use crate::driving::{Conditions, paced};

/// Command line of `maze-explore`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Explores a whole maze by recursion, then drives to the goal by the shortest way and back",
    after_help = "\
--world accepts a maze in any format (EyeSim's .maz, the micromouse text format, .maze, map, num), including the start.
Cells are 360 mm wide for an S4, as in the book, or 180 mm with --micromouse.

JSON fields:
  width, height               cells
  early_marking               whether cells known on all sides are skipped
  visited_cells, looks        visited cells, and stops for measurements
  unknown_walls               walls that remain unknown because they are inaccessible
  wrong_walls                 walls with a wrong result
  exploration_s               simulated seconds until the return to the start
  steps                       steps of the shortest path to the goal; null without one
  at_goal                     whether it was truly there
  localisation_error_mm       final true error of the robot's position estimate
  picture                     always
Outcomes: returned, unreachable, missed, timed_out, collided, failed."
)]
pub(crate) struct ExploreArgs {
    /// Enter every cell, even those known on all sides.
    #[arg(long)]
    pub(crate) thorough: bool,

    /// Use a micromouse in a maze of competition size.
    #[arg(long)]
    pub(crate) micromouse: bool,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(ExploreArgs, common: CommonArgs);

/// The robot's result.
#[derive(Debug, Clone)]
struct Told {
    exploration: Exploration,
    known: Maze,
    route: Option<Route>,
    at_goal: bool,
    pose: Pose,
}

/// The command's work.
pub(crate) fn work(args: &ExploreArgs) -> Result<Report, Failure> {
    args.common.check_picture()?;
    let place = Place::new(&args.common, args.micromouse)?;
    let maze = place.maze();
    let conditions = Conditions::new(&args.common, 600.0 + 40.0 * maze.cell_count() as f64)?;
    let parameters =
        if args.micromouse { MazeRunnerParameters::MICROMOUSE } else { MazeRunnerParameters::EYEBOT };
    let run = conditions.run_watched(&place.scene(), paced(&args.common), |robot, step| {
        let range = NoiseModel::real().scaled(conditions.noise).range;
        let rig = Rig::new(&place.spec, conditions.odometry_errors(), range)?;
        let mut truth = None;
        let mut watch = |_: Pose| truth = Some(step());
        let mut runner =
            MazeRunner::new(robot, rig, unexplored(maze)?, place.scale, parameters, conditions.time_limit)?;
        let mut explorer =
            if args.thorough { RecursiveExplorer::without_early_marking() } else { RecursiveExplorer::new() };
        let exploration = runner.explore(&mut explorer, &mut watch)?;
        exploration.in_time()?;
        let route = shortest_route(runner.maze(), Unknown::Closed, Preference::Steps);
        if let Some(route) = &route {
            runner.go_to(route.end(), &mut watch)?;
        }
        let at_goal = truth.is_some_and(|pose| place.is_at_goal(pose.position()));
        let mut watch = |_: Pose| {
            step();
        };
        runner.go_to(maze.start(), &mut watch)?;
        runner.face(maze.heading(), &mut watch)?;
        Ok(Told { exploration, known: runner.maze().clone(), route, at_goal, pose: runner.pose() })
    })?;
    let told = run.ending.as_ref().ok();
    let report = run.report(|told| match (&told.route, told.at_goal) {
        (None, _) => Outcome::verdict("unreachable"),
        (Some(_), true) => Outcome::verdict("returned"),
        (Some(_), false) => Outcome::failure("missed"),
    });
    let lost = told.map(|told| run.truth.pose.distance_to(told.pose.position()));
    let report = report
        .field("width", maze.width())
        .field("height", maze.height())
        .field("early_marking", !args.thorough)
        .field("visited_cells", told.map(|told| told.exploration.visited))
        .field("looks", told.map(|told| told.exploration.looks))
        .field("unknown_walls", told.map(|told| told.known.unknown_walls()))
        .field("wrong_walls", told.map(|told| wrong_walls(&told.known, maze)))
        .field("exploration_s", told.map(|told| rounded(told.exploration.time)))
        .field("steps", told.and_then(|told| told.route.as_ref().map(Route::steps)))
        .field("at_goal", told.is_some_and(|told| told.at_goal))
        .field("localisation_error_mm", lost.map(millimetres));
    Ok(args.common.draw(report, "maze_explore.svg", || {
        let caption = told.map_or(String::new(), |told| {
            let Exploration { visited, looks, time, .. } = told.exploration;
            format!("{visited} of {} cells visited, {looks} looks, {time:.0} s", maze.cell_count())
        });
        place.picture_of("Recursive exploration", caption, &run)
    }))
}

fn wrong_walls(known: &Maze, truth: &Maze) -> usize {
    use roverlab::maze::{Direction, WallState};
    let sides = truth.cells().flat_map(|cell| Direction::ALL.map(|side| (cell, side)));
    let wrong = |&(cell, side): &(_, _)| {
        let wall = known.wall(cell, side);
        wall != WallState::Unknown
            && (wall == WallState::Present) != (truth.wall(cell, side) != WallState::Absent)
    };
    sides.filter(wrong).count()
}
