use std::collections::BTreeMap;

use super::arcs::Arcs;
use super::centre_line::CentreLine;
use super::cone::{APART, Cone, ConeColour};
use super::corridor::{Corridor, CrossSection};
use super::error::LineError;
use super::pair::CentreLineParameters;
use crate::ParameterError;
use crate::geometry::{Point, Pose, Segment, cross, direction, math};

/// Metres beside a corridor within which a cone is one of its edge, and from its middle at which a lap may
/// have been driven.
pub(super) const BESIDE: f64 = 1.0;
/// Minimum fraction of coloured cones that stand at the corridor.
const PASSED: f64 = 0.97;
/// Minimum fraction of these that stand on their own side: where a track passes close to itself, some are
/// nearer to its other part.
const ON_THEIR_SIDE: f64 = 0.85;
/// Length of a gap relative to the usual distance between cones, and turn of a bend over it (rad).
const GAP_IN_BEND: (f64, f64) = (2.5, 0.6);
/// A length (m), and a turn over it that no track makes (rad): such a path turns back between cones.
const TURNING_BACK: (f64, f64) = (4.0, 2.4);
/// Largest difference between the length of a loop and the mean length of its edges, relative to the latter:
/// the two are equal but for what corners between cones and smoothing make of tight bends, up to 1.2 % on
/// published tracks.
const UNLIKE_EDGES: f64 = 0.02;
/// Length over which an edge of a loop may run against its direction (m). In the tightest bends of published
/// tracks it is a tenth of a metre, where a whole bend has lost its cones several metres.
const BACKWARDS: f64 = 0.5;

/// Cost of a cone on the wrong side where colours are certain and missing cones are bridged: more than all
/// other costs of a path.
const CERTAIN: f64 = 1e3;

impl CentreLine {
    /// The closed track of coloured cones, such as those of a file: ground truth for a referee.
    ///
    /// Where cones are missing, a search could also find a loop around a part of the track. Therefore the
    /// loop must pass nearly all coloured cones, blue ones on its left and yellow ones on its right, and must
    /// not cross itself; where most cones have no colour, it must pass nearly all of these too. If colours
    /// alone lead to no such loop, missing cones are bridged, first by certain colours, then as in a race.
    /// Between cones, its edges are arcs.
    ///
    /// # Errors
    ///
    /// If there is no such loop: what is wrong with it. O(n log n) for n cones.
    pub fn round_track(cones: &[Cone], start: Pose) -> Result<Self, LineError> {
        let by_colour = |colour: f64| {
            let mut line =
                Self::from_cones(cones, start, &CentreLineParameters { colour, ..Default::default() })?;
            check(&line.corridor, cones)?;
            check_start(&line.corridor, start)?;
            line.corridor = centred(&line.corridor)?;
            check_length(&line)?;
            line.corridor = along_arcs(&line)?;
            // Centring moves stations by as much as the edges are apart, which false edges may be anywhere.
            check_shape(&line.corridor)?;
            if let Some(at) = folded(&line.corridor) {
                return Err(LineError::TurnsBack { x: at.x.round(), y: at.y.round() });
            }
            for edge in [&line.left, &line.right] {
                check_bends(edge)?;
            }
            check_edges(&line)?;
            check_colours(&line, cones)?;
            Ok(line)
        };
        let strict: Result<Self, LineError> = by_colour(f64::INFINITY);
        strict.or_else(|error| {
            let usual = CentreLineParameters::default().colour;
            let bridged = by_colour(CERTAIN).or_else(|_| by_colour(usual));
            // With a start against the colours there is no way by them, so the other search says why.
            bridged.map_err(|other| if other == LineError::Against { other } else { error })
        })
    }
}

/// Rejects a corridor that is not that of a track.
fn check(corridor: &Corridor, cones: &[Cone]) -> Result<(), LineError> {
    if !corridor.is_closed() {
        return Err(LineError::Open { length: corridor.length().round() });
    }
    let near = Near::new(corridor.stations());
    let (mut all, mut passed, mut right, mut wrong) = (0, 0, 0, 0);
    for cone in counted(cones) {
        all += 1;
        let Some((station, offset)) = near.nearest(cone.position) else { continue };
        let width = if offset > 0.0 { station.left } else { station.right };
        if offset.abs() <= width + BESIDE {
            passed += 1;
            let agreement = offset * f64::from(cone.colour.side());
            right += usize::from(agreement > 0.0);
            wrong += u32::from(agreement < 0.0);
        }
    }
    if f64::from(passed) < PASSED * f64::from(all) {
        return Err(LineError::Passes { passed, all });
    }
    let all = right as u32 + wrong;
    if (right as f64) < ON_THEIR_SIDE * f64::from(all) {
        return Err(LineError::WrongSide { right, all });
    }
    check_shape(corridor)
}

