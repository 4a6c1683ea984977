//! Shared parts of pictures of drives between cones.

use roverlab::geometry::Point;
use roverlab::picture::{Figure, Picture, Style};
use roverlab::race::{ConeColour, RaceScore};
use roverlab::world::{Colour, RobotSpec};

use super::{Course, Passed};

/// Distance from the middle of the rear axle to the middle of the car (m).
const MIDDLE: f64 = 0.8;

/// The cones, fallen ones in red.
pub(crate) fn cones(picture: &mut Picture, course: &Course, stands: impl Fn(usize) -> bool) {
    for (index, cone) in course.cones.iter().enumerate() {
        let style = if stands(index) {
            Style::aid().colour(cone.colour.paint()).labelled(name(cone.colour))
        } else {
            Style::aid().colour(Colour::RED).labelled("cone that was hit")
        };
        let radius = if course.wide { 1.2 } else { 2.5 * cone.colour.radius() };
        picture.disc(cone.position, radius, style.filled(1.0));
    }
}

fn name(colour: ConeColour) -> &'static str {
    match colour {
        ConeColour::Blue => "blue cone",
        ConeColour::Yellow => "yellow cone",
        ConeColour::Orange => "orange cone",
        ConeColour::BigOrange => "big orange cone",
        ConeColour::Unknown => "cone",
    }
}

/// The moving car, and its path coloured by speed.
pub(crate) fn car(picture: &mut Picture, trail: &[Passed]) {
    let middle = |passed: &Passed| passed.pose.to_world(Point::new(MIDDLE, 0.0));
    picture.speed_trace(trail.iter().map(|passed| (passed.time, middle(passed), passed.speed)));
    let poses: Vec<_> = trail.iter().map(|passed| (passed.time, passed.pose)).collect();
    let style = Style::new(Colour::from_hex(0x26_2d_3a)).labelled("car");
    picture.add(Figure::Robot { poses, footprint: RobotSpec::race_car().footprint }, style);
}

/// Lap times and penalties as text.
pub(crate) fn caption(verdict: &RaceScore) -> String {
    let times: Vec<String> = verdict.lap_times.iter().map(|time| format!("{time:.2}")).collect();
    let laps = if times.is_empty() { "no laps".into() } else { format!("laps {} s", times.join(", ")) };
    let (cones, off) = (verdict.cones_hit, verdict.off_course);
    format!("{laps}; {cones} cones hit, {off} times off course")
}
