//! The bug family compared (book, section 10.1): six of its algorithms drive to the same goal, each in a
//! fresh copy of one generated world, and the table says how far each of them drove in terms of the shortest
//! way.
//!
//! `cargo run --release --example bug_compare`

use roverlab::io::control::run;
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::nav::BugKind::{Alg2, Bug1, Bug2, DistBug, Rev2, TangentBug};
use roverlab::nav::{BugOutcome, BugParameters, Reachability};
use roverlab::picture::{Mark, Picture, SERIES, Style};
use roverlab::random::Stream;
use roverlab::world::generate::CourseFamily;
use roverlab::world::{RobotSpec, Scene};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // Obstacles with hollows into which the straight way to the goal leads.
    let course = CourseFamily::LocalMinima.course(&mut Stream::new(8))?;
    let spec = RobotSpec::s4();
    let radius = spec.footprint.bounding_radius();
    let scene = Scene::with_robot(course.world.clone(), spec, course.start);
    // Over the cells of a grid of 10 mm, along edges and diagonals.
    let ways = Reachability::new(&course.world, radius, 0.01)?;
    let shortest =
        ways.shortest_path_length(course.start.position(), course.goal).ok_or("no way to the goal")?;

    let mut picture = Picture::new(&course.world);
    picture
        .title("Bugs on one course")
        .mark(Mark::Start, course.start.position())
        .mark(Mark::Goal, course.goal);
    println!("The shortest way is {shortest:.1} m long.\n");
    println!("{:12} {:>9} {:>14} {:>9}", "algorithm", "path (m)", "times shortest", "time (s)");
    for kind in [Bug1, Bug2, Alg2, Rev2, DistBug, TangentBug] {
        // Without noise the paths differ because of the algorithms alone, and odometry needs no correction.
        let options = SimOptions { trail_interval: Some(0.1), ..SimOptions::ideal() };
        let simulation = Simulation::new(&scene, options)?;
        let parameters =
            BugParameters { match_scans: false, period: 0.1, ..BugParameters::for_radius(radius) };
        let mut bug = kind.with(course.start.to_local(course.goal), parameters)?;
        let outcome = run(&mut simulation.robot(0)?, bug.as_mut(), 1800.0, |_, _, _| {})?;

        let (truth, time) = (simulation.truth().robot(0)?, simulation.truth().time());
        let (length, ratio) = (truth.path_length, truth.path_length / shortest);
        println!("{:12} {length:>9.1} {ratio:>14.2} {time:>9.0}", kind.name());
        assert_eq!((outcome, truth.contacts), (BugOutcome::Reached, 0), "{kind}");
        assert!(truth.pose.distance_to(course.goal) < 0.05 && ratio > 0.9, "{kind}");
        if let Some(colour) = [Bug1, Bug2, DistBug].iter().position(|&k| k == kind) {
            let style = Style::new(SERIES[colour]).labelled(kind.name());
            picture.line(truth.trail.iter().map(|point| point.pose.position()), style);
        }
    }
    picture.save("target/pictures/bug_compare.svg")?;
    Ok(())
}
