//! Things on hills: walls that follow the ground, and tilted robots.

use super::canvas::Canvas;
use super::face::Cutter;
use super::light::lit;
use super::model::Stand;
use super::solids::Standing;
use super::view::{Place, View};
use crate::geometry::{Point, Vector3};
use crate::world::{Colour, HeightField};

/// A piece of a wall on hills: its corners as seen from above, and the heights of foot and top at each of
/// them.
#[derive(Debug)]
pub(super) struct Piece {
    foot: [Place; 4],
    top: [Place; 4],
    colour: Colour,
    middle: Place,
    radius: f64,
}

/// Depth by which walls reach into the ground, which is not straight along a piece of wall (m).
const FOUNDATION: f64 = 0.05;
/// Pieces of a wall, at most.
const MOST_PIECES: f64 = 512.0;

/// The pieces of a wall, each no longer than a cell of the hills.
pub(super) fn pieces(hills: &HeightField, (corners, body): &([Point; 4], Standing)) -> Vec<Piece> {
    let [right, ahead_right, ahead_left, left] = *corners;
    let count = ((ahead_right - right).norm() / hills.pitch().min()).ceil().clamp(1.0, MOST_PIECES);
    let between = |a: Point, b: Point, share: f64| a + (b - a) * share;
    (0..count as u32)
        .map(|piece| {
            let (from, to) = (f64::from(piece) / count, f64::from(piece + 1) / count);
            let corners = [
                between(right, ahead_right, from),
                between(right, ahead_right, to),
                between(left, ahead_left, to),
                between(left, ahead_left, from),
            ];
            Piece::new(hills, &corners, body)
        })
        .collect()
}

impl Piece {
    fn new(hills: &HeightField, corners: &[Point; 4], body: &Standing) -> Self {
        let raised = |above: f64| corners.map(|at| [at.x, at.y, hills.height(at).unwrap_or(0.0) + above]);
        let (foot, top) = (raised(body.bottom - FOUNDATION), raised(body.top));
        let middle = [0, 1, 2].map(|axis| 0.5 * (foot[0][axis] + top[2][axis]));
        let away = |corner: &Place| {
            let aside = [0, 1, 2].map(|axis| corner[axis] - middle[axis]);
            aside.iter().map(|part| part * part).sum::<f64>().sqrt()
        };
        let radius = foot.iter().chain(&top).map(away).fold(0.0, f64::max);
        Self { foot, top, colour: body.colour, middle, radius }
    }

    pub(super) fn draw(&self, cutter: &mut Cutter, canvas: &mut Canvas, view: &View) {
        if view.misses(view.see(self.middle), self.radius) {
            return;
        }
        draw_hull(cutter, canvas, view, (&self.foot, &self.top), self.colour);
    }
}

/// Draws an upright prism of somebody's own frame, who stands on hills. Its corners run counter-clockwise as
/// seen from above.
pub(super) fn draw_block(
    cutter: &mut Cutter,
    canvas: &mut Canvas,
    view: &View,
    (stand, outline): (&Stand, &[Point]),
    body: Standing,
) {
    let at = |height: f64| -> Vec<Place> {
        outline.iter().map(|corner| stand.place([corner.x, corner.y, height])).collect()
    };
    draw_hull(cutter, canvas, view, (&at(body.bottom), &at(body.top)), body.colour);
}

/// Draws sides, lid and bottom of a hull between two outlines that run counter-clockwise as seen from above.
fn draw_hull(
    cutter: &mut Cutter,
    canvas: &mut Canvas,
    view: &View,
    (foot, top): (&[Place], &[Place]),
    colour: Colour,
) {
    let mut face = |corners: &[Place]| {
        let [a, b, c] = [corners[0], corners[1], corners[2]].map(Vector3::from);
        if let Some(normal) = (b - a).cross(&(c - a)).try_normalize(0.0) {
            cutter.draw(canvas, view, corners, lit(colour, normal.into()));
        }
    };
    for (corner, (&low, &high)) in foot.iter().zip(top).enumerate() {
        let next = (corner + 1) % foot.len();
        face(&[low, foot[next], top[next], high]);
    }
    face(top);
    face(&foot.iter().rev().copied().collect::<Vec<_>>());
}
