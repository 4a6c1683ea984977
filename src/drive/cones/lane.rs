//! The lane ahead of a car that knows only some of its cones: where one side is missing, where gaps are wide, and where others
//! stand about.

use super::arcs::ArcSearch;
use super::cone::Cone;
use super::rows::{Passage, RowParameters, rows};
use crate::geometry::{Point, Pose, Vector, math};

#[cfg(test)]
mod tests;

/// What a lane is looked for with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LaneParameters {
    /// Metres of a piece, which has one curvature.
    pub piece: f64,
    /// Pieces.
    pub pieces: usize,
    /// The greatest curvature, in 1/m.
    pub curvature: f64,
    /// Ways that are followed at a time.
    pub beam: usize,
    /// Metres to a cone at which a car would touch it.
    pub clearance: f64,
    /// Metres from the middle to an edge, from least to most.
    pub half_width: [f64; 2],
    /// The same before cones say more.
    pub usual: f64,
    /// Metres by which a cone of an edge may stand off it.
    pub loose: f64,
    /// Metres from cone to cone of an edge at most, where one or two are missing.
    pub spacing: f64,
    /// Radians by which an edge turns at most at one cone.
    pub sharpest: f64,
}

impl Default for LaneParameters {
    fn default() -> Self {
        Self {
            piece: 2.5,
            pieces: 7,
            curvature: 0.38,
            beam: 40,
            clearance: 1.15,
            half_width: [1.4, 2.8],
            usual: 1.9,
            loose: 0.8,
            spacing: 10.5,
            sharpest: 1.9,
        }
    }
}

/// The middle of a lane.
#[derive(Debug, Clone, PartialEq)]
pub struct Lane {
    /// Points along it, about a metre apart.
    pub points: Vec<Point>,
    /// The cones of its left and of its right edge, by their indices, in their order along it.
    pub edges: [Vec<usize>; 2],
    /// Metres from the middle to an edge, as its cones say.
    pub half_width: f64,
}

/// What rows are worth against how well a way goes between them.
const ROWS: f64 = 0.5;
/// Metres along the lane over which a cone speaks for its edge.
pub(super) const SPEAKS: f64 = 6.5;
/// Metres along the lane within which a cone is next to a station.
const NEXT_TO: f64 = 1.6;

/// Where a car was, is, and has been earlier.
#[derive(Debug, Clone, Copy)]
pub(super) struct Way<'w> {
    /// Where it was just now, oldest first.
    pub(super) behind: &'w [Pose],
    pub(super) car: Pose,
    /// The way by which it came: it does not lead back there. Where a circuit crosses itself, it goes straight on.
    pub(super) earlier: &'w [Pose],
    /// What is no cone and not to be touched.
    pub(super) others: &'w [Point],
}

impl Lane {
    /// A lane of which nothing is known but half its width.
    pub(super) fn unknown(half_width: f64) -> Self {
        Self { points: Vec::new(), edges: [Vec::new(), Vec::new()], half_width }
    }

    /// How far a place is from the lane, 0 to 1; 0 beyond its end.
    pub(super) fn away(&self, place: Point) -> f64 {
        let mut nearest = (0, f64::INFINITY);
        for (i, point) in self.points.iter().enumerate() {
            let squared = (point - place).norm_squared();
            if squared < nearest.1 {
                nearest = (i, squared);
            }
        }
        if nearest.0 + 2 < self.points.len() { nearest.1.min(1.0) } else { 0.0 }
    }
}

/// Looks for the lane that most cones are the edges of: a way of arcs, by a beam search, that keeps clear of all cones and has as
/// many as possible at half its width on both sides. Then its middle is moved to where the cones of both sides, or of the one that
/// there is, say that it is. Colours count, if they are known.
///
/// `behind` is where the car was, oldest first, `car` where it is, at the point of it that is to be in the middle, and `before` the
/// lane as it was found before. `None` without a cone at an edge. Takes O(n²) for n cones.
pub fn lane(
    cones: &[Cone],
    behind: &[Pose],
    car: Pose,
    before: &Lane,
    parameters: &LaneParameters,
) -> Option<Lane> {
    lane_where(cones, &Way { behind, car, earlier: &[], others: &[] }, before, parameters)
}

