//! The rows of cones that a lane lies between, followed from cone to cone from where the car is: a way that passes through one of
//! them leaves the track.

use super::cone::Cone;
use crate::geometry::{Point, Pose, Vector, cross, math};

/// How rows are followed.
#[derive(Debug, Clone, Copy)]
pub(super) struct RowParameters {
    /// Metres from cone to cone at most.
    pub(super) reach: f64,
    /// Metres from the middle of the lane to its edge, about.
    pub(super) half_width: f64,
    /// Metres by which a cone of an edge may stand off it.
    pub(super) loose: f64,
}

/// Rows that are followed at a time.
const BEAM: usize = 10;
/// Cones of a row at most.
const LONGEST: usize = 12;
/// Cones beside the car with which a row may begin.
const SEEDS: usize = 3;
/// Metres ahead of the car, or behind a place where it was, at which a cone is beside it.
const BESIDE: f64 = 2.0;
/// Metres between two cones of a row at least.
const NEAREST: f64 = 0.7;
/// Radians by which a row turns at most at one cone.
const SHARPEST: f64 = 1.35;
/// What a radian of turn costs, squared, a radian by which turns differ, a metre from cone to cone, and the known edge being the
/// other one. One more cone is worth 1, and none is added that costs more: from one edge to the other, a row would have to turn to
/// and fro.
const TURN: f64 = 0.5;
const CHANGE: f64 = 1.2;
const FAR: f64 = 0.07;
const OTHER_EDGE: f64 = 2.5;

/// A cone of a row, and how the row got there.
#[derive(Debug, Clone, Copy)]
struct Step {
    cone: usize,
    heading: Vector,
    turn: f64,
    worth: f64,
    parent: Option<usize>,
}

/// A row: its cones, and what they are worth together.
#[derive(Debug, Clone, Default)]
struct Row {
    cones: Vec<usize>,
    worth: f64,
}

/// The legs of the rows on the left and on the right of a lane, from cone to cone.
///
/// `places` is where the car was and is, oldest first. A row ends where no cone goes on with it. No cone belongs to both: of the
/// ways to share them out, that with the worthier rows is taken. Takes O(n) for n cones.
pub(super) fn legs(cones: &[Cone], places: &[Pose], p: &RowParameters) -> Vec<[Point; 2]> {
    let mut taken = [vec![false; cones.len()], vec![false; cones.len()]];
    let follow = |side: usize, taken: &[bool]| row(cones, places, [1.0, -1.0][side], taken, p);
    let mut rows = [0, 1].map(|side| follow(side, &taken[side]));
    while let Some(at) = parting(&rows) {
        // Either row keeps what it has from there on, and the other one is followed again without that.
        let again = [0, 1].map(|keeper| {
            let other = 1 - keeper;
            let mut without = taken[other].clone();
            rows[keeper].cones[at[keeper]..].iter().for_each(|&cone| without[cone] = true);
            (follow(other, &without), without)
        });
        let worth = [0, 1].map(|keeper| rows[keeper].worth + again[keeper].0.worth);
        let keeper = usize::from(worth[1] > worth[0]);
        let [left_keeps, right_keeps] = again;
        let (row, without) = if keeper == 0 { left_keeps } else { right_keeps };
        (rows[1 - keeper], taken[1 - keeper]) = (row, without);
    }
    let points = |row: &Row| -> Vec<[Point; 2]> {
        row.cones.windows(2).map(|pair| [cones[pair[0]].position, cones[pair[1]].position]).collect()
    };
    rows.iter().flat_map(points).collect()
}

/// The places in both rows of the first cone of the left one that the right one has as well.
fn parting(rows: &[Row; 2]) -> Option<[usize; 2]> {
    rows[0].cones.iter().enumerate().find_map(|(at, cone)| {
        let other = rows[1].cones.iter().position(|other| other == cone)?;
        Some([at, other])
    })
}

/// The row on a side, 1 for the left one, without the cones that are taken.
fn row(cones: &[Cone], places: &[Pose], side: f64, taken: &[bool], p: &RowParameters) -> Row {
    let mut steps = seeds(cones, places, side, p);
    steps.retain(|step| !taken[step.cone]);
    let mut beam: Vec<usize> = (0..steps.len()).collect();
    for _ in 0..LONGEST {
        let mut next: Vec<Step> = Vec::new();
        for &parent in &beam {
            let onwards = (0..cones.len()).filter(|&cone| !taken[cone] && !holds(&steps, parent, cone));
            next.extend(onwards.filter_map(|cone| onward(cones, &steps, parent, (cone, side), p)));
        }
        next.sort_by(|a, b| b.worth.total_cmp(&a.worth));
        next.truncate(BEAM);
        beam = (steps.len()..steps.len() + next.len()).collect();
        steps.extend(next);
    }
    let Some(best) = (0..steps.len()).max_by(|&a, &b| steps[a].worth.total_cmp(&steps[b].worth)) else {
        return Row::default();
    };
    let mut found = Row { cones: Vec::new(), worth: steps[best].worth };
    let mut at = Some(best);
    while let Some(index) = at {
        found.cones.push(steps[index].cone);
        at = steps[index].parent;
    }
    found.cones.reverse();
    found
}

