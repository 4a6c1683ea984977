use roverlab::geometry::Pose;
use roverlab::world::{RobotSpec, Scene, World};

use super::contest::{self, Entry};
use super::ride::{Ride, ride};
use super::{Args, campaign, picture, table};
use crate::common::{Failure, Outcome, Report, Trip, onlooker};

/// The command's work.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    check(args)?;
    if args.campaign {
        return campaign::campaign(args);
    }
    let is_recorded = args.common.record.is_some() || args.common.replay.is_some() || onlooker::stands_in();
    let entries = if is_recorded { vec![contest::recorded(args)?] } else { contest::entries(args)? };
    let rows = table::rows(&entries, args.common.noise);
    args.common.tell(table::text(&rows));
    // Odometry errors can mislead any algorithm: verdicts are judged only without noise.
    let good = args.common.noise > 0.0 || table::all_correct(&rows);
    let is_cut = args.common.time_limit.is_some()
        && entries.iter().flat_map(|entry| &entry.rides).any(Ride::is_timed_out);
    let outcome = match (is_cut, good) {
        (true, _) => Outcome::failure("timed_out"),
        (false, true) => Outcome::verdict("compared"),
        (false, false) => Outcome::failure("wrong"),
    };
    let report =
        summed(outcome, &entries).table("rows", table::json(&rows)).table("runs", table::json_runs(&rows));
    drawn(args, report, entries.first().filter(|_| is_recorded))
}

/// A report with the sums over all runs.
pub(super) fn summed(outcome: Outcome, entries: &[Entry]) -> Report {
    let rides = || entries.iter().flat_map(|entry| &entry.rides);
    Report {
        sim_time: Some(rides().map(|ride| ride.sim_time).sum()),
        collisions: Some(rides().map(|ride| u64::from(ride.contacts)).sum()),
        path_length: Some(rides().map(|ride| ride.path_length).sum()),
        ..Report::new(outcome)
    }
}

/// Rejects options that make no sense for many runs.
fn check(args: &Args) -> Result<(), Failure> {
    let common = &args.common;
    common.check_picture()?;
    let alone: [(&str, bool); 3] = [
        ("--start", common.start.is_some()),
        ("--goal", common.goal.is_some()),
        ("--robot", common.robot.is_some()),
    ];
    if let Some((option, _)) = alone.iter().find(|(_, given)| *given && common.world.is_none()) {
        return Err(Failure::input(format!("{option}: found no --world; expected both, or neither")));
    }
    let never = [("--fault", !common.fault.is_empty()), ("--realtime", common.realtime)];
    if let Some((option, _)) = never.iter().find(|(_, given)| *given) {
        return Err(Failure::input(format!(
            "{option}: found it for a comparison of many runs; expected a command line without it, or the command \
             `distbug`"
        )));
    }
    if args.campaign && (common.world.is_some() || !args.families.is_empty()) {
        return Err(Failure::input(
            "--campaign: found --world or --families beside it; expected neither, since it draws its own courses",
        ));
    }
    Ok(())
}

/// The trip of the options, for a suitable robot.
pub(super) fn own_trip(args: &Args) -> Result<Trip, Failure> {
    // The scene of `--world` takes precedence over this empty one.
    let empty = || Scene::with_robot(World::walled(1.0, 1.0), RobotSpec::s4(), Pose::new(0.5, 0.5, 0.0));
    let trip = args.common.trip(empty)?;
    args.common.check_turning_with_lidar(trip.spec())?;
    Ok(trip)
}

/// Draws the paths of all algorithms in one world, if requested: the recorded ones, or new ones.
pub(super) fn drawn(args: &Args, report: Report, recorded: Option<&Entry>) -> Result<Report, Failure> {
    let common = &args.common;
    if common.picture.is_none() && common.animation.is_none() {
        return Ok(report.field("picture", None::<&str>));
    }
    let new;
    let Entry { setting, rides } = if let Some(recorded) = recorded {
        recorded
    } else {
        let setting = contest::shown(args)?;
        let conditions = setting.conditions(args);
        let drive = |&kind| ride(&setting.trip, kind, conditions);
        let rides = args.bugs().iter().map(drive).collect::<Result<_, Failure>>()?;
        new = Entry { setting, rides };
        &new
    };
    Ok(common.draw(report, "bug_compare.svg", || picture::of(setting, rides, setting.conditions(args))))
}
