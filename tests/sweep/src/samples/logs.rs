//! Recordings.

use std::{env, fs, process};

use crate::sample::samples;
use roverlab::geometry::{Pose, Twist};
use roverlab::io::log::{Attachment, Compression, Header, Log, LogFile, LogWriter, recover};
use roverlab::io::sim::{Fleet, SimOptions, Simulation};
use roverlab::io::{
    Camera, Clock, DistanceSensors, Drive, FleetIo, GroundTruth, Keys, Lidar, MockRobot, Odometry, Psd,
};
use roverlab::world::{RobotSpec, Scene, World};

/// A recording of what is done with its writer.
fn recorded(
    header: &Header,
    run: impl FnOnce(&LogWriter<Vec<u8>>) -> roverlab::io::Result<()>,
) -> Option<Vec<u8>> {
    let writer = LogWriter::new(Vec::new(), header).ok()?;
    let _ = run(&writer);
    writer.finish().ok()
}

/// A recording of robots with these indices, of which each is given a time to wait and a speed.
fn robots(indices: impl IntoIterator<Item = usize>, seconds: f64, speed: f64) -> Option<Vec<u8>> {
    recorded(&Header::new("sweep", ["--fast"]), |writer| {
        for index in indices {
            let mut robot = writer.recorder(MockRobot::new().lenient(), index);
            for _ in 0..3 {
                robot.set_speed(Twist::new(speed, -speed))?;
                robot.set_pose(Pose::new(speed, -speed, speed))?;
                robot.wait(seconds)?;
                let _ =
                    (robot.pose(), robot.distance(Psd::FRONT), robot.scan(), robot.image(), robot.read_key());
            }
        }
        Ok(())
    })
}

/// A recording with a scene, a robot, what it does and where it is.
fn simulated(header: &Header) -> Option<Vec<u8>> {
    let scene = Scene::with_robot(World::walled(3.0, 2.0), RobotSpec::s4(), Pose::new(1.0, 1.0, 0.3));
    recorded(header, |writer| {
        let simulation = Simulation::new(&scene, SimOptions::default())?;
        writer.show(&scene);
        let mut robot = writer.recorder(simulation.robot(0)?, 0);
        let mut truth = writer.truth(simulation.truth(), 0);
        for _ in 0..3 {
            robot.set_speed(Twist::new(0.2, 0.5))?;
            robot.wait(0.1)?;
            robot.pose()?;
            robot.scan()?;
            truth.pose(0)?;
        }
        Ok(())
    })
}

/// A recording of a fleet.
fn fleet() -> Option<Vec<u8>> {
    let mut scene = Scene::with_robot(World::walled(3.0, 2.0), RobotSpec::s4(), Pose::new(1.0, 1.0, 0.3));
    scene.robots.push(scene.robots[0].clone());
    scene.robots[1].pose.x = 2.0;
    recorded(&Header::default(), |writer| {
        let mut fleet = writer.fleet(Fleet::new(&scene, SimOptions::default())?);
        fleet.run_for(0.1)?;
        fleet.pose(1)?;
        fleet.truth(0)?;
        Ok(())
    })
}

/// A recording of which only the first bytes are left.
fn rest(bytes: &[u8], share: f64) -> Option<Vec<u8>> {
    let length = (bytes.len() as f64 * share) as usize;
    Some(recover(&bytes[..length]).ok()?.bytes)
}

fn packed(compression: Compression) -> Header {
    let attachment =
        Attachment { name: "world\0.wld".into(), media_type: String::new(), data: vec![0; 1000] };
    Header {
        compression,
        seed: Some(u64::MAX),
        options: vec![String::new(); 1000],
        attachments: vec![attachment.clone(), attachment],
        ..Header::default()
    }
}

/// The file of a recording, in the place of an older one if there are bytes of one. Nothing of it stays.
fn log_file(older: &[u8]) -> Option<LogFile> {
    let name = format!("roverlab-sweep-{}.mcap", process::id());
    let [path, aside] = [name.clone(), format!(".{name}.part")].map(|name| env::temp_dir().join(name));
    if !older.is_empty() {
        fs::write(&path, older).ok()?;
    }
    let file = LogFile::create(&path).ok();
    for path in [path, aside] {
        let _ = fs::remove_file(path);
    }
    file
}

samples! {
    LogFile => [log_file(&[])?, log_file(&recorded(&Header::default(), |_| Ok(()))?)?];
    Log => [
        Log::read(robots(0..4, 0.5, 0.2)?).ok()?,
        Log::read(recorded(&Header::default(), |_| Ok(()))?).ok()?,
        Log::read(robots(0..4, 1e300, 1e300)?).ok()?,
        Log::read(robots(0..4, f64::NAN, f64::NAN)?).ok()?,
        Log::read(robots(0..4, f64::INFINITY, f64::NEG_INFINITY)?).ok()?,
        Log::read(robots(0..4, 18_446_744_073.0, 0.0)?).ok()?,
        Log::read(robots([3, 1000], 0.5, 0.2)?).ok()?,
        Log::read(robots([1_000_000_000], 0.5, 0.2)?).ok()?,
        Log::read(robots([usize::MAX], 0.5, 0.2)?).ok()?,
        Log::read(robots([0, 0], 0.5, 0.2)?).ok()?,
        Log::read(simulated(&Header::default())?).ok()?,
        Log::read(simulated(&packed(Compression::Lz4))?).ok()?,
        Log::read(simulated(&packed(Compression::Zstd))?).ok()?,
        Log::read(fleet()?).ok()?,
        Log::read(rest(&simulated(&packed(Compression::None))?, 0.7)?).ok()?,
        Log::read(rest(&robots(0..4, 0.5, 0.2)?, 0.9)?).ok()?
    ];
}
