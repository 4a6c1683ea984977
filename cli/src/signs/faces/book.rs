//! The six faces of the book's model road (section 13.5).

use roverlab::geometry::math;

use super::shapes::is_written;
use super::{BLACK, BLUE, Colour, Face, GRAY, Place, RED, WHITE};

/// Width and height of all (m).
const SIZE: (f64, f64) = (0.1, 0.1);

pub(super) static FACES: [Face; 6] = [
    Face::new("stop", SIZE, stop),
    Face::new("pedestrian", SIZE, |at| Some(pedestrian(at))),
    Face::new("park", SIZE, |at| Some(park(at))),
    Face::new("limit", SIZE, |at| Some(zone(at, RED))),
    Face::new("cancel", SIZE, |at| Some(cancel(at))),
    Face::new("give_way", SIZE, give_way),
];

pub(super) fn stop((x, y): Place) -> Option<Colour> {
    let (u, v) = (2.0 * x - 1.0, 2.0 * y - 1.0);
    // An octagon: the larger of two squares' distances, one of them turned by 45 degrees.
    let out = u.abs().max(v.abs()).max((u.abs() + v.abs()) * std::f64::consts::FRAC_1_SQRT_2);
    let letters = is_written("STOP", (x - 0.15) / 0.7, (y - 0.36) / 0.28);
    (out <= 1.0).then_some(if letters || out > 0.92 { WHITE } else { RED })
}

fn pedestrian((x, y): Place) -> Colour {
    let (u, v) = (2.0 * x - 1.0, 2.0 * y - 1.0);
    let triangle = u.abs() < 0.45 * (v + 0.75) && v < 0.7;
    let head = math::hypot(u, v + 0.2) < 0.12;
    let walks = v > -0.1 && v < 0.55 && (u.abs() - 0.4 * (v - 0.1).max(0.0)).abs() < 0.1;
    if triangle && (head || walks) {
        BLACK
    } else if triangle {
        WHITE
    } else {
        BLUE
    }
}

pub(super) fn park((x, y): Place) -> Colour {
    if is_written("P", (x - 0.28) / 0.44, (y - 0.15) / 0.7) { WHITE } else { BLUE }
}

fn cancel((x, y): Place) -> Colour {
    let (u, v) = (2.0 * x - 1.0, 2.0 * y - 1.0);
    let bars = (u + v).abs() < 0.5 && (u + v).rem_euclid(0.2) < 0.1;
    if bars { BLACK } else { zone((x, y), GRAY) }
}

pub(super) fn give_way((x, y): Place) -> Option<Colour> {
    let (u, v) = (2.0 * x - 1.0, 2.0 * y - 1.0);
    // A triangle that stands on its tip; the distance from its edges, 0 at them.
    let inside = (1.0 - v - 2.0 * u.abs()) / 5.0_f64.sqrt();
    let edge = inside.min(v + 1.0);
    (edge >= 0.0).then_some(if edge < 0.2 { RED } else { WHITE })
}

/// A white square with a ring around 30, and letters below.
fn zone((x, y): Place, ring: Colour) -> Colour {
    let away = math::hypot(x - 0.5, y - 0.42);
    let number = is_written("30", (x - 0.35) / 0.3, (y - 0.3) / 0.24);
    let letters = is_written("ZO", (x - 0.3) / 0.4, (y - 0.83) / 0.12);
    if number || letters {
        if ring == GRAY { GRAY } else { BLACK }
    } else if (0.26..0.35).contains(&away) {
        ring
    } else {
        WHITE
    }
}