/// The same for a car of which it is known where else it has been.
pub(super) fn lane_where(
    cones: &[Cone],
    way: &Way,
    before: &Lane,
    parameters: &LaneParameters,
) -> Option<Lane> {
    let car = way.car;
    let reach = parameters.piece * parameters.pieces as f64 + parameters.spacing;
    let near: Vec<usize> =
        (0..cones.len()).filter(|&cone| (cones[cone].position - car.position()).norm() < reach).collect();
    let cones: Vec<Cone> = near.iter().map(|&cone| cones[cone]).collect();
    let mut found = lane_between(&cones, way, before, parameters)?;
    for cone in found.edges.iter_mut().flatten() {
        *cone = near[*cone];
    }
    Some(found)
}

/// The same between cones that are all near.
fn lane_between(cones: &[Cone], way: &Way, before: &Lane, parameters: &LaneParameters) -> Option<Lane> {
    let half_width = before.half_width;
    let mut stations = way.behind.to_vec();
    stations.push(way.car);
    let p = parameters;
    let narrowest = p.half_width[0];
    let along_rows =
        RowParameters { reach: p.spacing, half_width, narrowest, loose: p.loose, sharpest: p.sharpest };
    let earlier: Vec<Passage> = way.earlier.iter().map(|pose| (*pose).into()).collect();
    let rows = rows(cones, &stations, &earlier, &along_rows);
    let search = ArcSearch { cones, others: way.others, earlier: &earlier, before, parameters };
    // Rows alone do not tell whether a car can drive between them.
    let ways = rows.iter().filter_map(|rows| {
        let (poses, cost) = search.best(rows, way.car)?;
        Some((cost - ROWS * rows.worth, rows, poses))
    });
    let (_, rows, poses) = ways.min_by(|a, b| a.0.total_cmp(&b.0))?;
    stations.extend(poses);
    let sides = rows.sides(cones.len());
    let mut found = settled((cones, &sides), &stations, half_width, parameters);
    let places: Vec<Point> =
        cones.iter().map(|cone| cone.position).chain(way.others.iter().copied()).collect();
    keep_clear(&mut found.points, &places, p.clearance + BEYOND_TOUCH);
    found.edges.iter().any(|edge| !edge.is_empty()).then_some(found)
}

/// A cone of an edge.
#[derive(Debug, Clone, Copy)]
struct EdgeCone {
    /// Metres along the lane, and aside of it.
    along: f64,
    aside: f64,
    index: usize,
}

/// The middle between the edges along some stations.
fn settled((cones, sides): (&[Cone], &[i8]), stations: &[Pose], half_width: f64, p: &LaneParameters) -> Lane {
    let mut along = vec![0.0];
    for pair in stations.windows(2) {
        along.push(along[along.len() - 1] + (pair[1].position() - pair[0].position()).norm());
    }
    let edges = [1.0, -1.0].map(|side| edge((cones, sides), stations, &along, (half_width, p.loose), side));
    let mut offsets: Vec<f64> = along.iter().map(|at| offset(&edges, *at, half_width)).collect();
    for _ in 0..3 {
        let old = offsets.clone();
        for i in 1..old.len().saturating_sub(1) {
            offsets[i] = 0.25 * old[i - 1] + 0.5 * old[i] + 0.25 * old[i + 1];
        }
    }
    // Beyond the last cone, nothing is known.
    let last = edges.iter().flatten().map(|cone| cone.along).fold(0.0, f64::max);
    let known = along.iter().position(|at| *at > last + 1.5).unwrap_or(along.len());
    let normal = |pose: &Pose| Vector::new(-math::sin(pose.heading), math::cos(pose.heading));
    let points: Vec<Point> = stations
        .iter()
        .zip(&offsets)
        .take(known)
        .map(|(pose, offset)| pose.position() + normal(pose) * *offset)
        .collect();
    let half_width = width(&edges, half_width, p);
    Lane {
        points: even(&points),
        edges: edges.map(|edge| edge.iter().map(|cone| cone.index).collect()),
        half_width,
    }
}