/// Rejects a loop that leads against the car's heading: its colours are those of the other direction.
fn check_start(corridor: &Corridor, start: Pose) -> Result<(), LineError> {
    let near = Near::new(corridor.stations());
    // The normal is to the left, so this is the part of the heading along the loop.
    let is_against = |station: &CrossSection| cross(direction(start.heading), station.normal) < 0.0;
    let against = near.nearest(start.position()).is_some_and(|(station, _)| is_against(station));
    if against { Err(LineError::Against) } else { Ok(()) }
}

/// The cones that a loop must pass: those with a side. Where they are fewer than those of unknown colour, the
/// latter are the track, not false cones beside it, and count as well.
fn counted(cones: &[Cone]) -> impl Iterator<Item = &Cone> {
    let has_side = |cone: &&Cone| cone.colour.side() != 0;
    let is_unknown = |cone: &&Cone| cone.colour == ConeColour::Unknown;
    let all = cones.iter().filter(has_side).count() < cones.iter().filter(is_unknown).count();
    cones.iter().filter(move |cone| has_side(cone) || all && is_unknown(cone))
}

/// Rejects a loop that turns back or crosses itself.
fn check_shape(corridor: &Corridor) -> Result<(), LineError> {
    if let Some(at) = turning_back(corridor) {
        return Err(LineError::TurnsBack { x: at.x.round(), y: at.y.round() });
    }
    let crossing = Near::new(corridor.stations()).crossing();
    crossing.map_or(Ok(()), |at| Err(LineError::Crosses { x: at.x.round(), y: at.y.round() }))
}

/// Rejects a loop whose edges, from cone to cone, cross themselves or each other.
fn check_edges(line: &CentreLine) -> Result<(), LineError> {
    let pieces: Vec<Segment> = [&line.left, &line.right].into_iter().flat_map(|edge| around(edge)).collect();
    let crossed = pieces.iter().enumerate().find_map(|(k, piece)| {
        pieces[k + 1..].iter().any(|other| cross_each_other(piece, other)).then_some(piece.a)
    });
    crossed.map_or(Ok(()), |at| Err(LineError::Crosses { x: at.x.round(), y: at.y.round() }))
}

/// Rejects a loop with two neighbouring cones of the other colour at an edge. One may be a false cone, but
/// two in a row are a piece of the other edge, across which the loop leaves the track.
fn check_colours(line: &CentreLine, cones: &[Cone]) -> Result<(), LineError> {
    let bits = |place: Point| [place.x.to_bits(), place.y.to_bits()];
    let sides: BTreeMap<_, _> = cones.iter().map(|cone| (bits(cone.position), cone.colour.side())).collect();
    for (edge, own) in [(&line.left, 1), (&line.right, -1)] {
        let sides: Vec<i8> = edge.iter().filter_map(|at| sides.get(&bits(*at)).copied()).collect();
        let painted: Vec<i8> = sides.into_iter().filter(|side| *side != 0).collect();
        let mut pairs = painted.iter().zip(painted.iter().cycle().skip(1));
        if pairs.any(|(one, next)| *one != own && *next != own) {
            let right = painted.iter().filter(|side| **side == own).count();
            return Err(LineError::WrongSide { right, all: painted.len() as u32 });
        }
    }
    Ok(())
}

/// Rejects a loop that differs in length from its edges, measured from cone to cone. In the bends of a short
/// track, few cones that are missing or stand beside it are enough for that.
fn check_length(line: &CentreLine) -> Result<(), LineError> {
    let edges = [&line.left, &line.right].map(|edge| around(edge).map(|piece| piece.length()).sum::<f64>());
    let (length, mean) = (line.corridor.length(), 0.5 * (edges[0] + edges[1]));
    if (length - mean).abs() <= UNLIKE_EDGES * mean {
        return Ok(());
    }
    let expected = format!("within {} % of the mean length of its edges, {mean:.1} m", 100.0 * UNLIKE_EDGES);
    Err(ParameterError::new("length of the loop", (10.0 * length).round() / 10.0, expected).into())
}

/// The lines from point to point of a closed edge.
fn around(edge: &[Point]) -> impl Iterator<Item = Segment> + '_ {
    edge.iter().zip(edge.iter().cycle().skip(1)).map(|(&a, &b)| Segment::new(a, b))
}

/// Puts the stations of a loop, which smoothing draws inwards in bends, midway between its edges.
fn centred(corridor: &Corridor) -> Result<Corridor, LineError> {
    between(corridor, |station| [station.left, station.right])
}

/// The same between arcs from cone to cone: where cones are sparse, chords cut the bends by several percent.
fn along_arcs(line: &CentreLine) -> Result<Corridor, LineError> {
    let (mut left, mut right) = (Arcs::new(&line.left), Arcs::new(&line.right));
    between(&line.corridor, |station| {
        let to_left = station.left + left.bulge(station.aside(station.left));
        [to_left, station.right - right.bulge(station.aside(-station.right))]
    })
}

/// Puts stations midway between edges at some distances to the left and to the right.
fn between(
    corridor: &Corridor,
    mut edges: impl FnMut(&CrossSection) -> [f64; 2],
) -> Result<Corridor, LineError> {
    let middle = |station: &CrossSection| {
        let [left, right] = edges(station);
        let half = 0.5 * (left + right);
        (station.aside(0.5 * (left - right)), half, half)
    };
    Corridor::closed(&corridor.stations().iter().map(middle).collect::<Vec<_>>())
}

