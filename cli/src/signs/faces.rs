//! Faces of signs that are drawn: the six of the book's model road (section 13.5).

use roverlab::geometry::math;

/// Names of the classes.
pub(super) const NAMES: [&str; 6] = ["stop", "pedestrian", "park", "limit", "cancel", "give_way"];

type Colour = [f64; 3];

const WHITE: Colour = [0.95, 0.95, 0.95];
const BLACK: Colour = [0.06, 0.06, 0.06];
const RED: Colour = [0.75, 0.06, 0.1];
const BLUE: Colour = [0.05, 0.25, 0.65];
const GRAY: Colour = [0.45, 0.45, 0.45];

/// Letters of 3 x 5 squares: a number of three bits for each row.
const LETTERS: [(char, [u8; 5]); 7] = [
    ('S', [7, 4, 7, 1, 7]),
    ('T', [7, 2, 2, 2, 2]),
    ('O', [7, 5, 5, 5, 7]),
    ('P', [7, 5, 7, 4, 4]),
    ('3', [7, 1, 7, 1, 7]),
    ('0', [7, 5, 5, 5, 7]),
    ('Z', [7, 1, 2, 4, 7]),
];

/// The colour of a face at a place, 0 to 1 to the right and downwards; nothing beside it.
pub(super) fn colour(class: usize, (x, y): (f64, f64)) -> Option<Colour> {
    let (u, v) = (2.0 * x - 1.0, 2.0 * y - 1.0);
    match NAMES[class] {
        "stop" => {
            // An octagon: the larger of two squares' distances, one of them turned by 45 degrees.
            let out = u.abs().max(v.abs()).max((u.abs() + v.abs()) * std::f64::consts::FRAC_1_SQRT_2);
            let letters = is_written("STOP", (x - 0.15) / 0.7, (y - 0.36) / 0.28);
            (out <= 1.0).then_some(if letters || out > 0.92 { WHITE } else { RED })
        }
        "pedestrian" => {
            let triangle = u.abs() < 0.45 * (v + 0.75) && v < 0.7;
            let head = math::hypot(u, v + 0.2) < 0.12;
            let walks = v > -0.1 && v < 0.55 && (u.abs() - 0.4 * (v - 0.1).max(0.0)).abs() < 0.1;
            Some(if triangle && (head || walks) {
                BLACK
            } else if triangle {
                WHITE
            } else {
                BLUE
            })
        }
        "park" => Some(if is_written("P", (x - 0.28) / 0.44, (y - 0.15) / 0.7) { WHITE } else { BLUE }),
        "limit" => Some(zone((x, y), RED)),
        "cancel" => {
            let bars = (u + v).abs() < 0.5 && (u + v).rem_euclid(0.2) < 0.1;
            Some(if bars { BLACK } else { zone((x, y), GRAY) })
        }
        _ => {
            // A triangle that stands on its tip; the distance from its edges, 0 at them.
            let inside = (1.0 - v - 2.0 * u.abs()) / 5.0_f64.sqrt();
            let edge = inside.min(v + 1.0);
            (edge >= 0.0).then_some(if edge < 0.2 { RED } else { WHITE })
        }
    }
}

/// A white square with a ring around 30, and letters below.
fn zone((x, y): (f64, f64), ring: Colour) -> Colour {
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

/// Whether a place is on a letter of a word that fills the unit square.
fn is_written(word: &str, x: f64, y: f64) -> bool {
    if !(0.0..1.0).contains(&x) || !(0.0..1.0).contains(&y) {
        return false;
    }
    // A letter has three columns and a gap.
    let column = x * (4 * word.len() - 1) as f64;
    let letter = word.chars().nth(column as usize / 4);
    let rows = LETTERS.iter().find(|(name, _)| Some(*name) == letter).map(|(_, rows)| rows);
    rows.is_some_and(|rows| rows[(y * 5.0) as usize] & (4 >> (column as usize % 4)) != 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_differ_and_fill_their_square() {
        let places = || (0..1600).map(|i| (f64::from(i % 40) / 40.0, f64::from(i / 40) / 40.0));
        let drawn: Vec<Vec<Option<Colour>>> =
            (0..NAMES.len()).map(|class| places().map(|at| colour(class, at)).collect()).collect();
        for (class, face) in drawn.iter().enumerate() {
            assert!(face.iter().flatten().count() > 700, "{}", NAMES[class]);
            for other in &drawn[..class] {
                let differ = face.iter().zip(other).filter(|(a, b)| a != b).count();
                assert!(differ > 80, "{}: {differ}", NAMES[class]);
            }
        }
    }
}
