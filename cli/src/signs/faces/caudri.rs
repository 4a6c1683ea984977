//! Faces of the signs that the rules of the CAuDri-Challenge name, in shapes and colours of German road law.

use roverlab::geometry::math;

use super::board::{chevron, landmark};
use super::shapes::{is_arrow, is_bent_arrow, is_car, is_walker, is_written, triangle};
use super::{BLACK, BLUE, Colour, Face, GRAY, Place, RED, WHITE, YELLOW, book};

/// Sizes by the rules (m): squares and the octagon; equal-sided triangles; discs, the diamond and chevrons.
const SQUARE: (f64, f64) = (0.15, 0.15);
const TRIANGLE: (f64, f64) = (0.15, 0.13);
const SMALL: (f64, f64) = (0.1, 0.1);

/// The number of a speed zone is not part of its class: from afar it is too small. A board of three
/// chevrons is marked as three signs, because signs are searched for in squares.
pub(super) static FACES: [Face; 25] = [
    Face::new("stop", SQUARE, book::stop),
    Face::new("give_way", TRIANGLE, book::give_way),
    Face::new("priority_road", SMALL, priority_road),
    Face::new("crosswalk", SQUARE, |at| Some(crosswalk(at))),
    Face::new("parking", SQUARE, |at| Some(book::park(at))),
    Face::new("speed_zone", SQUARE, |at| Some(zone(at, "20", [RED, BLACK]))),
    Face::new("speed_zone", SQUARE, |at| Some(zone(at, "30", [RED, BLACK]))),
    Face::new("speed_zone", SQUARE, |at| Some(zone(at, "50", [RED, BLACK]))),
    Face::new("speed_zone_end", SQUARE, |at| Some(zone_end(at, "20"))),
    Face::new("speed_zone_end", SQUARE, |at| Some(zone_end(at, "30"))),
    Face::new("speed_zone_end", SQUARE, |at| Some(zone_end(at, "50"))),
    Face::new("expressway", SQUARE, |at| Some(expressway(at))),
    Face::new("expressway_end", SQUARE, |at| Some(expressway_end(at))),
    Face::new("uphill", TRIANGLE, |at| slope(at, 1.0)),
    Face::new("downhill", TRIANGLE, |at| slope(at, -1.0)),
    Face::new("turn_left", SMALL, |(x, y)| turn_right((1.0 - x, y))),
    Face::new("turn_right", SMALL, turn_right),
    Face::new("oncoming_priority", SMALL, oncoming_priority),
    Face::new("no_passing", SMALL, no_passing),
    Face::new("no_passing_end", SMALL, no_passing_end),
    Face::new("chevron_left", SMALL, |(x, y)| Some(chevron((1.0 - x, y)))),
    Face { parts: 3, ..Face::new("chevron_left", (0.3, 0.1), |(x, y)| Some(chevron((3.0 - 3.0 * x, y)))) },
    Face::new("chevron_right", SMALL, |at| Some(chevron(at))),
    Face { parts: 3, ..Face::new("chevron_right", (0.3, 0.1), |(x, y)| Some(chevron((3.0 * x, y)))) },
    Face::new("landmark", SQUARE, |at| Some(landmark(at))),
];

/// From -1 to 1 instead of from 0 to 1.
fn centred((x, y): Place) -> (f64, f64) {
    (2.0 * x - 1.0, 2.0 * y - 1.0)
}

/// A yellow diamond with a white border.
fn priority_road(at: Place) -> Option<Colour> {
    let (u, v) = centred(at);
    let out = u.abs() + v.abs();
    let colour = if out < 0.64 {
        YELLOW
    } else if !(0.7..=0.96).contains(&out) {
        BLACK
    } else {
        WHITE
    };
    (out <= 1.0).then_some(colour)
}

/// A person on stripes, in a white triangle.
fn crosswalk(at: Place) -> Colour {
    let (u, v) = centred(at);
    let person = is_walker((u / 0.5, (v - 0.02) / 0.5));
    let stripes = (0.56..0.68).contains(&v) && u.abs() < 0.6 && u.rem_euclid(0.24) < 0.13;
    if triangle(u / 0.92, v / 0.85) < 0.0 {
        BLUE
    } else if person || stripes {
        BLACK
    } else {
        WHITE
    }
}

