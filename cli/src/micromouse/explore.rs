use std::cell::Cell;

use roverlab::geometry::Pose;
use roverlab::io;
use roverlab::io::sim::NoiseModel;
use roverlab::maze::files::MazeFile;
use roverlab::maze::{
    Exploration, ExplorationOutcome, FastPlan, Goals, Maze, MazeRunner, MazeRunnerParameters, Rig, Scale,
    TwoPhaseExplorer, mouse,
};
use roverlab::picture::{Figure, Picture, SERIES, Style};
use roverlab::world::{RobotSpec, Scene};

use super::plan::with_maze;
use super::{Args, picture, scene};
use crate::common::{Driven, Failure, Outcome, Report, millimetres, rounded};
use crate::driving::{Conditions, Run, draw_contacts, paced};

/// The robot's result.
#[derive(Debug, Clone)]
pub(crate) struct Told {
    pub(crate) exploration: Exploration,
    /// The known maze.
    pub(crate) known: Maze,
    pub(crate) plan: Option<FastPlan>,
    /// Duration of the fast run (s).
    pub(crate) race: Option<f64>,
    /// Number of observed steps before the fast run.
    pub(crate) explored_steps: usize,
    /// Final pose estimate.
    pub(crate) pose: Pose,
}

/// The robot, and the maze at its scale.
pub(crate) fn kit(doubled: bool) -> (RobotSpec, Scale, MazeRunnerParameters) {
    if doubled {
        (RobotSpec::s4(), Scale::DOUBLED, MazeRunnerParameters::EYEBOT)
    } else {
        (mouse(), Scale::MICROMOUSE, MazeRunnerParameters::MICROMOUSE)
    }
}

/// Lets a robot explore a maze and race through it.
pub(crate) fn explore(args: &Args) -> Result<Report, Failure> {
    let file = scene::maze(args)?;
    let (spec, scale, _) = kit(args.doubled);
    for defect in &file.defects {
        args.common.tell(format_args!("defect: {defect}"));
    }
    let scene = stage(&file, &spec, scale);
    let conditions = Conditions::new(&args.common, limit(&file.maze))?;
    let mut told = None;
    let run = conditions.run(&scene, paced(&args.common), |robot, step| {
        drive(robot, args, &file.maze, &conditions, &mut told, step)
    })?;
    let told = told.as_ref();
    // A program that ends without an error has proved its maze.
    let report = run.report(|()| match told.and_then(|told| told.race) {
        Some(_) => Outcome::verdict("raced"),
        None => Outcome::verdict("unreachable"),
    });
    let report = with_maze(report, args, &file);
    let at_goal = goal_error(run.truth.pose, &file.maze, scale);
    let report = with_run(report, told, run.truth.pose, scale)
        .field("goal_error_mm", told.and_then(|told| told.race).map(|_| millimetres(at_goal)));
    Ok(args.common.draw(report, "micromouse.svg", || picture_of(&file, &run, told, (&spec, scale))))
}

/// Distance of a robot from the middle of the nearest goal cell (m).
pub(crate) fn goal_error(truth: Pose, maze: &Maze, scale: Scale) -> f64 {
    maze.goals().map(|goal| truth.distance_to(scale.centre(goal))).fold(f64::INFINITY, f64::min)
}

/// A time limit sufficient for any maze (s).
pub(crate) fn limit(maze: &Maze) -> f64 {
    600.0 + 40.0 * maze.cell_count() as f64
}

pub(crate) fn stage(file: &MazeFile, spec: &RobotSpec, scale: Scale) -> Scene {
    let start = scale.pose(file.maze.start(), file.maze.heading());
    Scene::with_robot(scale.world(&file.maze), spec.clone(), start)
}

