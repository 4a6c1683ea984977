use roverlab::geometry::units;
use roverlab::picture::Picture;
use roverlab::world::RobotSpec;

use super::Args;
use super::campaign;
use super::cross::{Crossed, Passage, cross, levels, outcome};
use crate::common::{Failure, Report, millimetres, rounded};
use crate::driving::{Conditions, Run, paced};
use crate::terrain::{Hike, Ride, degrees, percent};

/// Simulated duration of a crossing (s).
pub(super) const SECONDS: f64 = 400.0;

/// The work of the command.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    if args.trials.campaign {
        return campaign(args);
    }
    let common = &args.common;
    common.check_picture()?;
    let hike = Hike::of(common, &RobotSpec::blizzard(), || levels(common.seed).scene)?;
    hike.require_dry_ground()?;
    let conditions = Conditions::new(common, SECONDS)?;
    common.tell(format_args!(
        "{} at {:.0} mm, friction {:.2}",
        hike.spec().name,
        units::to_mm(hike.start_height()),
        hike.spec().friction
    ));
    let run = cross(&hike, &conditions, paced(common), |words| common.tell(words))?;
    let (ride, passage) = (Ride::of(&run), Passage::of(&hike, &run));
    let report = run.report(|ended| outcome(*ended, ride.as_ref(), &passage));
    let report = fields(report, &hike, &run, ride, &passage).field("time_limit_s", conditions.time_limit);
    Ok(common.draw(report, "ramp.svg", || picture(&hike, &run, ride, &passage)))
}

fn fields(report: Report, hike: &Hike, run: &Run<Crossed>, ride: Option<Ride>, passage: &Passage) -> Report {
    let edge = passage.edge_distance;
    report
        .field("crossed", passage.crossed)
        .field("edge_distance_mm", edge.is_finite().then(|| millimetres(edge)))
        .field("height_mm", ride.map(|ride| millimetres(ride.height())))
        .field("level_mm", passage.level.is_finite().then(|| millimetres(passage.level)))
        .field("max_tilt_deg", ride.map(|ride| degrees(ride.max_tilt)))
        .field("slip_percent", ride.and_then(|ride| ride.slip).map(percent))
        .field("friction", rounded(hike.spec().friction))
        .field("looks", run.ending.as_ref().ok().map(|ended| ended.looks))
}

fn picture(hike: &Hike, run: &Run<Crossed>, ride: Option<Ride>, passage: &Passage) -> Picture {
    let mut picture = Picture::new(&hike.scene.world);
    let title = if passage.crossed { "up, across and down" } else { "not crossed" };
    picture.title(format!("Ramps: {title}"));
    let (metres, seconds) = (run.truth.path_length, run.sim_time);
    let tilt = ride.map_or(0.0, |ride| degrees(ride.max_tilt));
    picture.caption(format!("{metres:.1} m in {seconds:.0} s, tilted up to {tilt:.0} degrees"));
    run.draw(&mut picture, hike.spec());
    picture
}
