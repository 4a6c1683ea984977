use super::beam_search::BeamSearch;
use super::cone::Cone;
use super::corridor::Corridor;
use super::error::LineError;
use super::generate::LONGEST;
use super::mesh::Mesh;
use super::pair::{CentreLineParameters, Pair, Way};
use super::sides::sides;
use crate::ParameterError;
use crate::geometry::{Point, Pose, Segment, Vector, cross, math};

#[cfg(test)]
mod tests;

/// A track between cones: both edges, and the corridor between them.
#[derive(Debug, Clone, PartialEq)]
pub struct CentreLine {
    /// Left edge, from cone to cone. Missing cones are replaced by points one width from the other edge.
    pub left: Vec<Point>,
    /// Right edge.
    pub right: Vec<Point>,
    /// Centre line with widths.
    pub corridor: Corridor,
}

impl CentreLine {
    /// Finds the track ahead of a car between cones, from their Delaunay triangulation. Where the car passes
    /// between a left and a right cone, it crosses an edge of the triangulation; the third cone of the
    /// triangle behind it is the next one on the left or on the right. A beam search decides which, by
    /// widths, distances, turns and, if known, colours.
    ///
    /// The track is closed if it returns to its start; otherwise it ends with the cones or at the horizon.
    /// O(n log n) for n cones.
    ///
    /// ```
    /// use roverlab::race::{CentreLine, CentreLineParameters, Cone};
    /// use roverlab::geometry::{Point, Pose};
    /// // A straight lane of unknown cones.
    /// let cones: Vec<_> = (0..14).map(|i| Cone::unknown(Point::new(4.0 * f64::from(i / 2), 3.0 * f64::from(i % 2)))).collect();
    /// let line = CentreLine::from_cones(&cones, Pose::new(0.0, 1.4, 0.1), &CentreLineParameters::default())?;
    /// assert_eq!((line.left.len(), line.right.len()), (7, 7));
    /// assert!(line.corridor.stations().iter().all(|s| (s.position.y - 1.5).abs() < 0.01));
    /// # Ok::<(), roverlab::race::LineError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// If no track leads on from the car, it leads over 50 m without cones, or it is longer than 50 km.
    pub fn from_cones(
        cones: &[Cone],
        car: Pose,
        parameters: &CentreLineParameters,
    ) -> Result<Self, LineError> {
        Self::along(cones, car, &[], parameters)
    }

    /// The same, with a known path: `driven` has its points, about one every two metres. Deviations from it
    /// cost more.
    ///
    /// # Errors
    ///
    /// As for [`from_cones`](Self::from_cones).
    pub fn along(
        cones: &[Cone],
        car: Pose,
        driven: &[Point],
        parameters: &CentreLineParameters,
    ) -> Result<Self, LineError> {
        parameters.validate()?;
        let mut kept = cones.to_vec();
        let (mut mesh, mut beside) = (Mesh::new(cones)?, sides(cones, driven));
        let mut way = walk(cones, &mesh, &beside, car, parameters).ok_or(LineError::NoWay)?;
        for round in 0..ROUNDS {
            // Leave out cones that stick out of an edge, and search again.
            let strays = strays(&kept, &way.pairs, way.closed, parameters);
            if strays.is_empty() && (round > 0 || !way.closed) {
                break;
            }
            // Search a loop from where it looks most like a track: the cones around the car were taken on
            // trust.
            let from = if way.closed { best_place(&kept, &way.pairs, parameters) } else { car };
            let mut fewer = kept.clone();
            if !strays.is_empty() {
                leave_out(&mut fewer, &strays);
                leave_out(&mut beside, &strays);
                mesh = Mesh::new(&fewer)?;
            }
            let Some(again) = walk(&fewer, &mesh, &beside, from, parameters) else { break };
            if way.closed && !again.closed {
                break;
            }
            (way, kept) = (again, fewer);
        }
        if way.closed {
            let turned = nearest_ahead(&kept, &way.pairs, car);
            way.pairs.rotate_left(turned);
        }
        Self::between(&kept, &way.pairs, way.closed, parameters)
    }

