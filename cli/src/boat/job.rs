use roverlab::drive::marine::BoatOutcome;
use roverlab::geometry::{Point, units};
use roverlab::picture::{Mark, Picture, Style};
use roverlab::world::Scene;

use super::Args;
use super::campaign::campaign;
use super::lake::{Lake, lake, raft};
use super::voyage::{Voyage, sail};
use crate::common::{Failure, Outcome, Report, millimetres, point_in_mm};
use crate::driving::{Conditions, paced};
use crate::water::{Side, afloat, ground};

/// Seconds for a metre of the course, and besides.
const PACE: f64 = 8.0;
const BESIDES: f64 = 180.0;

/// Seconds for a course.
pub(super) fn limit(scene: &Scene, course: &[Point]) -> f64 {
    let start = scene.robots[0].pose.position();
    let from = std::iter::once(start).chain(course.iter().copied());
    let length: f64 = from.zip(course).map(|(from, to)| (to - from).norm()).sum();
    PACE * length + BESIDES
}

/// The work of the command.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    if args.trials.campaign {
        return campaign(args);
    }
    let common = &args.common;
    common.check_picture()?;
    let Lake { scene, course } = lake(common.seed)?;
    if common.world.is_some() && args.course.is_none() {
        return Err(Failure::input("--world: found no course; expected --course X,Y;X,Y..."));
    }
    let scene = afloat((common, &args.waters), &raft(), || scene)?;
    let course = args.course.as_ref().map_or(course, |given| given.0.clone());
    let floor = scene.world.site();
    if let Some(&outside) = course.iter().find(|&&point| !floor.contains(point)) {
        let [x, y] = point_in_mm(outside);
        return Err(Failure::input(format!(
            "--course: found {x},{y}, outside of the world; expected places in it"
        )));
    }
    let level = scene.world.water_level.unwrap_or(f64::INFINITY);
    let is_ashore = |point: &Point| {
        ground(&scene.world).and_then(|ground| ground.height(*point)).is_some_and(|height| height >= level)
    };
    if let Some(&ashore) = course.iter().find(|point| is_ashore(point)) {
        let [x, y] = point_in_mm(ashore);
        return Err(Failure::input(format!("--course: found {x},{y}, ashore; expected places in the water")));
    }
    let conditions = Conditions::new(common, limit(&scene, &course))?;
    let voyage = sail(&scene, &course, &conditions, paced(common))?;
    let run = &voyage.run;
    let report = run
        .report(|outcome| match outcome {
            BoatOutcome::Arrived if voyage.is_good() || run.truth.contacts > 0 => Outcome::verdict("arrived"),
            BoatOutcome::Arrived => Outcome::failure("missed"),
            _ => Outcome::failure("timed_out"),
        })
        .field("waypoints", voyage.passed)
        .field("max_miss_mm", voyage.miss.map(millimetres))
        .field("cross_track_rms_mm", voyage.cross_track.map(millimetres))
        .field("station_rms_mm", voyage.station.map(millimetres))
        .field("course_mm", course.iter().copied().map(point_in_mm).collect::<Vec<_>>());
    Ok(common.draw(report, "boat.svg", || picture(&scene, &course, &voyage)))
}

fn picture(scene: &Scene, course: &[Point], voyage: &Voyage) -> Picture {
    let run = &voyage.run;
    let mut above = Picture::new(&scene.world);
    above.title("From above");
    let start = scene.robots[0].pose.position();
    above.line(std::iter::once(start).chain(course.iter().copied()), Style::plan());
    run.draw(&mut above, &scene.robots[0].spec);
    for (number, &waypoint) in (1..).zip(course) {
        above.mark(if number == course.len() { Mark::Goal } else { Mark::Waypoint }, waypoint);
    }
    let mut both = Picture::panels(&[above, Side::of(scene, run).picture(scene)], 2);
    both.title("Solar raft on its course");
    let mm = |value: Option<f64>| value.map_or("no".into(), |value| format!("{:.0} mm", units::to_mm(value)));
    let (wind, current) = (scene.world.water.wind.norm(), scene.world.water.current_at(0.0).norm());
    both.caption(format!(
        "{} off the legs, {} off the station, {} from a waypoint at most; wind {wind:.1} m/s, current {current:.2} m/s",
        mm(voyage.cross_track), mm(voyage.station), mm(voyage.miss)
    ));
    both
}
