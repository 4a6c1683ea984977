use roverlab::nav::{BugOutcome, Reachability};
use roverlab::random::Stream;
use roverlab::world::generate::{Course, CourseOptions, obstacle_course};
use roverlab::world::{Colour, Marker, RobotSpec, Scene};

use super::{Options, drive, sim_options};
use crate::common::{Failure, Stage, Trip, at_goal, portable};
use crate::driving::Ending;

/// One course of a campaign, driven once at every noise level.
#[derive(Debug, Clone)]
pub(crate) struct Trial {
    /// Seed of the course and the runs.
    pub(crate) seed: u64,
    pub(crate) runs: Vec<Run>,
}

portable!(struct Trial { seed, runs });

/// Result of one run.
#[derive(Debug, Clone)]
pub(crate) struct Run {
    pub(crate) ending: Ending<BugOutcome>,
    pub(crate) judgement: Judgement,
    pub(crate) contacts: u32,
    /// True distance from the goal (m).
    pub(crate) goal_distance: f64,
    /// Path length relative to the shortest path; only for correct runs to the goal.
    pub(crate) path_ratio: Option<f64>,
    /// Simulated time (s).
    pub(crate) sim_time: f64,
}

portable!(struct Run { ending, judgement, contacts, goal_distance, path_ratio, sim_time });

/// Judgement of a verdict.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Judgement {
    Correct,
    /// "Reached", but too far from the goal.
    FarFromGoal,
    /// "Reached" although no way exists: the robot's pose estimate is wrong.
    NotReached,
    /// "Unreachable" although a way exists.
    NotUnreachable,
    /// No verdict within the time limit.
    TimedOut,
    /// The robot failed.
    Failed,
}

portable!(
    enum Judgement {
        Correct,
        FarFromGoal,
        NotReached,
        NotUnreachable,
        TimedOut,
        Failed,
    }
);

impl Judgement {
    /// Names of the wrong judgements in a table.
    pub(crate) const WRONG: [(Judgement, &'static str); 5] = [
        (Judgement::FarFromGoal, "off"),
        (Judgement::NotReached, "false r."),
        (Judgement::NotUnreachable, "false u."),
        (Judgement::TimedOut, "late"),
        (Judgement::Failed, "failed"),
    ];

    fn of(ending: &Ending<BugOutcome>, reachable: bool, goal_distance: f64, noise: f64) -> Self {
        use BugOutcome as Outcome;
        match (ending, reachable) {
            (Err(_), _) => Self::Failed,
            (Ok(Outcome::TimedOut | Outcome::Stopped), _) => Self::TimedOut,
            (Ok(Outcome::Unreachable | Outcome::NoRoom), true) => Self::NotUnreachable,
            (Ok(Outcome::Reached), false) => Self::NotReached,
            (Ok(Outcome::Reached), true) if goal_distance > at_goal(noise) => Self::FarFromGoal,
            (Ok(Outcome::Unreachable | Outcome::NoRoom), false) | (Ok(Outcome::Reached), true) => {
                Self::Correct
            }
        }
    }
}

impl Run {
    /// Whether the verdict is correct and nothing was touched.
    pub(crate) fn is_clean(&self) -> bool {
        self.judgement == Judgement::Correct && self.contacts == 0
    }
}

/// Generates the course of a seed and drives an S4 through it at several noise levels.
pub(crate) fn trial(seed: u64, noises: &[f64]) -> Result<Trial, Failure> {
    let spec = RobotSpec::s4();
    let course = course(seed, &spec)?;
    let shortest = shortest_way(&course, spec.footprint.bounding_radius())?;
    let trip = trip(&course, spec);
    let time_limit = trip.generous_time_limit();
    let runs = noises.iter().map(|&noise| {
        let options = Options { seed, noise, time_limit };
        let stage = Stage::simulated(&trip.scene, sim_options(&options), Vec::new())?;
        let drive = drive(&trip, &options, &stage, |_, _| {})?;
        let judgement = Judgement::of(&drive.ending, course.reachable, drive.goal_distance, noise);
        let arrived = judgement == Judgement::Correct && course.reachable;
        Ok(Run {
            judgement,
            contacts: drive.truth.contacts,
            goal_distance: drive.goal_distance,
            path_ratio: shortest.filter(|_| arrived).map(|shortest| drive.truth.path_length / shortest),
            sim_time: drive.sim_time,
            ending: drive.ending,
        })
    });
    let runs = runs.collect::<Result<_, Failure>>()?;
    Ok(Trial { seed, runs })
}

/// The course of a seed, for a robot.
fn course(seed: u64, spec: &RobotSpec) -> Result<Course, Failure> {
    let robot_radius = spec.footprint.bounding_radius();
    let options = CourseOptions { robot_radius, ..CourseOptions::default() };
    obstacle_course(&mut Stream::new(seed), &options).map_err(Failure::run)
}

/// The scene of a seed's course.
pub(crate) fn scene(seed: u64) -> Result<Scene, Failure> {
    let spec = RobotSpec::s4();
    Ok(trip(&course(seed, &spec)?, spec).scene)
}

/// Length of the shortest way for a robot radius, if there is one (m).
fn shortest_way(course: &Course, radius: f64) -> Result<Option<f64>, Failure> {
    const RESOLUTION: f64 = 0.010;
    if !course.reachable {
        return Ok(None);
    }
    let ways = Reachability::new(&course.world, radius, RESOLUTION).map_err(Failure::run)?;
    Ok(ways.shortest_path_length(course.start.position(), course.goal))
}

/// The course as a scene with its goal as first marker, as in a `.sim`.
fn trip(course: &Course, spec: RobotSpec) -> Trip {
    let mut world = course.world.clone();
    world.markers.push(Marker { position: course.goal, colour: Colour::GREEN, alpha: 255 });
    Trip { scene: Scene::with_robot(world, spec, course.start), goal: course.goal }
}
