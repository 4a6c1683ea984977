use std::fmt::Write as _;
use std::path::Path;

use roverlab::geometry::{Point, Pose};
use roverlab::io::log::{Entry, Log};
use roverlab::picture::{Mark, Picture};
use roverlab::world::{World, formats};
use serde_json::json;

use super::{Found, write};
use crate::common::Failure;

/// Writes a recording's calls as a table, and its paths as a picture.
pub(super) fn export(log: &Log, csv: Option<&Path>, picture: Option<&Path>) -> Result<Found, Failure> {
    let (table, rows) = table(log);
    if let Some(file) = csv {
        write(file, table.as_bytes())?;
    }
    if let Some(file) = picture {
        drawn(log)?.save(file)?;
    }
    let text = format!("exported {rows} calls");
    let fields = json!({
        "example": "replay", "command": "export", "outcome": "exported", "rows": rows, "csv": csv, "picture": picture,
    });
    Ok(Found { fields, text, good: true, warning: None })
}

/// All calls ordered by robot and time, and their number.
fn table(log: &Log) -> (String, usize) {
    let mut table = String::from("robot,time_s,topic,method,arguments,result,error\n");
    let mut rows = 0;
    for robot in 0..log.robots() {
        for Entry { time, truth, method, arguments, result, .. } in log.entries(robot) {
            let topic = if truth { "truth" } else { "calls" };
            let (result, error) = match result {
                Ok(result) => (result, String::new()),
                Err(error) => (String::new(), error),
            };
            let [arguments, result, error] = [arguments, result, error].map(|text| quoted(&text));
            // Writing to a string cannot fail.
            let _ = writeln!(table, "{},{time},{topic},{method},{arguments},{result},{error}", robot + 1);
            rows += 1;
        }
    }
    (table, rows)
}

/// A field of a table, quoted if necessary.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.into()
    }
}

/// The world with the robots' true paths and paths by odometry.
fn drawn(log: &Log) -> Result<Picture, Failure> {
    let world = match log.header().attachment("scene.wld") {
        Some(file) => {
            formats::wld::parse(&String::from_utf8_lossy(&file.data), "scene.wld")
                .map_err(Failure::run)?
                .value
        }
        None => floor(log),
    };
    let mut picture = Picture::new(&world);
    let header = log.header();
    picture.title(format!("Recording of {}", header.program));
    picture.caption(header.options.join(" "));
    for robot in 0..log.robots() {
        picture.true_path(path(log, robot, Pose::default(), true));
        let start = log.start(robot).unwrap_or_default();
        picture.odometry_path(path(log, robot, start, false));
        picture.mark(Mark::Start, start.position());
    }
    Ok(picture)
}

/// A robot's true path.
#[cfg(feature = "native")]
pub(crate) fn true_path(log: &Log, robot: usize) -> Vec<Point> {
    path(log, robot, Pose::default(), true)
}

/// A robot's path: true, or by odometry from a start.
fn path(log: &Log, robot: usize, start: Pose, truth: bool) -> Vec<Point> {
    let entries = log.entries(robot).filter(|entry| entry.truth == truth);
    let places = entries.filter(|entry| matches!(entry.method.as_str(), "pose" | "robot"));
    places
        .filter_map(|entry| match entry.numbers[..] {
            [x, y, ..] => Some(start.to_world(Point::new(x, y))),
            _ => None,
        })
        .collect()
}

/// A floor around all paths, for a recording without a world.
fn floor(log: &Log) -> World {
    const MARGIN: f64 = 0.5;
    let paths = (0..log.robots()).flat_map(|robot| {
        let start = log.start(robot).unwrap_or_default();
        [path(log, robot, Pose::default(), true), path(log, robot, start, false)].concat()
    });
    let (mut low, mut high) = (Point::origin(), Point::origin());
    for point in paths {
        low = Point::new(low.x.min(point.x), low.y.min(point.y));
        high = Point::new(high.x.max(point.x), high.y.max(point.y));
    }
    let mut world = World::empty(1.0, 1.0);
    world.floor.min = Point::new(low.x - MARGIN, low.y - MARGIN);
    world.floor.max = Point::new(high.x + MARGIN, high.y + MARGIN);
    world
}