/// Cones beside the car, or beside where it was, with which a row may begin: those farthest back.
fn seeds(cones: &[Cone], places: &[Pose], side: f64, p: &RowParameters) -> Vec<Step> {
    let mut found: Vec<(usize, Step)> = Vec::new();
    for (cone, Cone { position, colour }) in cones.iter().enumerate() {
        let beside = places.iter().enumerate().find_map(|(at, place)| {
            let local = place.to_local(*position);
            let aside = side * local.y;
            let near = (0.5 * p.half_width..p.half_width + p.loose + 0.4).contains(&aside);
            (local.x.abs() < BESIDE && near).then_some((at, place.forward(), (aside - p.half_width).abs()))
        });
        let Some((at, heading, off)) = beside else { continue };
        if f64::from(colour.side()) * side >= 0.0 {
            let step = Step { cone, heading, turn: 0.0, worth: -0.5 * off, parent: None };
            found.push((at, step));
        }
    }
    found.sort_by_key(|(at, _)| *at);
    found.into_iter().take(SEEDS).map(|(_, step)| step).collect()
}

/// Whether a row has a cone already.
fn holds(steps: &[Step], row: usize, cone: usize) -> bool {
    let mut at = Some(row);
    while let Some(index) = at {
        if steps[index].cone == cone {
            return true;
        }
        at = steps[index].parent;
    }
    false
}

/// A row with one more cone. `None` where that is too far off, or too far aside.
fn onward(
    cones: &[Cone],
    steps: &[Step],
    parent: usize,
    (cone, side): (usize, f64),
    p: &RowParameters,
) -> Option<Step> {
    let last = &steps[parent];
    let leg = cones[cone].position - cones[last.cone].position;
    let length = leg.norm();
    if !(NEAREST..p.reach).contains(&length) {
        return None;
    }
    let turn = math::atan2(cross(last.heading, leg), last.heading.dot(&leg));
    if turn.abs() > SHARPEST {
        return None;
    }
    // The first leg may be aslant: the car is.
    let change = if last.parent.is_none() { 0.0 } else { turn - last.turn };
    let other = f64::from(cones[cone].colour.side()) * side < 0.0;
    let own =
        TURN * turn * turn + CHANGE * change * change + FAR * length + if other { OTHER_EDGE } else { 0.0 };
    (own < 1.0).then(|| Step {
        cone,
        heading: leg / length,
        turn,
        worth: last.worth + 1.0 - own,
        parent: Some(parent),
    })
}

/// Whether the way from one point to another passes through a leg.
pub(super) fn passes([a, b]: [Point; 2], [c, d]: [Point; 2]) -> bool {
    let side = |from: Point, to: Point, point: Point| cross(to - from, point - from) > 0.0;
    side(a, b, c) != side(a, b, d) && side(c, d, a) != side(c, d, b)
}

#[cfg(test)]
mod tests {
    use super::*;

    const P: RowParameters = RowParameters { reach: 10.5, half_width: 1.8, loose: 0.8 };

    fn at(places: &[(f64, f64)]) -> Vec<Cone> {
        places.iter().map(|&(x, y)| Cone::unknown(Point::new(x, y))).collect()
    }

    fn is_leg(legs: &[[Point; 2]], a: (f64, f64), b: (f64, f64)) -> bool {
        legs.contains(&[Point::new(a.0, a.1), Point::new(b.0, b.1)])
    }

    #[test]
    fn rows_go_on_where_a_cone_is_missing() {
        let cones =
            at(&[(0.0, 1.8), (4.0, 1.8), (12.0, 2.0), (0.0, -1.8), (4.0, -1.8), (8.0, -1.8), (12.0, -1.6)]);
        let found = legs(&cones, &[Pose::default()], &P);
        assert!(
            is_leg(&found, (4.0, 1.8), (12.0, 2.0)) && is_leg(&found, (8.0, -1.8), (12.0, -1.6)),
            "{found:?}"
        );
        assert_eq!(found.len(), 5);
    }

    #[test]
    fn a_row_that_ends_does_not_go_over_to_the_other_one() {
        // The left one ends; the right one goes on across its way, in a bend to the left.
        let right: Vec<(f64, f64)> = (0..8)
            .map(|k| 0.22 * f64::from(k))
            .map(|a| (13.0 * math::sin(a), 11.2 - 13.0 * math::cos(a)))
            .collect();
        let left = [(-2.8, 1.8), (0.0, 1.8), (2.7, 2.2)];
        let cones = at(&[&left[..], &right[..]].concat());
        let found = legs(&cones, &[Pose::new(-2.8, 0.0, 0.0), Pose::default()], &P);
        let crosses = |[a, b]: &[Point; 2]| left.contains(&(a.x, a.y)) && right.contains(&(b.x, b.y));
        assert!(found.len() >= 8 && !found.iter().any(crosses), "{found:?}");
    }

    #[test]
    fn ways_pass_through_legs() {
        let leg = [Point::new(2.0, -1.0), Point::new(2.0, 3.0)];
        assert!(passes([Point::origin(), Point::new(4.0, 0.5)], leg));
        assert!(!passes([Point::origin(), Point::new(1.5, 0.0)], leg));
        assert!(!passes([Point::origin(), Point::new(4.0, -3.0)], leg));
    }
}
