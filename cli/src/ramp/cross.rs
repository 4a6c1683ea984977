use roverlab::geometry::{Point, units};
use roverlab::io::control::run;
use roverlab::io::{Mishap, TruthInSpace};
use roverlab::nav::{Fence, RampCrossing, RampOutcome, SummitParameters};
use roverlab::random::Stream;
use roverlab::world::RobotSpec;
use roverlab::world::generate::{ReliefKind, ReliefOptions, relief};

use super::edges::Edges;
use crate::common::{Failure, Outcome};
use crate::driving::{Conditions, Run};
use crate::terrain::{Hike, Ride, require_attitude, word};

/// A crossing as the robot takes it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Crossed {
    pub(crate) outcome: RampOutcome,
    pub(crate) looks: u32,
}

/// Range of slopes (degrees) and of friction coefficients of generated levels.
const SLOPES: [f64; 2] = [7.0, 20.0];
const FRICTION: [f64; 2] = [0.4, 1.0];
/// Difference in elevation that is a level (m).
const LEVEL: f64 = 0.05;

/// Generated levels with a robot in front of a ramp.
pub(crate) fn levels(seed: u64) -> Hike {
    let mut stream = Stream::new(seed).child("levels", 0);
    let slope = units::from_deg(stream.between(SLOPES[0], SLOPES[1]));
    let friction = stream.between(FRICTION[0], FRICTION[1]);
    let options = ReliefOptions { slope, ..ReliefOptions::of(ReliefKind::Ramp) };
    let made = relief(&mut Stream::new(seed), &options).expect("slopes for which there is room");
    Hike::generated(made, RobotSpec { friction, ..RobotSpec::blizzard() })
}

/// Crosses.
pub(crate) fn cross(
    hike: &Hike,
    conditions: &Conditions,
    watch: impl FnMut(f64),
    mut tell: impl FnMut(String),
) -> Result<Run<Crossed>, Failure> {
    let limit = conditions.time_limit;
    let parameters = RampCrossing::parameters(hike.spec())
        .ok_or_else(|| Failure::input("found a robot without a lidar; expected one with a lidar"))?;
    require_attitude(hike.spec())?;
    let fence = Some(Fence { area: hike.ground.area(), start: hike.start() });
    let extent = hike.ground.area().size().max() + 0.1;
    let resolution = parameters.resolution.max(extent / 500.0);
    let parameters = SummitParameters { fence, extent, resolution, ..parameters };
    conditions.run(&hike.scene, watch, |robot, step| {
        let mut crossing = RampCrossing::new(parameters)?;
        let mut looks = 0;
        let outcome = run(robot, &mut crossing, limit, |_, crossing, seen| {
            step();
            if crossing.looks() > looks {
                looks = crossing.looks();
                let (leg, height) = (crossing.phase().0, units::to_mm(crossing.pose().1));
                tell(format!("{:.0} s: look {looks}, {leg:?}: {height:.0} mm above the start", seen.time));
            }
        })?;
        Ok(Crossed { outcome, looks: crossing.looks() })
    })
}

/// Ground truth of a crossing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Passage {
    /// Whether it led up and down, at different places, and the robot still stands.
    pub(crate) crossed: bool,
    /// Highest elevation (m).
    pub(crate) level: f64,
    /// Smallest distance to an edge (m); infinite without edges.
    pub(crate) edge_distance: f64,
}

impl Passage {
    pub(crate) fn of<T>(hike: &Hike, run: &Run<T>) -> Self {
        let (edges, spec) = (Edges::of(&hike.ground), hike.spec());
        let distances = run.in_space.iter().map(|space| edges.distance(&spec.footprint, &space.pose));
        let edge_distance = distances.fold(f64::INFINITY, f64::min);
        let level = run.in_space.iter().map(|space| space.pose.position.z).fold(f64::NEG_INFINITY, f64::max);
        let half = 0.5 * (hike.start_height() + level);
        let apart = changes(&run.in_space, half)
            .is_some_and(|[up, down]| (up - down).norm() > 2.0 * spec.footprint.bounding_radius());
        let end = run.in_space.last().map_or(level, |space| space.pose.position.z);
        let low = level - end > LEVEL && level - hike.start_height() > LEVEL;
        let is_whole = run.in_space.last().is_some_and(|end| !end.mishap.is_some_and(Mishap::is_final));
        Self { crossed: is_whole && low && apart, level, edge_distance }
    }
}

/// Places where a robot first rose above an elevation, and last sank below it.
fn changes(ride: &[TruthInSpace], elevation: f64) -> Option<[Point; 2]> {
    let is_above = |space: &&TruthInSpace| space.pose.position.z > elevation;
    let first = ride.iter().find(is_above)?;
    let last = ride.iter().rfind(is_above)?;
    Some([first.pose.position.xy(), last.pose.position.xy()])
}

/// How a crossing ended in truth.
pub(crate) fn outcome(ended: Crossed, ride: Option<&Ride>, passage: &Passage) -> Outcome {
    let Some(ride) = ride else { return Outcome::failure("failed") };
    match (ride.end.mishap, ended.outcome) {
        (Some(mishap), _) if mishap.is_final() => Outcome::failure(word(mishap)),
        (_, RampOutcome::Crossed) if passage.crossed => Outcome::verdict("crossed"),
        (_, RampOutcome::NoWayUp) => Outcome::verdict("no_way_up"),
        (_, RampOutcome::NoWayDown) => Outcome::verdict("no_way_down"),
        // The robot is wrong about what it has crossed.
        (_, RampOutcome::Crossed) => Outcome::failure("not_crossed"),
        (_, RampOutcome::Stuck) => Outcome::failure("stuck"),
        _ => Outcome::failure("timed_out"),
    }
}
