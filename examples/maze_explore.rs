//! Recursive exploration (book, sections 9.5 to 9.7): a robot with three distance sensors explores a whole
//! maze, counts steps to the goal by flood fill, and drives the shortest way there.
//!
//! `cargo run --release --example maze_explore`

use roverlab::geometry::units;
use roverlab::io::sim::{NoiseModel, SimOptions, Simulation};
use roverlab::kinematics::OdometryErrors;
use roverlab::maze::{
    Maze, MazeRunner, MazeRunnerParameters, Preference, RecursiveExplorer, Rig, Scale, Unknown,
    distances_to_goal, files, shortest_route,
};
use roverlab::picture::{Mark, Picture, Style};
use roverlab::world::{RobotSpec, Scene};

const MAZE: &str = "\
o---o---o---o---o---o
|           |       |
o   o---o   o   o   o
|   |   |       |   |
o   o   o---o---o   o
|   |           | G |
o   o---o---o   o---o
|           |       |
o   o---o   o---o   o
| S |               |
o---o---o---o---o---o
";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let maze = files::parse(MAZE.as_bytes(), "the lesson's maze")?.maze;
    let (scale, spec, noise) = (Scale::DOUBLED, RobotSpec::s4(), NoiseModel::real());
    let start = scale.pose(maze.start(), maze.heading());
    let scene = Scene::with_robot(scale.world(&maze), spec.clone(), start);
    let options = SimOptions { trail_interval: Some(0.1), ..SimOptions::with_noise(1.0, 1) };
    let simulation = Simulation::new(&scene, options)?;
    let mut robot = simulation.robot(0)?;

    // The robot is told the size of the maze, its start and its goal, but no wall.
    let mut known = Maze::unexplored(maze.width(), maze.height())?;
    known.set_start(maze.start(), maze.heading());
    known.set_goals(maze.goals());
    let NoiseModel { wheel_scale, wheel_mismatch, track, slip, .. } = noise;
    let rig = Rig::new(&spec, OdometryErrors { wheel_scale, wheel_mismatch, track, slip }, noise.range)?;
    let mut runner = MazeRunner::new(&mut robot, rig, known, scale, MazeRunnerParameters::EYEBOT, 1200.0)?;
    let found = runner.explore(&mut RecursiveExplorer::new(), &mut |_| {})?;
    println!("explored {} of {} cells in {:.0} s", found.visited, maze.cell_count(), found.time);
    let explored = simulation.truth().robot(0)?.trail.len();

    let route =
        shortest_route(runner.maze(), Unknown::Closed, Preference::Steps).ok_or("no way to the goal")?;
    println!("the shortest way has {} steps and {} turns", route.steps(), route.turns());
    runner.go_to(route.end(), &mut |_| {})?;
    // On the true maze, flood fill counts as many steps: the robot's map is right where it matters.
    let steps = distances_to_goal(&maze, Unknown::Closed).get(maze.start());
    assert_eq!(steps, Some(route.steps() as u32));

    let truth = simulation.truth().robot(0)?;
    let off = units::to_mm(truth.pose.distance_to(scale.centre(route.end())));
    println!("at the goal, {off:.0} mm from the middle of its cell");
    assert!(truth.contacts == 0 && off < 50.0);

    let path: Vec<_> = truth.trail.iter().map(|point| point.pose.position()).collect();
    let mut picture = Picture::new(&scene.world);
    picture
        .title("Exploration, and the shortest way")
        .line(path[..explored].to_vec(), Style::aid().width(1.6));
    picture.true_path(path[explored - 1..].to_vec()).robot(truth.pose, &spec.footprint);
    picture.mark(Mark::Start, start.position()).mark(Mark::Goal, scale.centre(route.end()));
    picture.save("target/pictures/maze_explore.svg")?;
    Ok(())
}