/// Rejects an edge with a gap in a bend, where the course of the track is unknown.
fn check_bends(edge: &[Point]) -> Result<(), LineError> {
    let mut edge = edge.to_vec();
    // The way from a cone to one at its foot has any direction, and says nothing about a bend.
    edge.dedup_by(|next, before| (*next - *before).norm() < APART);
    let n = edge.len();
    let leg = |k: usize| edge[(k + 1) % n] - edge[k % n];
    let mut lengths: Vec<f64> = (0..n).map(|k| leg(k).norm()).collect();
    if lengths.is_empty() {
        return Ok(());
    }
    let usual = *lengths.select_nth_unstable_by(n / 2, f64::total_cmp).1;
    let (times, radians) = GAP_IN_BEND;
    let is_gap = |k: &usize| {
        let (before, after) = (leg(k + n - 1), leg(k + 1));
        let turn = math::atan2(cross(before, after), before.dot(&after));
        leg(*k).norm() > times * usual && turn.abs() > radians
    };
    (0..n).find(is_gap).map_or(Ok(()), |k| {
        let expected = format!("at most {times} times the usual distance of {usual:.1} m");
        Err(ParameterError::new("gap of cones in a bend", leg(k).norm().round(), expected).into())
    })
}

/// Point at which a loop turns back.
pub(super) fn turning_back(corridor: &Corridor) -> Option<Point> {
    let (metres, radians) = TURNING_BACK;
    let stations = corridor.stations();
    let n = stations.len();
    let apart = (metres * n as f64 / corridor.length()).ceil() as usize;
    let turns_back = |k: &usize| {
        let [from, to] = [stations[*k].normal, stations[(k + apart) % n].normal];
        from.dot(&to) < math::cos(radians)
    };
    (0..n).find(turns_back).map(|k| stations[k].position)
}

/// Point at which an edge of a loop runs against its direction.
fn folded(corridor: &Corridor) -> Option<Point> {
    let stations = corridor.stations();
    let n = stations.len();
    [true, false].into_iter().find_map(|left| {
        let edge = corridor.edge(left);
        let mut backwards = 0.0_f64;
        (0..2 * n).map(|k| k % n).find_map(|k| {
            // The normal is to the left, so this is the part of the step along the loop.
            let along = cross(edge[(k + 1) % n] - edge[k], stations[k].normal);
            backwards = (backwards - along).max(0.0);
            (backwards > BACKWARDS).then_some(edge[k])
        })
    })
}

/// Stations of a loop, indexed by position.
struct Near<'a> {
    stations: &'a [CrossSection],
    cells: BTreeMap<(i64, i64), Vec<usize>>,
}

/// Edge of a cell (m); nothing farther away is a neighbour.
const CELL: f64 = 8.0;

impl<'a> Near<'a> {
    fn new(stations: &'a [CrossSection]) -> Self {
        let mut cells: BTreeMap<_, Vec<_>> = BTreeMap::new();
        for (index, station) in stations.iter().enumerate() {
            cells.entry(cell(station.position)).or_default().push(index);
        }
        Self { stations, cells }
    }

    fn around(&self, place: Point) -> impl Iterator<Item = usize> + '_ {
        let (x, y) = cell(place);
        let cells = (x - 1..=x + 1).flat_map(move |x| (y - 1..=y + 1).map(move |y| (x, y)));
        cells.filter_map(|cell| self.cells.get(&cell)).flatten().copied()
    }

    /// The station nearest to a point, and the signed distance, positive to the left (m).
    fn nearest(&self, place: Point) -> Option<(&CrossSection, f64)> {
        let away = |index: &usize| (self.stations[*index].position - place).norm_squared();
        let index = self.around(place).min_by(|a, b| away(a).total_cmp(&away(b)))?;
        let station = &self.stations[index];
        let offset = place - station.position;
        Some((station, offset.norm().copysign(station.normal.dot(&offset))))
    }

    /// Point at which the loop crosses itself.
    fn crossing(&self) -> Option<Point> {
        let n = self.stations.len();
        let piece = |index: usize| {
            Segment::new(self.stations[index].position, self.stations[(index + 1) % n].position)
        };
        (0..n).find_map(|index| {
            let own = piece(index);
            let others = self.around(own.a).filter(|&other| other > index + 1 && (other + 1) % n != index);
            others.map(piece).any(|other| cross_each_other(&own, &other)).then_some(own.a)
        })
    }
}

fn cell(place: Point) -> (i64, i64) {
    ((place.x / CELL).floor() as i64, (place.y / CELL).floor() as i64)
}

fn cross_each_other(one: &Segment, other: &Segment) -> bool {
    let side = |line: &Segment, point: Point| cross(line.b - line.a, point - line.a);
    side(one, other.a) * side(one, other.b) < 0.0 && side(other, one.a) * side(other, one.b) < 0.0
}

#[cfg(test)]
mod tests;
