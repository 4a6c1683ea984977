use roverlab::geometry::{Point, Pose};
use roverlab::io::control::run;
use roverlab::io::log::GroundTruth;
use roverlab::io::sim::{RobotTruth, SimOptions};
use roverlab::io::{self, ErrorKind};
use roverlab::nav::{BugEvent, BugOutcome, BugParameters, DistBug, WallSide};

use crate::common::{Failure, Stage, StageTruth, Trip, at_goal};
use crate::driving::{Ending, Trail};

/// Driving options.
#[derive(Debug, Clone)]
pub(crate) struct Options {
    pub(crate) seed: u64,
    pub(crate) noise: f64,
    /// Time limit (s).
    pub(crate) time_limit: f64,
}

/// An event of a run. Points are in the world.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Event {
    /// Time (s).
    pub(crate) time: f64,
    pub(crate) happening: Happening,
}

/// Kind of an event.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Happening {
    /// An obstacle was met, at a distance from the goal (m).
    Hit { point: Point, side: WallSide, distance: f64 },
    /// The obstacle was left, with a free range towards the goal (m).
    Leave { point: Point, free: f64, distance: f64 },
    /// The robot touched something.
    Contact { point: Point },
}

/// A run with its ground truth.
#[derive(Debug, Clone)]
pub(crate) struct Drive {
    pub(crate) ending: Ending<BugOutcome>,
    pub(crate) events: Vec<Event>,
    /// Ground truth at the end.
    pub(crate) truth: RobotTruth,
    /// Pose by odometry, in the world.
    pub(crate) odometry: Pose,
    /// Simulated time (s).
    pub(crate) sim_time: f64,
    /// True distance of the robot from the goal (m).
    pub(crate) goal_distance: f64,
    /// True path, and path by odometry.
    pub(crate) trail: Trail,
    pub(crate) odometry_path: Vec<(f64, Point)>,
    /// Points of the last scan, placed by the robot's own pose estimate.
    pub(crate) seen: Vec<Point>,
}

impl Drive {
    /// Whether the robot says that it is at the goal and in truth is not, as odometry has drifted.
    pub(crate) fn is_missed(&self, noise: f64) -> bool {
        self.ending == Ok(BugOutcome::Reached) && self.goal_distance > at_goal(noise)
    }

    /// Points of the events accepted by `pick`.
    pub(crate) fn points(&self, pick: impl Fn(&Happening) -> Option<Point>) -> Vec<Point> {
        self.events.iter().filter_map(|event| pick(&event.happening)).collect()
    }

    /// Hit points.
    pub(crate) fn hit_points(&self) -> Vec<Point> {
        self.points(|h| if let Happening::Hit { point, .. } = h { Some(*point) } else { None })
    }

    /// Leave points.
    pub(crate) fn leave_points(&self) -> Vec<Point> {
        self.points(|h| if let Happening::Leave { point, .. } = h { Some(*point) } else { None })
    }
}

/// Drives the first robot of a stage to a goal by DistBug. `watch` is called at every step with its time and
/// events.
///
/// Fails if there is no such robot, or it cannot run DistBug. Failures during the run are part of the result.
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
    // Dropping the robot freezes the world, and therefore the ground truth.
    drop(robot);
    log.finish(&bug, trip.goal, ending(result))
}

/// Options of the simulation.
pub(crate) fn sim_options(options: &Options) -> SimOptions {
    // The behaviour's own limit comes first, unless its clock has stopped.
    const RESERVE: f64 = 1.0;
    SimOptions {
        time_limit: Some(options.time_limit + RESERVE),
        ..SimOptions::with_noise(options.noise, options.seed)
    }
}

/// The ending of a bug's run. The end of the simulator's time is that of the bug's.
pub(crate) fn ending(result: io::Result<BugOutcome>) -> Ending<BugOutcome> {
    match result {
        Err(error) if error.kind() == ErrorKind::TimedOut => Ok(BugOutcome::TimedOut),
        result => result.map_err(|error| Failure::from(error).to_string()),
    }
}

/// Observations of a run so far.
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

    /// Records the step at a time. Returns its events.
    fn note(&mut self, time: f64, bug: &mut DistBug) -> &[Event] {
        let before = self.events.len();
        // The truth is that of the driving robot, so it exists.
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

    fn finish(mut self, bug: &DistBug, goal: Point, ending: Ending<BugOutcome>) -> Result<Drive, Failure> {
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
