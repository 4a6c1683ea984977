//! The command `lidar-scan`.

use std::path::PathBuf;
use std::sync::Arc;

use image::RgbImage;
use roverlab::geometry::{Point, Pose, units};
use roverlab::io::sim::NoiseModel;
use roverlab::io::{self, Clock, Display, Lidar, LidarScan};
use roverlab::picture::{Picture, Style};
use roverlab::scan::{
    Extremum, ExtremumKind, ScanFeatures, ScanFeaturesParameters, extract_features, local_extrema, plot_scan,
};
use roverlab::world::{Colour, Object, ObjectKind, RobotSpec, Scene, World};
use serde_json::{Value, json};

use crate::common::{CommonArgs, Failure, Outcome, Report, millimetres, rounded};
use crate::driving::{Conditions, Run, check_lidar, paced};

/// Command line of `lidar-scan`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Takes a lidar scan, plots it on the robot's display, and finds walls, corners and objects in it",
    after_help = "\
Without --world, the robot is in a room with a projecting corner and two cans.

JSON fields:
  beams                       number of beams in the scan
  walls                       number of straight walls in it
  corners                     a list of {x_mm, y_mm, angle_deg}: the angle on the robot's side; above 180 it projects
  objects                     a list of {x_mm, y_mm, radius_mm}
  peaks_deg, dips_deg         directions of the scan's local extrema, counter-clockwise from straight ahead
  corner_error_mm             largest true distance from a detected corner to the nearest end of a wall; null
                              without corners
  object_error_mm             the same from a detected object to the nearest one in the world
  lcd, picture
Outcomes: scanned, timed_out, failed."
)]
pub(crate) struct Args {
    /// Save what the robot's display shows as a .png file.
    #[arg(long, value_name = "FILE.png")]
    pub(crate) lcd: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs);

/// Result of a scan.
#[derive(Debug, Clone)]
pub(crate) struct Seen {
    pub(crate) scan: LidarScan,
    pub(crate) features: ScanFeatures,
    pub(crate) extrema: Vec<Extremum>,
    pub(crate) display: RgbImage,
}

/// Number of averaged beams, and prominence of an extremum (m), as on the display.
const WINDOW: usize = 5;
const PROMINENCE: f64 = 0.08;

/// Takes a scan and shows it.
pub(crate) fn scan<R: Clock + Lidar + Display + ?Sized>(
    robot: &mut R,
    parameters: &ScanFeaturesParameters,
) -> io::Result<Seen> {
    let scan = robot.scan()?;
    let features = extract_features(&scan, parameters)?;
    let extrema = local_extrema(&scan, WINDOW, PROMINENCE);
    plot_scan(robot, &scan, None)?;
    robot.set_menu(["SCAN", "", "", "END"])?;
    let display = robot.screenshot()?;
    Ok(Seen { scan, features, extrema, display })
}

/// The command's work.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    let common = &args.common;
    common.check_picture()?;
    let scene = common.placed_without_goal("the robot stands still", scene)?;
    check_lidar(&scene)?;
    let conditions = Conditions { reserve: 0.0, ..Conditions::new(common, 5.0)? };
    let parameters = ScanFeaturesParameters {
        range_error: NoiseModel::real().scaled(conditions.noise).range,
        ..ScanFeaturesParameters::default()
    };
    let run = conditions.run(&scene, paced(common), |robot, step| {
        let seen = scan(robot, &parameters);
        step();
        seen
    })?;
    let report = run.report(|_| Outcome::verdict("scanned"));
    let report = match &run.ending {
        Ok(seen) => fields(report, seen, &scene),
        Err(_) => report,
    };
    let (lcd, lcd_trouble) = save_display(args, &run);
    let report = Report { trouble: lcd_trouble, ..report.field("lcd", lcd) };
    Ok(common.draw(report, "lidar_scan.svg", || picture(&scene, &run, conditions.noise, conditions.seed)))
}

fn save_display(args: &Args, run: &Run<Seen>) -> (Option<PathBuf>, Option<String>) {
    let (Some(file), Ok(seen)) = (&args.lcd, &run.ending) else { return (None, None) };
    match seen.display.save_with_format(file, image::ImageFormat::Png) {
        Ok(()) => (Some(file.clone()), None),
        Err(error) => (None, Some(format!("--lcd {}: {error}", file.display()))),
    }
}

