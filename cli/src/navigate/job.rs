use roverlab::geometry::{Point, units};
use roverlab::nav::{NavigatorEvent, NavigatorOutcome};
use roverlab::random::Stream;

use super::course::{self, Course};
use super::drive::{Arrival, drive};
use super::{Args, campaign, picture};
use crate::common::{Failure, Outcome, Report, millimetres, point_in_mm};
use crate::driving::{Conditions, Run, paced};

/// True distance from the goal up to which it counts as reached (m).
pub(super) const AT_GOAL: f64 = 0.1;
/// Default number of unmapped obstacles in the command's default world.
const UNMAPPED: u32 = 3;

/// The command's work.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    if args.campaign {
        return campaign(args);
    }
    let common = &args.common;
    common.check_picture()?;
    let trip = common.trip(course::scene)?;
    common.check_turning_with_lidar(trip.spec())?;
    let parameters = args.parameters(trip.spec().footprint)?;
    let usual = if common.world.is_none() { UNMAPPED } else { 0 };
    let mut stream = Stream::new(common.seed).child("unmapped", 0);
    let course = course::changed(trip, args.unmapped.unwrap_or(usual), &mut stream)?;
    let trip = &course.trip;
    let conditions = Conditions::new(common, trip.generous_time_limit())?;
    common.tell(format_args!(
        "{} at {} mm; goal at {} mm; {} obstacles unmapped",
        trip.spec().name,
        in_words(trip.start().position()),
        in_words(trip.goal),
        course.unmapped
    ));
    let places = (&course.known, trip.start(), trip.goal);
    let run = conditions.run(&trip.scene, paced(common), |robot, step| {
        drive(robot, places, parameters, conditions.time_limit, |news| {
            for event in news {
                common.tell(told(event));
            }
            step();
        })
    })?;
    let report = report(&course, &run, conditions.time_limit);
    Ok(common.draw(report, "navigate.svg", || picture::of(&course, &run, &conditions)))
}

fn told(event: &NavigatorEvent) -> String {
    let mm = |metres: f64| units::to_mm(metres).round() + 0.0;
    match event {
        NavigatorEvent::Planned { length, clearance } => {
            format!("planned: {} mm, {} mm beside the robot", mm(*length), mm(*clearance))
        }
        NavigatorEvent::Replanned { point, length } => {
            format!("something unmapped, seen from {} mm: now {} mm are left", in_words(*point), mm(*length))
        }
        NavigatorEvent::Blocked { point } => format!("blocked at {} mm: backing off", in_words(*point)),
        NavigatorEvent::Doubted { point } => format!("no way left at {} mm: looking again", in_words(*point)),
        NavigatorEvent::End(outcome) => verdict(*outcome).into(),
        _ => String::new(),
    }
}

/// Text of an outcome, as the robot sees it.
pub(super) fn verdict(outcome: NavigatorOutcome) -> &'static str {
    match outcome {
        NavigatorOutcome::Reached => "goal reached",
        NavigatorOutcome::Unreachable => "the goal cannot be reached",
        NavigatorOutcome::NoRoom => "no room at the goal",
        NavigatorOutcome::Stuck => "the robot makes no progress",
        NavigatorOutcome::TimedOut | NavigatorOutcome::Stopped => "the time is over",
    }
}

/// Whether the robot says that it is at the goal and in truth is not.
pub(super) fn is_missed(course: &Course, run: &Run<Arrival>) -> bool {
    let says_reached = run.ending.as_ref().is_ok_and(|arrival| arrival.outcome == NavigatorOutcome::Reached);
    says_reached && run.truth.pose.distance_to(course.trip.goal) > AT_GOAL
}

fn report(course: &Course, run: &Run<Arrival>, limit: f64) -> Report {
    let arrival = run.ending.as_ref().ok();
    let planned = arrival.and_then(Arrival::planned);
    let error = arrival.map(|arrival| run.truth.pose.distance_to(arrival.believed.position()));
    let contacts: Vec<_> = run.truth.contact_places.iter().copied().map(point_in_mm).collect();
    run.report(|arrival| match arrival.outcome {
        _ if is_missed(course, run) => Outcome::failure("missed"),
        NavigatorOutcome::Reached => Outcome::verdict("reached"),
        NavigatorOutcome::Unreachable => Outcome::verdict("unreachable"),
        NavigatorOutcome::NoRoom => Outcome::verdict("no_room"),
        NavigatorOutcome::Stuck => Outcome::failure("stuck"),
        NavigatorOutcome::TimedOut | NavigatorOutcome::Stopped => Outcome::failure("timed_out"),
    })
    .field("goal", point_in_mm(course.trip.goal))
    .field("goal_distance_mm", millimetres(run.truth.pose.distance_to(course.trip.goal)))
    .field("position_error_mm", error.map(millimetres))
    .field("planned_length_mm", planned.map(|(length, _)| millimetres(length)))
    .field("clearance_mm", planned.map(|(_, clearance)| millimetres(clearance)))
    .field("replans", arrival.map(Arrival::replans))
    .field("recoveries", arrival.map(Arrival::recoveries))
    .field("unmapped", course.unmapped)
    .field("contact_points", contacts)
    .field("time_limit_s", limit)
}

fn in_words(point: Point) -> String {
    let [x, y] = [point.x, point.y].map(|metres| units::to_mm(metres).round() + 0.0);
    format!("{x}, {y}")
}
