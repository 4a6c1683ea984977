//! Along the sides of a pool (book, section 8.4): Mako keeps half a metre from the wall by its distance
//! sensors, at a constant depth, until it has come by its first corner again.
//!
//! `cargo run --release --example pool_wall`

use roverlab::drive::marine::{PoolWall, PoolWallOutcome, PoolWallParameters};
use roverlab::geometry::{Pose, units};
use roverlab::io::control::run;
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::picture::{Mark, Picture};
use roverlab::world::{RobotSpec, Scene, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut pool = World { water_level: Some(2.0), ..World::walled(8.0, 6.0) };
    for wall in &mut pool.walls {
        wall.height = 3.0;
    }
    // By its Doppler log, it knows the way over ground.
    let mako = RobotSpec { dvl: Some(10.0), ..RobotSpec::mako() };
    let start = Pose::new(4.0, 3.0, 0.3);
    let scene = Scene::with_robot(pool, mako.clone(), start);
    let options = SimOptions { trail_interval: Some(0.2), ..SimOptions::with_noise(1.0, 1) };
    let simulation = Simulation::new(&scene, options)?;

    let mut wall = PoolWall::new(&mako, PoolWallParameters::default())?;
    let mut deepest = [f64::INFINITY, 0.0];
    let outcome = run(&mut simulation.robot(0)?, &mut wall, 300.0, |_, _, step| {
        if step.time > 30.0 {
            let depth = step.seen.dive.depth;
            deepest = [deepest[0].min(depth), deepest[1].max(depth)];
        }
    })?;
    let truth = simulation.truth().robot(0)?;
    println!(
        "{outcome:?} after {:.1} m, {:.0} to {:.0} mm deep",
        truth.path_length,
        units::to_mm(deepest[0]),
        units::to_mm(deepest[1])
    );
    assert_eq!((outcome, truth.contacts), (PoolWallOutcome::Round, 0));
    assert!((truth.path_length - 24.0).abs() < 6.0 && deepest[0] > 0.7 && deepest[1] < 0.9);

    let mut picture = Picture::new(&scene.world);
    picture.title("Along the sides of a pool").mark(Mark::Start, start.position());
    picture.true_path(truth.trail.iter().map(|point| point.pose.position()));
    picture.robot(truth.pose, &mako.footprint).save("target/pictures/pool_wall.svg")?;
    Ok(())
}
