//! The memory that an hour of recording takes: it is printed for each ten minutes of the run, and must stay
//! where it is. For Linux, whose kernel tells how much memory a process uses.

use std::io;

use roverlab::geometry::{Pose, Twist};
use roverlab::io::log::{Header, LogWriter};
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::io::{Clock, Drive, Lidar, LidarScan, Odometry, Result};
use roverlab::world::{RobotSpec, Scene, World};

/// Megabytes that this process uses, if somebody tells.
fn used() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    Some(line.trim().strip_suffix(" kB")?.trim().parse::<f64>().ok()? / 1024.0)
}

fn main() -> Result<()> {
    let scene = Scene::with_robot(World::walled(3.0, 3.0), RobotSpec::s4(), Pose::new(1.0, 1.5, 0.0));
    let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 1))?;
    let writer = LogWriter::new(io::sink(), &Header::new("memory", [""; 0])).expect("a recording");
    let mut robot = writer.recorder(simulation.robot(0)?, 0);
    robot.set_speed(Twist::new(0.1, 0.2))?;
    let mut scan = LidarScan::default();
    let mut first = None;
    for minute in 1..=60 {
        while robot.now()? < 60.0 * f64::from(minute) {
            robot.scan_into(&mut scan)?;
            robot.pose()?;
            robot.wait(0.05)?;
        }
        if minute % 10 == 0 {
            let Some(now) = used() else { return Ok(()) };
            let growth = now - *first.get_or_insert(now);
            println!(
                "{minute} minutes of a scan and a pose each 0.05 s: {now:.1} MB, {growth:.1} MB more than after ten"
            );
            // An entry in the index of chunks for each second is all that grows.
            assert!(growth < 8.0, "memory grows");
        }
    }
    Ok(())
}
