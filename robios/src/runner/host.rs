use std::collections::BTreeMap;
use std::path::Path;
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use crate::ask::Request;
use crate::memory::{Asked, Memory};
use crate::plan::{Plan, names};
use crate::process;
use crate::report::{Report, Stance};
use crate::seat::{Seat, Terms, Walked};
use crate::verdict::{Ending, Truth, Verdict};
use crate::wire::{Answer, LONGEST_REQUEST, Question};
use roverlab::files::TemporaryFolder;
use roverlab::geometry::Pose;
use roverlab::io::log::{Header, LogFile, LogWriter};
use roverlab::io::sim::{SimOptions, Simulation, TICK, Truth as World};
use roverlab::io::{self, Clock, ErrorKind, RobotIo};
use roverlab::world::Scene;
use roverlab_view::serve::Beside;

use super::children::{Running, start};
use super::options::Options;
use super::panels::Panels;
use super::picture;
use super::programs::Program;
use super::stopwatch::Stopwatch;

/// The end of a program from its host's perspective.
#[derive(Debug)]
struct Served {
    /// Time of the program (s).
    time: f64,
    /// Number of its robot's contacts until then.
    contacts: u64,
    /// What is known of a walker.
    walked: Option<Walked>,
    /// How the program ended, and its report.
    ending: Ending,
    report: Report,
}

/// Interval between two points of a path in a picture (s).
const TRAIL: f64 = 0.1;
/// Grace period for the threads that answer programs which were ended.
const GRACE: Duration = Duration::from_secs(1);

/// Runs programs in one world hosted here: a thread answers each of them, and the world advances when all
/// running programs have asked it to.
pub(crate) fn run_together(
    programs: &[Program],
    plan: &Plan,
    scene: &Scene,
    options: &Options,
    folder: &TemporaryFolder,
    page: Option<&Beside>,
) -> Result<Vec<Verdict>, String> {
    let trail = options.trail.or(options.picture.is_some().then_some(TRAIL));
    let sim_options = SimOptions { trail_interval: trail, ..plan.options() };
    let terms = Terms::of(&sim_options);
    // A recording contains all calls.
    let terms = Terms { exact: terms.exact && options.record.is_none(), ..terms };
    let simulation = Simulation::new(scene, sim_options).map_err(|error| error.to_string())?;
    // All programs get their robots before the first one drives, so that the world waits for all of them.
    let log = options.record.as_deref().map(|file| recording(file, options, plan, scene)).transpose()?;
    let seats = programs.iter().map(|program| {
        let (robot, index) = (simulation.robot(program.robot)?, program.robot);
        let robot: Box<dyn RobotIo + Send> = match &log {
            Some(log) => Box::new(log.recorder(robot, index)),
            None => Box::new(robot),
        };
        Ok(Seat::of(robot, &simulation, scene, index, terms))
    });
    let seats = seats.collect::<io::Result<Vec<_>>>().map_err(|error| error.to_string())?;

    let panels = page.map(|page| watched(page, &simulation, scene, options));
    let stopwatch = Stopwatch::start();
    let (sender, results) = mpsc::channel();
    let mut processes = Vec::new();
    let tables = programs.iter().zip(seats).map(|(program, seat)| {
        let patience = options.hang_limit.to_string().into();
        let (seed, index) = (options.seed.to_string().into(), program.robot.to_string().into());
        let variables =
            BTreeMap::from([(names::SHARED, patience), (names::SEED, seed), (names::INDEX, index)]);
        Ok((seat, start(program, variables, options, folder, stopwatch, panels.as_ref())?))
    });
    for (number, (seat, running)) in tables.collect::<Result<Vec<_>, String>>()?.into_iter().enumerate() {
        processes.extend(running.as_ref().ok().map(Running::id));
        let (sender, limits) = (sender.clone(), (options.real_limit, options.hang_limit));
        thread::spawn(move || {
            // Nobody receives any more after the real-time limit.
            let _ = sender.send((number, attend(seat, running, limits)));
        });
    }
    let served = collect(&results, programs.len(), &processes, &stopwatch, options.real_limit);

    drive_on(&simulation, scene, &stopwatch, options.real_limit);
    // A thread that is still answering holds a reference, so nothing more is written.
    let finished = served.iter().all(Option::is_some);
    if let Some(Err(error)) = log.filter(|_| finished).map(|log| log.finish().and_then(LogFile::complete)) {
        return Err(format!("--record: the recording is incomplete: {error}"));
    }
    let world = simulation.truth();
    if let Some(file) = &options.picture {
        picture::draw(scene, &world, file)?;
    }
    let verdicts = programs.iter().zip(served).map(|(program, served)| {
        let served = served.unwrap_or_else(|| Served {
            time: world.time(),
            contacts: world.robot(program.robot).map_or(0, |robot| robot.contacts.into()),
            walked: None,
            ending: Ending::OutOfTime(format!("ended after {} real seconds", options.real_limit)),
            report: Report::default(),
        });
        let time = program_time(served.time, served.report.time).min(options.time_limit);
        let mut truth = truth(&world, program.robot, time, served.contacts);
        if options.trail.is_none() {
            truth.trail.clear();
        }
        if let Some(Walked { odometry, path_length, stance }) = served.walked {
            truth = Truth { stance, odometry, path_length, ..truth };
        }
        Verdict::new(&program.name, program.robot, served.ending, &served.report, truth)
    });
    Ok(verdicts.collect())
}