/// A square room with a projecting corner, and two cans.
fn scene() -> Scene {
    let mut world = World::empty(3.0, 3.0);
    let corners = [(0.0, 0.0), (3.0, 0.0), (3.0, 3.0), (1.9, 3.0), (1.9, 1.9), (0.0, 1.9)];
    world.add_loop(&corners.map(|(x, y)| Point::new(x, y)));
    let can = ObjectKind::predefined("can").map(Arc::new);
    for (x, y) in [(0.8, 0.6), (2.3, 1.2)] {
        world.objects.extend(can.iter().map(|can| Object::new(Arc::clone(can), Pose::new(x, y, 0.0))));
    }
    Scene::with_robot(world, RobotSpec::s4(), Pose::new(1.5, 0.9, units::from_deg(60.0)))
}

fn fields(report: Report, seen: &Seen, scene: &Scene) -> Report {
    let pose = scene.robots[0].pose;
    let degrees = |kind: ExtremumKind| -> Vec<f64> {
        let of_kind = seen.extrema.iter().filter(move |extremum| extremum.kind == kind);
        of_kind.map(|extremum| rounded(units::to_deg(extremum.angle))).collect()
    };
    let place = |point: Point| {
        let place = pose.to_world(point);
        (millimetres(place.x), millimetres(place.y))
    };
    let corners: Vec<Value> = seen
        .features
        .corners
        .iter()
        .map(|corner| {
            let (x, y) = place(corner.position);
            json!({ "x_mm": x, "y_mm": y, "angle_deg": rounded(units::to_deg(corner.angle)) })
        })
        .collect();
    let objects: Vec<Value> = seen
        .features
        .objects
        .iter()
        .map(|object| {
            let (x, y) = place(object.centre);
            json!({ "x_mm": x, "y_mm": y, "radius_mm": millimetres(object.radius) })
        })
        .collect();
    let ends: Vec<Point> = scene.world.walls.iter().flat_map(|wall| [wall.line.a, wall.line.b]).collect();
    let middles: Vec<Point> = scene.world.objects.iter().map(|object| object.pose.position()).collect();
    let corner_error =
        farthest(seen.features.corners.iter().map(|corner| pose.to_world(corner.position)), &ends);
    let object_error =
        farthest(seen.features.objects.iter().map(|object| pose.to_world(object.centre)), &middles);
    report
        .field("beams", seen.scan.ranges.len())
        .field("walls", seen.features.walls.len())
        .field("corners", corners)
        .field("objects", objects)
        .field("peaks_deg", degrees(ExtremumKind::Peak))
        .field("dips_deg", degrees(ExtremumKind::Dip))
        .field("corner_error_mm", corner_error.map(millimetres))
        .field("object_error_mm", object_error.map(millimetres))
}

/// Largest distance of the found points from the nearest real one (m).
fn farthest(found: impl Iterator<Item = Point>, real: &[Point]) -> Option<f64> {
    found
        .map(|place| real.iter().map(|other| (other - place).norm()).fold(f64::INFINITY, f64::min))
        .reduce(f64::max)
}

/// The room with the features found in the scan.
fn picture(scene: &Scene, run: &Run<Seen>, noise: f64, seed: u64) -> Picture {
    let pose = scene.robots[0].pose;
    let mut picture = Picture::new(&scene.world);
    picture.title("Walls, corners and objects in a scan");
    if let Ok(seen) = &run.ending {
        let ScanFeatures { walls, corners, objects } = &seen.features;
        picture.caption(format!(
            "{} walls, {} corners, {} objects; {} beams, noise {noise}, seed {seed}",
            walls.len(),
            corners.len(),
            objects.len(),
            seen.scan.ranges.len()
        ));
        picture.points(seen.scan.points().map(|point| pose.to_world(point)), Style::lidar());
        for (index, wall) in walls.iter().enumerate() {
            let style = Style::new(Colour::from_hex(0xd0_60_10)).width(3.0);
            let style = if index == 0 { style.labelled("wall") } else { style };
            picture.line(wall.ends.map(|end| pose.to_world(end)), style);
        }
        for (index, corner) in corners.iter().enumerate() {
            let style = Style::new(Colour::from_hex(0x20_80_40)).width(3.0);
            let style = if index == 0 { style.labelled("corner") } else { style };
            picture.disc(pose.to_world(corner.position), 0.04, style);
        }
        for (index, object) in objects.iter().enumerate() {
            let style = Style::new(Colour::from_hex(0x80_20_a0)).width(3.0);
            let style = if index == 0 { style.labelled("object") } else { style };
            picture.disc(pose.to_world(object.centre), object.radius, style);
        }
    }
    picture.robot(pose, &scene.robots[0].spec.footprint);
    picture
}
