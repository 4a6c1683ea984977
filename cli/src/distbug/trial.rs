use roverlab::nav::{BugOutcome, Reachability};
use roverlab::random::Stream;
use roverlab::world::generate::{Course, CourseOptions, obstacle_course};
use roverlab::world::{Colour, Marker, RobotSpec, Scene};

use super::{Ending, Options, drive, sim_options};
use crate::common::{Failure, Stage, Trip};

/// One course of a campaign, driven once at every level of noise.
#[derive(Debug, Clone)]
pub(crate) struct Trial {
    /// The seed of the course and of the runs.
    pub(crate) seed: u64,
    pub(crate) trip: Trip,
    pub(crate) runs: Vec<Run>,
}

/// What came of one run.
#[derive(Debug, Clone)]
pub(crate) struct Run {
    pub(crate) ending: Ending,
    pub(crate) judgement: Judgement,
    pub(crate) contacts: u32,
    /// Metres.
    pub(crate) goal_distance: f64,
    /// The length of the robot's way in terms of the shortest one; for correct runs to the goal alone.
    pub(crate) path_ratio: Option<f64>,
    /// Seconds.
    pub(crate) sim_time: f64,
}

/// Whether a verdict is correct.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Judgement {
    Correct,
    /// "Reached", too far from the goal.
    FarFromGoal,
    /// "Reached" though there is no way; the robot is mistaken about where it is.
    NotReached,
    /// "Unreachable" though there is a way.
    NotUnreachable,
    /// No verdict in the time.
    TimedOut,
    /// The robot failed.
    Failed,
}

impl Judgement {
    /// What a table calls the wrong ones.
    pub(crate) const WRONG: [(Judgement, &'static str); 5] = [
        (Judgement::FarFromGoal, "off"),
        (Judgement::NotReached, "false r."),
        (Judgement::NotUnreachable, "false u."),
        (Judgement::TimedOut, "late"),
        (Judgement::Failed, "failed"),
    ];

    fn of(ending: &Ending, reachable: bool, goal_distance: f64, noise: f64) -> Self {
        use BugOutcome as Outcome;
        match (ending, reachable) {
            (Ending::Failed(_), _) => Self::Failed,
            (Ending::Verdict(Outcome::TimedOut | Outcome::Stopped), _) => Self::TimedOut,
            (Ending::Verdict(Outcome::Unreachable | Outcome::NoRoom), true) => Self::NotUnreachable,
            (Ending::Verdict(Outcome::Reached), false) => Self::NotReached,
            (Ending::Verdict(Outcome::Reached), true) if goal_distance > tolerance(noise) => {
                Self::FarFromGoal
            }
            (Ending::Verdict(Outcome::Unreachable | Outcome::NoRoom), false)
            | (Ending::Verdict(Outcome::Reached), true) => Self::Correct,
        }
    }
}

impl Run {
    /// Whether the verdict is correct and nothing was touched.
    pub(crate) fn is_clean(&self) -> bool {
        self.judgement == Judgement::Correct && self.contacts == 0
    }
}

/// How far from the goal, in metres, "reached" is still correct. Odometry errs, so more with noise.
pub(crate) fn tolerance(noise: f64) -> f64 {
    if noise == 0.0 { 0.050 } else { 0.250 }
}

/// Draws the course of a seed and drives an S4 through it at some levels of noise.
pub(crate) fn trial(seed: u64, noises: &[f64]) -> Result<Trial, Failure> {
    let spec = RobotSpec::s4();
    let radius = spec.footprint.bounding_radius();
    let options = CourseOptions { robot_radius: radius, ..CourseOptions::default() };
    let course = obstacle_course(&mut Stream::new(seed), &options).map_err(Failure::run)?;
    let shortest = shortest_way(&course, radius)?;
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
    Ok(Trial { seed, trip, runs })
}

/// Metres along the shortest way of a robot of some radius, if there is one.
fn shortest_way(course: &Course, radius: f64) -> Result<Option<f64>, Failure> {
    const RESOLUTION: f64 = 0.010;
    if !course.reachable {
        return Ok(None);
    }
    let ways = Reachability::new(&course.world, radius, RESOLUTION).map_err(Failure::run)?;
    Ok(ways.shortest_path_length(course.start.position(), course.goal))
}

/// The course as a scene whose first marker is its goal, as a `.sim` holds it.
fn trip(course: &Course, spec: RobotSpec) -> Trip {
    let mut world = course.world.clone();
    world.markers.push(Marker { position: course.goal, colour: Colour::GREEN, alpha: 255 });
    Trip { scene: Scene::with_robot(world, spec, course.start), goal: course.goal }
}
