//! Lane detection in the log of another car's drive.

use roverlab::geometry::{Aabb, Point, Segment};
use roverlab::picture::{Picture, Style};
use roverlab::race::{Cone, ConeColour, ConeFrame, Lane, LaneFinder, LaneParameters};
use roverlab::world::World;

use super::{Args, Sensors};
use crate::common::{Failure, Outcome, Report, rounded};
use crate::cones::refuse;

/// Length of the way ahead compared with the lane (m).
const AHEAD: f64 = 8.0;
/// Distance from a lane within which a cone must be on its side (m).
const BESIDE: f64 = 3.0;
/// Margin around the cones in the picture (m).
const MARGIN: f64 = 3.0;

/// Results for a log.
#[derive(Debug, Default)]
struct Found {
    lanes: Vec<Vec<Point>>,
    wrong_side: u32,
    /// Distances of the driven path from the lane (m).
    away: Vec<f64>,
}

/// Detects the lane in every frame.
pub(crate) fn follow(args: &Args, frames: &[ConeFrame]) -> Result<Report, Failure> {
    check(args)?;
    let mut finder = LaneFinder::new(LaneParameters::default())?;
    let mut found = Found::default();
    for (k, frame) in frames.iter().enumerate() {
        let cones = beheld(frame, args.sensors);
        let Some(lane) = finder.step(frame.car, &cones) else { continue };
        found.wrong_side += u32::from(is_wrong(lane, frame));
        found.away.extend(ahead(&frames[k..]).filter_map(|place| distance(lane, place)));
        found.lanes.push(lane.points.clone());
    }
    let squares: f64 = found.away.iter().map(|away| away * away).sum();
    let rms = (!found.away.is_empty()).then(|| rounded((squares / found.away.len() as f64).sqrt()));
    let most = found.away.iter().copied().reduce(f64::max).map(rounded);
    let trouble = args.common.picture.as_ref().and_then(|file| picture(frames, &found).save(file).err());
    let report = Report::new(Outcome::verdict("planned"))
        .field("event", "log")
        .field("frames", frames.len())
        .field("planned", found.lanes.len())
        .field("wrong_side", found.wrong_side)
        .field("from_driven_rms_m", rms)
        .field("from_driven_most_m", most)
        .field("picture", args.common.picture.clone());
    Ok(Report { trouble: trouble.map(|error| error.to_string()), ..report })
}

/// Options valid for a log. All others affect a race, of which there is none.
const OF_LOGS: [&str; 2] = ["--track", "--sensors"];

/// Fails for an option without meaning for a log.
fn check(args: &Args) -> Result<(), Failure> {
    let options = args.common.origin.facts().options;
    let names = options.iter().map(|option| option.split('=').next().unwrap_or(option));
    let mut given: Vec<_> = names.map(|name| (name, !OF_LOGS.contains(&name))).collect();
    given.push(("--animation", args.common.animation.is_some()));
    refuse(&given, "found the log of a drive; expected a track, or a command line without it")
}

/// The cones of a frame as seen by the sensors.
fn beheld(frame: &ConeFrame, sensors: Sensors) -> Vec<Cone> {
    match sensors {
        Sensors::Lidar => frame.cones.iter().map(|cone| Cone::unknown(cone.position)).collect(),
        Sensors::Camera | Sensors::Both => frame.cones.clone(),
    }
}

/// Positions along the next metres.
fn ahead(frames: &[ConeFrame]) -> impl Iterator<Item = Point> {
    let mut way = 0.0;
    let mut before = frames.first().map(|frame| frame.car.position());
    frames.iter().map(|frame| frame.car.position()).take_while(move |place| {
        way += before.map_or(0.0, |before| (place - before).norm());
        before = Some(*place);
        way < AHEAD
    })
}

/// Distance of a point from a lane (m); `None` beyond its ends.
fn distance(lane: &Lane, place: Point) -> Option<f64> {
    let last = lane.points.len().checked_sub(1)?;
    let (nearest, away) = nearest(lane, place)?;
    let beyond = (nearest == 0 || nearest + 1 == last) && {
        let end = if nearest == 0 { lane.points[0] } else { lane.points[last] };
        (place - end).norm() <= away + 1e-9
    };
    (!beyond).then_some(away)
}

/// The segment of a lane nearest to a point, and its distance (m).
fn nearest(lane: &Lane, place: Point) -> Option<(usize, f64)> {
    let pieces = lane.points.windows(2).map(|ends| Segment::new(ends[0], ends[1]).distance_to(place));
    pieces.enumerate().min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Whether a coloured cone beside a lane is on its wrong side.
fn is_wrong(lane: &Lane, frame: &ConeFrame) -> bool {
    frame.cones.iter().any(|cone| {
        let Some((piece, away)) = nearest(lane, cone.position) else { return false };
        let (from, to) = (lane.points[piece], lane.points[piece + 1]);
        let side = roverlab::geometry::cross(to - from, cone.position - from);
        away < BESIDE && distance(lane, cone.position).is_some() && side * f64::from(cone.colour.side()) < 0.0
    })
}

/// The final cones, the lanes, and the driven path.
fn picture(frames: &[ConeFrame], found: &Found) -> Picture {
    let cones = frames.last().map_or(&[][..], |frame| &frame.cones);
    let driven = frames.iter().map(|frame| frame.car.position());
    let mut world = World::empty(1.0, 1.0);
    let around = Aabb::around(cones.iter().map(|cone| cone.position).chain(driven.clone()));
    world.floor = around.unwrap_or(world.floor).inflated(MARGIN);
    let mut picture = Picture::new(&world);
    picture.title("A log of a drive");
    for lane in found.lanes.iter().step_by(5) {
        picture.line(lane.iter().copied(), Style::plan().width(0.8).opacity(0.5));
    }
    for cone in cones {
        let radius = if cone.colour == ConeColour::BigOrange { 0.4 } else { 0.3 };
        picture.disc(cone.position, radius, Style::aid().colour(cone.colour.paint()).filled(1.0));
    }
    if frames.iter().all(|frame| frame.speed.is_some()) {
        picture.speed_path(driven.zip(frames.iter().filter_map(|frame| frame.speed)));
    } else {
        picture.line(driven, Style::aid().width(1.5).labelled("driven"));
    }
    picture.caption(format!("{} lanes in {} frames", found.lanes.len(), frames.len()));
    picture
}
