//! Two robots with a program and a thread each (book, chapter 5): the first one drives past four places and
//! tells the second one by radio where it has been; the second one drives there. However the threads are
//! scheduled, the run is the same.
//!
//! `cargo run --release --example two_robots`

use std::sync::Arc;
use std::thread;

use roverlab::drive::{AToB, AToBParameters, Goal, Method};
use roverlab::geometry::{Point, Pose};
use roverlab::io::sim::{RobotTruth, SimOptions, SimRobot, Simulation};
use roverlab::io::{Clock, Radio, Result, control};
use roverlab::picture::{Mark, Picture};
use roverlab::world::{RobotPlacement, RobotSpec, Scene, World};

const PLACES: [(f64, f64); 4] = [(2.0, 0.5), (2.2, 1.6), (1.2, 1.3), (0.5, 1.7)];

fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    let starts = [Pose::new(1.0, 0.5, 0.0), Pose::new(0.4, 0.5, 0.0)];
    let spec = Arc::new(RobotSpec::s4());
    let mut scene = Scene::new(World::walled(2.6, 2.1));
    scene.robots.extend(starts.map(|pose| RobotPlacement::new(Arc::clone(&spec), pose)));
    let (truths, heard) = run(&scene, starts)?;
    // The same bits again, whatever the machine does beside.
    assert_eq!((truths.clone(), heard.clone()), run(&scene, starts)?);
    for (time, place) in heard {
        println!("{time:5.1} s: robot 1 hears that ({:.1}, {:.1}) m is free", place.x, place.y);
    }

    let mut picture = Picture::new(&scene.world);
    picture.title("One leads, one is told by radio");
    for (index, truth) in truths.iter().enumerate() {
        println!("robot {index} drove {:.2} m", truth.path_length);
        assert_eq!(truth.contacts, 0);
        picture.true_path(truth.trail.iter().map(|point| point.pose.position()));
        picture.robot(truth.pose, &spec.footprint).mark(Mark::Start, starts[index].position());
    }
    // The follower has reached the last place but one, where it was sent last.
    let (x, y) = PLACES[2];
    assert!(truths[1].pose.distance_to(Point::new(x, y)) < 0.1);
    picture.save("target/pictures/two_robots.svg")?;
    Ok(())
}

/// When the follower heard of which place.
type Heard = Vec<(f64, Point)>;

/// One run: what is true of both robots in the end, and what the follower heard.
fn run(scene: &Scene, starts: [Pose; 2]) -> Result<([RobotTruth; 2], Heard)> {
    let options = SimOptions { trail_interval: Some(0.1), ..SimOptions::with_noise(1.0, 1) };
    let simulation = Simulation::new(scene, options)?;
    // Both are taken before one drives: the world waits for every robot that has been taken.
    let (leader, follower) = (simulation.robot(0)?, simulation.robot(1)?);
    let heard = thread::scope(|scope| {
        let led = scope.spawn(|| lead(leader, starts[0]));
        let followed = scope.spawn(|| follow(follower, starts[1]));
        led.join().expect("the leader's thread does not panic")?;
        followed.join().expect("the follower's thread does not panic")
    })?;
    Ok(([simulation.truth().robot(0)?, simulation.truth().robot(1)?], heard))
}

fn lead(mut robot: SimRobot, start: Pose) -> Result<()> {
    for (number, (x, y)) in PLACES.into_iter().enumerate() {
        go_to(&mut robot, start, Point::new(x, y))?;
        // The place before this one is free now.
        if let Some((x, y)) = number.checked_sub(1).map(|before| PLACES[before]) {
            robot.send(2, format!("{x} {y}").as_bytes())?;
        }
    }
    robot.send(2, b"end")
}

fn follow(mut robot: SimRobot, start: Pose) -> Result<Heard> {
    let mut heard = Vec::new();
    loop {
        let Some(message) = robot.receive()? else {
            robot.wait(0.1)?;
            continue;
        };
        let text = String::from_utf8_lossy(&message.data);
        let numbers: Vec<f64> = text.split(' ').filter_map(|word| word.parse().ok()).collect();
        let [x, y] = numbers[..] else { return Ok(heard) };
        heard.push((robot.now()?, Point::new(x, y)));
        go_to(&mut robot, start, Point::new(x, y))?;
    }
}

/// Drives to a place in the world; odometry begins at the robot's own start.
fn go_to(robot: &mut SimRobot, start: Pose, place: Point) -> Result<()> {
    let goal = Goal::point(start.to_local(place));
    let mut drive = AToB::new(Method::Turn, goal, AToBParameters::default())?;
    control::run(robot, &mut drive, 60.0, |_, _, _| {}).map(|_| ())
}
