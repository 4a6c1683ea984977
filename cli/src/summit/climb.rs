use roverlab::drive::terrain::{Ascent, AscentOutcome, AscentParameters, SlopeSensor};
use roverlab::io::TruthInSpace;
use roverlab::io::control::run;
use roverlab::nav::elevation::{ElevationPlanner, Objective};
use roverlab::nav::{Fence, SummitOutcome, SummitParameters, SummitSearch};
use roverlab::world::RobotSpec;

use super::Args;
use super::args::Method;
use crate::common::{Failure, Outcome};
use crate::driving::{Conditions, Run};
use crate::terrain::{Hike, Ride, require_attitude, shore, unfit, word};

/// How a climb ended, as the robot takes it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Arrival {
    Top,
    Stuck,
    TimedOut,
}

/// What a climb was like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ascended {
    pub(crate) arrival: Arrival,
    pub(crate) looks: u32,
    /// Square metres; `None` before the first map, and for a method that has none.
    pub(crate) unknown: Option<f64>,
}

/// What could be reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Summit {
    pub(crate) place: roverlab::geometry::Point3,
    /// Metres of the way there of who knows the map.
    pub(crate) way: Option<f64>,
    /// Metres between the lowest and the highest place.
    pub(crate) relief: f64,
}

/// So many metres from the highest reachable place, or this share of the relief below it, counts as reached.
const NEAR: f64 = 0.1;
const BELOW: f64 = 0.02;
/// Looks after which a search has a map.
const FIRST_MAP: u32 = 2;
/// Difference in elevation that counts as none (m): belts yield by as much under a robot.
const LEVEL: f64 = 1e-3;

impl Summit {
    /// The highest place that a robot can reach.
    pub(crate) fn of(hike: &Hike, args: &Args) -> Result<Self, Failure> {
        let map = hike.map(&args.climber(hike.spec()))?;
        let start = hike.start().position();
        let place = map.highest_reachable(start).ok_or_else(|| unfit(start))?;
        let mut planner = ElevationPlanner::astar(&map, Objective::Length).map_err(Failure::input)?;
        let way = planner.plan_any_angle(start, place.xy()).ok().map(|way| way.cost);
        let relief = hike.ground.highest() - hike.ground.lowest();
        Ok(Self { place, way, relief })
    }

    /// Metres over the map.
    pub(crate) fn distance(&self, end: &TruthInSpace) -> f64 {
        (end.pose.position.xy() - self.place.xy()).norm()
    }

    pub(crate) fn is_reached(&self, end: &TruthInSpace) -> bool {
        self.distance(end) <= NEAR || self.place.z - end.pose.position.z <= LEVEL + BELOW * self.relief
    }
}

/// A robot with what a method needs.
pub(crate) fn equipped(spec: RobotSpec, method: Method) -> RobotSpec {
    match method {
        Method::Psd => SlopeSensor::equip(spec),
        Method::Search | Method::Ascent => spec,
    }
}

/// Climbs.
pub(crate) fn climb(
    args: &Args,
    method: Method,
    hike: &Hike,
    conditions: &Conditions,
    watch: impl FnMut(f64),
    mut tell: impl FnMut(String),
) -> Result<Run<Ascended>, Failure> {
    let spec = hike.spec();
    let limit = conditions.time_limit;
    if method == Method::Search {
        let parameters = SummitParameters::of(spec)
            .ok_or_else(|| Failure::input("found a robot without a lidar; expected one with a lidar"))?;
        require_attitude(spec)?;
        let lowest = shore(&hike.scene.world).map(|shore| shore - hike.start_height());
        let side = hike.ground.area().size().max();
        let parameters = SummitParameters {
            climber: args.climber(spec),
            lowest,
            fence: Some(Fence { area: hike.ground.area(), start: hike.start() }),
            // Two cells beyond a corner, wherever the start is.
            extent: side + 0.1,
            resolution: (side / 100.0).max(0.05),
            ..parameters
        };
        return conditions.run(&hike.scene, watch, |robot, step| {
            let mut search = SummitSearch::new(parameters)?;
            let mut looks = 0;
            let outcome = run(robot, &mut search, limit, |_, search, seen| {
                step();
                if search.looks() > looks {
                    looks = search.looks();
                    let (top, unknown) = (search.highest(), search.unknown_area());
                    tell(format!(
                        "{:.0} s: look {looks}: highest way {:.0} mm up, {unknown:.2} m2 may be higher",
                        seen.time,
                        1000.0 * top
                    ));
                }
            })?;
            let arrival = match outcome {
                SummitOutcome::Highest => Arrival::Top,
                SummitOutcome::Stuck => Arrival::Stuck,
                _ => Arrival::TimedOut,
            };
            let has_map = search.looks() >= FIRST_MAP;
            let unknown = has_map.then(|| search.unknown_area());
            Ok(Ascended { arrival, looks: search.looks(), unknown })
        });
    }
    let sensor = if method == Method::Psd { SlopeSensor::psds(spec) } else { SlopeSensor::lidar(spec) };
    let sensor =
        sensor.ok_or_else(|| Failure::input("found a robot without a lidar; expected one with a lidar"))?;
    let parameters = AscentParameters { slope: args.climber(spec).slope, ..AscentParameters::of(spec) };
    conditions.run(&hike.scene, watch, |robot, step| {
        let mut ascent = Ascent::new(sensor, parameters)?;
        let outcome = run(robot, &mut ascent, limit, |_, _, _| step())?;
        let arrival = match outcome {
            AscentOutcome::Top => Arrival::Top,
            AscentOutcome::TooSteep => Arrival::Stuck,
            _ => Arrival::TimedOut,
        };
        Ok(Ascended { arrival, looks: 0, unknown: None })
    })
}

/// How a climb ended in truth.
pub(crate) fn outcome(ascended: &Ascended, ride: Option<&Ride>, summit: &Summit) -> Outcome {
    let Some(ride) = ride else { return Outcome::failure("failed") };
    match (ride.end.mishap, ascended.arrival) {
        (Some(mishap), _) if mishap.is_final() => Outcome::failure(word(mishap)),
        (_, Arrival::Top) if summit.is_reached(&ride.end) => Outcome::verdict("reached"),
        (Some(_), _) | (_, Arrival::Stuck) => Outcome::failure("stuck"),
        (_, Arrival::Top) => Outcome::verdict("local_maximum"),
        (_, Arrival::TimedOut) => Outcome::failure("timed_out"),
    }
}
