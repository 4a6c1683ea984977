//! Levels (book, section 7.4): a snow truck on belts drives up a ramp, across a level of 0.2 m, and down
//! another ramp. It knows neither their slopes nor where the other ramp is, and maps them with its lidar.
//! Then a cliff guard keeps a robot that drives blindly on the level.
//!
//! `cargo run --release --example ramp`

use roverlab::geometry::{Pose, Twist, units};
use roverlab::io::control::run;
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::io::{Clock, Drive};
use roverlab::nav::{RampCrossing, RampOutcome};
use roverlab::picture::{Mark, Picture, Style};
use roverlab::random::Stream;
use roverlab::safety::{CliffGuard, CliffGuardParameters};
use roverlab::world::generate::{ReliefKind, ReliefOptions, relief};
use roverlab::world::{RobotSpec, Scene};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let levels = relief(&mut Stream::new(SEED), &ReliefOptions::of(ReliefKind::Ramp))?;
    let spec = RobotSpec::blizzard();
    let options = SimOptions { trail_interval: Some(0.2), ..SimOptions::with_noise(1.0, SEED) };
    let scene = Scene::with_robot(levels.world.clone(), spec.clone(), levels.start);
    let simulation = Simulation::new(&scene, options.clone())?;
    let mut crossing = RampCrossing::new(RampCrossing::parameters(&spec).ok_or("no lidar")?)?;
    let mut highest: f64 = 0.0;
    let outcome = run(&mut simulation.robot(0)?, &mut crossing, 400.0, |_, crossing, _| {
        highest = highest.max(crossing.pose().1);
    })?;
    let truth = simulation.truth().robot(0)?;
    println!(
        "{outcome}, after {:.1} m with {} looks, {:.0} mm above the floor in between",
        truth.path_length,
        crossing.looks(),
        units::to_mm(highest)
    );
    assert_eq!((outcome, simulation.truth().mishap(0)?), (RampOutcome::Crossed, None));

    // On the level, between both ramps: straight on, whatever comes.
    let [_, up, across, _] = levels.way[..] else { return Err("no ramps".into()) };
    let middle = up + (across - up) * 0.5;
    let parameters = CliffGuardParameters::of(&spec);
    let guarded = CliffGuard::equip(spec.clone(), &parameters);
    let start = Pose::new(middle.x, middle.y, levels.start.heading + 0.3);
    let scene = Scene::with_robot(levels.world.clone(), guarded.clone(), start);
    let other = Simulation::new(&scene, options)?;
    let mut robot = CliffGuard::new(other.robot(0)?, &guarded, parameters)?;
    robot.set_speed(Twist::new(0.3, 0.0))?;
    robot.wait(10.0)?;
    let blind = other.truth().robot(0)?;
    println!("blindly on: at an edge: {}, after {:.2} m", robot.is_at_edge(), blind.path_length);
    assert!(robot.is_at_edge() && other.truth().mishap(0)?.is_none());

    let mut picture = Picture::new(&levels.world);
    picture.title("Up a ramp, across, and down another one");
    let path =
        |trail: &[roverlab::io::TrailPoint]| trail.iter().map(|at| at.pose.position()).collect::<Vec<_>>();
    picture.line(path(&blind.trail), Style::odometry().labelled("blindly, with a cliff guard"));
    picture.true_path(path(&truth.trail)).robot(truth.pose, &spec.footprint);
    picture.robot(blind.pose, &spec.footprint).mark(Mark::Start, levels.start.position());
    picture.save("target/pictures/ramp.svg")?;
    Ok(())
}

/// Number of the levels.
const SEED: u64 = 1;
