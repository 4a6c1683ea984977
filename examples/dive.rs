//! Diving (book, sections 8.1 to 8.3): Mako comes to a depth by its two upright thrusters, holds it, and
//! surfaces by itself when they stop.
//!
//! `cargo run --release --example dive`

use roverlab::drive::marine::{Dive, DiveOutcome, DiveParameters};
use roverlab::geometry::{Point, Pose, units};
use roverlab::io::control::run;
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::io::{Clock, DepthSensor, Motors};
use roverlab::kinematics::marine::CraftSpec;
use roverlab::picture::{Picture, Style};
use roverlab::world::{RobotSpec, Scene, World};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let pool = World { water_level: Some(3.0), ..World::walled(10.0, 20.0) };
    let scene = Scene::with_robot(pool, RobotSpec::mako(), Pose::new(5.0, 10.0, 0.0));
    let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 1))?;
    let mut mako = simulation.robot(0)?;
    let afloat = mako.depth()?;

    let parameters = DiveParameters { depth: 2.0, duration: 60.0, ..DiveParameters::default() };
    let mut dive = Dive::new(&CraftSpec::mako(), parameters)?;
    let (mut farthest, mut line) = (0.0_f64, Vec::new());
    let outcome = run(&mut mako, &mut dive, 120.0, |_, _, step| {
        // A second is 50 mm wide.
        line.push(Point::new(0.05 * step.time, 3.0 - step.seen.depth));
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

    let mut picture = Picture::new(&World::empty(5.0, 3.0));
    picture.title("Depth against time").line(line, Style::true_path().labelled("depth"));
    picture.line([1.0, 3.0].map(|height| Point::new(0.0, height)), Style::aid());
    picture.line([0.0, 5.0].map(|time| Point::new(time, 1.0)), Style::plan().labelled("2 m"));
    picture.save("target/pictures/dive.svg")?;
    Ok(())
}
