use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs::File;
use std::io::{BufWriter, ErrorKind as StreamError};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::thread;
use std::time::Duration;

use eyesim::ask::{Request, Seat};
use eyesim::plan::{Plan, names};
use eyesim::process;
use eyesim::report::Report;
use eyesim::wire::{Answer, LONGEST_REQUEST, Question, receive, send};
use roverlab::geometry::Pose;
use roverlab::io::log::{Header, LogWriter};
use roverlab::io::sim::{SimOptions, Simulation, TICK, Truth as World};
use roverlab::io::{self, Clock, ErrorKind, RobotIo};
use roverlab::world::Scene;

use super::children::{Running, start};
use super::options::Options;
use super::picture;
use super::programs::Program;
use super::verdict::{Ending, Truth, Verdict};
use super::work_folder::WorkFolder;

/// A program's end as its host saw it.
#[derive(Debug)]
struct Served {
    /// The program's own time.
    time: f64,
    /// Its robot's contacts until then.
    contacts: u64,
    /// What the host has ended it for.
    ended: Option<Ending>,
}

/// Seconds between two points of a path in a picture.
const TRAIL: f64 = 0.1;

/// Runs programs in one world, which lives here: each of them is answered by a thread of its own, and the world moves
/// on when all that run have asked for it.
pub(crate) fn run_together(
    programs: &[Program],
    plan: &Plan,
    scene: &Scene,
    options: &Options,
    folder: &WorkFolder,
) -> Result<Vec<Verdict>, String> {
    let trail = options.picture.is_some().then_some(TRAIL);
    let sim_options = SimOptions { trail_interval: trail, ..plan.options() };
    let times = (sim_options.call_duration, sim_options.time_limit);
    let simulation = Simulation::new(scene, sim_options).map_err(|error| error.to_string())?;
    // All are seated before the first one drives, so that the world waits for all of them.
    let log = options.record.as_deref().map(|file| recording(file, plan, scene)).transpose()?;
    let seats = programs.iter().map(|program| {
        let (robot, index) = (simulation.robot(program.robot)?, program.robot);
        let robot: Box<dyn RobotIo + Send> = match &log {
            Some(log) => Box::new(log.recorder(robot, index)),
            None => Box::new(robot),
        };
        Ok(Seat::of(robot, &simulation, scene, index, times))
    });
    let seats = seats.collect::<io::Result<Vec<_>>>().map_err(|error| error.to_string())?;

    let mut tables = Vec::new();
    for (program, seat) in programs.iter().zip(seats) {
        let (ours, theirs) = UnixStream::pair().map_err(|error| format!("no socket: {error}"))?;
        let number = OsString::from(process::socket_number(&theirs).to_string());
        let (seed, index) = (options.seed.to_string().into(), program.robot.to_string().into());
        let variables = BTreeMap::from([(names::SOCKET, number), (names::SEED, seed), (names::INDEX, index)]);
        let running = start(program, variables, Some(&theirs), options, folder)?;
        drop(theirs);
        tables.push((program, seat, ours, running));
    }
    let endings: Vec<_> = thread::scope(|scope| {
        let threads: Vec<_> = tables
            .into_iter()
            .map(|(program, seat, stream, running)| {
                scope.spawn(move || (program, attend(seat, stream, running, options)))
            })
            .collect();
        threads.into_iter().filter_map(|thread| thread.join().ok()).collect()
    });

    drive_on(&simulation, scene);
    if let Some(Err(error)) = log.map(LogWriter::finish) {
        return Err(format!("--record: the recording is incomplete: {error}"));
    }
    let world = simulation.truth();
    if let Some(file) = &options.picture {
        picture::draw(scene, &world, file)?;
    }
    let verdicts = endings.into_iter().map(|(program, (served, (ending, report)))| {
        let ending = match served.ended {
            Some(ended) if !matches!(ending, Ending::Exit(..)) => ended,
            _ => ending,
        };
        let time = program_time(served.time, report.time).min(options.time_limit);
        let contacts = served.contacts;
        Verdict::new(program, ending, &report, truth(&world, program.robot, time, contacts))
    });
    Ok(verdicts.collect())
}

/// The program's time at its end: that of its last question, and what calls without a question have taken since, as its
/// library says. That is not much; more is not believed.
fn program_time(last_question: f64, reported: f64) -> f64 {
    let most = last_question + 2.0 * TICK;
    if (last_question..=most).contains(&reported) { reported } else { last_question }
}

