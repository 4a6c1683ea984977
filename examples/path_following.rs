//! Path following (book, section 3.6 and after): a smooth path through waypoints, driven by two steering
//! laws. Pure pursuit aims at a point ahead and cuts corners; the cross-track law steers by the path's own
//! curvature and stays on it.
//!
//! `cargo run --release --example path_following`

use roverlab::drive::{Path, PathFollower, PathFollowerParameters, Steering, Waypoint};
use roverlab::geometry::{Point, Twist, units};
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::io::{Clock, Drive, Odometry};
use roverlab::picture::{Mark, Picture, SERIES, Style};
use roverlab::world::{RobotSpec, Scene, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let corners =
        [(0.4, 0.4), (1.3, 0.5), (1.7, 1.0), (1.3, 1.5), (1.5, 2.1), (2.3, 2.0), (2.6, 1.2), (2.2, 0.4)];
    let waypoints = corners.map(|(x, y)| Waypoint { position: Point::new(x, y), heading: None });
    let path = Path::through(&waypoints)?;
    let start = path.start();
    let scene = Scene::with_robot(World::walled(3.0, 2.5), RobotSpec::s4(), start);
    let tightest = 1.0 / path.max_curvature();
    println!("{:.2} m of path, whose tightest bend has a radius of {tightest:.2} m", path.length());

    let mut picture = Picture::new(&scene.world);
    picture
        .title("One path, two steering laws")
        .line(path.points().iter().map(|p| p.pose.position()), Style::plan());
    for waypoint in &waypoints {
        picture.mark(Mark::Waypoint, waypoint.position);
    }
    let laws = [
        ("pure pursuit", Steering::PurePursuit { lookahead: 0.3 }),
        ("cross-track", Steering::CrossTrack { reach: 0.08 }),
    ];
    let mut worst = [0.0_f64; 2];
    for (index, (name, steering)) in laws.into_iter().enumerate() {
        let options = SimOptions { trail_interval: Some(0.05), ..SimOptions::ideal() };
        let simulation = Simulation::new(&scene, options)?;
        let mut robot = simulation.robot(0)?;
        // From now on odometry speaks of the world, as the path does.
        robot.set_pose(start)?;
        let parameters = PathFollowerParameters { steering, ..PathFollowerParameters::default() };
        let mut follower = PathFollower::new(path.clone(), parameters)?;
        while follower.rest() > 0.01 {
            let twist = follower.step(robot.pose()?);
            worst[index] = worst[index].max(follower.cross_track_error().abs());
            robot.set_speed(twist)?;
            robot.wait(0.05)?;
        }
        robot.set_speed(Twist::STOP)?;
        let truth = simulation.truth().robot(0)?;
        let (time, off) = (simulation.truth().time(), units::to_mm(worst[index]));
        println!("{name:13} {time:.1} s, at most {off:.0} mm beside the path");
        assert!(truth.contacts == 0 && truth.pose.distance_to(path.end().position()) < 0.03);
        let style = Style::new(SERIES[2 * index]).labelled(name);
        picture.line(truth.trail.iter().map(|point| point.pose.position()), style);
    }
    assert!(worst[1] < 0.02 && worst[0] > worst[1]);
    picture.save("target/pictures/path_following.svg")?;
    Ok(())
}
