//! Runs whose every bit `test_trajectories.py` repeats in Python. Their digests are in `trajectories.txt`,
//! which `REGENERATE=1 cargo test -p roverlab-python` writes anew.

use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;

use roverlab::geometry::{Pose, Twist};
use roverlab::io::sim::{SimOptions, Stepped};
use roverlab::io::{DistanceSensors, Drive, Lidar, LidarScan, Odometry, Psd, Result};
use roverlab::random::Stream;
use roverlab::world::generate::{RoomOptions, room};
use roverlab::world::{RobotPlacement, RobotSpec, Scene};

/// FNV-1a over words of 64 bits.
struct Digest(u64);

impl Digest {
    fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn add(&mut self, values: &[f64]) {
        for value in values {
            self.0 = (self.0 ^ value.to_bits()).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
}

fn numbers(pose: Pose) -> [f64; 3] {
    [pose.x, pose.y, pose.heading]
}

/// Two robots in a random room, for 20 s: all that they sense, and where they are.
fn digest(seed: u64) -> Result<u64> {
    let drawn = room(&mut Stream::new(seed), &RoomOptions::default())?;
    let mut scene = Scene::with_robot(drawn.world, RobotSpec::s4(), drawn.start);
    let second = Pose::new(drawn.start.x, drawn.start.y + 0.3, 1.0);
    scene.robots.push(RobotPlacement::new(Arc::new(RobotSpec::s4()), second));
    let mut world = Stepped::new(&scene, SimOptions::with_noise(1.0, seed))?;
    let (mut digest, mut scan) = (Digest::new(), LidarScan::default());
    for _ in 0..200 {
        for index in 0..2 {
            let mut robot = world.robot(index)?;
            robot.scan_into(&mut scan)?;
            let [ahead, left, right, back] =
                [Psd::FRONT, Psd::LEFT, Psd::RIGHT, Psd::BACK].map(|psd| robot.distance(psd));
            let ahead = ahead?;
            digest.add(&scan.ranges);
            digest.add(&[ahead, left?, right?, back?]);
            digest.add(&numbers(robot.pose()?));
            let turn = scan.ranges[270].min(1.0) - scan.ranges[90].min(1.0);
            robot.set_speed(Twist::new(0.2 * ahead.min(1.0), turn))?;
            digest.add(&numbers(world.pose(index)?));
        }
        world.run_for(0.1)?;
    }
    Ok(digest.0)
}

#[test]
fn runs_are_those_of_the_file() {
    let mut table = String::new();
    for seed in 1..=10 {
        writeln!(table, "{seed} {:016x}", digest(seed).unwrap()).unwrap();
    }
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/trajectories.txt");
    if std::env::var_os("REGENERATE").is_some() {
        std::fs::write(&file, &table).unwrap();
    }
    assert_eq!(std::fs::read_to_string(&file).unwrap(), table);
}
