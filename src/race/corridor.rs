use super::error::LineError;
use crate::geometry::{Point, Segment, Vector};
use crate::parameter::{require, require_not_negative, require_positive};

/// A station of the centre line, with the widths to both edges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrossSection {
    /// Position (m).
    pub position: Point,
    /// Unit vector to the left.
    pub normal: Vector,
    /// Distance to the left edge (m).
    pub left: f64,
    /// Distance to the right edge (m).
    pub right: f64,
}

impl CrossSection {
    /// The point `offset` metres to the left of the centre line.
    pub fn aside(&self, offset: f64) -> Point {
        self.position + self.normal * offset
    }
}

/// A track as a centre line with widths, closed or open.
///
/// ```
/// use roverlab::geometry::{Point, direction};
/// use roverlab::race::Corridor;
/// let angle = |k: u8| (4.0 * f64::from(k)).to_radians();
/// let place = |k| (Point::origin() + direction(angle(k)) * 20.0, 2.0, 3.0);
/// let ring = Corridor::closed(&(0..90).map(place).collect::<Vec<_>>())?;
/// assert!((ring.length() - 125.6).abs() < 0.1, "2 pi 20 m");
/// assert!(ring.edge(true).iter().all(|point| (point.coords.norm() - 18.0).abs() < 0.01), "to the left");
/// # Ok::<(), roverlab::race::LineError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Corridor {
    stations: Vec<CrossSection>,
    closed: bool,
}

impl Corridor {
    /// A loop from points in driving order, each with the distances to the left and the right edge (m).
    ///
    /// # Errors
    ///
    /// If there are fewer than five points, neighbours coincide, or a number is out of range.
    pub fn closed(points: &[(Point, f64, f64)]) -> Result<Self, LineError> {
        Self::new(points, true)
    }

    /// An open track from points in driving order.
    ///
    /// # Errors
    ///
    /// As for [`closed`](Self::closed), but from two points on.
    pub fn open(points: &[(Point, f64, f64)]) -> Result<Self, LineError> {
        Self::new(points, false)
    }

    fn new(points: &[(Point, f64, f64)], closed: bool) -> Result<Self, LineError> {
        let n = points.len();
        let needed = if closed { 5 } else { 2 };
        if n < needed {
            return Err(LineError::TooFew { found: n, needed });
        }
        let at = |i: usize| points[i % n].0;
        let mut stations = Vec::with_capacity(n);
        for (index, &(position, left, right)) in points.iter().enumerate() {
            require_positive("width to the left", left)?;
            require_positive("width to the right", right)?;
            let (before, after) = if closed {
                (at(index + n - 1), at(index + 1))
            } else {
                (at(index.saturating_sub(1)), at((index + 1).min(n - 1)))
            };
            let (along, next) = (after - before, after - position);
            let length = along.norm();
            let last = !closed && index + 1 == n;
            if !(length > 1e-9 && length.is_finite() && (last || next.norm() > 1e-9)) {
                return Err(LineError::Degenerate { index });
            }
            let normal = Vector::new(-along.y, along.x) / length;
            stations.push(CrossSection { position, normal, left, right });
        }
        Ok(Self { stations, closed })
    }

    /// Stations in driving order.
    pub fn stations(&self) -> &[CrossSection] {
        &self.stations
    }

    /// Rotates a loop such that the station nearest to a point is the first. An open corridor stays as it is.
    #[must_use]
    pub fn beginning_near(mut self, place: Point) -> Self {
        if self.closed {
            let away = |i: &usize| (self.stations[*i].position - place).norm_squared();
            let nearest = (0..self.stations.len()).min_by(|a, b| away(a).total_cmp(&away(b)));
            self.stations.rotate_left(nearest.unwrap_or(0));
        }
        self
    }

    /// Whether it is a loop.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// Length of the centre line, by its chords (m).
    pub fn length(&self) -> f64 {
        self.pairs().map(|(a, b)| (b.position - a.position).norm()).sum()
    }

    /// The left or the right edge as a chain of points.
    pub fn edge(&self, left: bool) -> Vec<Point> {
        self.stations.iter().map(|s| if left { s.aside(s.left) } else { s.aside(-s.right) }).collect()
    }

    /// Consecutive stations.
    fn pairs(&self) -> impl Iterator<Item = (&CrossSection, &CrossSection)> {
        let n = self.stations.len();
        let count = if self.closed { n } else { n - 1 };
        (0..count).map(move |i| (&self.stations[i], &self.stations[(i + 1) % n]))
    }

    /// For each station, the range of offsets to the left at which a line keeps `margin` metres from both
    /// edges. O(n), unless stations are much closer together than the margin.
    ///
    /// # Errors
    ///
    /// If the margin is negative, or nothing is left between the edges.
    pub fn free(&self, margin: f64) -> Result<Vec<[f64; 2]>, LineError> {
        require_not_negative("margin", margin)?;
        let margins = vec![[margin; 2]; self.stations.len()];
        let ranges = self.ranges(&margins);
        let narrow = ranges.iter().position(|[low, high]| high <= low);
        narrow.map_or(Ok(ranges), |index| {
            let station = &self.stations[index];
            let free = (station.left + station.right).max(0.0);
            Err(LineError::TooNarrow { index, free, needed: 2.0 * margin })
        })
    }

