//! Wall following (book, chapter 6): a robot drives once round a generated room with curves and corners of
//! many angles, by three distance sensors, and by a lidar. The table says how well each keeps its distance of
//! 200 mm.
//!
//! `cargo run --release --example wall_following`

use roverlab::drive::{
    AlongWall, FollowsWalls, LidarWallFollower, LidarWallFollowerParameters, WallFollower,
    WallFollowerParameters, WallReading,
};
use roverlab::geometry::{Point, units};
use roverlab::io::Result;
use roverlab::io::control::{run, until};
use roverlab::io::sim::{RobotTruth, SimOptions, SimRobot, Simulation};
use roverlab::picture::{Mark, Picture, SERIES, Style};
use roverlab::random::Stream;
use roverlab::world::generate::{RoomOptions, room};
use roverlab::world::{RobotSpec, Scene, World};

fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    let room = room(&mut Stream::new(4), &RoomOptions::default())?;
    let scene = Scene::with_robot(room.world.clone(), RobotSpec::s4(), room.start);
    let mut picture = Picture::new(&room.world);
    picture
        .title("Once round a room, by distance sensors and by lidar")
        .mark(Mark::Start, room.start.position());

    let mut sensors = WallFollower::new(WallFollowerParameters::default())?;
    let mut lidar = LidarWallFollower::new(LidarWallFollowerParameters::default())?;
    let runs = [("distance sensors", walk(&scene, &mut sensors)?), ("lidar", walk(&scene, &mut lidar)?)];
    for (&colour, (name, truth)) in SERIES.iter().zip(runs) {
        let path: Vec<Point> = truth.trail.iter().map(|point| point.pose.position()).collect();
        let distances: Vec<f64> = path.iter().map(|&place| distance_to_wall(place, &room.world)).collect();
        // On its way to the wall the robot is farther away; that does not count.
        let near: Vec<f64> = distances.into_iter().skip_while(|&distance| distance > 0.22).collect();
        let mean = near.iter().sum::<f64>() / near.len() as f64;
        let [mean, least] = [mean, near.iter().copied().fold(mean, f64::min)].map(units::to_mm);
        let length = truth.path_length;
        println!(
            "{name:17} {length:.1} m, {mean:.0} mm from the wall in the mean, {least:.0} mm at the least"
        );
        assert!(truth.contacts == 0 && length > 4.0 && (180.0..230.0).contains(&mean), "{name}");
        picture.line(path, Style::new(colour).labelled(name));
    }
    picture.save("target/pictures/wall_following.svg")?;
    Ok(())
}

/// Follows the wall until the robot is back where it first drove along it.
fn walk<C>(scene: &Scene, controller: C) -> Result<RobotTruth>
where
    C: FollowsWalls<Observation: WallReading<SimRobot>>,
{
    let options = SimOptions { trail_interval: Some(0.1), ..SimOptions::with_noise(1.0, 1) };
    let simulation = Simulation::new(scene, options)?;
    let truth = simulation.truth();
    let (mut began, mut away) = (None, false);
    run(&mut simulation.robot(0)?, &mut AlongWall::new(controller), 300.0, |_, along, _| {
        let pose = truth.pose(0)?;
        if began.is_none() && along.controller.is_beside_wall() {
            began = Some(pose.position());
        }
        let distance = began.map_or(0.0, |began| pose.distance_to(began));
        away |= distance > 0.5;
        Result::Ok(until(away && distance < 0.1))
    })?;
    truth.robot(0)
}

fn distance_to_wall(place: Point, world: &World) -> f64 {
    let distances = world.walls.iter().map(|wall| wall.line.distance_to(place) - 0.5 * wall.thickness);
    distances.fold(f64::INFINITY, f64::min)
}
