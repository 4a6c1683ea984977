use roverlab::geometry::{Point, Pose};
use roverlab::io::control::run;
use roverlab::io::log::GroundTruth;
use roverlab::io::sim::SimOptions;
use roverlab::nav::{BugEvent, BugKind, BugOutcome, BugParameters, Guarantee};

use crate::common::{Driven, Failure, Stage, StageTruth, Trip, at_goal};
use crate::distbug::ending;
use crate::driving::Ending;

/// Driving conditions.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Conditions {
    pub(crate) seed: u64,
    pub(crate) noise: f64,
    /// Time limit (s).
    pub(crate) time_limit: f64,
}

/// One algorithm's run with its ground truth.
#[derive(Debug, Clone)]
pub(crate) struct Ride {
    pub(crate) kind: BugKind,
    pub(crate) guarantee: Guarantee,
    pub(crate) ending: Ending<BugOutcome>,
    pub(crate) contacts: u32,
    /// Path length (m).
    pub(crate) path_length: f64,
    pub(crate) goal_distance: f64,
    /// Simulated time (s).
    pub(crate) sim_time: f64,
    /// Hit points, in the world.
    pub(crate) hits: Vec<Point>,
    /// The same as step numbers of the path, each with the step of the following leave or end.
    pub(crate) follows: Vec<(usize, usize)>,
    /// True position at each step.
    pub(crate) path: Vec<Point>,
}

impl Ride {
    /// Whether time was over before a verdict.
    pub(crate) fn is_timed_out(&self) -> bool {
        matches!(self.ending, Ok(BugOutcome::TimedOut | BugOutcome::Stopped))
    }

    /// Name of the ending.
    pub(crate) fn word(&self) -> &'static str {
        match self.ending {
            Ok(BugOutcome::Reached) => "reached",
            Ok(BugOutcome::Unreachable) => "unreachable",
            Ok(BugOutcome::NoRoom) => "no_room",
            Ok(BugOutcome::TimedOut | BugOutcome::Stopped) => "timed_out",
            Err(_) => "failed",
        }
    }

    /// Whether the verdict is true: `reached` requires the robot's true position to be at the goal. Where
    /// nobody can tell whether the goal can be reached, either verdict may be.
    pub(crate) fn is_correct(&self, reachable: Option<bool>, noise: f64) -> bool {
        match self.ending {
            Ok(BugOutcome::Reached) => reachable != Some(false) && self.goal_distance <= at_goal(noise),
            Ok(BugOutcome::Unreachable | BugOutcome::NoRoom) => reachable != Some(true),
            _ => false,
        }
    }
}

/// Parameters of a bug on a trip.
pub(crate) fn parameters(trip: &Trip, noise: f64) -> BugParameters {
    let radius = trip.spec().footprint.bounding_radius();
    // Odometry without noise needs no correction.
    BugParameters { match_scans: noise > 0.0, ..BugParameters::for_radius(radius) }
}

impl Conditions {
    /// Options of the simulation.
    pub(crate) fn sim_options(self) -> SimOptions {
        let time_limit = Some(self.time_limit + 1.0);
        SimOptions { time_limit, ..SimOptions::with_noise(self.noise, self.seed) }
    }
}

/// Drives the first robot of a scene to a goal by one algorithm.
///
/// Fails if the robot cannot be simulated or the algorithm cannot run. Failures during the run are part of
/// the result.
pub(crate) fn ride(trip: &Trip, kind: BugKind, conditions: Conditions) -> Result<Ride, Failure> {
    let stage = Stage::simulated(&trip.scene, conditions.sim_options(), Vec::new())?;
    ride_with(trip, kind, conditions, stage.robot(0)?, &mut stage.truth(0)?)
}

/// The same with a given robot and its ground truth.
pub(crate) fn ride_with(
    trip: &Trip,
    kind: BugKind,
    conditions: Conditions,
    mut robot: Driven,
    truth: &mut StageTruth,
) -> Result<Ride, Failure> {
    let start = trip.start();
    let parameters = parameters(trip, conditions.noise);
    let mut bug = kind.with(start.to_local(trip.goal), parameters).map_err(Failure::input)?;
    let (mut hits, mut follows, mut path) = (Vec::new(), Vec::new(), vec![start.position()]);
    let result = run(&mut robot, bug.as_mut(), conditions.time_limit, |_, bug, _| {
        path.extend(truth.pose(0).ok().as_ref().map(Pose::position));
        for event in bug.take_events() {
            match event {
                BugEvent::Hit { point, .. } => {
                    hits.push(start.to_world(point));
                    follows.push((path.len() - 1, usize::MAX));
                }
                BugEvent::Leave { .. } => {
                    if let Some(follow) = follows.last_mut() {
                        follow.1 = path.len();
                    }
                }
                _ => {}
            }
        }
    });
    for follow in &mut follows {
        follow.1 = follow.1.min(path.len());
    }
    // Read before the robot is dropped, which ends its recording.
    let (sim_time, truth) = (truth.time().map_err(Failure::run)?, truth.robot(0).map_err(Failure::run)?);
    drop(robot);
    Ok(Ride {
        kind,
        guarantee: bug.guarantee(),
        ending: ending(result),
        contacts: truth.contacts,
        path_length: truth.path_length,
        goal_distance: truth.pose.distance_to(trip.goal),
        sim_time,
        hits,
        follows,
        path,
    })
}
