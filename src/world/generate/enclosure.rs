use super::border::{self, Field};
use super::figure::Figure;
use super::repertoire::Brush;
use super::{bent, round, straight};

/// A figure that shuts a part of the field off, and whether it stands on the border.
pub(super) fn draw(brush: &mut Brush, field: Field) -> (Figure, bool) {
    match brush.stream.below(14) {
        0 => (border::divider(brush, field), true),
        1 => (border::shut_corner(brush, field), true),
        2 | 3 => (border::shut_alcove(brush, field), true),
        4 => (round::shut_ring(brush), false),
        5 => (bent::shut_trough(brush), false),
        6 => (straight::shut_room_in_room(brush), false),
        7 => (round::hollow_arc(brush), false),
        8 | 9 => (bent::hollow_bend(brush), false),
        _ => (ring(brush), false),
    }
}

/// A closed line of a simple shape, sometimes with a wall that leads away from it.
fn ring(brush: &mut Brush) -> Figure {
    brush.radius = brush.radius.max(1.8 * brush.gap);
    let figure = match brush.stream.below(5) {
        0 => round::disc(brush),
        1 => round::ellipse(brush),
        2 => straight::polygon(brush),
        3 => {
            brush.radius = brush.radius.max(3.0 * brush.gap);
            straight::star(brush)
        }
        _ => straight::shut_room(brush),
    };
    if brush.stream.chance(0.4) { bent::with_tail(brush, figure) } else { figure }
}
