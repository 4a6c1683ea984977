//! Pictures of a race, still and moving.

use std::path::Path;

use roverlab::geometry::{Point, Pose, units};
use roverlab::picture::{Picture, Style};
use roverlab::race::{Cone, Event, EventCourse};
use roverlab::world::Colour;
use svg::Document;
use svg::node::element::{Animate, AnimateTransform, Circle, Polygon, Polyline};

use super::race::Outcome;
use crate::cones::Course;

/// The track, the cones, the racing line, and the driven line coloured by speed.
pub(crate) fn picture(course: &Course, outcome: &Outcome) -> Picture {
    let mut picture = Picture::new(&course.frame(&outcome.trail));
    picture.title(match course.event.as_ref().map(EventCourse::event) {
        Some(Event::Acceleration) => "Acceleration",
        Some(Event::Skidpad) => "Skidpad",
        _ => "Cone race",
    });
    let fallen = |index: usize| !outcome.standing.get(index).copied().unwrap_or(true);
    for left in [true, false] {
        let mut edge = course.corridor.edge(left);
        close(&mut edge, course);
        picture.line(edge, Style::aid().width(1.0).opacity(0.4));
    }
    for (index, Cone { position, colour: paint }) in course.cones.iter().enumerate() {
        let style =
            if fallen(index) { Style::aid().colour(Colour::RED) } else { Style::aid().colour(paint.paint()) };
        let radius = if course.wide { 1.2 } else { 2.0 * paint.radius() };
        picture.disc(*position, radius, style.filled(1.0));
    }
    let mut line = outcome.line.clone();
    close(&mut line, course);
    picture.line(line, Style::plan().width(1.0).labelled("racing line"));
    if let Some(other) = &outcome.other {
        let way = other.trail.iter().map(|(pose, _)| pose.to_world(Point::new(0.8, 0.0)));
        picture.line(way, Style::aid().width(1.0).colour(Colour::BLACK).labelled("second car"));
    }
    // All laps: the first one, which is slow, and those on the racing line.
    let points = outcome.trail.iter().map(|(pose, speed)| (pose.to_world(Point::new(0.8, 0.0)), *speed));
    picture.speed_path(points);
    picture.caption(caption(outcome));
    picture
}

/// The times and the penalties in words.
fn caption(outcome: &Outcome) -> String {
    let times: Vec<String> = outcome.verdict.lap_times.iter().map(|time| format!("{time:.2}")).collect();
    let laps = if times.is_empty() { "no laps".into() } else { format!("laps {} s", times.join(", ")) };
    let (cones, off) = (outcome.verdict.cones_hit, outcome.verdict.off_course);
    format!("{laps}; {cones} cones hit, {off} times off course")
}

/// Joins the end of a line to its beginning where the course is a loop.
fn close(line: &mut Vec<Point>, course: &Course) {
    if course.corridor.is_closed() {
        line.extend(line.first().copied());
    }
}

/// The car driving, in real time, again and again.
pub(crate) fn animation(course: &Course, outcome: &Outcome, file: &Path) -> std::io::Result<()> {
    svg::save(file, &document(course, outcome))
}

/// Pixels for a metre.
const SCALE: f64 = 8.0;

fn document(course: &Course, outcome: &Outcome) -> Document {
    let bounds = course.frame(&outcome.trail).floor;
    let size = bounds.size() * SCALE;
    let place = |p: Point| {
        let round = |value: f64| (value * 10.0).round() / 10.0;
        (round((p.x - bounds.min.x) * SCALE), round((bounds.max.y - p.y) * SCALE))
    };
    let chain = |points: &[Point]| {
        let texts: Vec<String> = points
            .iter()
            .map(|p| {
                let (x, y) = place(*p);
                format!("{x},{y}")
            })
            .collect();
        texts.join(" ")
    };
    let mut document = Document::new()
        .set("viewBox", (0, 0, size.x.ceil() as i64, size.y.ceil() as i64))
        .set("width", size.x.ceil())
        .set("height", size.y.ceil())
        .set("style", "background:#f4f4f2");
    let mut line = outcome.line.clone();
    close(&mut line, course);
    document = document.add(
        Polyline::new()
            .set("points", chain(&line))
            .set("fill", "none")
            .set("stroke", "#999")
            .set("stroke-width", 1),
    );
    for cone in &course.cones {
        let (x, y) = place(cone.position);
        let radius = (cone.colour.radius() * SCALE * 1.6).max(1.5);
        document = document.add(
            Circle::new()
                .set("cx", x)
                .set("cy", y)
                .set("r", radius)
                .set("fill", cone.colour.paint().to_string()),
        );
    }
    let others = outcome.other.iter().map(|other| &other.trail);
    let cars = others.chain([&outcome.trail]);
    cars.fold(document, |document, trail| document.add(car(trail, outcome.time, place)))
}

/// A car that moves along its trail.
fn car(
    trail: &[(Pose, f64)],
    seconds: f64,
    place: impl Fn(Point) -> (f64, f64),
) -> svg::node::element::Group {
    // Ten places a second are smooth enough, and keep the file small.
    let frames: Vec<Pose> = trail.iter().step_by(2).map(|(pose, _)| *pose).collect();
    let mut turned = 0.0;
    let mut before = frames.first().map_or(0.0, |pose| pose.heading);
    let mut places = Vec::new();
    let mut angles = Vec::new();
    for pose in &frames {
        // Angles that go on beyond a full turn, so that nothing spins back.
        turned += roverlab::geometry::angle_difference(pose.heading, before);
        before = pose.heading;
        let (x, y) = place(pose.position());
        places.push(format!("{x} {y}"));
        let first = frames.first().map_or(0.0, |pose| pose.heading);
        angles.push(format!("{:.1}", -units::to_deg(first + turned)));
    }
    let motion = |kind: &str, values: &[String], sum: bool| {
        AnimateTransform::new()
            .set("attributeName", "transform")
            .set("type", kind)
            .set("values", values.join(";"))
            .set("dur", format!("{seconds:.1}s"))
            .set("repeatCount", "indefinite")
            .set("additive", if sum { "sum" } else { "replace" })
    };
    let corner = |x: f64, y: f64| format!("{:.1},{:.1}", x * SCALE, y * SCALE);
    let outline = [(-0.45, -0.7), (1.6, -0.7), (2.15, -0.3), (2.15, 0.3), (1.6, 0.7), (-0.45, 0.7)];
    let points: Vec<String> = outline.iter().map(|(x, y)| corner(*x, *y)).collect();
    let fastest = trail.iter().map(|(_, speed)| *speed).fold(1.0, f64::max);
    let colours: Vec<String> = trail
        .iter()
        .step_by(10)
        .map(|(_, speed)| roverlab::picture::ramp(speed / fastest).to_string())
        .collect();
    let paint = Animate::new()
        .set("attributeName", "fill")
        .set("values", colours.join(";"))
        .set("dur", format!("{seconds:.1}s"))
        .set("repeatCount", "indefinite");
    let body = Polygon::new()
        .set("points", points.join(" "))
        .set("stroke", "#222")
        .set("stroke-width", 0.8)
        .add(paint);
    svg::node::element::Group::new()
        .add(motion("translate", &places, false))
        .add(motion("rotate", &angles, true))
        .add(body)
}
