//! DistBug (book, sections 10.1 and 10.2): a robot drives to a goal through a world that it does not know. It
//! follows the boundary of each obstacle that it meets, and leaves it where the lidar shows enough free way
//! towards the goal.
//!
//! `cargo run --release --example distbug`

use std::f64::consts::{FRAC_PI_4, TAU};
use std::sync::Arc;

use roverlab::geometry::{Point, Pose, direction, units};
use roverlab::io::control::run;
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::nav::{BugEvent as Event, BugOutcome, BugParameters, DistBug};
use roverlab::picture::{Mark, Picture, Style};
use roverlab::world::{Colour, Marker, Object, ObjectKind, RobotSpec, Scene, Wall, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (start, goal) = (Pose::new(0.5, 0.5, 0.0), Point::new(3.85, 3.85));
    let scene = Scene::with_robot(world(goal), RobotSpec::s4(), start);
    let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 1))?;
    // The truth is for the verdict and the picture; the robot has no access to it.
    let (truth, mut robot) = (simulation.truth(), simulation.robot(0)?);
    let (mut path, mut odometry, mut seen) = (vec![start.position()], vec![start.position()], Vec::new());
    let mut marks = Vec::new();

    // The robot counts from where it stands, so the goal is given in its own frame.
    let mut bug = DistBug::new(start.to_local(goal), BugParameters::default())?;
    let outcome = run(&mut robot, &mut bug, 600.0, |_, bug, step| {
        for event in bug.take_events() {
            let (mark, letter, point, words) = match event {
                Event::Hit { point, side } => (Mark::HitPoint, 'H', point, format!("wall on the {side:?}")),
                Event::Leave { point, free } => (Mark::LeavePoint, 'L', point, format!("{free:.2} m free")),
                _ => continue,
            };
            // Every hit point is followed by its leave point.
            let (name, point) = (format!("{letter}{}", marks.len() / 2 + 1), start.to_world(point));
            println!("{:5.1} s: {mark:?} {name} at ({:.2}, {:.2}) m, {words}", step.time, point.x, point.y);
            marks.push((mark, point, name));
        }
        let here = start.compose(&bug.pose());
        seen = bug.visible_points().iter().map(|&point| here.to_world(point)).collect();
        let robot = truth.robot(0).expect("the scene has a robot 0");
        path.push(robot.pose.position());
        odometry.push(start.compose(&robot.odometry).position());
    })?;

    let (end, time) = (truth.robot(0)?, truth.time());
    let (driven, missed) = (end.path_length, units::to_mm(end.pose.distance_to(goal)));
    let drift = units::to_mm(end.pose.distance_to(start.compose(&end.odometry).position()));
    println!("{time:5.1} s: {outcome:?} after {driven:.1} m, {missed:.0} mm from the goal");
    println!("Odometry alone is {drift:.0} mm wrong by now; the robot corrects it by matching scans.");
    assert!(outcome == BugOutcome::Reached && end.contacts == 0 && missed < 100.0);

    let mut picture = Picture::new(&scene.world);
    picture.title("DistBug: goal reached");
    picture.caption(format!("{driven:.1} m in {time:.0} s, {missed:.0} mm from the goal, noise 1, seed 1"));
    picture.points(seen, Style::lidar()).true_path(path).odometry_path(odometry);
    picture.robot(end.pose, &RobotSpec::s4().footprint);
    picture.mark(Mark::Start, start.position()).mark(Mark::Goal, goal);
    marks.sort_by_key(|&(mark, ..)| mark);
    for (mark, point, name) in marks {
        picture.mark_named(mark, point, name);
    }
    picture.save("target/pictures/distbug.svg")?;
    Ok(())
}

/// A C, a crescent, a hook, a room with its door on the far side, a zig-zag and a block. In millimetres.
fn world(goal: Point) -> World {
    let at = |&(x, y): &(f64, f64)| Point::new(units::from_mm(x), units::from_mm(y));
    let arc = |shift: f64, radius: f64| {
        let middle = at(&(2150.0, 2000.0)) + direction(FRAC_PI_4) * shift;
        let angle = |i: i32| FRAC_PI_4 + (f64::from(i) / 24.0 - 0.5) * (0.55 * TAU);
        (0..=24).map(move |i| middle + direction(angle(i)) * radius).collect::<Vec<_>>()
    };
    let corner = |i: i32| at(&(3400.0, 1500.0)) + direction(TAU * (f64::from(i) + 0.3) / 6.0) * 0.34;
    let line = |corners: &[(f64, f64)]| corners.iter().map(at).collect::<Vec<_>>();
    let (outer, inner) = (arc(0.0, 0.75), arc(-0.05, 0.6));
    let mut world = World::walled(4.5, 4.5);
    for line in [
        line(&[(950.0, 1500.0), (1550.0, 1500.0), (1550.0, 850.0), (1100.0, 850.0)]),
        outer.iter().chain(inner.iter().rev()).chain(&outer[..1]).copied().collect(),
        line(&[(2750.0, 2900.0), (2750.0, 3500.0), (2250.0, 3500.0), (2250.0, 3250.0)]),
        line(&[(4150.0, 4200.0), (3350.0, 4200.0), (3350.0, 3350.0), (4250.0, 3350.0), (4250.0, 3700.0)]),
        line(&[(500.0, 2500.0), (900.0, 2750.0), (500.0, 3000.0), (900.0, 3250.0)]),
        (0..=6).map(|i| corner(i % 6)).collect(),
    ] {
        world.walls.extend(line.windows(2).map(|ends| Wall::new(ends[0], ends[1])));
    }
    for (name, x, y) in [("crate", 1150.0, 3950.0), ("can", 2450.0, 700.0), ("soccer", 3900.0, 600.0)] {
        let kind = ObjectKind::predefined(name).expect("one of the kinds that every scene knows");
        world.objects.push(Object::new(Arc::new(kind), Pose::from_mm_deg(x, y, 20.0)));
    }
    world.markers.push(Marker { position: goal, colour: Colour::GREEN, alpha: 255 });
    world
}
