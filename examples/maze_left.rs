//! The left hand on the wall (book, sections 9.2 and 9.3): a robot with three distance sensors finds the goal
//! of a maze. At every cell it turns left where that is free, else drives straight on, else right, else back.
//!
//! `cargo run --release --example maze_left`

use roverlab::geometry::units;
use roverlab::io::control::{run, until};
use roverlab::io::sim::{NoiseModel, SimOptions, Simulation};
use roverlab::kinematics::OdometryErrors;
use roverlab::maze::{CellDriveParameters, LeftHand, LeftHandOutcome, LeftHandParameters, Rig, Scale, files};
use roverlab::picture::{Mark, Picture};
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
    // Twice as large as for a micromouse: cells of 36 cm, in which the S4 has room.
    let (scale, spec, noise) = (Scale::DOUBLED, RobotSpec::s4(), NoiseModel::real());
    let start = scale.pose(maze.start(), maze.heading());
    let scene = Scene::with_robot(scale.world(&maze), spec.clone(), start);
    let options = SimOptions { trail_interval: Some(0.1), ..SimOptions::with_noise(1.0, 1) };
    let simulation = Simulation::new(&scene, options)?;

    // A PID controller keeps the robot in the middle between the walls while it drives from cell to cell.
    let NoiseModel { wheel_scale, wheel_mismatch, track, slip, .. } = noise;
    let rig = Rig::new(&spec, OdometryErrors { wheel_scale, wheel_mismatch, track, slip }, noise.range)?;
    let drive = CellDriveParameters::pid(&rig, scale, 0.5 * scale.cell);
    let mut rule = LeftHand::new(LeftHandParameters::controlled(drive), maze.heading())?;
    let goal = maze.goals().next().ok_or("the maze has no goal")?;
    let (east, north) =
        (i32::from(goal.x) - i32::from(maze.start().x), i32::from(goal.y) - i32::from(maze.start().y));
    let mut robot = simulation.robot(0)?;
    let outcome = run(&mut robot, &mut rule, 600.0, |_, rule, _| until(rule.at() == (east, north)))?;

    let truth = simulation.truth().robot(0)?;
    let (off, time) = (units::to_mm(truth.pose.distance_to(scale.centre(goal))), simulation.truth().time());
    println!("{outcome:?} after {} cells, {:.1} m and {time:.0} s", rule.cells(), truth.path_length);
    println!("The robot stands {off:.0} mm from the middle of the goal.");
    assert_eq!((outcome, truth.contacts), (LeftHandOutcome::Stopped, 0));
    assert!(off < 0.25 * units::to_mm(scale.cell));

    let mut picture = Picture::new(&scene.world);
    picture.title("Left hand on the wall").true_path(truth.trail.iter().map(|point| point.pose.position()));
    picture.mark(Mark::Start, start.position()).mark(Mark::Goal, scale.centre(goal));
    picture.robot(truth.pose, &spec.footprint);
    picture.save("target/pictures/maze_left.svg")?;
    Ok(())
}
