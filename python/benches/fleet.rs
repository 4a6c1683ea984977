//! Robot steps per second of a fleet without Python: `cargo bench -p roverlab-python --bench fleet`.
//!
//! Each of 1,000 robots alone in a walled square, 180 beams, a step of 0.1 s, as in `rates.py`.

use std::ops::ControlFlow;
use std::time::Instant;

use roverlab::geometry::{Pose, Twist};
use roverlab::io::sim::{Fleet, SimOptions};
use roverlab::io::{DistanceSensors, Drive, Lidar, LidarScan, Odometry, Psd, Result};
use roverlab::world::{LidarSpec, RobotSpec, Scene, World};

const ROBOTS: u64 = 1000;
const STEPS: u32 = 100;

#[allow(clippy::disallowed_methods, reason = "a benchmark measures time")]
fn main() -> Result<()> {
    let spec =
        RobotSpec { lidar: Some(LidarSpec { points: 180, ..LidarSpec::default() }), ..RobotSpec::s4() };
    let scene = Scene::with_robot(World::walled(4.0, 4.0), spec, Pose::new(2.0, 2.0, 0.0));
    let mut fleets = Vec::new();
    for seed in 1..=ROBOTS {
        let mut fleet = Fleet::new(&scene, SimOptions::with_noise(1.0, seed))?;
        let mut scan = LidarScan::default();
        fleet.control(0, 0.1, move |robot| {
            robot.scan_into(&mut scan)?;
            let ranges = [Psd::FRONT, Psd::LEFT, Psd::RIGHT, Psd::BACK].map(|psd| robot.distance(psd));
            let pose = robot.pose()?;
            assert!(
                ranges.iter().all(std::result::Result::is_ok) && pose.is_finite() && scan.ranges.len() == 180
            );
            robot.set_speed(Twist::new(0.2, 0.5))?;
            Ok(ControlFlow::Continue(()))
        })?;
        fleets.push(fleet);
    }
    let mut rates = Vec::new();
    for _ in 0..5 {
        let start = Instant::now();
        for _ in 0..STEPS {
            fleets.iter_mut().try_for_each(|fleet| fleet.run_for(0.1))?;
        }
        rates.push(f64::from(STEPS) * ROBOTS as f64 / start.elapsed().as_secs_f64());
    }
    assert!(fleets.iter().all(|fleet| (fleet.time() - 50.0).abs() < 1e-9));
    rates.sort_by(f64::total_cmp);
    println!("1,000 robots of a fleet, one thread: {:.0} robot steps/s", rates[2]);
    Ok(())
}
