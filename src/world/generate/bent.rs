//! Obstacles made of bent lines: hooks, zig-zags, corridors and square spirals.

use std::f64::consts::FRAC_PI_2;

use super::brush::Brush;
use super::figure::{Figure, Outline, beside, stroke};
use super::straight::points;
use crate::geometry::{Point, Pose, direction};

/// A U, shallow to deep.
pub(super) fn trough(brush: &mut Brush) -> Figure {
    let (line, width, half, depth) = trough_line(brush);
    let ground = Point::new(0.0, 0.5 * width + 0.6 * brush.gap);
    let pockets = vec![ground, ground, Point::new(0.0, 0.7 * depth), Point::new(0.4 * half, ground.y)];
    Figure::of(vec![brush.wall_or_stroke(line, width)]).with_pockets(pockets).centred()
}

/// A U with its opening closed by another wall.
pub(super) fn shut_trough(brush: &mut Brush) -> Figure {
    let (line, width, half, depth) = trough_line(brush);
    let reach = half + 0.5 * width;
    let more = brush.stream.between(0.0, 0.5);
    let lid = points(&[(-reach - more, depth), (reach + brush.stream.between(0.0, 0.5), depth)]);
    let depth_of_chamber = 0.5 * width + 0.6 * brush.gap;
    Figure::of(vec![brush.wall_or_stroke(line, width), Outline::open(lid)])
        .with_chambers(vec![Point::new(0.0, depth_of_chamber), Point::new(0.0, 0.5 * depth)])
        .centred()
}

fn trough_line(brush: &mut Brush) -> (Vec<Point>, f64, f64, f64) {
    let width = brush.stream.between(0.04, 0.15);
    let half = (brush.radius * brush.stream.between(0.45, 0.9)).max(0.75 * brush.gap + 0.5 * width);
    let depth = (brush.radius * brush.stream.between(0.8, 1.8)).max(1.4 * brush.gap + width);
    let shorter = depth * brush.stream.between(0.8, 1.0);
    let other = if brush.stream.chance(0.5) { depth } else { shorter };
    (points(&[(-half, depth), (-half, 0.0), (half, 0.0), (half, other)]), width, half, depth.min(other))
}

/// An L.
pub(super) fn angle(brush: &mut Brush) -> Figure {
    let width = brush.stream.between(0.04, 0.2);
    let (a, b) = (2.0 * brush.radius, brush.radius * brush.stream.between(0.8, 2.0));
    let crook = 0.5 * width + 0.6 * brush.gap;
    let line = points(&[(a, 0.0), (0.0, 0.0), (0.0, b)]);
    Figure::of(vec![brush.wall_or_stroke(line, width)]).with_pockets(vec![Point::new(crook, crook)]).centred()
}

/// A zig-zag of three to six legs.
pub(super) fn zigzag(brush: &mut Brush) -> Figure {
    let legs = 3 + brush.stream.below(4);
    let line = zigzag_line(brush, legs, 2.2 * brush.radius / legs as f64);
    let width = brush.stream.between(0.03, 0.1);
    let inner = line[1..legs].iter().enumerate();
    let off = |k: usize| if k.is_multiple_of(2) { -0.8 } else { 0.8 } * brush.gap;
    let pockets = inner.map(|(k, p)| Point::new(p.x, p.y + off(k))).collect();
    Figure::of(vec![brush.wall_or_stroke(line, width)]).with_pockets(pockets).centred()
}

/// Alternating legs of a given length up and down, at 40 to 55 degrees to either side.
fn zigzag_line(brush: &mut Brush, legs: usize, length: f64) -> Vec<Point> {
    let length = length.max(1.5 * brush.gap);
    let slope = brush.stream.between(0.6, 0.92);
    let mut line = vec![Point::origin()];
    for k in 0..legs {
        let stretch = brush.stream.between(0.8, 1.2);
        let side = if k % 2 == 0 { slope } else { -slope };
        line.push(line[k] + direction(side) * (length * stretch));
    }
    line
}