    fn between(
        cones: &[Cone],
        pairs: &[Pair],
        closed: bool,
        parameters: &CentreLineParameters,
    ) -> Result<Self, LineError> {
        let (pairs, chains) = complete(cones, pairs, closed, parameters);
        check_gaps(&pairs, closed)?;
        let middles = middle(&pairs, closed, parameters.step);
        let rows: Vec<_> = middles
            .iter()
            .map(|&(position, normal, pair)| {
                let width = |side: usize, sign: f64| {
                    let chain = &chains[side];
                    let near = pairs[pair].indices[side];
                    reach(chain, near, closed, position, normal * sign, 0.5 * parameters.width[1])
                };
                (position, width(0, 1.0), width(1, -1.0))
            })
            .collect();
        let corridor = if closed { Corridor::closed(&rows)? } else { Corridor::open(&rows)? };
        let [left, right] = chains;
        Ok(Self { left, right, corridor })
    }
}

fn walk(
    cones: &[Cone],
    mesh: &Mesh,
    sides: &[i8],
    from: Pose,
    parameters: &CentreLineParameters,
) -> Option<Way> {
    BeamSearch { cones, parameters, mesh, sides }.run(from)
}

/// Distance between pairs beyond which cones belong to no track (m).
const FARTHEST: f64 = 50.0;

/// Rejects pairs that are too far apart for one track.
fn check_gaps(pairs: &[Opposite], closed: bool) -> Result<(), LineError> {
    let n = pairs.len();
    let middle = |k: usize| nalgebra::center(&pairs[k % n].points[0], &pairs[k % n].points[1]);
    let mut length = 0.0;
    for k in 0..if closed { n } else { n - 1 } {
        let gap = (middle(k + 1) - middle(k)).norm();
        if gap > FARTHEST {
            let expected = "at most 50 m";
            return Err(ParameterError::new("gap from cones to the next ones", gap.round(), expected).into());
        }
        length += gap;
    }
    if length > LONGEST {
        let value = length.round();
        return Err(ParameterError::new("length of the way", value, "at most 50000 m").into());
    }
    Ok(())
}

/// Removes the items at some indices.
fn leave_out<T>(list: &mut Vec<T>, places: &[usize]) {
    let mut index = 0;
    list.retain(|_| {
        index += 1;
        places.binary_search(&(index - 1)).is_err()
    });
}

/// Number of times that cones are left out and the path is searched again.
const ROUNDS: usize = 3;
/// Number of pairs to either side among which the other edge is searched.
const WINDOW: usize = 5;

/// A pair of points on both edges, and their indices in the chains.
#[derive(Debug, Clone, Copy)]
struct Opposite {
    points: [Point; 2],
    indices: [usize; 2],
}

/// Pairs of points, with points for missing cones, and the chains of both edges.
fn complete(
    cones: &[Cone],
    pairs: &[Pair],
    closed: bool,
    parameters: &CentreLineParameters,
) -> (Vec<Opposite>, [Vec<Point>; 2]) {
    let mut opposites: Vec<[Point; 2]> = pairs.iter().map(|pair| pair.map(|i| cones[i].position)).collect();
    if parameters.colour.is_finite() {
        let width = usual_width(&opposites, parameters);
        for side in 0..2 {
            bridge(&mut opposites, side, closed, width, parameters);
        }
    }
    let mut chains = [Vec::new(), Vec::new()];
    let mut result = Vec::with_capacity(opposites.len());
    for points in opposites {
        let mut indices = [0; 2];
        for side in 0..2 {
            let chain: &mut Vec<Point> = &mut chains[side];
            if chain.last() != Some(&points[side]) {
                chain.push(points[side]);
            }
            indices[side] = chain.len() - 1;
        }
        result.push(Opposite { points, indices });
    }
    // The last cone of a loop may equal the first one.
    for (side, chain) in chains.iter_mut().enumerate() {
        if closed && chain.len() > 3 && chain.first() == chain.last() {
            chain.pop();
            let last = chain.len();
            for pair in &mut result {
                if pair.indices[side] == last {
                    pair.indices[side] = 0;
                }
            }
        }
    }
    (result, chains)
}

