//! A swarm (book, chapter 5): a LabBot leads round a hall, and four S4s follow in a chain, each the robot
//! before it, by what their lidars see.
//!
//! `cargo run --release --example follow_me`

use std::ops::ControlFlow;
use std::sync::Arc;

use roverlab::drive::{
    Cruise, CruiseParameters, Follower, FollowerObservation, FollowerParameters, robots_in,
};
use roverlab::geometry::{Point, Pose};
use roverlab::io::sim::{Fleet, SimOptions};
use roverlab::io::{Clock, Drive, Lidar, Odometry};
use roverlab::picture::{Picture, Style};
use roverlab::world::{RobotPlacement, RobotSpec, Scene, World};

const GAP: f64 = 0.36;
const PERIOD: f64 = 0.1;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let start = Pose::new(3.0, 1.2, 0.0);
    let mut scene = Scene::new(World::walled(6.0, 4.5));
    scene.robots.push(RobotPlacement::new(Arc::new(RobotSpec::labbot()), start));
    let spec = Arc::new(RobotSpec::s4());
    for follower in 1..=4 {
        let place = start.to_world(Point::new(-GAP * f64::from(follower) - 0.05, 0.0));
        scene.robots.push(RobotPlacement::new(Arc::clone(&spec), Pose::new(place.x, place.y, 0.0)));
    }

    let options = SimOptions { trail_interval: Some(PERIOD), ..SimOptions::with_noise(1.0, 1) };
    let mut fleet = Fleet::new(&scene, options)?;
    let round = [(4.7, 1.3), (4.7, 3.2), (3.0, 2.9), (1.3, 3.2), (1.3, 1.5), (3.0, 1.6)];
    let waypoints = round.iter().map(|&(x, y)| start.to_local(Point::new(x, y))).collect();
    let mut leader = Cruise::new(waypoints, CruiseParameters::default())?;
    fleet.control(0, PERIOD, move |robot| {
        // What is behind the leader follows it and is no obstacle.
        let ahead: Vec<Point> = robot.scan()?.points().filter(|point| point.x > -0.05).collect();
        let twist = leader.step(robot.pose()?, &ahead)?;
        robot.set_speed(twist)?;
        Ok(ControlFlow::Continue(()))
    })?;
    for follower in 1..scene.robots.len() {
        let leader_radius = scene.robots[follower - 1].spec.footprint.bounding_radius();
        let parameters = FollowerParameters { gap: GAP, leader_radius, ..FollowerParameters::default() };
        let mut behaviour = Follower::new(parameters)?;
        fleet.control(follower, PERIOD, move |robot| {
            let (time, pose, scan) = (robot.now()?, robot.pose()?, robot.scan()?);
            scan.validate()?;
            // Things of its size may be the robot ahead; the follower tracks the one that moves as expected.
            let candidates = robots_in(&scan, leader_radius);
            let obstacles: Vec<Point> = scan.points().collect();
            let seen = FollowerObservation { time, pose, candidates: &candidates, obstacles: &obstacles };
            let twist = behaviour.step(&seen)?;
            robot.set_speed(twist)?;
            Ok(ControlFlow::Continue(()))
        })?;
    }
    fleet.run_for(90.0)?;

    let mut picture = Picture::new(&scene.world);
    picture.title("A leader and a chain of four followers");
    for (index, robot) in scene.robots.iter().enumerate() {
        let truth = fleet.truth(index)?;
        picture.line(truth.trail.iter().map(|point| point.pose.position()), Style::aid());
        picture.robot(truth.pose, &robot.spec.footprint);
        assert_eq!(truth.contacts, 0, "robot {index}");
        if index == 0 {
            println!("the leader drove {:.1} m in {:.0} s", truth.path_length, fleet.time());
            continue;
        }
        let gap = truth.pose.distance_to(fleet.truth(index - 1)?.pose.position());
        println!(
            "follower {index} drove {:.1} m and is {gap:.2} m behind robot {}",
            truth.path_length,
            index - 1
        );
        assert!((gap - GAP).abs() < 0.2, "follower {index}");
    }
    picture.save("target/pictures/follow_me.svg")?;
    Ok(())
}