/// Puts a page beside a world, and waits for somebody who looks unless told not to. Returns what the page has
/// of the programs.
fn watched(page: &Beside, simulation: &Simulation, scene: &Scene, options: &Options) -> Panels {
    let panels = Panels::default();
    simulation.watch(page.scene_with(scene, Some(Box::new(panels.clone()))));
    if !options.no_wait {
        page.wait();
    }
    panels
}

/// Waits for the ends of programs, and ends them all at the real-time limit.
fn collect(
    results: &mpsc::Receiver<(usize, Served)>,
    count: usize,
    processes: &[u32],
    stopwatch: &Stopwatch,
    real_limit: f64,
) -> Vec<Option<Served>> {
    let mut served: Vec<Option<Served>> = (0..count).map(|_| None).collect();
    let mut patience = Duration::try_from_secs_f64(real_limit).unwrap_or(Duration::MAX);
    let mut killed = false;
    while served.iter().any(Option::is_none) {
        match results.recv_timeout(patience) {
            Ok((number, end)) => served[number] = Some(end),
            Err(mpsc::RecvTimeoutError::Timeout) if !killed => {
                for &process in processes {
                    process::kill_all(process);
                }
                killed = true;
            }
            Err(_) => break,
        }
        let left = Duration::try_from_secs_f64(real_limit - stopwatch.seconds()).unwrap_or(Duration::ZERO);
        patience = if killed { GRACE } else { left };
    }
    served
}

/// The program's time at its end: that of its last request plus later local calls, as reported by its library
/// and limited to a plausible value.
fn program_time(last_question: f64, reported: f64) -> f64 {
    let most = last_question + 2.0 * TICK;
    if (last_question..=most).contains(&reported) { reported } else { last_question }
}

/// Starts a recording.
fn recording(
    file: &Path,
    options: &Options,
    plan: &Plan,
    scene: &Scene,
) -> Result<LogWriter<LogFile>, String> {
    let begin = || {
        let header = Header { seed: Some(plan.seed), ..Header::new("robios", Vec::<String>::new()) };
        let sink = if options.force { LogFile::replace(file) } else { LogFile::create(file) }?;
        LogWriter::new(if options.fsync { sink.synced() } else { sink }, &header)
    };
    let log = begin().map_err(|error: std::io::Error| {
        let expected = match error.kind() {
            std::io::ErrorKind::AlreadyExists => ", or --force",
            std::io::ErrorKind::ResourceBusy => "",
            _ => "; expected a file that can be written",
        };
        format!("--record {}: {error}{expected}", file.display())
    })?;
    log.show(scene);
    Ok(log)
}

fn truth(world: &World, index: usize, time: f64, contacts: u64) -> Truth {
    world.robot(index).map_or_else(
        |_| Truth::default(),
        |robot| Truth {
            time,
            pose: robot.pose,
            stance: Stance::of(world, index),
            odometry: robot.odometry,
            path_length: robot.path_length,
            contacts,
            later_contacts: u64::from(robot.contacts).saturating_sub(contacts),
            trail: robot.trail,
        },
    )
}

