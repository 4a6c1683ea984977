//! A maze by lidar (book, section 9.4): the robot follows the left wall by the shortest beam to its left,
//! turns right where a wall is ahead, and draws a map of what it saw where odometry has it.
//!
//! `cargo run --release --example maze_lidar`

use roverlab::geometry::units;
use roverlab::io::control::{Halt, run, until};
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::maze::{LidarLeft, LidarLeftParameters, Scale, files};
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
    let scale = Scale::DOUBLED;
    let start = scale.pose(maze.start(), maze.heading());
    let goal = scale.centre(maze.goals().next().ok_or("the maze has no goal")?);
    let scene = Scene::with_robot(scale.world(&maze), RobotSpec::s4(), start);
    let options = SimOptions { trail_interval: Some(0.1), ..SimOptions::with_noise(1.0, 1) };
    let simulation = Simulation::new(&scene, options)?;
    let truth = simulation.truth();

    let mut follower = LidarLeft::new(LidarLeftParameters::for_corridor(scale.cell - scale.wall))?;
    let (mut map, mut scans) = (Vec::new(), 0);
    let outcome = run(&mut simulation.robot(0)?, &mut follower, 300.0, |_, _, step| {
        // One scan in twenty is enough for a map. Odometry begins at the robot's start.
        if scans % 20 == 0 {
            map.extend(step.seen.points().map(|point| start.to_world(point)));
        }
        scans += 1;
        // The referee stops the robot at the goal.
        until(truth.pose(0).is_ok_and(|pose| pose.distance_to(goal) < 0.1))
    })?;
    assert_eq!(outcome, Halt::Stopped);

    let end = truth.robot(0)?;
    let to_walls = |point| {
        let distances =
            scene.world.walls.iter().map(|wall| wall.line.distance_to(point) - 0.5 * wall.thickness);
        distances.fold(f64::INFINITY, f64::min).max(0.0)
    };
    let error = units::to_mm(map.iter().map(|&point| to_walls(point)).sum::<f64>() / map.len() as f64);
    println!("at the goal after {:.1} m and {:.0} s", end.path_length, truth.time());
    println!("The map has {} points, {error:.0} mm from the walls in the mean.", map.len());
    assert!(end.pose.distance_to(goal) < 0.15 && end.contacts == 0);
    assert!(error < 60.0);

    let mut picture = Picture::new(&scene.world);
    picture.title("Left wall by lidar, and a map by odometry").points(map, Style::lidar().labelled("map"));
    picture.true_path(end.trail.iter().map(|point| point.pose.position()));
    picture.mark(Mark::Start, start.position()).mark(Mark::Goal, goal);
    picture.robot(end.pose, &RobotSpec::s4().footprint);
    picture.save("target/pictures/maze_lidar.svg")?;
    Ok(())
}
