//! Recordings: every call of a robot and every answer go into an MCAP file. The same program runs on the
//! recording alone, without a simulator; a changed program fails at its first call that differs. Needs the
//! feature `log`.
//!
//! `cargo run --release --features log --example record_replay`

use roverlab::drive::{AToB, AToBOutcome, AToBParameters, Goal, Method};
use roverlab::geometry::{Point, Pose};
use roverlab::io::control::run;
use roverlab::io::log::{Difference, Header, Log, LogWriter, Replay};
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::io::{
    Clock, DistanceSensors, Drive, ErrorKind, Manoeuvres, Odometry, Psd, Result, StallDetector,
};
use roverlab::world::{RobotSpec, Scene, World};

/// The program: it does not know what kind of robot it drives. Returns the last odometry and the range ahead.
fn program(
    robot: &mut (impl Clock + DistanceSensors + Drive + Odometry + Manoeuvres + StallDetector),
    method: Method,
) -> Result<(Pose, f64)> {
    let mut drive = AToB::new(method, Goal::point(Point::new(1.2, 0.5)), AToBParameters::default())?;
    let outcome = run(robot, &mut drive, 60.0, |_, _, _| {})?;
    assert_eq!(outcome, AToBOutcome::Reached);
    Ok((robot.pose()?, robot.distance(Psd::FRONT)?))
}

fn record(seed: u64) -> std::result::Result<(Log, (Pose, f64)), Box<dyn std::error::Error>> {
    let scene = Scene::with_robot(World::walled(2.0, 1.5), RobotSpec::s4(), Pose::new(0.3, 0.4, 0.0));
    let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, seed))?;
    // Any sink will do: here it is memory, so that nothing is left behind.
    let writer = LogWriter::new(Vec::new(), &Header::new("record_replay", [format!("--seed {seed}")]))?;
    writer.show(&scene);
    let mut robot = writer.recorder(simulation.robot(0)?, 0);
    let end = program(&mut robot, Method::Arc)?;
    drop(robot);
    Ok((Log::read(writer.finish()?)?, end))
}

fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    let (log, end) = record(1)?;
    let (from, to) = log.span().ok_or("an empty recording")?;
    println!("{} bytes, {:.1} s, topics:", log.bytes().len(), to - from);
    for (topic, messages) in log.topics() {
        println!("  {messages:5} messages of {topic}");
    }

    // The same program on the recording: the same end, to the last bit.
    let replayed = program(&mut Replay::new(&log, 0)?, Method::Arc)?;
    let (pose, ahead) = replayed;
    println!("replayed: at ({:.4}, {:.4}) m, a wall {ahead:.4} m ahead", pose.x, pose.y);
    assert_eq!(replayed, end);

    // Another program asks for something else, and is told so.
    let error = program(&mut Replay::new(&log, 0)?, Method::Turn).err().ok_or("no difference was found")?;
    println!("another program: {error}");
    assert_eq!(error.kind(), ErrorKind::Diverged);

    // The same seed gives the same bytes; another one, another recording.
    assert_eq!(Difference::between(&log, &record(1)?.0), None);
    let difference = Difference::between(&log, &record(2)?.0).ok_or("seeds make no difference")?;
    println!("another seed: {difference}");
    Ok(())
}
