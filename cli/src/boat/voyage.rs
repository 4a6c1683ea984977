use roverlab::drive::marine::{Boat, BoatOutcome, BoatParameters};
use roverlab::geometry::{Point, Pose, Segment};
use roverlab::io::control;
use roverlab::world::{DriveSpec, Scene};

use crate::common::Failure;
use crate::driving::{Conditions, Run};

/// A voyage and how well it followed its course.
#[derive(Debug, Clone)]
pub(super) struct Voyage {
    pub(super) run: Run<BoatOutcome>,
    /// Waypoints passed, and the most that one was missed by (m).
    pub(super) passed: usize,
    pub(super) miss: Option<f64>,
    pub(super) cross_track: Option<f64>,
    pub(super) station: Option<f64>,
}

/// Metres from a waypoint that are good, in the root mean square from the legs, and on station.
pub(super) const NEAR: f64 = 0.5;
pub(super) const TRACK: f64 = 0.25;
pub(super) const STATION: f64 = 0.3;
/// Seconds on station before it counts.
const SETTLING: f64 = 20.0;

impl Voyage {
    /// Whether it went as it should.
    pub(super) fn is_good(&self) -> bool {
        let within = |value: Option<f64>, most: f64| value.is_some_and(|value| value <= most);
        self.run.ending == Ok(BoatOutcome::Arrived)
            && self.run.truth.contacts == 0
            && within(self.miss, NEAR)
            // A course whose waypoints are all where it begins has no legs to keep to.
            && self.cross_track.is_none_or(|off| off <= TRACK)
            && within(self.station, STATION)
    }
}

/// Sails a course.
pub(super) fn sail(
    scene: &Scene,
    course: &[Point],
    conditions: &Conditions,
    watch: impl FnMut(f64),
) -> Result<Voyage, Failure> {
    let robot = &scene.robots[0];
    let DriveSpec::Craft(craft) = &robot.spec.drive else {
        return Err(Failure::input("found a robot with another drive; expected a craft"));
    };
    let mut boat = Boat::new(craft, robot.pose, course, BoatParameters::default()).map_err(Failure::input)?;
    let mut legs = Vec::new();
    let run = conditions.run(scene, watch, |robot, step| {
        control::run(robot, &mut boat, conditions.time_limit, |_, boat, _| {
            step();
            legs.push(boat.leg());
        })
    })?;
    Ok(judged(run, robot.pose, course, &legs))
}

fn judged(run: Run<BoatOutcome>, start: Pose, course: &[Point], legs: &[usize]) -> Voyage {
    let from = std::iter::once(start.position()).chain(course.iter().copied());
    let ways: Vec<Segment> = from.zip(course).map(|(from, &to)| Segment::new(from, to)).collect();
    let steps = || run.trail.iter().skip(1).zip(legs);
    let passed = legs.last().copied().unwrap_or(0);
    // What counts is how near the raft came before it turned to the next leg.
    let miss = |waypoint: usize| {
        let near = steps().filter(|(_, leg)| **leg <= waypoint + 1);
        near.map(|((_, pose), _)| (pose.position() - course[waypoint]).norm()).fold(f64::INFINITY, f64::min)
    };
    let missed = (0..course.len()).map(miss).reduce(f64::max);
    let track = steps().filter_map(|((_, pose), leg)| Some(ways.get(*leg)?.distance_to(pose.position())));
    let arrived = steps().find(|(_, leg)| **leg == course.len()).map(|((time, _), _)| *time);
    let station = arrived.and_then(|arrived| {
        let stays = steps().filter(|((time, _), _)| *time >= arrived + SETTLING);
        rms(stays.map(|((_, pose), _)| (pose.position() - course[course.len() - 1]).norm()))
    });
    Voyage { passed, miss: missed, cross_track: rms(track), station, run }
}

fn rms(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0_u32), |(sum, count), value| (sum + value * value, count + 1));
    (count > 0).then(|| (sum / f64::from(count)).sqrt())
}
