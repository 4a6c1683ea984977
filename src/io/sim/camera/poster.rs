use super::canvas::{Canvas, Packed, first_pixel};
use super::face::Cutter;
use super::light::{SUN, scaled, shade};
use super::view::{NEAR, Place, View};
use crate::geometry::direction;
use crate::world::{Billboard, Colour};

/// Colour of a billboard's back.
const BACK: Colour = Colour::from_hex(0x80_80_80);
/// Smallest visible opacity of a texel.
const OPAQUE: u8 = 128;

/// Draws a picture on a board that stands on the ground at a level, where it is nearest.
pub(super) fn draw_poster(
    cutter: &mut Cutter,
    canvas: &mut Canvas,
    view: &View,
    board: &Billboard,
    level: f64,
) {
    let (columns, rows) = board.image.dimensions();
    if columns == 0 || rows == 0 {
        return;
    }
    let facing = direction(board.pose.heading);
    // From the board's left to its right, as seen from the front.
    let across = [-facing.y * board.width, facing.x * board.width, 0.0];
    let foot = level + board.elevation;
    let top = foot + board.height;
    let corner: Place = [board.pose.x - 0.5 * across[0], board.pose.y - 0.5 * across[1], top];
    let below = |place: Place| [place[0], place[1], foot];
    let beside = [corner[0] + across[0], corner[1] + across[1], top];
    let Some(plane) = cutter.look(view, &[corner, below(corner), below(beside), beside]) else { return };
    let Some((first_row, spans)) = cutter.cut(view) else { return };

    let is_front = plane.offset < 0.0;
    let cosine = (SUN[0] * facing.x + SUN[1] * facing.y) * if is_front { 1.0 } else { -1.0 };
    let light = shade(cosine);
    let near = plane.nearness(view);
    let origin = view.see(corner);
    let (right, down) = (view.turned(across), view.turned([0.0, 0.0, -board.height]));
    let texel = |ray_x: f64, ray_y: f64, depth: f64| -> Option<Packed> {
        let place = super::view::Seen { x: ray_x * depth, y: ray_y * depth, z: depth }.minus(origin);
        let u = place.dot(right) / right.dot(right) * f64::from(columns);
        let v = place.dot(down) / down.dot(down) * f64::from(rows);
        let pixel = board.image.get_pixel((u as u32).min(columns - 1), (v as u32).min(rows - 1));
        let [red, green, blue, alpha] = pixel.0;
        let colour = if is_front { Colour::new(red, green, blue) } else { BACK };
        (alpha >= OPAQUE).then(|| scaled(colour, light))
    };
    for (row, span) in (first_row..).zip(spans) {
        let (from, to) = (first_pixel(span.left, canvas.width), first_pixel(span.right, canvas.width));
        for column in from..to {
            let at = row * canvas.width + column;
            let here = near.at(column, row);
            if here as f32 <= canvas.nearness[at] || here > 1.0 / NEAR {
                continue;
            }
            let (x, y) = (view.ray_x(column as f64), view.ray_y(row as f64));
            if let Some(colour) = texel(x, y, 1.0 / here) {
                canvas.nearness[at] = here as f32;
                canvas.colours[at] = colour;
            }
        }
    }
}