/// Median track width, over pairs within the expected range.
fn usual_width(pairs: &[[Point; 2]], parameters: &CentreLineParameters) -> f64 {
    let [low, high] = parameters.width;
    // Distance of a cone from the chord of the other side, because a pair may be skewed.
    let widths = pairs.windows(2).filter_map(|two| {
        let side = usize::from(two[0][0] == two[1][0]);
        let chord = Segment::new(two[0][side], two[1][side]);
        let point = two[0][1 - side];
        let width = chord.distance_to(point);
        ((low..=high).contains(&width) && chord.length() < parameters.spacing).then_some(width)
    });
    let mut widths: Vec<f64> = widths.collect();
    if widths.is_empty() {
        return 0.5 * (low + high);
    }
    let half = widths.len() / 2;
    *widths.select_nth_unstable_by(half, f64::total_cmp).1
}

/// Cones of a side in order, each once, with the index of its first pair.
fn chain_of(pairs: &[Pair], side: usize) -> Vec<(usize, usize)> {
    let mut chain: Vec<(usize, usize)> = Vec::new();
    for (at, pair) in pairs.iter().enumerate() {
        if chain.last().is_none_or(|&(cone, _)| cone != pair[side]) {
            chain.push((pair[side], at));
        }
    }
    chain
}

/// Pose in the middle of the most regular pair: usual width, neighbours at the usual distance.
fn best_place(cones: &[Cone], pairs: &[Pair], parameters: &CentreLineParameters) -> Pose {
    let n = pairs.len();
    let middle =
        |k: usize| nalgebra::center(&cones[pairs[k % n][0]].position, &cones[pairs[k % n][1]].position);
    let opposites: Vec<[Point; 2]> = pairs.iter().map(|pair| pair.map(|i| cones[i].position)).collect();
    let width = usual_width(&opposites, parameters);
    let badness = |k: usize| {
        let around = (k + n - 2..k + n + 3).map(|k| {
            let [left, right] = opposites[k % n];
            ((left - right).norm() - width).abs()
        });
        let ways = [middle(k) - middle(k + n - 1), middle(k + 1) - middle(k)];
        let turn = cross(ways[0], ways[1]).abs() / (ways[0].norm() * ways[1].norm()).max(1e-9);
        around.sum::<f64>() + 2.0 * turn
    };
    let best = (0..n).min_by(|&a, &b| badness(a).total_cmp(&badness(b))).unwrap_or(0);
    let across = opposites[best][0] - opposites[best][1];
    let at = middle(best);
    // The edge itself lies a metre ahead, where a start is expected.
    let ahead = Vector::new(across.y, -across.x) / across.norm().max(1e-9);
    let from = at - ahead;
    Pose::new(from.x, from.y, math::atan2(ahead.y, ahead.x))
}

/// The pair of a loop that a car passes next.
fn nearest_ahead(cones: &[Cone], pairs: &[Pair], car: Pose) -> usize {
    let away = |pair: &Pair| {
        let local = car.to_local(nalgebra::center(&cones[pair[0]].position, &cones[pair[1]].position));
        if local.x >= 0.0 { local.coords.norm() } else { 100.0 + local.coords.norm() }
    };
    (0..pairs.len()).min_by(|&a, &b| away(&pairs[a]).total_cmp(&away(&pairs[b]))).unwrap_or(0)
}

