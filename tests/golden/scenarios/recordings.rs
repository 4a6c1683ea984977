//! Recordings: the bytes written, the entries read back, and replays.

use super::Scenario;

pub(super) const SCENARIOS: &[Scenario] = &[
    #[cfg(feature = "log")]
    Scenario::new("recording", with_log::recording),
    #[cfg(not(feature = "log"))]
    Scenario::without("recording", "built without the feature `log`"),
    #[cfg(feature = "log")]
    Scenario::new("recorded-fleet", with_log::fleet),
    #[cfg(not(feature = "log"))]
    Scenario::without("recorded-fleet", "built without the feature `log`"),
];

#[cfg(feature = "log")]
mod with_log {
    use std::ops::ControlFlow;

    use roverlab::geometry::{Pose, Twist};
    use roverlab::io::log::{FleetIo, GroundTruth, Header, Log, LogWriter, OpenLoop, Player, recover};
    use roverlab::io::sim::{Fleet, Simulation};
    use roverlab::io::{Clock, Drive, LidarScan, Odometry, Psd, Result, RobotIo};

    use super::super::{fnv, in_room, noise, note, other};

    /// Some of everything.
    fn tour<R: RobotIo + ?Sized>(robot: &mut R) -> Result<()> {
        robot.print("hello, \"world\"\n")?;
        robot.set_speed(Twist::new(0.2, 0.4))?;
        let mut scan = LidarScan::default();
        while robot.now()? < 2.0 {
            robot.scan_into(&mut scan)?;
            robot.pose()?;
            robot.read_key()?;
            robot.encoder(1)?;
            robot.distance(Psd::FRONT)?;
            robot.wait(0.1)?;
        }
        robot.image()?;
        // A sensor that is not there.
        let _ = robot.distance(Psd(77));
        let id = robot.radio_id()?;
        robot.send(id, b"x\0y")?;
        robot.receive()?;
        robot.turn(0.5, 1.0)?;
        robot.wait_done()
    }

    fn header() -> Header {
        // A new version of the library alone must not change the bytes.
        let header = Header::new("golden", ["--noise=1", "--seed=171"]);
        Header { seed: Some(171), version: "0".into(), ..header }
    }

    /// The bytes of a recording, its entries, its replay, and what is left of it when it is cut off.
    pub(super) fn recording() -> Result<String> {
        let mut log = String::new();
        let scene = in_room(0.5, 0.5, 0.3);
        let simulation = Simulation::new(&scene, noise(1.0, 171))?;
        let writer = LogWriter::new(Vec::new(), &header()).map_err(other)?;
        writer.show(&scene);
        let mut robot = writer.recorder(simulation.robot(0)?, 0);
        let mut truth = writer.truth(simulation.truth(), 0);
        tour(&mut robot)?;
        drop(robot);
        truth.robot(0)?;
        let bytes = writer.finish().map_err(other)?;
        note(&mut log, "bytes", &(bytes.len(), fnv(bytes.iter().copied())));
        let read = Log::read(bytes.clone()).map_err(other)?;
        note(&mut log, "contents", &(read.topics(), read.chunks(), read.span(), read.start(0)));
        for entry in read.entries(0) {
            note(
                &mut log,
                "entry",
                &(entry.time, entry.truth, &entry.method, &entry.arguments, entry.result),
            );
        }
        let player = Player::new(&read);
        let mut truth = player.truth(0).map_err(other)?;
        let replayed = tour(&mut player.robot(0).map_err(other)?);
        note(&mut log, "replayed", &(replayed, truth.robot(0)?, player.rest()));
        let mut open = OpenLoop::new(&read, 0).map_err(other)?;
        open.set_speed(Twist::new(0.3, 0.1))?;
        open.wait(0.5)?;
        note(&mut log, "open loop", &(open.now()?, open.pose()?, open.report(), open.commands()));
        let saved = recover(&bytes[..bytes.len() * 2 / 3]).map_err(other)?;
        note(&mut log, "saved", &(saved.chunks, saved.messages, saved.lost, fnv(saved.bytes)));
        Ok(log)
    }

    /// Two robots that keep their distance, for three seconds.
    fn approach(fleet: &mut dyn FleetIo<'_>) -> Result<Vec<Pose>> {
        for robot in 0..2 {
            fleet.control(
                robot,
                0.1 + 0.05 * robot as f64,
                Box::new(|robot| {
                    let free = robot.distance(Psd::FRONT)?;
                    robot.set_speed(Twist::new(0.5 * (free - 0.2), 0.1))?;
                    Ok(ControlFlow::Continue(()))
                }),
            )?;
        }
        fleet.run_for(3.0)?;
        (0..2).map(|robot| fleet.pose(robot)).collect()
    }

    pub(super) fn fleet() -> Result<String> {
        let mut log = String::new();
        let mut scene = in_room(0.5, 0.5, 0.3);
        let mut second = scene.robots[0].clone();
        second.pose = Pose::new(2.5, 1.2, 3.0);
        scene.robots.push(second);
        let writer = LogWriter::new(Vec::new(), &header()).map_err(other)?;
        let mut recorded = writer.fleet(Fleet::new(&scene, noise(1.0, 172))?);
        note(&mut log, "poses", &approach(&mut recorded)?);
        drop(recorded);
        let bytes = writer.finish().map_err(other)?;
        note(&mut log, "bytes", &(bytes.len(), fnv(bytes.iter().copied())));
        let read = Log::read(bytes).map_err(other)?;
        for entry in read.entries(1) {
            note(&mut log, "entry", &(entry.time, entry.method, entry.arguments, entry.result));
        }
        note(&mut log, "replayed", &approach(&mut Player::new(&read).fleet())?);
        Ok(log)
    }
}
