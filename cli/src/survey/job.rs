use roverlab::drive::marine::{DepthMap, SurveyOutcome};
use roverlab::geometry::{Point, Vector, units};
use roverlab::picture::{Picture, Style, ramp};
use roverlab::world::{HeightField, Scene, World};

use super::Args;
use super::campaign::campaign;
use super::floor::scene;
use super::map;
use super::tour::{COVERED, Tour, tour, true_depth};
use crate::common::{Failure, Outcome, Report, check_writable, millimetres, rounded};
use crate::driving::{Conditions, paced};
use crate::terrain::percent;
use crate::water::{Side, Site, afloat, ground, limit, surveyor};

/// The work of the command.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    if args.trials.campaign {
        return campaign(args);
    }
    let common = &args.common;
    common.check_picture()?;
    for file in args.map.iter().flat_map(|file| map::files(file)) {
        check_writable("--map", &file)?;
    }
    let scene = afloat((common, &args.waters), &surveyor(), || scene(common.seed, args.altitude))?;
    check_room(args, &scene)?;
    let site = Site::open(&scene, args.depth)?;
    let conditions = Conditions::new(common, limit(&site, args.spacing))?;
    let done = tour(&scene, args.parameters(&scene.world), &conditions, paced(common))?;
    let quality = &done.quality;
    let mut report = done
        .run
        .report(|outcome| match outcome {
            SurveyOutcome::Covered if quality.coverage >= COVERED => Outcome::verdict("covered"),
            SurveyOutcome::Covered => Outcome::failure("not_covered"),
            _ => Outcome::failure("timed_out"),
        })
        .field("coverage_percent", percent(quality.coverage))
        .field("depth_error_p95_mm", quality.depth.map(millimetres))
        .field("position_error_p95_mm", quality.position.map(millimetres))
        .field("inside_2_sigma_percent", percent(quality.inside))
        .field("way_ratio", rounded(quality.way))
        .field("altitude_rms_error_mm", quality.altitude.map(millimetres))
        .field("by_walls", quality.by_walls)
        .field("map", &args.map);
    if let Some(file) = &args.map {
        map::save(&done.map, done.cell, file)?;
    }
    report = common.draw(report, "survey.svg", || picture(&scene, &done));
    Ok(report)
}

/// Fails where there is no water of the wanted depth or altitude with room for the craft.
fn check_room(args: &Args, scene: &Scene) -> Result<(), Failure> {
    let (world, spec) = (&scene.world, &scene.robots[0].spec);
    let deepest = world.water_level.unwrap_or_default() - ground(world).map_or(0.0, HeightField::lowest);
    // The depth is that of the sensor, above the craft's lowest point.
    let up = spec.depth_sensor.map_or(0.0, |sensor| sensor.z);
    let (option, found, most) = match args.altitude {
        _ if args.depth >= deepest - up => ("--depth", args.depth, deepest - up),
        Some(altitude) if altitude >= deepest - args.depth - up => {
            ("--altitude", altitude, deepest - args.depth - up)
        }
        _ => return Ok(()),
    };
    let [found, most, deepest] = [found, most, deepest].map(|length| units::to_mm(length).round());
    Err(Failure::input(format!(
        "{option}: found {found} mm, in water of at most {deepest} mm; expected less than {most} mm"
    )))
}

/// The way over the pool, the map, the truth, and the way from the side.
fn picture(scene: &Scene, done: &Tour) -> Picture {
    let cell = done.cell;
    let mut way = Picture::new(&scene.world);
    way.title("Way");
    done.run.draw(&mut way, &scene.robots[0].spec);
    let (low, high) = map::range(&done.map);
    let measured = |column, row| done.map.cell(column, row).map(|cell| cell.depth);
    let truth = |column, row| true_depth(&scene.world, done.map.centre(column, row), cell);
    let found = cells("Map", &scene.world, &done.map, cell, |column, row| {
        Some((measured(column, row)? - low) / (high - low).max(1e-3))
    });
    let there = cells("Truth", &scene.world, &done.map, cell, |column, row| {
        Some((truth(column, row)? - low) / (high - low).max(1e-3))
    });
    let side = Side::of(scene, &done.run).picture(scene);
    let mut all = Picture::panels(&[way, found, there, side], 4);
    all.title("Survey of a floor");
    let mm =
        |value: Option<f64>| value.map_or("unknown".into(), |value| format!("{:.0} mm", units::to_mm(value)));
    all.caption(format!(
        "{:.1} % covered; 95 % within {} in depth and {} in place; depths from {:.0} to {:.0} mm",
        100.0 * done.quality.coverage,
        mm(done.quality.depth),
        mm(done.quality.position),
        units::to_mm(low),
        units::to_mm(high)
    ));
    all
}

fn cells(
    title: &str,
    world: &World,
    map: &DepthMap,
    cell: f64,
    share: impl Fn(usize, usize) -> Option<f64>,
) -> Picture {
    let size = world.floor.size();
    let mut picture = Picture::new(&World::empty(size.x, size.y));
    picture.title(title);
    for (column, row) in (0..map.rows()).flat_map(|row| (0..map.columns()).map(move |column| (column, row))) {
        let Some(deep) = share(column, row) else { continue };
        let centre: Point = map.centre(column, row);
        let corner = |x: f64, y: f64| centre + Vector::new(x, y) * (0.5 * cell);
        let corners = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
        let colour = ramp((1.0 - deep).clamp(0.0, 1.0));
        let mut style = Style::new(colour).width(0.0).filled(1.0);
        if deep <= 0.0 {
            style = style.labelled("shallowest cell");
        } else if deep >= 1.0 {
            style = style.labelled("deepest cell");
        }
        picture.polygon(corners, style);
    }
    picture
}