/// Begins a recording.
fn recording(file: &Path, plan: &Plan, scene: &Scene) -> Result<LogWriter<BufWriter<File>>, String> {
    let begin = || {
        let header = Header { seed: Some(plan.seed), ..Header::new("robios", Vec::<String>::new()) };
        LogWriter::new(BufWriter::new(File::create(file)?), &header)
    };
    let log = begin().map_err(|error: std::io::Error| {
        format!("--record {}: {error}; expected a file that can be written", file.display())
    })?;
    log.show(scene);
    Ok(log)
}

fn truth(world: &World, robot: usize, time: f64, contacts: u64) -> Truth {
    world.robot(robot).map_or_else(
        |_| Truth::default(),
        |robot| Truth {
            time,
            pose: robot.pose,
            odometry: robot.odometry,
            path_length: robot.path_length,
            contacts,
            later_contacts: u64::from(robot.contacts).saturating_sub(contacts),
        },
    )
}

/// Answers a program until it ends, and waits for its end.
fn attend(
    mut seat: Seat,
    stream: UnixStream,
    running: Result<Running, String>,
    options: &Options,
) -> (Served, (Ending, Report)) {
    match running {
        Err(message) => {
            let served = Served { time: seat.now(), contacts: 0, ended: None };
            (served, (Ending::NotStarted(message), Report::default()))
        }
        Ok(running) => {
            let served = serve(seat, stream, running.id(), options.hang_limit);
            (served, running.wait(options.real_limit))
        }
    }
}

/// Answers a program's questions. When it returns, the world goes on without the robot's program.
fn serve(mut seat: Seat, mut stream: UnixStream, process: u32, hang_limit: f64) -> Served {
    let mut frame = Vec::new();
    let patience = Duration::try_from_secs_f64(hang_limit).ok();
    // Others wait for a program that neither asks nor takes its answers.
    let _ = stream.set_read_timeout(patience).and_then(|()| stream.set_write_timeout(patience));
    let ended = loop {
        match receive(&mut stream, LONGEST_REQUEST, &mut frame) {
            Ok(true) => {}
            Err(error) if is_timeout(&error) => {
                if drift(&mut seat, &stream) {
                    continue;
                }
                let message =
                    format!("its simulated time was over, after {hang_limit} real seconds without a call");
                break Some(Ending::OutOfTime(message));
            }
            Err(error) if error.kind() == StreamError::InvalidData => {
                break Some(Ending::Offence(error.to_string()));
            }
            // It has ended, after a question or in the middle of one.
            Ok(false) | Err(_) => break None,
        }
        let Some(Question { debt, request }) = Question::decode(&frame) else {
            let message = format!("a question of {} bytes that makes no sense", frame.len());
            break Some(Ending::Offence(message));
        };
        let reply = seat.ask(debt, &request);
        let over = reply.as_ref().is_err_and(|error| error.kind() == ErrorKind::TimedOut);
        let answer = Answer { now: seat.now(), reply };
        if send(&mut stream, answer.encode()).is_err() || over {
            break None;
        }
    };
    if ended.is_some() {
        process::kill_all(process);
    }
    let contacts = seat.truth().robot(seat.index()).map_or(0, |robot| robot.contacts.into());
    Served { time: seat.now(), contacts, ended }
}

/// Lets time pass for a program that has not called for long, so that the world goes on without it: it may have nothing
/// more to ask, as after `VWSetSpeed(0, 100); while (1);`. Returns whether it calls again, before its time is over.
fn drift(seat: &mut Seat, stream: &UnixStream) -> bool {
    while !process::is_readable(stream, 1) {
        if seat.ask(0.0, &Request::Pass(LOOK)).is_err() {
            return false;
        }
    }
    true
}

fn is_timeout(error: &std::io::Error) -> bool {
    matches!(error.kind(), StreamError::WouldBlock | StreamError::TimedOut)
}

/// Seconds between two looks at robots that drive on.
const LOOK: f64 = 0.1;

/// Lets robots whose programs have ended drive on until all stand, or the time is over.
fn drive_on(simulation: &Simulation, scene: &Scene) {
    let world = simulation.truth();
    let poses =
        || -> Vec<Pose> { (0..scene.robots.len()).filter_map(|robot| world.pose(robot).ok()).collect() };
    let Ok(mut robot) = simulation.robot(0) else { return };
    let mut before = poses();
    while robot.wait(LOOK).is_ok() {
        let now = poses();
        if now == before {
            return;
        }
        before = now;
    }
}
