use std::io;
use std::path::Path;

use svg::Document;
use svg::node::element::{Animate, Circle, Line};

use super::strip::Walk;

/// Pixels in a metre.
const SCALE: f64 = 1000.0;
/// What is seen: metres along the floor to either side of the walk, and above the floor.
const MARGIN: f64 = 0.25;
const HEIGHT: f64 = 0.40;

/// Writes the walk as a picture that moves in real time, again and again.
pub(crate) fn save(file: &Path, walk: &Walk) -> io::Result<()> {
    svg::save(file, &document(walk))
}

fn document(walk: &Walk) -> Document {
    let places = || walk.postures.iter().map(|posture| posture.body.0);
    let left = places().fold(0.0, f64::min) - MARGIN;
    let right = places().fold(0.0, f64::max) + MARGIN;
    let (width, height) = (SCALE * (right - left), SCALE * HEIGHT);
    let film = Film { walk, left };
    let floor = Line::new()
        .set("x1", 0)
        .set("x2", width.round())
        .set("y1", Film::y(0.0))
        .set("y2", Film::y(0.0))
        .set("stroke", "#444")
        .set("stroke-width", 3);
    let start = Circle::new().set("cx", film.x(0.0)).set("cy", Film::y(0.0)).set("r", 6).set("fill", "#2a2");
    let mut document = Document::new()
        .set("viewBox", (0, 0, width.round() as i64, height.round() as i64))
        .set("width", width.round())
        .set("height", height.round())
        .add(floor)
        .add(start);
    for limb in 0..walk.postures.first().map_or(0, |posture| posture.segments.len()) {
        document = document.add(film.limb(limb));
    }
    document.add(film.body())
}

/// Turns postures into animated attributes.
struct Film<'a> {
    walk: &'a Walk,
    left: f64,
}

impl Film<'_> {
    fn x(&self, metres: f64) -> f64 {
        (SCALE * (metres - self.left) * 10.0).round() / 10.0
    }

    fn y(metres: f64) -> f64 {
        (SCALE * (HEIGHT - 0.04 - metres) * 10.0).round() / 10.0
    }

    fn animate(&self, attribute: &str, value: impl Fn(usize) -> f64) -> Animate {
        let count = self.walk.postures.len();
        let values: Vec<String> = (0..count).map(|i| value(i).to_string()).collect();
        Animate::new()
            .set("attributeName", attribute)
            .set("dur", format!("{:.2}s", count as f64 * self.walk.interval))
            .set("repeatCount", "indefinite")
            .set("values", values.join(";"))
    }

    fn limb(&self, limb: usize) -> Line {
        let segment = |i: usize| self.walk.postures[i].segments[limb];
        let colour = if limb == 0 { "#d33" } else { "#247" };
        Line::new()
            .set("stroke", colour)
            .set("stroke-width", (2.0 * SCALE * self.walk.limb_radius).round())
            .set("stroke-linecap", "round")
            .add(self.animate("x1", |i| self.x(segment(i)[0].0)))
            .add(self.animate("y1", |i| Self::y(segment(i)[0].1)))
            .add(self.animate("x2", |i| self.x(segment(i)[1].0)))
            .add(self.animate("y2", |i| Self::y(segment(i)[1].1)))
    }

    fn body(&self) -> Circle {
        let body = |i: usize| self.walk.postures[i].body;
        Circle::new()
            .set("r", (SCALE * self.walk.body_radius).round())
            .set("fill", "#9bd")
            .add(self.animate("cx", |i| self.x(body(i).0)))
            .add(self.animate("cy", |i| Self::y(body(i).1)))
    }
}