/// The cones of a side, in their order along the lane: 1 for the left one.
fn edge(
    (cones, sides): (&[Cone], &[i8]),
    stations: &[Pose],
    along: &[f64],
    (half_width, loose): (f64, f64),
    side: f64,
) -> Vec<EdgeCone> {
    let mut found: Vec<EdgeCone> = Vec::new();
    for (index, (cone, known)) in cones.iter().zip(sides).enumerate() {
        let nearest = (0..stations.len()).min_by(|&a, &b| {
            let squared = |i: usize| (stations[i].position() - cone.position).norm_squared();
            squared(a).total_cmp(&squared(b))
        });
        let Some(nearest) = nearest else { continue };
        let local = stations[nearest].to_local(cone.position);
        let aside = side * local.y;
        let wrong = f64::from(cone.colour.side()) * side < 0.0;
        // A cone of a row is at that row's edge wherever the lane is wider or narrower than usual.
        let at_edge = if *known == 0 {
            (aside - half_width).abs() < loose && !wrong
        } else {
            f64::from(*known) * side > 0.0 && (0.0..2.0 * half_width).contains(&aside)
        };
        if local.x.abs() < NEXT_TO && at_edge {
            found.push(EdgeCone { along: along[nearest] + local.x, aside, index });
        }
    }
    found.sort_by(|a, b| a.along.total_cmp(&b.along));
    found
}

/// How far the middle is to the left of the lane at a place.
fn offset(edges: &[Vec<EdgeCone>; 2], at: f64, half_width: f64) -> f64 {
    let [left, right] = [0, 1].map(|side| distance(&edges[side], at));
    match (left, right) {
        (Some(left), Some(right)) => 0.5 * (left - right),
        (Some(left), None) => left - half_width,
        (None, Some(right)) => half_width - right,
        (None, None) => 0.0,
    }
}

/// Metres to an edge at a place, between the cones before and behind it.
fn distance(edge: &[EdgeCone], at: f64) -> Option<f64> {
    let next = edge.partition_point(|cone| cone.along < at);
    let near = |cone: Option<&EdgeCone>| cone.filter(|cone| (cone.along - at).abs() < SPEAKS).copied();
    match (near(next.checked_sub(1).and_then(|k| edge.get(k))), near(edge.get(next))) {
        (Some(before), Some(after)) => {
            let share = (at - before.along) / (after.along - before.along).max(1e-6);
            Some(before.aside + (after.aside - before.aside) * share)
        }
        (one, other) => one.or(other).map(|cone| cone.aside),
    }
}

/// Half the width as the cones say, in small steps.
fn width(edges: &[Vec<EdgeCone>; 2], before: f64, p: &LaneParameters) -> f64 {
    let mut asides: Vec<f64> = edges.iter().flatten().map(|cone| cone.aside).collect();
    if asides.len() < 3 {
        return before;
    }
    asides.sort_by(f64::total_cmp);
    let step = 0.1 * (asides[asides.len() / 2] - before);
    (before + step).clamp(p.half_width[0], p.half_width[1])
}

/// Points at even steps of about a metre along a chain, smoothed.
fn even(chain: &[Point]) -> Vec<Point> {
    let mut points: Vec<Point> = Vec::new();
    let mut left = 0.0;
    for pair in chain.windows(2) {
        let leg = pair[1] - pair[0];
        let length = leg.norm();
        while left < length {
            points.push(pair[0] + leg * (left / length));
            left += 1.0;
        }
        left -= length;
    }
    (0..3).for_each(|_| smooth(&mut points));
    points
}

/// Moves points towards the middle of their neighbours, and then as much outwards again, as bends would shrink.
fn smooth(points: &mut [Point]) {
    for share in [0.5, -0.52] {
        let old = points.to_vec();
        for i in 1..old.len().saturating_sub(1) {
            points[i] += (nalgebra::center(&old[i - 1], &old[i + 1]) - old[i]) * share;
        }
    }
}

/// Rounds in which points are moved away from cones.
const PUSHES: usize = 8;
/// Metres to a cone that are kept beside those at which a car touches it, where the lane is wide enough.
const BEYOND_TOUCH: f64 = 0.4;

/// Moves points away from cones, or other places, that are nearer than some metres, where those of the other edge let them.
fn keep_clear(points: &mut [Point], places: &[Point], room: f64) {
    for _ in 0..PUSHES {
        for point in points.iter_mut() {
            let push = |place: &Point| {
                let away = *point - place;
                let distance = away.norm().max(1e-6);
                away * (0.5 * (room - distance).max(0.0) / distance)
            };
            let pushes: Vector = places.iter().map(push).sum();
            *point += pushes;
        }
        smooth(points);
    }
}
