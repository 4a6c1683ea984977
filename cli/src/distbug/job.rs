use std::fmt::Display;

use roverlab::geometry::{Point, units};
use roverlab::nav::{BugOutcome, WallSide};

use super::{Args, Drive, Event, Happening, Options, campaign, drive, picture, scene, sim_options};
use crate::common::{CommonArgs, Failure, Outcome, Pacer, Progress, Report, Trip, millimetres, point_in_mm};

/// The command's work: drives, reports events, draws.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    if args.campaign {
        return campaign::campaign(args);
    }
    let common = &args.common;
    common.check_picture()?;
    let trip = common.trip(scene)?;
    common.check_turning_with_lidar(trip.spec())?;
    let time_limit = common.time_limit.unwrap_or_else(|| trip.generous_time_limit());
    let options = Options { seed: common.seed, noise: common.noise, time_limit };

    let drive = watched(common, &trip, &options)?;
    let report = report(&trip, &drive, &options);
    Ok(common.draw(report, "distbug.svg", || picture::of(&trip, &drive, &options)))
}

/// Drives and reports events.
fn watched(common: &CommonArgs, trip: &Trip, options: &Options) -> Result<Drive, Failure> {
    let (start, goal) = (in_words(trip.start().position()), in_words(trip.goal));
    let heading = units::to_deg(trip.start().heading);
    common.tell(line(
        0.0,
        format_args!(
            "{} at {start} mm, heading {heading:.0} deg; goal at {goal} mm, {} mm away",
            trip.spec().name,
            mm(trip.distance())
        ),
    ));
    let (pacer, mut progress) = (Pacer::start(), Progress::start());
    let (mut hits, mut leaves) = (0, 0);
    let stage = common.stage(&trip.scene, sim_options(options))?;
    let drive = drive(trip, options, &stage, |time, news| {
        if common.realtime {
            pacer.keep(time);
        }
        for event in news {
            progress.clear();
            common.tell(told(event, &mut hits, &mut leaves));
        }
        progress.show(|| format!("{time:8.1} s of at most {:.0} s", options.time_limit));
    })?;
    progress.clear();
    common.tell(line(drive.sim_time, verdict(&drive, options.noise)));
    Ok(drive)
}

/// A line of output during the run.
fn line(time: f64, text: impl Display) -> String {
    format!("{time:8.2} s  {text}")
}

fn told(event: &Event, hits: &mut usize, leaves: &mut usize) -> String {
    match event.happening {
        Happening::Hit { point, side, distance } => {
            *hits += 1;
            let side = match side {
                WallSide::Left => "left",
                WallSide::Right => "right",
            };
            let (number, point, distance) = (*hits, in_words(point), mm(distance));
            line(
                event.time,
                format_args!(
                    "hit point {number} at {point} mm, {distance} mm from the goal: obstacle, kept on the {side}"
                ),
            )
        }
        Happening::Leave { point, free, distance } => {
            *leaves += 1;
            let (number, point, distance) = (*leaves, in_words(point), mm(distance));
            line(
                event.time,
                format_args!(
                    "leave point {number} at {point} mm, {distance} mm from the goal: {} mm of the way free",
                    mm(free)
                ),
            )
        }
        Happening::Contact { point } => line(event.time, format_args!("contact at {} mm", in_words(point))),
    }
}

fn verdict(drive: &Drive, noise: f64) -> String {
    let off = mm(drive.goal_distance);
    match &drive.ending {
        _ if drive.is_missed(noise) => format!("at the goal by odometry, but {off} mm from it in truth"),
        Ok(BugOutcome::Reached) => format!("at the goal, {off} mm from it in truth"),
        Ok(BugOutcome::Unreachable) => {
            "all round the obstacle without a place to leave it: the goal cannot be reached".into()
        }
        Ok(BugOutcome::NoRoom) => {
            "there is no room for the robot at the goal: the goal cannot be reached".into()
        }
        Ok(BugOutcome::TimedOut | BugOutcome::Stopped) => {
            format!("the time is over, {off} mm from the goal")
        }
        Err(error) => format!("the robot failed: {error}"),
    }
}

fn report(trip: &Trip, drive: &Drive, options: &Options) -> Report {
    let (outcome, error) = match &drive.ending {
        _ if drive.is_missed(options.noise) => (Outcome::failure("missed"), None),
        Ok(BugOutcome::Reached) => (Outcome::verdict("reached"), None),
        Ok(BugOutcome::Unreachable) => (Outcome::verdict("unreachable"), None),
        Ok(BugOutcome::NoRoom) => (Outcome::verdict("no_room"), None),
        Ok(BugOutcome::TimedOut | BugOutcome::Stopped) => (Outcome::failure("timed_out"), None),
        Err(error) => (Outcome::failure("failed"), Some(error.clone())),
    };
    let points = |points: &[Point]| points.iter().copied().map(point_in_mm).collect::<Vec<_>>();
    Report {
        sim_time: Some(drive.sim_time),
        collisions: Some(drive.truth.contacts.into()),
        path_length: Some(drive.truth.path_length),
        pose: Some(drive.truth.pose),
        odometry: Some(drive.odometry),
        error,
        ..Report::new(outcome)
    }
    .field("goal", point_in_mm(trip.goal))
    .field("goal_distance_mm", millimetres(drive.goal_distance))
    .field("hit_points", points(&drive.hit_points()))
    .field("leave_points", points(&drive.leave_points()))
    .field("contact_points", points(&drive.truth.contact_places))
    .field("time_limit_s", options.time_limit)
}

fn mm(metres: f64) -> f64 {
    units::to_mm(metres).round() + 0.0
}

fn in_words(point: Point) -> String {
    format!("{}, {}", mm(point.x), mm(point.y))
}