/// The robot's program, which knows the maze's size, start and goal. Its result of the exploration remains
/// valid if the fast run fails.
pub(crate) fn drive(
    robot: &mut Driven,
    args: &Args,
    truth: &Maze,
    conditions: &Conditions,
    told: &mut Option<Told>,
    step: &mut dyn FnMut(),
) -> io::Result<()> {
    let (spec, scale, parameters) = kit(args.doubled);
    let rig =
        Rig::new(&spec, conditions.odometry_errors(), NoiseModel::real().scaled(conditions.noise).range)?;
    let mut known = Maze::unexplored(truth.width(), truth.height())
        .map_err(|error| io::Error::new(io::ErrorKind::InvalidInput, error.to_string()))?;
    known.set_start(truth.start(), truth.heading());
    known.set_goals(truth.goals());
    let steps = Cell::new(0);
    let mut watch = |_: Pose| {
        steps.set(steps.get() + 1);
        step();
    };
    let mut runner = MazeRunner::new(robot, rig, known, scale, parameters, conditions.time_limit)?;
    let mut explorer = TwoPhaseExplorer::new(Goals::StepsAndTime(Box::new(runner.planner())));
    let exploration = runner.explore(&mut explorer, &mut watch)?;
    let plan = runner.plan_fast_run();
    let (known, explored_steps, pose) = (runner.maze().clone(), steps.get(), runner.pose());
    let told = told.insert(Told { exploration, known, plan, race: None, explored_steps, pose });
    told.exploration.in_time()?;
    if let Some(plan) = &told.plan {
        let race = runner.race(plan, &mut watch);
        told.pose = runner.pose();
        told.race = Some(race?);
    }
    Ok(())
}

fn with_run(report: Report, told: Option<&Told>, truth: Pose, scale: Scale) -> Report {
    let proved = told.is_some_and(|told| {
        matches!(told.exploration.verdict, ExplorationOutcome::Optimal | ExplorationOutcome::Unreachable)
    });
    let seconds = |time: Option<f64>| time.map(rounded);
    let error = told.map(|told| truth.distance_to(told.pose.position()));
    report
        .field("proved_optimal", proved)
        .field("visited_cells", told.map(|told| told.exploration.visited))
        .field("looks", told.map(|told| told.exploration.looks))
        .field("unknown_walls", told.map(|told| told.known.unknown_walls()))
        .field("exploration_s", seconds(told.map(|told| told.exploration.time)))
        .field("fast_run_planned_s", seconds(told.and_then(|told| Some(told.plan.as_ref()?.time))))
        .field("fast_run_s", seconds(told.and_then(|told| told.race)))
        .field("fast_run_steps", told.and_then(|told| Some(told.plan.as_ref()?.route.steps())))
        .field("localisation_error_mm", error.map(millimetres))
        .field("cell_mm", millimetres(scale.cell))
}

fn picture_of(
    file: &MazeFile,
    run: &Run<()>,
    told: Option<&Told>,
    (spec, scale): (&RobotSpec, Scale),
) -> Picture {
    let split = told.map_or(run.trail.len(), |told| told.explored_steps.min(run.trail.len()));
    let mut picture = picture::of_maze(&file.maze, scale);
    let caption = match told.map(|told| (told, told.race)) {
        Some((told, _)) if told.exploration.verdict == ExplorationOutcome::TimedOut => {
            format!("the time is over; {} of {} cells seen", told.exploration.visited, file.maze.cell_count())
        }
        Some((told, Some(race))) => format!(
            "explored to the proof in {:.0} s and {} of {} cells; fast run {race:.2} s",
            told.exploration.time,
            told.exploration.visited,
            file.maze.cell_count()
        ),
        Some((Told { plan: Some(_), .. }, None)) => "explored to the proof; the fast run failed".into(),
        Some((told, None)) => format!("no way to the goal; {} cells seen", told.exploration.visited),
        None => "the drive failed".into(),
    };
    picture.title("Micromouse").caption(caption);
    picture::add_drive(&mut picture, &run.trail, split);
    let figure = Figure::Robot { poses: run.trail.clone(), footprint: spec.footprint };
    picture.add(figure, Style::new(SERIES[0]));
    draw_contacts(&mut picture, &run.truth.contact_places);
    picture
}
