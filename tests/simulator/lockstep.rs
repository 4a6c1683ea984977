//! Several programs in one world: what each of them sees does not depend on how their threads are scheduled.

use std::io::Sink;
use std::thread;
use std::time::Duration;

use roverlab::geometry::{Pose, Twist, direction};
use roverlab::io::sim::{SimOptions, SimRobot, Simulation};
use roverlab::io::wrappers::Traced;
use roverlab::io::{
    Clock, DistanceSensors, Drive, Keys, Lidar, Manoeuvres, Odometry, Psd, Radio, Result, StallDetector,
};
use roverlab::random::Stream;

use crate::common::robots;
use crate::scenes::cluttered;

/// Lets threads come in another order each time.
struct Disturbance(Stream);

impl Disturbance {
    fn now(&mut self) {
        match self.0.below(40) {
            0 => thread::sleep(Duration::from_micros(self.0.below(300) as u64)),
            1..8 => thread::yield_now(),
            _ => {}
        }
    }
}

type Robot = Traced<SimRobot, Sink>;

/// Reads its sensors all the time and never waits.
fn busy(robot: &mut Robot, seconds: f64, disturb: &mut Disturbance) -> Result<()> {
    while robot.now()? < seconds {
        disturb.now();
        let free = robot.distance(Psd::FRONT)?;
        robot
            .set_speed(Twist::new(0.3 * (free - 0.1).clamp(-0.5, 1.0), if free < 0.2 { 2.0 } else { 0.2 }))?;
        robot.pose()?;
    }
    Ok(())
}

/// Scans, drives, waits, at its own pace.
fn patient(robot: &mut Robot, seconds: f64, disturb: &mut Disturbance) -> Result<()> {
    let mut turn = 1.0;
    while robot.now()? < seconds {
        disturb.now();
        let nearest = robot.scan()?.ranges.into_iter().fold(f64::INFINITY, f64::min);
        turn = -turn;
        robot.curve(0.3 * nearest.min(1.0), turn, 0.25)?;
        robot.wait(0.137)?;
        disturb.now();
        robot.is_stalled()?;
    }
    Ok(())
}

/// Tells everybody where it is and turns towards the sum of what it hears.
fn talkative(robot: &mut Robot, seconds: f64, disturb: &mut Disturbance) -> Result<()> {
    let peers = robot.radio_peers()?;
    while robot.now()? < seconds {
        disturb.now();
        let pose = robot.pose()?;
        for &peer in &peers {
            robot.send(peer, &pose.x.to_le_bytes())?;
        }
        let mut heard = 0.0;
        while let Some(message) = robot.receive()? {
            disturb.now();
            heard += f64::from(message.data[5]) - 100.0;
        }
        robot.set_speed(Twist::new(0.1, heard.clamp(-2.0, 2.0)))?;
        robot.wait(0.03)?;
        robot.read_key()?;
    }
    Ok(())
}

/// Manoeuvres to their ends, then leaves early.
fn brief(robot: &mut Robot, seconds: f64, disturb: &mut Disturbance) -> Result<()> {
    while robot.now()? < 0.6 * seconds {
        disturb.now();
        robot.turn(0.7, 1.5)?;
        robot.wait_done()?;
        robot.straight(0.05, 0.2)?;
        robot.wait_done()?;
    }
    Ok(())
}

/// A digest of all that the programs of so many robots saw, and of where they ended.
fn run(number: usize, disturbance: u64) -> u64 {
    let poses: Vec<Pose> = (0..number)
        .map(|i| {
            let angle = std::f64::consts::TAU * i as f64 / 8.0;
            let place = direction(angle) * 0.2;
            Pose::new(1.2 + place.x, 1.2 + place.y, angle)
        })
        .collect();
    let options = SimOptions { seed: 5, ..SimOptions::default() };
    let simulation = Simulation::new(&robots(cluttered(3), &poses), options).unwrap();
    let taken: Vec<SimRobot> = (0..number).map(|robot| simulation.robot(robot).unwrap()).collect();
    let programs = [busy, patient, talkative, brief];
    let digests: Vec<u64> = thread::scope(|scope| {
        let threads: Vec<_> = taken
            .into_iter()
            .enumerate()
            .map(|(index, robot)| {
                let mut disturb = Disturbance(Stream::new(disturbance).child("robot", index as u64));
                scope.spawn(move || {
                    let mut robot = Traced::new(robot, std::io::sink());
                    programs[index % 4](&mut robot, 1.5, &mut disturb).unwrap();
                    robot.digest()
                })
            })
            .collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).collect()
    });
    let truth = simulation.truth();
    let places = (0..number).flat_map(|robot| {
        let told = truth.robot(robot).unwrap();
        let pose = told.pose;
        [pose.x.to_bits(), pose.y.to_bits(), pose.heading.to_bits(), u64::from(told.contacts)]
    });
    let all = digests.into_iter().chain(places).chain([truth.time().to_bits()]);
    all.fold(0, |sum: u64, value| (sum ^ value).wrapping_mul(0x0000_0100_0000_01b3).rotate_left(7))
}

/// The same on every machine, in debug and in release. A change of the simulator's numbers changes them; then
/// the new ones stand here.
const DIGESTS: [(usize, u64); 8] = [
    (1, 0xc241_40d3_6154_d2b4),
    (2, 0xa0cd_f191_4052_0c9c),
    (3, 0x6bf5_b7ec_51e8_d86c),
    (4, 0x9115_0c51_96c7_ed93),
    (5, 0xdeb1_0d80_3922_d547),
    (6, 0x4609_4cc1_3434_5eb8),
    (7, 0x3cc9_40e1_bbdb_4fa5),
    (8, 0x4e50_9378_300e_dc73),
];

#[test]
fn traces_do_not_depend_on_scheduling() {
    let found = DIGESTS.map(|(number, _)| (number, run(number, 0)));
    for (number, digest) in found {
        for disturbance in 1..12 {
            assert_eq!(run(number, disturbance), digest, "{number} robots, disturbance {disturbance}");
        }
    }
    assert_eq!(found, DIGESTS, "found {found:#x?}");
}
