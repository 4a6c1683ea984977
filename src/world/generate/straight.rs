//! Obstacles with corners: polygons, stars, combs and rooms.

use std::f64::consts::{FRAC_PI_2, TAU};

use super::brush::Brush;
use super::figure::{Figure, Outline};
use crate::geometry::{Point, Pose, direction};

/// A convex polygon with three to eight corners on an ellipse.
pub(super) fn polygon(brush: &mut Brush) -> Figure {
    let n = 3 + brush.stream.below(6);
    let flatness = brush.stream.between(0.55, 1.0);
    let points = (0..n)
        .map(|i| {
            let jitter = brush.stream.between(-0.22, 0.22);
            let d = direction(TAU * (i as f64 + jitter) / n as f64) * brush.radius;
            Point::new(d.x, flatness * d.y)
        })
        .collect();
    Figure::of(vec![Outline::closed(points)]).with_chambers(vec![Point::origin()])
}

/// A star with four to seven points.
pub(super) fn star(brush: &mut Brush) -> Figure {
    let n = 4 + brush.stream.below(4);
    let waist = brush.stream.between(0.42, 0.65) * brush.radius;
    let points = (0..2 * n)
        .map(|i| {
            let radius = if i % 2 == 0 { brush.radius } else { waist };
            Point::origin() + direction(TAU * i as f64 / (2 * n) as f64) * radius
        })
        .collect();
    let cove = Point::origin() + direction(0.5 * TAU / n as f64) * (waist + 0.7 * brush.gap);
    Figure::of(vec![Outline::closed(points)]).with_chambers(vec![Point::origin()]).with_pockets(vec![cove])
}

/// A cross of two beams.
pub(super) fn cross(brush: &mut Brush) -> Figure {
    let (r, s) = (brush.radius, brush.radius * brush.stream.between(0.6, 1.0));
    let h = 0.5 * brush.stream.between(0.06, 0.2);
    let corners = [
        (r, -h),
        (r, h),
        (h, h),
        (h, s),
        (-h, s),
        (-h, h),
        (-r, h),
        (-r, -h),
        (-h, -h),
        (-h, -s),
        (h, -s),
        (h, -h),
    ];
    let cove = Point::new(h + 0.7 * brush.gap, h + 0.7 * brush.gap);
    Figure::of(vec![Outline::closed(points(&corners))]).with_pockets(vec![cove])
}

/// A comb: teeth on one side of a spine.
pub(super) fn comb(brush: &mut Brush) -> Figure {
    let tooth = brush.stream.between(0.02, 0.07);
    let space = brush.gap * brush.stream.between(1.1, 1.6);
    let pitch = tooth + space;
    let spaces = ((2.0 * brush.radius / pitch) as usize).clamp(2, 4);
    let depth = brush.gap * brush.stream.between(1.5, 3.5);
    let spine = brush.stream.between(0.03, 0.08);
    let end = spaces as f64 * pitch + tooth;
    // Along the back of the spine, then along teeth and gaps from right to left.
    let mut corners = vec![(0.0, -spine), (end, -spine)];
    for k in (0..=spaces).rev() {
        let x = k as f64 * pitch;
        corners.extend([(x + tooth, 0.0), (x + tooth, depth), (x, depth), (x, 0.0)]);
    }
    // The outermost teeth have no inner corner on their outer sides.
    corners.retain(|&(x, y)| y != 0.0 || (x != 0.0 && x != end));
    let pockets = (0..spaces)
        .map(|k| Point::new(k as f64 * pitch + tooth + 0.5 * space, (0.6 * brush.gap).max(0.4 * depth)))
        .collect();
    Figure::of(vec![Outline::closed(points(&corners))]).with_pockets(pockets).centred()
}

/// A room with a door.
pub(super) fn room(brush: &mut Brush) -> Figure {
    let (a, b) = room_size(brush);
    let walls = doored_walls(brush, a, b);
    let width = brush.stream.between(0.03, 0.12).min(a.min(b) - 0.7 * brush.gap).max(0.02);
    let nook = Point::new(a - 0.5 * width - 0.6 * brush.gap, b - 0.5 * width - 0.6 * brush.gap);
    let pockets = vec![Point::origin(), nook, Point::new(-nook.x, -nook.y)];
    Figure::of(vec![brush.wall_or_stroke(walls, width)]).with_pockets(pockets)
}

/// A room with a door around another one, with doors on different sides.
pub(super) fn nested_rooms(brush: &mut Brush) -> Figure {
    let a = brush.radius.max(2.8 * brush.gap);
    let b = (a * brush.stream.between(0.75, 1.0)).max(2.6 * brush.gap);
    let aisle = brush.gap * brush.stream.between(1.15, 1.5);
    let outer = doored_walls(brush, a, b);
    let inner = doored_walls(brush, a - aisle, b - aisle);
    // The doors are in the right walls; the inner room is turned by a half turn.
    let mut inner =
        Figure::of(vec![Outline::open(inner)]).placed(Pose::new(0.0, 0.0, 2.0 * FRAC_PI_2), false);
    inner.outlines.push(Outline::open(outer));
    inner.with_pockets(vec![Point::origin(), Point::origin(), Point::new(0.5 * aisle - a, 0.0)])
}

/// A room without a door.
pub(super) fn shut_room(brush: &mut Brush) -> Figure {
    let (a, b) = room_size(brush);
    let corners = points(&[(-a, -b), (a, -b), (a, b), (-a, b)]);
    Figure::of(vec![Outline::closed(corners)])
        .with_chambers(vec![Point::origin(), Point::new(a - 0.7 * brush.gap, b - 0.7 * brush.gap)])
}

/// A closed room inside a room with a door.
pub(super) fn shut_room_in_room(brush: &mut Brush) -> Figure {
    let aisle = brush.gap * brush.stream.between(1.2, 1.6);
    let a = brush.radius.max(aisle + 1.2 * brush.gap);
    let b = (a * brush.stream.between(0.8, 1.0)).max(aisle + 1.1 * brush.gap);
    let (c, d) = (a - aisle, b - aisle);
    let outer = doored_walls(brush, a, b);
    let inner = points(&[(-c, -d), (c, -d), (c, d), (-c, d)]);
    Figure::of(vec![Outline::open(outer), Outline::closed(inner)])
        .with_chambers(vec![Point::origin()])
        .with_pockets(vec![Point::new(0.5 * aisle - a, 0.0)])
}

/// Half the side lengths of a room.
fn room_size(brush: &mut Brush) -> (f64, f64) {
    let a = brush.radius.max(1.5 * brush.gap);
    (a, (a * brush.stream.between(0.55, 1.0)).max(1.2 * brush.gap))
}

/// Walls of a room, from one side of a door in its right wall round to the other.
fn doored_walls(brush: &mut Brush, a: f64, b: f64) -> Vec<Point> {
    let door = (brush.gap * brush.stream.between(1.3, 2.0)).min(1.8 * b);
    let low = brush.stream.between(-b, b - door);
    let high = low + door;
    let mut corners = vec![(a, high), (a, b), (-a, b), (-a, -b), (a, -b), (a, low)];
    // Avoids stumps shorter than the thickness of the door's posts.
    if b - high < 0.08 {
        corners.remove(0);
    }
    if low + b < 0.08 {
        corners.pop();
    }
    points(&corners)
}

pub(super) fn points(corners: &[(f64, f64)]) -> Vec<Point> {
    corners.iter().map(|&(x, y)| Point::new(x, y)).collect()
}
