use super::border::{self, Field};
use super::brush::{Brush, Drawing};
use super::figure::Figure;
use super::{bent, round, straight};

/// A figure that closes off a part of the field.
pub(super) fn draw(brush: &mut Brush, field: Field) -> Drawing {
    match brush.stream.below(14) {
        0 => Drawing::OnBorder(border::divider(brush, field)),
        1 => Drawing::OnBorder(border::shut_corner(brush, field)),
        2 | 3 => Drawing::OnBorder(border::shut_alcove(brush, field)),
        4 => Drawing::Loose(round::shut_ring(brush)),
        5 => Drawing::Loose(bent::shut_trough(brush)),
        6 => Drawing::Loose(straight::shut_room_in_room(brush)),
        7 => Drawing::Loose(round::hollow_arc(brush)),
        8 | 9 => Drawing::Loose(bent::hollow_bend(brush)),
        _ => Drawing::Loose(ring(brush)),
    }
}

/// A closed line of a simple shape, sometimes with an attached wall.
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