/// Indices, in order, of cones beside the track: too far from the other edge, and outside the line between
/// their neighbours.
fn strays(cones: &[Cone], pairs: &[Pair], closed: bool, parameters: &CentreLineParameters) -> Vec<usize> {
    let opposites: Vec<[Point; 2]> = pairs.iter().map(|pair| pair.map(|i| cones[i].position)).collect();
    let width = usual_width(&opposites, parameters);
    let mut found = Vec::new();
    for side in 0..2 {
        let chain = chain_of(pairs, side);
        let n = chain.len();
        let mut last = None;
        for k in 0..n {
            let certain = parameters.colour.is_infinite() && cones[chain[k].0].colour.side() != 0;
            if n < 4 || certain || (!closed && (k == 0 || k + 1 == n)) {
                continue;
            }
            let place = |k: usize| cones[chain[k % n].0].position;
            let (before, here, after) = (place(k + n - 1), place(k), place(k + 1));
            let along = after - before;
            let outwards =
                cross(along, here - before) / along.norm().max(1e-9) * if side == 0 { 1.0 } else { -1.0 };
            if outwards < 0.7 || last == Some(k.wrapping_sub(1)) {
                continue;
            }
            // From the other edge, near where this cone was passed.
            let (at, m) = (chain[k].1, pairs.len());
            let other = |k: usize| opposites[(at + m * WINDOW + k - WINDOW) % m][1 - side];
            let away = (0..2 * WINDOW).map(|k| Segment::new(other(k), other(k + 1)).distance_to(here));
            if away.fold(f64::INFINITY, f64::min) > width + 0.8 {
                found.push(chain[k].0);
                last = Some(k);
            }
        }
    }
    found.sort_unstable();
    found
}

/// For each pair, the longer one of the legs before and behind the cone of a side.
fn legs(pairs: &[[Point; 2]], side: usize, closed: bool) -> Vec<f64> {
    let n = pairs.len();
    let mut legs = vec![0.0; n];
    let mut i = 0;
    while i < n {
        let here = pairs[i][side];
        let mut j = i;
        while j + 1 < n && pairs[j + 1][side] == here {
            j += 1;
        }
        let leg = |k: Option<usize>| k.map_or(0.0, |k: usize| (pairs[k][side] - here).norm());
        let before = if i > 0 { Some(i - 1) } else { closed.then_some(n - 1) };
        let after = if j + 1 < n { Some(j + 1) } else { closed.then_some(0) };
        legs[i..=j].fill(f64::max(leg(before), leg(after)));
        i = j + 1;
    }
    legs
}

/// Where cones of a side are missing or far off the track, inserts points one usual width from the other
/// side.
fn bridge(
    pairs: &mut [[Point; 2]],
    side: usize,
    closed: bool,
    width: f64,
    parameters: &CentreLineParameters,
) {
    let n = pairs.len();
    let other = 1 - side;
    let far = 1.4 * parameters.spacing;
    let (own, opposite) = (legs(pairs, side, closed), legs(pairs, other, closed));
    let old = pairs.to_vec();
    let neighbour = |k: usize, forward: bool| -> Point {
        // The next cone of the other side.
        let here = old[k][other];
        for step in 1..n {
            let at = match (forward, closed) {
                (true, true) => (k + step) % n,
                (true, false) => (k + step).min(n - 1),
                (false, true) => (k + n - step) % n,
                (false, false) => k.saturating_sub(step),
            };
            if old[at][other] != here {
                return old[at][other];
            }
        }
        here
    };
    for k in 0..n {
        let (here, beside) = (old[k][other], old[k][side]);
        let (before, after) = (neighbour(k, false), neighbour(k, true));
        let chord = |to| Segment::new(here, to).distance_to(beside);
        let wide = (here - beside).norm();
        let gap = own[k] > far && wide > 1.25 * width;
        let stray = chord(before).min(chord(after)) > width + 1.2;
        let along = after - before;
        if opposite[k] > far || !(gap || stray) || along.norm() < 1e-6 {
            continue;
        }
        let aside = Vector::new(-along.y, along.x).normalize() * if side == 0 { width } else { -width };
        pairs[k][side] = here + aside;
    }
}

