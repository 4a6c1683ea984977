//! Obstacles attached to the border wall. In their frame, the x axis runs along the border and the y axis
//! points into the field.

use std::f64::consts::{FRAC_PI_2, PI};

use super::brush::Brush;
use super::figure::{Figure, Outline, stroke};
use super::round::{arc, wave};
use super::straight::points;
use crate::geometry::{Point, Pose};

/// A field from (0, 0) to (`width`, `height`).
#[derive(Debug, Clone, Copy)]
pub(super) struct Field {
    pub(super) width: f64,
    pub(super) height: f64,
}

impl Field {
    /// Length of the shorter side.
    pub(super) fn shorter(&self) -> f64 {
        self.width.min(self.height)
    }

    /// Frame on one of the four sides at a fraction of its length, and that length.
    fn side(&self, side: usize, share: f64) -> (Pose, f64) {
        let (w, h) = (self.width, self.height);
        match side % 4 {
            0 => (Pose::new(w * share, 0.0, 0.0), w),
            1 => (Pose::new(w, h * share, FRAC_PI_2), h),
            2 => (Pose::new(w * (1.0 - share), h, PI), w),
            _ => (Pose::new(0.0, h * (1.0 - share), -FRAC_PI_2), h),
        }
    }
}

/// A wall that projects from the border: straight, with a hook or with a cross-piece.
pub(super) fn spur(brush: &mut Brush, field: Field) -> Figure {
    let reach = (field.shorter() * brush.stream.between(0.15, 0.7)).max(1.6 * brush.gap);
    let hook = (brush.radius * brush.stream.between(0.6, 1.3)).max(1.2 * brush.gap);
    let mut line = points(&[(0.0, 0.0), (0.0, reach)]);
    let kind = brush.stream.below(4);
    let mut pockets = vec![Point::new(0.7 * brush.gap, 0.7 * brush.gap)];
    if kind < 2 {
        line.push(Point::new(hook, reach));
        pockets.push(Point::new(0.7 * brush.gap, reach - 0.7 * brush.gap));
        if kind == 0 && reach > 3.2 * brush.gap {
            line.push(Point::new(hook, reach - brush.gap * brush.stream.between(1.0, 1.5)));
        }
    }
    let mut outlines = if brush.stream.chance(0.4) && kind != 3 {
        vec![stroke(&line, brush.stream.between(0.04, 0.12))]
    } else {
        vec![Outline::open(line)]
    };
    if kind == 3 {
        outlines.push(Outline::open(points(&[(-hook, reach), (hook, reach)])));
    }
    on_border(brush, field, Figure::of(outlines).with_pockets(pockets))
}

/// A half disc on the border.
pub(super) fn bump(brush: &mut Brush, field: Field) -> Figure {
    let line = arc(Point::origin(), brush.radius, 0.0, PI, brush.facet());
    on_border(brush, field, Figure::of(vec![Outline::open(line)]))
}

/// A room on the border with a door.
pub(super) fn alcove(brush: &mut Brush, field: Field) -> Figure {
    let half = brush.radius.max(1.5 * brush.gap);
    let depth = brush.radius.max(1.4 * brush.gap) * brush.stream.between(1.0, 1.6);
    let door = brush.gap * brush.stream.between(1.3, 1.8);
    let outlines = if brush.stream.chance(0.5) {
        let edge = brush.stream.between(-half + 0.08, half - door - 0.08);
        vec![
            Outline::open(points(&[(-half, 0.0), (-half, depth), (edge, depth)])),
            Outline::open(points(&[(edge + door, depth), (half, depth), (half, 0.0)])),
        ]
    } else {
        // The door is next to the border.
        vec![Outline::open(points(&[(-half, 0.0), (-half, depth), (half, depth), (half, door)]))]
    };
    let pockets = vec![Point::new(0.0, 0.6 * brush.gap), Point::new(0.6 * brush.gap - half, 0.6 * brush.gap)];
    on_border(brush, field, Figure::of(outlines).with_pockets(pockets))
}

/// A room or half ring on the border, without a door.
pub(super) fn shut_alcove(brush: &mut Brush, field: Field) -> Figure {
    let half = brush.radius.max(1.3 * brush.gap);
    let line = if brush.stream.chance(0.5) {
        arc(Point::origin(), half, 0.0, PI, brush.facet())
    } else {
        let depth = half * brush.stream.between(1.0, 1.6);
        points(&[(half, 0.0), (half, depth), (-half, depth), (-half, 0.0)])
    };
    let chamber = Point::new(0.0, 0.6 * brush.gap);
    on_border(brush, field, Figure::of(vec![Outline::open(line)]).with_chambers(vec![chamber]))
}

/// A corner of the field, closed by a quarter ring or an angle.
pub(super) fn shut_corner(brush: &mut Brush, field: Field) -> Figure {
    let reach = (1.4 * brush.radius).max(1.7 * brush.gap);
    let line = if brush.stream.chance(0.5) {
        arc(Point::origin(), reach, 0.0, FRAC_PI_2, brush.facet())
    } else {
        let other = reach * brush.stream.between(0.8, 1.2);
        points(&[(reach, 0.0), (reach, other), (0.0, other)])
    };
    let inner = Point::new(0.6 * brush.gap, 0.6 * brush.gap);
    let figure = Figure::of(vec![Outline::open(line)]).with_chambers(vec![inner]);
    let (pose, _) = field.side(brush.stream.below(4), 0.0);
    figure.placed(pose, false)
}

/// A line across the whole field: straight, wavy or stepped.
pub(super) fn divider(brush: &mut Brush, field: Field) -> Figure {
    let share = brush.stream.between(0.3, 0.7);
    let (frame, length) = field.side(brush.stream.below(2), 0.0);
    let (_, across) = if frame.heading == 0.0 { field.side(1, 0.0) } else { field.side(0, 0.0) };
    let y = across * share;
    let line: Vec<Point> = match brush.stream.below(3) {
        0 => points(&[(0.0, y), (length, y)]),
        1 => {
            let waves = if brush.stream.chance(0.5) { 1.0 } else { 1.5 };
            let height = length * brush.stream.between(0.04, 0.08);
            wave(length, height, waves, 0.08).into_iter().map(|p| Point::new(p.x, p.y + y)).collect()
        }
        _ => {
            let (step, rise) = (length * brush.stream.between(0.3, 0.7), across * 0.12);
            points(&[(0.0, y - rise), (step, y - rise), (step, y + rise), (length, y + rise)])
        }
    };
    let chambers = vec![Point::new(0.5 * length, 0.35 * y), Point::new(0.2 * length, 0.35 * y)];
    Figure::of(vec![Outline::open(line)]).with_chambers(chambers).placed(frame, false)
}

/// Moves a figure from the border's frame to a random place on the border, away from the corners.
fn on_border(brush: &mut Brush, field: Field, figure: Figure) -> Figure {
    let share = brush.stream.between(0.12, 0.88);
    let (pose, _) = field.side(brush.stream.below(4), share);
    figure.placed(pose, false)
}
