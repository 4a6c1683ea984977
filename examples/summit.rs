//! A mountain range (book, section 7.4): a snow truck on belts looks around with its lidar, maps what it sees, and
//! drives to the highest place that it can reach. Steepest ascent alone ends on the first top that it meets.
//!
//! `cargo run --release --example summit`

use roverlab::drive::terrain::{Ascent, AscentParameters, SlopeSensor};
use roverlab::geometry::units;
use roverlab::io::control::run;
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::nav::elevation::{Climber, ElevationMap};
use roverlab::nav::{Fence, SummitOutcome, SummitParameters, SummitSearch};
use roverlab::picture::{Mark, Picture, Style};
use roverlab::random::Stream;
use roverlab::world::generate::{ReliefKind, ReliefOptions, relief};
use roverlab::world::{RobotSpec, Scene};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let range = relief(&mut Stream::new(SEED), &ReliefOptions::of(ReliefKind::Range))?;
    let ground = range.world.terrain.clone().and_then(|terrain| terrain.surface).ok_or("no hills")?;
    let spec = RobotSpec::blizzard();
    // The truth, which the robot does not know.
    let map = ElevationMap::new(&ground, &Climber::of(&spec))?;
    let top = map.highest_reachable(range.start.position()).ok_or("the start is too steep")?;

    let scene = Scene::with_robot(range.world.clone(), spec.clone(), range.start);
    let options = SimOptions { trail_interval: Some(0.2), ..SimOptions::with_noise(1.0, SEED) };
    let fence = Some(Fence { area: ground.area(), start: range.start });
    let parameters = SummitParameters { fence, ..SummitParameters::of(&spec).ok_or("no lidar")? };
    let simulation = Simulation::new(&scene, options.clone())?;
    let mut search = SummitSearch::new(parameters)?;
    let outcome = run(&mut simulation.robot(0)?, &mut search, 1200.0, |_, _, _| {})?;
    let (truth, end) = (simulation.truth().robot(0)?, simulation.truth().pose_in_space(0)?);
    let below = |height: f64| units::to_mm(top.z - height);
    let (looks, length, height) = (search.looks(), truth.path_length, end.position.z);
    println!(
        "search: {outcome} after {looks} looks and {length:.1} m, {:.0} mm below the summit",
        below(height)
    );
    assert_eq!(outcome, SummitOutcome::Highest);
    assert!(below(height) < 15.0 && simulation.truth().mishap(0)?.is_none());

    let other = Simulation::new(&scene, options)?;
    let sensor = SlopeSensor::lidar(&spec).ok_or("no lidar")?;
    let mut ascent = Ascent::new(sensor, AscentParameters::of(&spec))?;
    let outcome = run(&mut other.robot(0)?, &mut ascent, 300.0, |_, _, _| {})?;
    let (alone, height) = (other.truth().robot(0)?, other.truth().pose_in_space(0)?.position.z);
    println!("steepest ascent: {outcome}, {:.0} mm below the summit", below(height));

    let mut picture = Picture::new(&range.world);
    picture.title("To the highest place that can be reached");
    let path =
        |trail: &[roverlab::io::TrailPoint]| trail.iter().map(|at| at.pose.position()).collect::<Vec<_>>();
    picture.line(path(&alone.trail), Style::odometry().labelled("steepest ascent"));
    picture.true_path(path(&truth.trail)).robot(truth.pose, &spec.footprint);
    picture.mark(Mark::Start, range.start.position()).mark(Mark::Goal, top.xy());
    picture.save("target/pictures/summit.svg")?;
    Ok(())
}

/// Which of all ranges it is.
const SEED: u64 = 1;
