//! Robots stepped together in one thread.

use super::*;

/// Two robots, the first of which stops for good after some steps.
fn patrol(fleet: &mut dyn FleetIo<'_>, period: f64, steps: u32) -> Result<Vec<Pose>> {
    let mut left = steps;
    let first = move |robot: &mut dyn RobotIo| {
        left -= 1;
        robot.set_speed(Twist::new(0.1, 0.1 * f64::from(left)))?;
        Ok(if left == 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    };
    let second = |robot: &mut dyn RobotIo| {
        let free = robot.scan()?.ranges[0].min(robot.pose()?.x + 1.0);
        robot.set_speed(Twist::new(0.1 * free, 0.0))?;
        robot.print(".")?;
        Ok(ControlFlow::Continue(()))
    };
    fleet.control(0, period, Box::new(first))?;
    fleet.control(1, 0.07, Box::new(second))?;
    let mut path = Vec::new();
    while fleet.time()? < 2.45 {
        fleet.run_for(0.1)?;
        path.extend([fleet.pose(0)?, fleet.pose(1)?]);
    }
    path.extend([fleet.truth(0)?.pose, fleet.truth(1)?.odometry]);
    Ok(path)
}

fn pair() -> Scene {
    let mut scene = scene();
    let second = crate::world::RobotPlacement { pose: Pose::new(0.5, 0.4, 0.0), ..scene.robots[0].clone() };
    scene.robots.push(second);
    scene
}

fn recorded_fleet<'a, T>(
    fleet: impl FleetIo<'a> + 'a,
    run: impl FnOnce(&mut dyn FleetIo<'a>) -> T,
) -> (T, Vec<u8>) {
    let writer = LogWriter::new(Vec::new(), &header()).unwrap();
    let mut fleet = writer.fleet(fleet);
    let result = run(&mut fleet);
    drop(fleet);
    (result, writer.finish().unwrap())
}

fn fleet<'a>() -> Fleet<'a> {
    Fleet::new(&pair(), SimOptions::with_noise(1.0, 3)).unwrap()
}

#[test]
fn a_troop_replays_to_the_bit() {
    let (path, bytes) = recorded_fleet(fleet(), |fleet| patrol(fleet, 0.05, 30).unwrap());
    assert_eq!(path, patrol(&mut fleet(), 0.05, 30).unwrap());
    assert!(bytes == recorded_fleet(fleet(), |fleet| patrol(fleet, 0.05, 30)).1);
    let log = Log::read(bytes.clone()).unwrap();
    let player = Player::new(&log);
    let (again, second) = recorded_fleet(player.fleet(), |fleet| patrol(fleet, 0.05, 30).unwrap());
    assert_eq!((again, player.rest()), (path, None));
    let second = Log::read(second).unwrap();
    assert!(second.bytes() == bytes, "{}", Difference::between(&log, &second).unwrap());
    // Viewers and other tools expect messages in the order of their time.
    let times: Vec<u64> = super::reader::whole(&bytes)
        .unwrap()
        .iter()
        .filter(|record| record.opcode == mcap::records::op::CHUNK)
        .flat_map(|chunk| super::reader::inner(&chunk.body[40..]).map(|inner| inner.unwrap()))
        .filter(|record| record.opcode == mcap::records::op::MESSAGE)
        .map(|record| super::reader::message(record.body).unwrap().header.log_time)
        .collect();
    assert!(times.is_sorted() && times.len() > 300, "{}", times.len());
}

#[test]
fn a_troop_that_does_something_else_is_named() {
    let (_, bytes) = recorded_fleet(fleet(), |fleet| patrol(fleet, 0.05, 30));
    let log = Log::read(bytes.clone()).unwrap();
    let named = |log: &Log, period, steps| {
        let error = patrol(&mut Player::new(log).fleet(), period, steps).unwrap_err();
        (error.kind(), error.to_string())
    };
    let message = "found control(0.06); expected control(0.05), as recorded";
    assert_eq!(named(&log, 0.06, 30), (ErrorKind::Diverged, message.into()));
    let (kind, message) = named(&log, 0.05, 31);
    assert!(kind == ErrorKind::Diverged && message.contains("found the call set_speed("), "{message}");
    let (kind, message) = named(&log, 0.05, 29);
    assert!(kind == ErrorKind::Diverged && message.contains("set_speed("), "{message}");
    let idle = Player::new(&log)
        .fleet()
        .control(0, 0.05, Box::new(|_| Ok(ControlFlow::Continue(()))))
        .and_then(|()| patrol(&mut Player::new(&Log::read(recorded(0.3)).unwrap()).fleet(), 0.05, 3));
    assert_eq!(idle.unwrap_err().kind(), ErrorKind::EndOfLog);
    let mut fleet = Player::new(&log).fleet();
    fleet.control(0, 0.05, Box::new(|_| Ok(ControlFlow::Continue(())))).unwrap();
    let error = fleet.run_for(0.1).unwrap_err().to_string();
    assert!(error.starts_with("found a step without a call; expected set_speed("), "{error}");
    // A truncated recording replays as far as it goes.
    let saved = Log::read(recover(&bytes[..bytes.len() / 2]).unwrap().bytes).unwrap();
    assert_eq!(named(&saved, 0.05, 30).0, ErrorKind::EndOfLog);
}

#[test]
fn an_error_that_ends_a_troop_is_replayed() {
    let run = |fleet: &mut dyn FleetIo<'_>| {
        for (robot, sensor) in [(0, Psd::FRONT), (1, Psd(99))] {
            let mut steps = 0;
            let step = move |robot: &mut dyn RobotIo| {
                steps += 1;
                robot.pose()?;
                robot.distance(if steps < 8 { Psd::FRONT } else { sensor })?;
                Ok(ControlFlow::Continue(()))
            };
            fleet.control(robot, 0.05, Box::new(step)).unwrap();
        }
        (0..20).try_for_each(|_| fleet.run_for(0.1)).unwrap_err().to_string()
    };
    let (error, bytes) = recorded_fleet(fleet(), run);
    let log = Log::read(bytes.clone()).unwrap();
    let player = Player::new(&log);
    let (again, second) = recorded_fleet(player.fleet(), run);
    assert_eq!((again, player.rest()), (error, None));
    assert!(second == bytes, "{}", Difference::between(&log, &Log::read(second).unwrap()).unwrap());
}
