//! Shapes that faces are made of. Places are `(u, v)`, -1 to 1 to the right and downwards; those of letters
//! are `(x, y)`, 0 to 1.

use roverlab::geometry::math;

/// Letters of 3 x 5 squares: a number of three bits for each row.
const LETTERS: [(char, [u8; 5]); 13] = [
    ('S', [7, 4, 7, 1, 7]),
    ('T', [7, 2, 2, 2, 2]),
    ('O', [7, 5, 5, 5, 7]),
    ('P', [7, 5, 7, 4, 4]),
    ('N', [6, 5, 5, 5, 5]),
    ('E', [7, 4, 7, 4, 7]),
    ('Z', [7, 1, 2, 4, 7]),
    ('0', [7, 5, 5, 5, 7]),
    ('1', [2, 6, 2, 2, 7]),
    ('2', [7, 1, 7, 4, 7]),
    ('3', [7, 1, 7, 1, 7]),
    ('5', [7, 4, 7, 1, 7]),
    ('%', [5, 1, 2, 4, 5]),
];

/// Whether a place is on a letter of a word that fills the unit square.
pub(super) fn is_written(word: &str, x: f64, y: f64) -> bool {
    if !(0.0..1.0).contains(&x) || !(0.0..1.0).contains(&y) {
        return false;
    }
    // A letter has three columns and a gap.
    let column = x * (4 * word.len() - 1) as f64;
    let letter = word.chars().nth(column as usize / 4);
    let rows = LETTERS.iter().find(|(name, _)| Some(*name) == letter).map(|(_, rows)| rows);
    rows.is_some_and(|rows| rows[(y * 5.0) as usize] & (4 >> (column as usize % 4)) != 0)
}

/// Distance from the edges of a triangle on its base, positive inside.
pub(super) fn triangle(u: f64, v: f64) -> f64 {
    ((1.0 + v - 2.0 * u.abs()) / 5.0_f64.sqrt()).min(1.0 - v)
}

/// Whether a place is on a line of some width between two points.
fn is_on_line((u, v): (f64, f64), [(a, b), (c, d)]: [(f64, f64); 2], width: f64) -> bool {
    let (across, down) = (c - a, d - b);
    let along = ((u - a) * across + (v - b) * down) / (across * across + down * down);
    let along = along.clamp(0.0, 1.0);
    math::hypot(u - a - along * across, v - b - along * down) < 0.5 * width
}

/// A person who walks to the left, from -1 at the head to 1 at the feet.
pub(super) fn is_walker(at: (f64, f64)) -> bool {
    /// Body, legs and arms.
    const LIMBS: [[(f64, f64); 2]; 7] = [
        [(0.05, -0.45), (0.05, 0.1)],
        [(0.0, 0.1), (-0.2, 0.5)],
        [(-0.2, 0.5), (-0.4, 0.9)],
        [(0.1, 0.1), (0.25, 0.5)],
        [(0.25, 0.5), (0.5, 0.85)],
        [(0.0, -0.4), (-0.4, 0.0)],
        [(0.1, -0.4), (0.45, 0.0)],
    ];
    let is_body = is_on_line(at, LIMBS[0], 0.36);
    is_body || math::hypot(at.0, at.1 + 0.8) < 0.2 || LIMBS.iter().any(|&limb| is_on_line(at, limb, 0.2))
}

/// A car from before or behind.
pub(super) fn is_car(u: f64, v: f64) -> bool {
    let side = u.abs();
    let roof = (-0.8..-0.1).contains(&v) && side < 0.75 + 0.25 * v.min(-0.1);
    let window = (-0.62..-0.18).contains(&v) && side < 0.55 + 0.25 * v;
    let body = (-0.1..0.5).contains(&v) && side < 0.9;
    let light = math::hypot(side - 0.62, v - 0.16) < 0.16;
    let wheel = (0.5..0.8).contains(&v) && (0.5..0.85).contains(&side);
    (roof && !window) || (body && !light) || wheel
}

/// An arrow to the right, from -1 at its end to 1 at its tip.
pub(super) fn is_arrow(u: f64, v: f64) -> bool {
    let shaft = (-1.0..0.2).contains(&u) && v.abs() < 0.24;
    shaft || (u >= 0.1 && v.abs() < 0.75 * (1.0 - u))
}

/// An arrow that comes from below and bends to the right.
pub(super) fn is_bent_arrow(u: f64, v: f64) -> bool {
    let bend = (-0.1, 0.15);
    let (away, half) = (math::hypot(u - bend.0, v - bend.1), 0.13);
    // The shaft is upright up to the level of the bend's centre, and turns about that.
    let upright = (0.15..0.62).contains(&v) && (u - bend.0 + 0.3).abs() < half;
    let turning = u < bend.0 && v < bend.1 && (away - 0.3).abs() < half;
    let level = (bend.0..0.3).contains(&u) && (v - bend.1 + 0.3).abs() < half;
    let tip = u >= 0.2 && (v - bend.1 + 0.3).abs() < 0.8 * (0.7 - u);
    upright || turning || level || tip
}