/// Centre line at equal steps, smoothed: positions, unit normals to the left, and the preceding pair.
fn middle(pairs: &[Opposite], closed: bool, step: f64) -> Vec<(Point, Vector, usize)> {
    let n = pairs.len();
    let at = |i: usize| nalgebra::center(&pairs[i % n].points[0], &pairs[i % n].points[1]);
    let pieces = if closed { n } else { n - 1 };
    let total: f64 = (0..pieces).map(|i| (at(i + 1) - at(i)).norm()).sum();
    let count = ((total / step).round() as usize).max(5);
    let spacing = total / if closed { count as f64 } else { (count - 1) as f64 };
    let mut points = Vec::with_capacity(count);
    let mut owners = Vec::with_capacity(count);
    let (mut piece, mut passed) = (0, 0.0);
    for k in 0..count {
        let wanted = spacing * k as f64;
        let mut length = (at(piece + 1) - at(piece)).norm();
        while piece + 1 < pieces && passed + length < wanted {
            passed += length;
            piece += 1;
            length = (at(piece + 1) - at(piece)).norm();
        }
        let share = if length > 0.0 { ((wanted - passed) / length).min(1.0) } else { 0.0 };
        points.push(at(piece) + (at(piece + 1) - at(piece)) * share);
        owners.push(piece);
    }
    // Midpoints zigzag where cones alternate between the sides; smoothing over a few metres removes that.
    let passes = ((3.0 / step) * (3.0 / step)).ceil().clamp(2.0, 24.0) as usize;
    for _ in 0..passes {
        let old = points.clone();
        for i in 0..count {
            if closed || (i > 0 && i + 1 < count) {
                let around = nalgebra::center(&old[(i + count - 1) % count], &old[(i + 1) % count]);
                points[i] = nalgebra::center(&old[i], &around);
            }
        }
    }
    (0..count)
        .map(|i| {
            let (before, after) = if closed {
                (points[(i + count - 1) % count], points[(i + 1) % count])
            } else {
                (points[i.saturating_sub(1)], points[(i + 1).min(count - 1)])
            };
            let along = after - before;
            let length = along.norm().max(1e-9);
            (points[i], Vector::new(-along.y, along.x) / length, owners[i])
        })
        .collect()
}

/// Distance from a point along a direction to a chain, near one of its points; `otherwise` if the ray misses
/// it.
fn reach(chain: &[Point], near: usize, closed: bool, from: Point, along: Vector, otherwise: f64) -> f64 {
    /// Number of chain points to either side of a point that are examined.
    const AROUND: usize = 4;
    let n = chain.len();
    let mut least = f64::INFINITY;
    for k in 0..2 * AROUND {
        let at = near + k;
        let (i, j) = if closed {
            ((at + 2 * AROUND * n - AROUND) % n, (at + 2 * AROUND * n - AROUND + 1) % n)
        } else {
            let Some(i) = at.checked_sub(AROUND) else { continue };
            if i + 1 >= n {
                break;
            }
            (i, i + 1)
        };
        let (a, edge) = (chain[i], chain[j] - chain[i]);
        let turned = cross(along, edge);
        if turned.abs() < 1e-12 {
            continue;
        }
        let (distance, share) = (cross(a - from, edge) / turned, cross(a - from, along) / turned);
        if distance > 0.0 && (-1e-9..=1.0 + 1e-9).contains(&share) {
            least = least.min(distance);
        }
    }
    // Beyond the ends of an open chain, use its last point.
    if least.is_infinite() {
        let nearest =
            chain.iter().map(|p| (p - from).dot(&along)).filter(|d| *d > 0.0).fold(f64::INFINITY, f64::min);
        least = nearest;
    }
    if least.is_finite() { least.clamp(0.05, 2.0 * otherwise) } else { otherwise }
}
