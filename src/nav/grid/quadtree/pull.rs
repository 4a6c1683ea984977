//! Pulling a path straight.

use crate::nav::grid::any_angle::{Field, HalfPoint, in_sight};

/// The shortest path from a start to a goal through a sequence of portals, each given by its left and its
/// right end as seen from the start: the funnel algorithm. In half cells.
///
/// B. Chazelle, *A Theorem on Polygon Cutting with Applications*, FOCS 1982; D. T. Lee, F. P. Preparata,
/// *Euclidean Shortest Paths in the Presence of Rectilinear Barriers*, Networks 14, 1984.
pub(super) fn funnel(
    start: HalfPoint,
    openings: &[(HalfPoint, HalfPoint)],
    goal: HalfPoint,
) -> Vec<HalfPoint> {
    let mut path = vec![start];
    let mut apex = start;
    let (mut left, mut right) = ((start, 0), (start, 0));
    let opening = |index: usize| openings.get(index).copied().unwrap_or((goal, goal));
    let mut index = 0;
    while index <= openings.len() {
        let (next_left, next_right) = opening(index);
        // Rows count downwards, so clockwise turns have a positive area.
        if area(apex, right.0, next_right) <= 0 {
            if apex == right.0 || area(apex, left.0, next_right) > 0 {
                right = (next_right, index);
            } else {
                (apex, index) = left;
                path.push(apex);
                (left, right) = ((apex, index), (apex, index));
                index += 1;
                continue;
            }
        }
        if area(apex, left.0, next_left) >= 0 {
            if apex == left.0 || area(apex, right.0, next_left) < 0 {
                left = (next_left, index);
            } else {
                (apex, index) = right;
                path.push(apex);
                (left, right) = ((apex, index), (apex, index));
                index += 1;
                continue;
            }
        }
        index += 1;
    }
    path.push(goal);
    path.dedup();
    path
}

/// Twice the area of a triangle; positive if it turns clockwise, with rows counted downwards.
fn area(a: HalfPoint, b: HalfPoint, c: HalfPoint) -> i64 {
    let (ux, uy) = (i64::from(b.x - a.x), i64::from(b.y - a.y));
    let (vx, vy) = (i64::from(c.x - a.x), i64::from(c.y - a.y));
    ux * vy - uy * vx
}

/// Maximum number of points that a shortcut skips.
const REACH: usize = 12;

/// The shortest path over some of the points in their order, using lines of sight to later points.
/// Consecutive points are known to be in sight.
pub(super) fn shortcut(field: &Field, points: &[HalfPoint]) -> Vec<HalfPoint> {
    let mut best = vec![(f64::INFINITY, 0); points.len()];
    best[0].0 = 0.0;
    for to in 1..points.len() {
        for from in to.saturating_sub(REACH)..to {
            let cost = best[from].0 + distance(points[from], points[to]);
            if cost < best[to].0 && (from + 1 == to || in_sight(field, points[from], points[to])) {
                best[to] = (cost, from);
            }
        }
    }
    let mut path = vec![points[points.len() - 1]];
    let mut at = points.len() - 1;
    while at > 0 {
        at = best[at].1;
        path.push(points[at]);
    }
    path.reverse();
    path
}

pub(super) fn distance(a: HalfPoint, b: HalfPoint) -> f64 {
    let (dx, dy) = (f64::from(a.x - b.x), f64::from(a.y - b.y));
    0.5 * (dx * dx + dy * dy).sqrt()
}
