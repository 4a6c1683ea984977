//! Curved obstacles: circles and arcs of many short walls.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::brush::Brush;
use super::figure::{Figure, Outline, divided, stroke};
use crate::geometry::{Point, direction, math};

/// A disc.
pub(super) fn disc(brush: &mut Brush) -> Figure {
    let radius = brush.radius;
    oval(brush, radius, radius)
}

/// An ellipse.
pub(super) fn ellipse(brush: &mut Brush) -> Figure {
    let flatness = brush.stream.between(0.45, 0.8);
    oval(brush, brush.radius, brush.radius * flatness)
}

/// A closed oval with semi-axes `a` and `b`.
pub(super) fn oval(brush: &mut Brush, a: f64, b: f64) -> Figure {
    let step = brush.facet();
    let n = (TAU * a / step).clamp(16.0, 120.0) as usize;
    let corner = |i: usize| {
        let d = direction(TAU * i as f64 / n as f64);
        Point::new(a * d.x, b * d.y)
    };
    let chambers = vec![Point::origin(), Point::new(0.4 * a, 0.0)];
    Figure::of(vec![Outline::closed((0..n).map(corner).collect())]).with_chambers(chambers)
}

/// A C: most of a ring, open on one side.
pub(super) fn open_ring(brush: &mut Brush) -> Figure {
    let (radius, width) = ring_size(brush);
    let half_mouth = half_mouth(brush, radius, width);
    let line = arc(Point::origin(), radius, half_mouth, TAU - half_mouth, brush.facet());
    let pockets = vec![Point::origin(), Point::new(-0.4 * radius, 0.0)];
    Figure::of(vec![brush.wall_or_stroke(line, width)]).with_pockets(pockets)
}

/// A G: a C with a bar from one end of the ring inwards.
pub(super) fn hooked_ring(brush: &mut Brush) -> Figure {
    let radius = brush.radius.max(2.6 * brush.gap);
    let width = brush.stream.between(0.03, 0.08).min(0.3 * brush.gap);
    let mouth = math::asin(((1.5 * brush.gap + width) / radius).min(1.0)) + brush.stream.between(0.0, 0.5);
    let mut line = arc(Point::origin(), radius, mouth, TAU, brush.facet());
    let inner = brush.stream.between(0.1, 0.5) * radius;
    line.push(Point::new(inner, 0.0));
    let pockets = vec![Point::new(-0.4 * radius, 0.0), Point::new(0.5 * radius, -0.45 * radius)];
    Figure::of(vec![brush.wall_or_stroke(line, width)]).with_pockets(pockets)
}

/// A C within a C, open on different sides.
pub(super) fn nested_rings(brush: &mut Brush) -> Figure {
    let radius = brush.radius.max(2.9 * brush.gap);
    let inner = radius - brush.gap * brush.stream.between(1.2, 1.5);
    let turn = brush.stream.between(FRAC_PI_2, 3.0 * FRAC_PI_2);
    let outlines = [(radius, 0.0), (inner, turn)].map(|(r, turn)| {
        let half_mouth = half_mouth(brush, r, 0.0).min(1.2);
        Outline::open(arc(Point::origin(), r, turn + half_mouth, turn + TAU - half_mouth, brush.facet()))
    });
    let between = Point::origin() + direction(PI) * (0.5 * (radius + inner));
    Figure::of(outlines.to_vec()).with_pockets(vec![Point::origin(), between])
}

/// A crescent that tapers to pointed horns.
pub(super) fn crescent(brush: &mut Brush) -> Figure {
    let radius = brush.radius.max(1.7 * brush.gap);
    let belly = brush.stream.between(0.2, 0.45) * radius;
    let belly = belly.min(radius - 0.9 * brush.gap);
    let half_mouth = half_mouth(brush, radius, 0.0).max(0.9);
    let outer = arc(Point::origin(), radius, half_mouth, TAU - half_mouth, brush.facet());
    let n = outer.len() - 1;
    let inner = (1..n).rev().map(|i| {
        let taper = math::sin(PI * i as f64 / n as f64);
        Point::origin() + (outer[i] - Point::origin()) * (1.0 - belly / radius * taper)
    });
    let points = outer.iter().copied().chain(inner).collect();
    Figure::of(vec![Outline::closed(points)])
        .with_pockets(vec![Point::origin(), Point::new(0.4 * radius, 0.0)])
}

/// A round spiral with a corridor to its centre.
pub(super) fn spiral(brush: &mut Brush) -> Figure {
    let width = brush.stream.between(0.02, 0.05);
    let pitch = brush.gap * brush.stream.between(1.1, 1.4) + width;
    let eye = brush.gap * brush.stream.between(0.5, 0.7) + 0.5 * width;
    let turns = ((brush.radius - eye) / pitch).clamp(1.2, 2.5);
    let radius_at = |angle: f64| eye + pitch * angle / TAU;
    let facet = brush.facet();
    let mut angle = 0.0;
    let mut line = Vec::new();
    while angle < TAU * turns {
        line.push(Point::origin() + direction(angle) * radius_at(angle));
        angle += facet / radius_at(angle);
    }
    let mid_corridor = Point::origin() + direction(0.5 * PI) * (radius_at(0.5 * PI) + 0.5 * pitch);
    let pockets = vec![Point::origin(), Point::origin(), mid_corridor];
    Figure::of(vec![brush.wall_or_stroke(line, width)]).with_pockets(pockets)
}