/// Answers a program until it ends, and waits for its end.
fn attend(mut seat: Seat, running: Result<Running, String>, (real_limit, hang_limit): (f64, f64)) -> Served {
    let mut running = match running {
        Ok(running) => running,
        Err(message) => {
            let ending = Ending::NotStarted(message);
            return Served { time: seat.now(), contacts: 0, walked: None, ending, report: Report::default() };
        }
    };
    let offence = serve(&mut seat, &mut running, hang_limit);
    let contacts = seat.truth().robot(seat.index()).map_or(0, |robot| robot.contacts.into());
    let (time, walked) = (seat.now(), seat.walked());
    // The world continues without the robot's program.
    drop(seat);
    if offence.is_some() {
        process::kill_all(running.id());
    }
    let (ending, report) = running.wait(real_limit);
    let ending = match offence {
        Some(offence) if !matches!(ending, Ending::Exit(..)) => offence,
        _ => ending,
    };
    Served { time, contacts, walked, ending, report }
}

/// Interval of the checks whether a silent program has ended.
const GLANCE: Duration = Duration::from_millis(5);

/// Answers a program's requests until there are no more. Returns the reason to end it, if any.
fn serve(seat: &mut Seat, running: &mut Running, hang_limit: f64) -> Option<Ending> {
    let memory = running.memory().clone();
    let mut silence = Stopwatch::start();
    loop {
        let frame = match memory.asked(LONGEST_REQUEST, GLANCE) {
            Asked::Question(frame) => frame,
            Asked::Left => return None,
            Asked::TooLong(length) => {
                let message = format!("a question of {length} bytes; expected at most {LONGEST_REQUEST}");
                return Some(Ending::Offence(message));
            }
            Asked::Nothing if running.has_ended() => return None,
            // Others wait for a program that sends no requests.
            Asked::Nothing if silence.seconds() < hang_limit || drift(seat, &memory, running) => continue,
            Asked::Nothing if running.has_ended() => return None,
            Asked::Nothing => {
                let message =
                    format!("its simulated time was over, after {hang_limit} real seconds without a call");
                return Some(Ending::OutOfTime(message));
            }
        };
        let Some(Question { debt, wanted, request }) = Question::decode(&frame) else {
            let message = format!("a question of {} bytes that makes no sense", frame.len());
            return Some(Ending::Offence(message));
        };
        let reply = seat.ask(debt, &request);
        let over = reply.as_ref().is_err_and(|error| error.kind() == ErrorKind::TimedOut);
        let now = seat.now();
        let readings = if reply.is_ok() { seat.readings(&wanted) } else { Vec::new() };
        memory.answer(&Answer { now, readings, reply }.encode());
        if over {
            return None;
        }
        silence = Stopwatch::start();
    }
}

/// Lets time pass for a program without calls for long, so that the world continues: it may need none, as
/// after `VWSetSpeed(0, 100); while (1);`. Returns whether it calls again before its time limit.
fn drift(seat: &mut Seat, memory: &Memory, running: &mut Running) -> bool {
    while !memory.is_asked(Duration::from_millis(1)) {
        if running.has_ended() || seat.ask(0.0, &Request::Pass(LOOK)).is_err() {
            return false;
        }
    }
    true
}

/// Interval of the checks on robots that drive on (s).
const LOOK: f64 = 0.1;

/// Lets robots whose programs have ended drive on until all stand, or the time is over.
fn drive_on(simulation: &Simulation, scene: &Scene, stopwatch: &Stopwatch, real_limit: f64) {
    let world = simulation.truth();
    let poses =
        || -> Vec<Pose> { (0..scene.robots.len()).filter_map(|robot| world.pose(robot).ok()).collect() };
    let Ok(mut robot) = simulation.robot(0) else { return };
    let mut before = poses();
    while stopwatch.seconds() < real_limit && robot.wait(LOOK).is_ok() {
        let now = poses();
        if now == before {
            return;
        }
        before = now;
    }
}
