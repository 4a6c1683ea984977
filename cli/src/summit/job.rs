use roverlab::geometry::units;
use roverlab::picture::{Mark, Picture};
use roverlab::random::Stream;
use roverlab::world::generate::{ReliefKind, ReliefOptions, relief};
use roverlab::world::{RobotSpec, Scene};

use super::Args;
use super::args::Method;
use super::campaign;
use super::climb::{Ascended, Summit, climb, equipped, outcome};
use crate::common::{Failure, Report, millimetres};
use crate::driving::{Conditions, Run, paced};
use crate::terrain::{Hike, Ride, degrees, percent, word};

/// Simulated seconds of a climb.
pub(super) const SECONDS: f64 = 1200.0;

/// The work of the command.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    if args.trials.campaign {
        return campaign(args);
    }
    let common = &args.common;
    common.check_picture()?;
    let own = || {
        let made = relief(&mut Stream::new(common.seed), &ReliefOptions::of(ReliefKind::Range));
        let made = made.expect("the usual options are good");
        Scene::with_robot(made.world, RobotSpec::blizzard(), made.start)
    };
    let mut hike = Hike::of(common, &RobotSpec::blizzard(), own)?;
    let spec = equipped(hike.spec().clone(), args.method);
    hike.scene.robots[0].spec = std::sync::Arc::new(spec);
    let summit = Summit::of(&hike, args)?;
    let conditions = Conditions::new(common, SECONDS)?;
    common.tell(format_args!(
        "{} at {:.0} mm; its highest reachable place is at {:.0} mm",
        hike.spec().name,
        units::to_mm(hike.start_height()),
        units::to_mm(summit.place.z)
    ));
    let run = climb(args, args.method, &hike, &conditions, paced(common), |words| common.tell(words))?;
    let ride = Ride::of(&run);
    let report = fields(run.report(|ended| outcome(ended, ride.as_ref(), &summit)), &run, ride, &summit)
        .field("slope_limit_deg", degrees(args.climber(hike.spec()).slope))
        .field("time_limit_s", conditions.time_limit);
    Ok(common.draw(report, "summit.svg", || picture(args.method, &hike, &run, &summit, ride)))
}

fn fields(report: Report, run: &Run<Ascended>, ride: Option<Ride>, summit: &Summit) -> Report {
    let ended = run.ending.as_ref().ok();
    report
        .field("height_mm", ride.map(|ride| millimetres(ride.height())))
        .field("highest_reachable_mm", millimetres(summit.place.z))
        .field("distance_mm", ride.map(|ride| millimetres(summit.distance(&ride.end))))
        .field("max_tilt_deg", ride.map(|ride| degrees(ride.max_tilt)))
        .field("slip_percent", ride.and_then(|ride| ride.slip).map(percent))
        .field("planned_length_mm", summit.way.map(millimetres))
        .field("looks", ended.map(|ended| ended.looks))
        .field("unknown_m2", ended.and_then(|ended| ended.unknown).map(|area| (100.0 * area).round() / 100.0))
}

fn picture(method: Method, hike: &Hike, run: &Run<Ascended>, summit: &Summit, ride: Option<Ride>) -> Picture {
    let mut picture = Picture::new(&hike.scene.world);
    let title = match ride.and_then(|ride| ride.end.mishap) {
        Some(mishap) => word(mishap),
        None if ride.is_some_and(|ride| summit.is_reached(&ride.end)) => {
            "on the highest place that can be reached"
        }
        None => "not on the highest place",
    };
    picture.title(format!(
        "{}: {title}",
        if method == Method::Search { "Summit search" } else { "Steepest ascent" }
    ));
    let (metres, seconds) = (run.truth.path_length, run.sim_time);
    let below = ride.map_or(0.0, |ride| units::to_mm(summit.place.z - ride.height()));
    picture.caption(format!("{metres:.1} m in {seconds:.0} s, {below:.0} mm below the summit"));
    run.draw(&mut picture, hike.spec());
    picture.mark(Mark::Goal, summit.place.xy());
    picture
}
