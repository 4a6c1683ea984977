//! Micromouse (book, chapter 9): a mouse explores a maze until no unknown wall can hide a better way, and
//! then drives the proven fastest run, with smooth turns and along diagonals.
//!
//! `cargo run --release --example micromouse`

use roverlab::geometry::units;
use roverlab::io::sim::{NoiseModel, SimOptions, Simulation};
use roverlab::kinematics::OdometryErrors;
use roverlab::maze::{
    ExplorationOutcome, Goals, Maze, MazeRunner, MazeRunnerParameters, Rig, Scale, TwoPhaseExplorer, Unknown,
    files, mouse,
};
use roverlab::picture::{Mark, Picture, Style};
use roverlab::world::Scene;

const MAZE: &str = "\
o---o---o---o---o---o---o---o---o
|           |               |   |
o   o---o   o   o---o---o   o   o
|   |       |       |       |   |
o   o   o---o---o   o   o---o   o
|   |   |           |           |
o   o   o   o---o---o---o---o   o
|   |   |   | G   G |       |   |
o   o   o   o       o   o   o   o
|   |   |     G   G |   |       |
o   o   o---o---o---o   o---o   o
|   |           |       |       |
o   o---o---o   o   o---o   o---o
|           |       |           |
o   o---o   o---o---o   o---o   o
| S |                   |       |
o---o---o---o---o---o---o---o---o
";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let maze = files::parse(MAZE.as_bytes(), "the lesson's maze")?.maze;
    let (scale, spec, noise) = (Scale::MICROMOUSE, mouse(), NoiseModel::real());
    let start = scale.pose(maze.start(), maze.heading());
    let scene = Scene::with_robot(scale.world(&maze), spec.clone(), start);
    let options = SimOptions { trail_interval: Some(0.02), ..SimOptions::with_noise(1.0, 1) };
    let simulation = Simulation::new(&scene, options)?;
    let mut robot = simulation.robot(0)?;

    let mut known = Maze::unexplored(maze.width(), maze.height())?;
    known.set_start(maze.start(), maze.heading());
    known.set_goals(maze.goals());
    let NoiseModel { wheel_scale, wheel_mismatch, track, slip, .. } = noise;
    let rig = Rig::new(&spec, OdometryErrors { wheel_scale, wheel_mismatch, track, slip }, noise.range)?;
    let mut runner =
        MazeRunner::new(&mut robot, rig, known, scale, MazeRunnerParameters::MICROMOUSE, 1200.0)?;
    let mut explorer = TwoPhaseExplorer::new(Goals::StepsAndTime(Box::new(runner.planner())));
    let found = runner.explore(&mut explorer, &mut |_| {})?;
    let (seconds, unknown) = (found.time, runner.maze().unknown_walls());
    println!("{:?} after {} of {} cells and {seconds:.0} s", found.verdict, found.visited, maze.cell_count());
    println!("{unknown} walls are unknown still, and none of them matters.");
    let explored = simulation.truth().robot(0)?.trail.len();

    let plan = runner.plan_fast_run().ok_or("no way to the goal")?;
    // Who knew the whole maze could not plan a faster run.
    let best = runner.planner().plan(&maze, Unknown::Closed).ok_or("no way to the goal")?;
    let raced = runner.race(&plan, &mut |_| {})?;
    println!("fast run: {} steps, planned {:.2} s, driven {raced:.2} s", plan.route.steps(), plan.time);
    let truth = simulation.truth().robot(0)?;
    let off = units::to_mm(truth.pose.distance_to(scale.centre(plan.route.end())));
    println!("The mouse stands {off:.0} mm from the middle of a goal cell.");
    assert!(found.verdict == ExplorationOutcome::Optimal && (plan.time - best.time).abs() < 1e-5);
    assert!(truth.contacts == 0 && off < 30.0);

    let path: Vec<_> = truth.trail.iter().map(|point| point.pose.position()).collect();
    let mut picture = Picture::new(&scene.world);
    picture.title("Exploration, and the fast run").line(path[..explored].to_vec(), Style::aid().width(1.6));
    picture.true_path(path[explored - 1..].to_vec()).mark(Mark::Start, start.position());
    picture.robot(truth.pose, &spec.footprint).mark(Mark::Goal, scale.centre(plan.route.end()));
    picture.save("target/pictures/micromouse.svg")?;
    Ok(())
}