/// A snake: alternating half rings.
pub(super) fn snake(brush: &mut Brush) -> Figure {
    let bends = 2 + brush.stream.below(3);
    let bend = (brush.radius / bends as f64).max(0.75 * brush.gap);
    let width = brush.stream.between(0.03, 0.12).min(0.4 * bend);
    let facet = brush.facet();
    let bend = bend + 0.5 * width;
    let mut line = vec![Point::origin()];
    for k in 0..bends {
        let middle = Point::new((2 * k + 1) as f64 * bend, 0.0);
        let half = arc(middle, bend, PI, 0.0, facet);
        let side = if k % 2 == 0 { 1.0 } else { -1.0 };
        line.extend(half.iter().skip(1).map(|p| Point::new(p.x, side * p.y)));
    }
    let pockets = (0..bends).map(|k| Point::new((2 * k + 1) as f64 * bend, 0.0)).collect();
    Figure::of(vec![brush.wall_or_stroke(line, width)]).with_pockets(pockets).centred()
}

/// A bowed wall: a shallow arc.
pub(super) fn bow(brush: &mut Brush) -> Figure {
    let bulge = brush.stream.between(0.6, 1.4);
    let bend = brush.radius / math::sin(bulge.min(FRAC_PI_2));
    let line = arc(Point::new(-bend, 0.0), bend, -bulge, bulge, brush.facet());
    let width = brush.stream.between(0.03, 0.15);
    let cove = Point::new(-0.5 * brush.gap - 0.2, 0.0);
    Figure::of(vec![brush.wall_or_stroke(line, width)]).with_pockets(vec![cove]).centred()
}

/// A closed band along an arc, wide enough for a robot inside.
pub(super) fn hollow_arc(brush: &mut Brush) -> Figure {
    let width = brush.gap * brush.stream.between(1.3, 1.8);
    let radius = brush.radius.max(1.6 * width);
    let half_mouth = half_mouth(brush, radius, width);
    let line = arc(Point::origin(), radius, half_mouth, TAU - half_mouth, brush.facet());
    let chambers = vec![line[line.len() / 2], line[line.len() / 4]];
    Figure::of(vec![stroke(&line, width)])
        .with_chambers(chambers)
        .with_pockets(vec![Point::new(-0.2 * radius, 0.0)])
}

/// A C with its mouth closed by another wall.
pub(super) fn shut_ring(brush: &mut Brush) -> Figure {
    let mut ring = open_ring(brush);
    ring.chambers = std::mem::take(&mut ring.pockets);
    let points = ring.outlines.iter().flat_map(|outline| &outline.points);
    let front = points.fold(f64::NEG_INFINITY, |front, p| front.max(p.x));
    let half = brush.radius.max(1.6 * brush.gap) * brush.stream.between(1.0, 1.5);
    // The ring's rightmost points are the edges of its mouth, or lie on a circle that the wall also touches.
    let lid = vec![Point::new(front, -half), Point::new(front, half)];
    ring.outlines.push(Outline::open(lid));
    ring
}

fn ring_size(brush: &mut Brush) -> (f64, f64) {
    let radius = brush.radius.max(1.6 * brush.gap);
    let thickest = (radius - 0.9 * brush.gap).min(0.2);
    (radius, brush.stream.between(0.04, thickest.max(0.05)))
}

/// Half the opening angle of a ring, for a mouth of at least 1.5 gaps and at most a half ring.
fn half_mouth(brush: &mut Brush, radius: f64, width: f64) -> f64 {
    let least = math::asin((0.5 * (1.5 * brush.gap + width) / (radius - 0.5 * width)).min(1.0));
    brush.stream.between(least, (least + 0.9).min(FRAC_PI_2))
}

/// Points of an arc from one angle to another, at most `facet` apart.
pub(super) fn arc(middle: Point, radius: f64, from: f64, to: f64, facet: f64) -> Vec<Point> {
    let steps = ((to - from).abs() * radius / facet).ceil().max(4.0);
    (0..=steps as usize).map(|k| middle + direction(from + (to - from) * k as f64 / steps) * radius).collect()
}

/// A wavy line along x; the numbers of crests and troughs are equal.
pub(super) fn wave(length: f64, height: f64, waves: f64, facet: f64) -> Vec<Point> {
    divided(&[Point::origin(), Point::new(length, 0.0)], facet)
        .into_iter()
        .map(|p| Point::new(p.x, height * math::sin(TAU * waves * p.x / length)))
        .collect()
}
