use roverlab::geometry::{Point, Pose};
use roverlab::io::control::run;
use roverlab::io::log::GroundTruth;
use roverlab::io::sim::{RobotTruth, SimOptions};
use roverlab::io::{self, ErrorKind};
use roverlab::nav::{BugEvent, BugOutcome, BugParameters, DistBug, WallSide};

use crate::common::{Failure, Stage, StageTruth, Trip};
use crate::driving::Trail;

/// How to drive.
#[derive(Debug, Clone)]
pub(crate) struct Options {
    pub(crate) seed: u64,
    pub(crate) noise: f64,
    /// Simulated seconds.
    pub(crate) time_limit: f64,
}

/// How the behaviour ended.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Ending {
    /// With a verdict, or because the time was over.
    Verdict(BugOutcome),
    /// The robot failed.
    Failed(String),
}

/// Something that happened during a run. Points are in the world.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Event {
    /// Simulated seconds.
    pub(crate) time: f64,
    pub(crate) happening: Happening,
}

/// What happened.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Happening {
    /// An obstacle was in the way, at so many metres from the goal.
    Hit { point: Point, side: WallSide, distance: f64 },
    /// The robot left the obstacle, with the way free for so many metres.
    Leave { point: Point, free: f64, distance: f64 },
    /// The robot touched something.
    Contact { point: Point },
}

/// A run and what is known of it afterwards.
#[derive(Debug, Clone)]
pub(crate) struct Drive {
    pub(crate) ending: Ending,
    pub(crate) events: Vec<Event>,
    /// What is true about the robot in the end.
    pub(crate) truth: RobotTruth,
    /// Where odometry takes the robot to be in the world.
    pub(crate) odometry: Pose,
    /// Simulated seconds.
    pub(crate) sim_time: f64,
    /// Metres from the robot to the goal, truly.
    pub(crate) goal_distance: f64,
    /// Where the robot was at each step, truly and by odometry.
    pub(crate) trail: Trail,
    pub(crate) odometry_path: Vec<(f64, Point)>,
    /// What the robot saw last, in the world as the robot takes it.
    pub(crate) seen: Vec<Point>,
}

impl Drive {
    /// The points of the events that `pick` picks.
    pub(crate) fn points(&self, pick: impl Fn(&Happening) -> Option<Point>) -> Vec<Point> {
        self.events.iter().filter_map(|event| pick(&event.happening)).collect()
    }

    /// Where obstacles were met.
    pub(crate) fn hit_points(&self) -> Vec<Point> {
        self.points(|h| if let Happening::Hit { point, .. } = h { Some(*point) } else { None })
    }

    /// Where obstacles were left.
    pub(crate) fn leave_points(&self) -> Vec<Point> {
        self.points(|h| if let Happening::Leave { point, .. } = h { Some(*point) } else { None })
    }
}

/// Drives the first robot of a stage to a goal by DistBug. `watch` is called with the time at every step, and with
/// what happened there.
///
/// Fails if there is no such robot, or it cannot run DistBug. What goes wrong on the way is part of the result.
pub(crate) fn drive(
    trip: &Trip,
    options: &Options,
    stage: &Stage,
    mut watch: impl FnMut(f64, &[Event]),
) -> Result<Drive, Failure> {
    let start = trip.start();
    let radius = trip.spec().footprint.bounding_radius();
    let parameters = BugParameters::for_radius(radius);
    let mut bug = DistBug::new(start.to_local(trip.goal), parameters).map_err(Failure::input)?;
    let mut robot = stage.robot(0)?;
    let mut log = Log::new(stage.truth(0)?, start);
    let result = run(&mut robot, &mut bug, options.time_limit, |_, bug, _| {
        let time = log.truth.time().unwrap_or_default();
        watch(time, log.note(time, bug));
    });
    // The robot lets go of the world, so that what is true stays as it is.
    drop(robot);
    log.finish(&bug, trip.goal, ending(result))
}

/// How the simulator runs.
pub(crate) fn sim_options(options: &Options) -> SimOptions {
    // The behaviour's own limit comes first, unless its clock has stopped.
    const RESERVE: f64 = 1.0;
    SimOptions {
        time_limit: Some(options.time_limit + RESERVE),
        ..SimOptions::with_noise(options.noise, options.seed)
    }
}

fn ending(result: io::Result<BugOutcome>) -> Ending {
    match result {
        Ok(outcome) => Ending::Verdict(outcome),
        Err(error) if error.kind() == ErrorKind::TimedOut => Ending::Verdict(BugOutcome::TimedOut),
        Err(error) => Ending::Failed(Failure::from(error).to_string()),
    }
}

/// What has been seen of a run so far.
struct Log {
    truth: StageTruth,
    start: Pose,
    events: Vec<Event>,
    contacts: usize,
    trail: Trail,
    odometry_path: Vec<(f64, Point)>,
}

impl Log {
    fn new(truth: StageTruth, start: Pose) -> Self {
        Self {
            truth,
            start,
            events: Vec::new(),
            contacts: 0,
            trail: vec![(0.0, start)],
            odometry_path: vec![(0.0, start.position())],
        }
    }

    /// Takes down the step at a time. Returns what happened in it.
    fn note(&mut self, time: f64, bug: &mut DistBug) -> &[Event] {
        let before = self.events.len();
        // The robot of the truth is the one that drives, so there is one.
        if let Ok(truth) = self.truth.robot(0) {
            let touched = truth.contact_places.iter().skip(self.contacts);
            self.events.extend(touched.map(|&point| Event { time, happening: Happening::Contact { point } }));
            self.contacts = truth.contact_places.len();
            self.trail.push((time, truth.pose));
            self.odometry_path.push((time, self.start.compose(&truth.odometry).position()));
        }
        let distance = bug.goal_distance();
        for event in bug.take_events() {
            let happening = match event {
                BugEvent::Hit { point, side } => {
                    Happening::Hit { point: self.start.to_world(point), side, distance }
                }
                BugEvent::Leave { point, free } => {
                    Happening::Leave { point: self.start.to_world(point), free, distance }
                }
                _ => continue,
            };
            self.events.push(Event { time, happening });
        }
        &self.events[before..]
    }

    fn finish(mut self, bug: &DistBug, goal: Point, ending: Ending) -> Result<Drive, Failure> {
        let truth = self.truth.robot(0).map_err(Failure::run)?;
        let believed = self.start.compose(&bug.pose());
        let sim_time = self.truth.time().map_err(Failure::run)?;
        self.trail.push((sim_time, truth.pose));
        Ok(Drive {
            ending,
            events: self.events,
            odometry: self.start.compose(&truth.odometry),
            sim_time,
            goal_distance: truth.pose.distance_to(goal),
            trail: self.trail,
            odometry_path: self.odometry_path,
            seen: bug.visible_points().iter().map(|&point| believed.to_world(point)).collect(),
            truth,
        })
    }
}
