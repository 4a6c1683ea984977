//! Diving (book, sections 8.1 to 8.3): Mako comes to a depth by its two upright thrusters, holds it, and
//! surfaces by itself when they stop.
//!
//! `cargo run --release --example dive`

use roverlab::drive::marine::{Dive, DiveOutcome, DiveParameters};
use roverlab::geometry::{Pose, units};
use roverlab::io::control::run;
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::io::{Clock, DepthSensor, Motors};
use roverlab::kinematics::marine::CraftSpec;
use roverlab::world::{RobotSpec, Scene, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let pool = World { water_level: Some(3.0), ..World::walled(10.0, 20.0) };
    let scene = Scene::with_robot(pool, RobotSpec::mako(), Pose::new(5.0, 10.0, 0.0));
    let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 1))?;
    let mut mako = simulation.robot(0)?;
    let afloat = mako.depth()?;

    let parameters = DiveParameters { depth: 2.0, duration: 60.0, ..DiveParameters::default() };
    let mut dive = Dive::new(&CraftSpec::mako(), parameters)?;
    let mut farthest = 0.0_f64;
    let outcome = run(&mut mako, &mut dive, 120.0, |_, _, step| {
        if step.time > 25.0 {
            farthest = farthest.max((step.seen.depth - 2.0).abs());
        }
    })?;
    assert_eq!(outcome, DiveOutcome::Over);
    println!("held 2 m: after 25 s never read more than {:.0} mm off", units::to_mm(farthest));
    assert!(farthest < 0.02);

    // Stopped thrusters are what a fault leads to: buoyancy brings it up.
    mako.set_motor(2, 0.0)?;
    mako.set_motor(4, 0.0)?;
    mako.wait(30.0)?;
    println!(
        "up again: {:.0} mm deep, {:.0} mm at the start",
        units::to_mm(mako.depth()?),
        units::to_mm(afloat)
    );
    assert!((mako.depth()? - afloat).abs() < 0.05);
    Ok(())
}