/// A square spiral, from a hook to a labyrinth.
pub(super) fn square_spiral(brush: &mut Brush) -> Figure {
    let width = brush.stream.between(0.02, 0.07);
    let pitch = brush.gap * brush.stream.between(1.1, 1.5) + width;
    let legs = (4.0 * brush.radius / pitch).clamp(4.0, 9.0) as usize;
    let mut line = vec![Point::origin()];
    for k in 0..legs {
        line.push(line[k] + direction(FRAC_PI_2 * k as f64) * (pitch * (k / 2 + 1) as f64));
    }
    let eye = Point::new(0.5 * pitch, 0.5 * pitch);
    Figure::of(vec![brush.wall_or_stroke(line, width)]).with_pockets(vec![eye, eye]).centred()
}

/// A corridor of two walls, straight or with one bend.
pub(super) fn corridor(brush: &mut Brush) -> Figure {
    let half = brush.gap * brush.stream.between(0.52, 0.8);
    let bend = if brush.stream.chance(0.6) { brush.stream.between(0.3, FRAC_PI_2) } else { 0.0 };
    let leg = brush.radius.max(1.5 * brush.gap);
    let line = [Point::new(-leg, 0.0), Point::origin(), Point::origin() + direction(bend) * leg];
    let mut sides = [beside(&line, half), beside(&line, -half)];
    // One wall may be shorter than the other.
    sides[0][0].x += brush.stream.between(0.0, 0.4) * leg;
    let pockets = vec![Point::origin(), Point::new(-0.5 * leg, 0.0)];
    Figure::of(sides.map(Outline::open).to_vec()).with_pockets(pockets).centred()
}

/// A channel with alternating baffles.
pub(super) fn baffles(brush: &mut Brush) -> Figure {
    let half = brush.gap * brush.stream.between(1.1, 1.5);
    let spacing = brush.gap * brush.stream.between(1.2, 1.7);
    let count = ((2.0 * brush.radius / spacing) as usize).clamp(3, 5) - 1;
    let end = spacing * (count + 1) as f64;
    let opening = brush.gap * brush.stream.between(1.1, 1.3);
    let mut outlines = [half, -half].map(|y| Outline::open(points(&[(0.0, y), (end, y)]))).to_vec();
    for k in 0..count {
        let (x, side) = (spacing * (k + 1) as f64, if k % 2 == 0 { half } else { -half });
        let tip = side - side.signum() * (2.0 * half - opening);
        outlines.push(Outline::open(points(&[(x, side), (x, tip)])));
    }
    let pockets = (1..count).map(|k| Point::new(spacing * (k as f64 + 0.5), 0.0)).collect();
    Figure::of(outlines).with_pockets(pockets).centred()
}

/// A closed band along an L, U or zig-zag, wide enough for a robot inside.
pub(super) fn hollow_bend(brush: &mut Brush) -> Figure {
    let width = brush.gap * brush.stream.between(1.3, 1.8);
    let reach = brush.radius.max(1.6 * width);
    let line = match brush.stream.below(3) {
        0 => points(&[(1.6 * reach, 0.0), (0.0, 0.0), (0.0, 1.4 * reach)]),
        1 => {
            let half = reach.max(0.5 * width + 0.8 * brush.gap + 0.1);
            points(&[(-half, 1.5 * reach), (-half, 0.0), (half, 0.0), (half, 1.2 * reach)])
        }
        _ => zigzag_line(brush, 3, 1.8 * width),
    };
    let chambers = line[1..line.len() - 1].to_vec();
    Figure::of(vec![stroke(&line, width)]).with_chambers(chambers).centred()
}

/// The figure with a crooked wall attached to one of its corners.
pub(super) fn with_tail(brush: &mut Brush, mut figure: Figure) -> Figure {
    let corners = &figure.outlines[0].points;
    let Some(&root) =
        corners.iter().max_by(|p, q| p.coords.norm_squared().total_cmp(&q.coords.norm_squared()))
    else {
        return figure;
    };
    let away = crate::geometry::math::atan2(root.y, root.x);
    let first = Pose::new(root.x, root.y, away);
    let length = brush.gap * brush.stream.between(1.5, 3.0);
    let knee = first.to_world(Point::new(length, 0.0));
    let turn = brush.stream.between(-1.5, 1.5);
    let end = knee + direction(away + turn) * length;
    figure.outlines.push(Outline::open(vec![root, knee, end]));
    figure
}
