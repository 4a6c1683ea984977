//! Navigation (book, section 10.3 and after): a robot plans its way with a map of three rooms. Two crates and
//! a wall are not in the map; the robot sees them, repairs its plan, and comes to its goal without touching
//! anything.
//!
//! `cargo run --release --example navigate`

use std::sync::Arc;

use roverlab::geometry::{Point, Pose, units};
use roverlab::io::control::run;
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::nav::{Navigator, NavigatorEvent, NavigatorOutcome, NavigatorParameters};
use roverlab::picture::{Mark, Picture, SERIES, Style};
use roverlab::world::{Object, ObjectKind, RobotSpec, Scene, Wall, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let wall = |(x1, y1), (x2, y2)| Wall::new(Point::new(x1, y1), Point::new(x2, y2));
    let mut known = World::walled(4.0, 3.0);
    known.walls.extend([
        wall((1.4, 0.0), (1.4, 0.5)),
        wall((1.4, 1.0), (1.4, 2.2)),
        wall((1.4, 2.6), (1.4, 3.0)),
        wall((2.7, 0.0), (2.7, 0.3)),
        wall((2.7, 0.7), (2.7, 1.9)),
        wall((2.7, 2.4), (2.7, 3.0)),
        wall((2.0, 1.0), (2.0, 2.0)),
    ]);
    let mut real = known.clone();
    real.walls.push(wall((2.7, 1.9), (2.7, 2.4)));
    let crates = Arc::new(ObjectKind::predefined("crate").ok_or("no such object")?);
    real.objects.push(Object::new(Arc::clone(&crates), Pose::new(0.9, 0.6, 0.3)));
    real.objects.push(Object::new(crates, Pose::new(3.3, 1.6, 0.8)));

    let (start, goal) = (Pose::new(0.4, 0.4, 0.0), Point::new(3.6, 2.6));
    let spec = RobotSpec::s4();
    let scene = Scene::with_robot(real.clone(), spec.clone(), start);
    let options = SimOptions { trail_interval: Some(0.1), ..SimOptions::with_noise(1.0, 1) };
    let simulation = Simulation::new(&scene, options)?;
    let parameters = NavigatorParameters::for_footprint(spec.footprint);
    let mut navigator = Navigator::new(&known, start, goal, parameters)?;
    let (mut plan, mut repairs) = (Vec::new(), 0);
    let outcome = run(&mut simulation.robot(0)?, &mut navigator, 300.0, |_, navigator, step| {
        let time = step.time;
        for event in navigator.take_events() {
            match event {
                NavigatorEvent::Planned { length, .. } if plan.is_empty() => {
                    println!("{time:5.1} s: first plan, {length:.2} m long");
                    plan = navigator.path().to_vec();
                }
                NavigatorEvent::Replanned { length, .. } => {
                    repairs += 1;
                    println!("{time:5.1} s: something is in the way; now {length:.2} m to the goal");
                }
                _ => {}
            }
        }
    })?;

    let truth = simulation.truth().robot(0)?;
    let off = units::to_mm(truth.pose.distance_to(goal));
    let (time, length) = (simulation.truth().time(), truth.path_length);
    println!(
        "{time:5.1} s: {outcome:?} after {length:.2} m and {repairs} repairs, {off:.0} mm from the goal"
    );
    assert_eq!((outcome, truth.contacts), (NavigatorOutcome::Reached, 0));
    assert!(off < 60.0 && repairs > 0);

    let mut picture = Picture::new(&real);
    picture.title("A plan, and what was not in the map").line(plan, Style::plan().labelled("first plan"));
    let unknown = Style::new(SERIES[2]).width(3.0).labelled("seen, not in the map");
    picture.points(navigator.unknown_obstacles(), unknown);
    picture
        .true_path(truth.trail.iter().map(|point| point.pose.position()))
        .robot(truth.pose, &spec.footprint);
    picture.mark(Mark::Start, start.position()).mark(Mark::Goal, goal);
    picture.save("target/pictures/navigate.svg")?;
    Ok(())
}