    /// The same with individual margins per station, right and left. Where nothing is left, the offset that
    /// misses both margins equally.
    pub(super) fn room(&self, margins: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let mut ranges = self.ranges(margins);
        for range in ranges.iter_mut().filter(|[low, high]| high <= low) {
            let middle = 0.5 * (range[0] + range[1]);
            *range = [middle - 1e-6, middle + 1e-6];
        }
        ranges
    }

    fn ranges(&self, margins: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let edges = [self.edge(false), self.edge(true)];
        let limit = |index: usize, left: bool| {
            let station = &self.stations[index];
            let (side, sign) = if left { (1, 1.0) } else { (0, -1.0) };
            let margin = margins[index][side];
            let mut offset = if left { station.left } else { station.right } - margin;
            // Move towards the middle by the missing distance until none is missing: edges may be oblique or
            // bend inwards.
            for _ in 0..12 {
                let place = station.aside(sign * offset);
                let missing = margin - self.distance_to_edge(&edges[side], index, place, margin);
                if missing <= 1e-9 {
                    break;
                }
                offset -= missing * 1.05 + 1e-9;
            }
            sign * offset
        };
        (0..self.stations.len()).map(|index| [limit(index, false), limit(index, true)]).collect()
    }

    /// Distance of a point from an edge near a station, exact below `reach`.
    fn distance_to_edge(&self, edge: &[Point], index: usize, point: Point, reach: f64) -> f64 {
        let n = edge.len();
        let mut least = f64::INFINITY;
        for forward in [true, false] {
            let (mut passed, mut at) = (0.0, index);
            // Inside a bend, the edge may be much shorter than the centre line, so both lengths are tracked.
            for _ in 0..n / 2 {
                let at_end = if forward { at + 1 == n } else { at == 0 };
                if at_end && !self.closed {
                    break;
                }
                let next = if forward { (at + 1) % n } else { (at + n - 1) % n };
                let segment = Segment::new(edge[at], edge[next]);
                least = least.min(segment.distance_to(point));
                passed += (edge[next] - edge[at]).norm();
                at = next;
                if passed > 2.0 * reach + 1.0 {
                    break;
                }
            }
        }
        least
    }

    /// Resamples the corridor at about `step` metres: a loop by a spline through its stations, an open one by
    /// its chords.
    ///
    /// # Errors
    ///
    /// If `step` is not positive, or so short that there would be more than a million stations, or the loop
    /// turns back on itself.
    pub fn resampled(&self, step: f64) -> Result<Self, LineError> {
        require_positive("step", step)?;
        let expected = "at least a millionth of the corridor's length";
        require("step", step, self.length() / step <= 1e6, expected)?;
        let n = self.stations.len();
        if !self.closed {
            let mut points = Vec::new();
            for (a, b) in self.pairs() {
                let parts = ((b.position - a.position).norm() / step).ceil().max(1.0);
                for k in 0..parts as usize {
                    let share = k as f64 / parts;
                    let mix = |a: f64, b: f64| a + (b - a) * share;
                    let position = a.position + (b.position - a.position) * share;
                    points.push((position, mix(a.left, b.left), mix(a.right, b.right)));
                }
            }
            let last = self.stations[n - 1];
            points.push((last.position, last.left, last.right));
            return Self::open(&points);
        }
        let positions: Vec<Point> = self.stations.iter().map(|s| s.position).collect();
        let spline = super::ClosedSpline::through(&positions)?;
        let places = spline.resample_with_pieces(step);
        let points: Vec<_> = places
            .iter()
            .map(|&(piece, share, position)| {
                let (a, b) = (&self.stations[piece], &self.stations[(piece + 1) % n]);
                (position, a.left + (b.left - a.left) * share, a.right + (b.right - a.right) * share)
            })
            .collect();
        // The spline's points are equally far apart: only where it turns back do neighbours coincide.
        Self::closed(&points).map_err(|error| match error {
            LineError::Degenerate { index } => {
                let at = points[index].0;
                LineError::TurnsBack { x: at.x.round(), y: at.y.round() }
            }
            other => other,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::race::{TrackOptions, generate};
    use proptest::prelude::*;

    /// Its stations are not those of the corridor, so an error names the place.
    #[test]
    fn where_a_resampled_loop_turns_back_is_said() {
        let line: Vec<_> = (0..100).map(|k| (Point::new(2.0 * f64::from(k), 0.0), 5.0, 5.0)).collect();
        let error = Corridor::closed(&line).unwrap().resampled(1.0).unwrap_err();
        assert!(matches!(error, LineError::TurnsBack { y: 0.0, .. }), "{error}");
    }

    proptest! {
        #![proptest_config(crate::testing::cases(20))]
        #[test]
        fn a_loop_begins_where_it_is_told(seed in 0_u64..50, share in 0.0..1.0f64, aside in -1.0..1.0f64) {
            let corridor = generate(seed, &TrackOptions::drawn(seed)).unwrap().corridor;
            let n = corridor.stations().len();
            let at = ((share * n as f64) as usize).min(n - 1);
            let turned = corridor.clone().beginning_near(corridor.stations()[at].aside(aside));
            // The same stations in the same order, from the nearest one on.
            let first = turned.stations()[0];
            let shift = corridor.stations().iter().position(|station| *station == first).unwrap();
            prop_assert!((0..n).all(|i| turned.stations()[i] == corridor.stations()[(i + shift) % n]));
            prop_assert!((shift + n - at) % n <= 2 || (at + n - shift) % n <= 2, "{shift} for {at}");
            prop_assert!((turned.length() - corridor.length()).abs() < 1e-9);
        }
    }
}