/// A ring around a number, above the word ZONE; the colours are those of the ring, and of number and word.
fn zone((x, y): Place, number: &str, [ring, dark]: [Colour; 2]) -> Colour {
    let away = math::hypot(x - 0.5, y - 0.4);
    let is_number = is_written(number, (x - 0.33) / 0.34, (y - 0.26) / 0.28);
    if is_number || is_written("ZONE", (x - 0.2) / 0.6, (y - 0.82) / 0.13) {
        dark
    } else if (0.28..0.36).contains(&away) {
        ring
    } else {
        WHITE
    }
}

fn zone_end((x, y): Place, number: &str) -> Colour {
    // Bars from corner to corner.
    let across = x + y - 1.0;
    let bars = across.abs() < 0.175 && (across + 0.175).rem_euclid(0.1) < 0.05;
    if bars { BLACK } else { zone((x, y), number, [GRAY, GRAY]) }
}

fn expressway(at: Place) -> Colour {
    let (u, v) = centred(at);
    if is_car(u / 0.72, v / 0.72) { WHITE } else { BLUE }
}

fn expressway_end(at: Place) -> Colour {
    if (at.0 + at.1 - 1.0).abs() < 0.1 { RED } else { expressway(at) }
}

/// A slope of 10 %, which rises to the right by 1, or to the left by -1.
fn slope(at: Place, rise: f64) -> Option<Colour> {
    let (u, v) = centred(at);
    let edge = triangle(u, v);
    // Distances above the ground and along it; it is drawn five times as steep as it is.
    let above = (0.42 - v - 0.5 * rise * u) / 1.25_f64.sqrt();
    let along = (u - 0.5 * rise * (v - 0.42)) / 1.25_f64.sqrt();
    // The number stands over the lower half, where the triangle is wide.
    let is_number = is_written("10%", (along + 0.14 * rise + 0.28) / 0.56, (0.4 - above) / 0.3);
    let colour = if edge < 0.15 {
        RED
    } else if above < 0.0 || is_number {
        BLACK
    } else {
        WHITE
    };
    (edge >= 0.0).then_some(colour)
}

fn turn_right(at: Place) -> Option<Colour> {
    let (u, v) = centred(at);
    let out = math::hypot(u, v);
    let is_white = is_bent_arrow(u, v) || out > 0.94;
    (out <= 1.0).then_some(if is_white { WHITE } else { BLUE })
}

/// A white disc with what `inner` draws on it, within an edge of some width.
fn disc(at: Place, (edge, width): (Colour, f64), inner: impl Fn(f64, f64) -> Colour) -> Option<Colour> {
    let (u, v) = centred(at);
    let out = math::hypot(u, v);
    (out <= 1.0).then(|| if out > 1.0 - width { edge } else { inner(u, v) })
}

/// A black arrow towards the car, and a red one away from it.
fn oncoming_priority(at: Place) -> Option<Colour> {
    disc(at, (RED, 0.18), |u, v| {
        if is_arrow(v / 0.6, (u + 0.3) / 0.45) {
            BLACK
        } else if is_arrow(-v / 0.6, (u - 0.3) / 0.45) {
            RED
        } else {
            WHITE
        }
    })
}

/// Two cars side by side, in the colours of the left and the right one.
fn cars((u, v): (f64, f64), colours: [Colour; 2]) -> Colour {
    let side = usize::from(u > 0.0);
    if is_car((u.abs() - 0.37) / 0.36, v / 0.48) { colours[side] } else { WHITE }
}

fn no_passing(at: Place) -> Option<Colour> {
    disc(at, (RED, 0.18), |u, v| cars((u, v), [RED, BLACK]))
}

fn no_passing_end(at: Place) -> Option<Colour> {
    disc(at, (GRAY, 0.05), |u, v| {
        let bars = (u + v).abs() < 0.35 && (u + v + 0.35).rem_euclid(0.2) < 0.1;
        if bars { BLACK } else { cars((u, v), [GRAY, GRAY]) }
    })
}
