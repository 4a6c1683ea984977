use std::f64::consts::TAU;

use super::cone::RUN_UP;
use super::corridor::Corridor;
use super::error::LineError;
use super::racing_line::curvature;
use super::{ClosedSpline, Cone, ConeColour, ConeTrack};
use crate::ParameterError;
use crate::geometry::{Point, Pose, Vector, cross, direction, math};
use crate::parameter::require;
use crate::random::Stream;

#[cfg(test)]
mod tests;

/// Options of generated tracks. The defaults follow the rules of Formula Student: laps of 200 to 500 m, at
/// least 3 m wide, straights of at most 80 m, hairpins with an outside diameter of at least 9 m, cones at
/// most 5 m apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackOptions {
    /// Minimum and maximum lap length along the centre line (m).
    pub length: [f64; 2],
    /// Minimum and maximum track width (m).
    pub width: [f64; 2],
    /// Distance between the cones of an edge: in the tightest bends, and on straights (m). Cones deviate from
    /// their places by a few centimetres.
    pub spacing: [f64; 2],
    /// Number of hairpins to attempt, at most 20.
    pub hairpins: usize,
    /// Minimum radius of the centre line (m).
    pub radius: f64,
}

impl Default for TrackOptions {
    fn default() -> Self {
        Self { length: [200.0, 500.0], width: [3.0, 4.5], spacing: [2.2, 4.8], hairpins: 2, radius: 4.0 }
    }
}

impl TrackOptions {
    /// Random options within the rules.
    pub fn drawn(seed: u64) -> Self {
        let mut random = Stream::new(seed).child("track options", 0);
        let narrow = random.between(3.0, 3.8);
        let tight = random.between(2.0, 3.2);
        Self {
            length: [200.0, 500.0],
            width: [narrow, narrow + random.between(0.0, 1.5)],
            spacing: [tight, random.between(tight + 0.5, 5.0)],
            hairpins: random.below(4),
            radius: random.between(3.6, 6.0),
        }
    }

    /// Checks the options.
    ///
    /// # Errors
    ///
    /// If one is out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        let range = |name, [low, high]: [f64; 2], least: f64, most: f64, expected: &'static str| {
            let wrong = if (least..=most).contains(&low) { high } else { low };
            require(name, wrong, least <= low && low <= high && high <= most, expected)
        };
        range("length", self.length, 100.0, 5000.0, "100 to 5000 m, least before most")?;
        range("width", self.width, 2.0, 20.0, "2 to 20 m, least before most")?;
        range("spacing", self.spacing, 0.5, 20.0, "0.5 to 20 m, in bends before straights")?;
        range(
            "radius",
            [self.radius; 2],
            0.5 * self.width[1] + 0.5,
            100.0,
            "more than half the width, up to 100 m",
        )?;
        require("hairpins", self.hairpins as f64, self.hairpins <= MOST_HAIRPINS, "at most 20")
    }
}

/// Maximum number of hairpins to try: more than there are corners.
const MOST_HAIRPINS: usize = 20;

/// A track of cones, with its corridor.
#[derive(Debug, Clone, PartialEq)]
pub struct GeneratedTrack {
    /// Cones and start.
    pub track: ConeTrack,
    /// Centre line with widths, about one station per metre; it begins at the start line.
    pub corridor: Corridor,
}

/// Minimum distance between the edges of two parts of a track (m).
const APART: f64 = 2.5;

/// Generates a closed track of cones. The same seed and options give the same track, to the bit.
///
/// ```
/// use roverlab::race::{TrackOptions, generate};
/// let generated = generate(3, &TrackOptions::default())?;
/// assert!((200.0..500.0).contains(&generated.corridor.length()));
/// # Ok::<(), roverlab::race::LineError>(())
/// ```
///
/// # Errors
///
/// If an option is out of range, or the options contradict each other.
pub fn generate(seed: u64, options: &TrackOptions) -> Result<GeneratedTrack, LineError> {
    options.validate()?;
    for attempt in 0..400 {
        let mut random = Stream::new(seed).child("track", attempt);
        // After failures, try with fewer hairpins.
        let hairpins = options.hairpins.saturating_sub(attempt as usize / 12);
        if let Some(track) = attempt_track(&mut random, options, hairpins) {
            return Ok(track);
        }
    }
    Err(ParameterError::new("radius", options.radius, "options that a track can meet").into())
}

/// Places cones along both edges of a closed corridor, at most `spacing` metres apart, and none where one
/// part of the course crosses another. The resulting corridor has about one station per metre. O(n²) for n
/// metres.
///
/// ```
/// use roverlab::race::{Corridor, lined};
/// use roverlab::geometry::{Point, direction};
/// let ring = |radius: f64| {
///     let place = |k: u8| (Point::origin() + direction(0.1 * std::f64::consts::TAU * f64::from(k)) * radius, 3.0, 3.0);
///     Corridor::closed(&(0..10).map(place).collect::<Vec<_>>())
/// };
/// assert!(lined(&ring(50.0)?, 5.0)?.track.cones.len() > 2 * 60);
/// let error = lined(&ring(4.0)?, 5.0).unwrap_err().to_string();
/// assert!(error.ends_with("expected a closed corridor of 30 to 50000 m"), "{error}");
/// # Ok::<(), roverlab::race::LineError>(())
/// ```
///
/// # Errors
///
/// If the corridor is open, shorter than 30 m or longer than 50 km, or the spacing is not 0.5 to 20 m.
pub fn lined(corridor: &Corridor, spacing: f64) -> Result<GeneratedTrack, LineError> {
    let length = corridor.length();
    if !(corridor.is_closed() && (SHORTEST..=LONGEST).contains(&length)) {
        let expected = "a closed corridor of 30 to 50000 m";
        return Err(ParameterError::new("length of the corridor", length, expected).into());
    }
    if !(0.5..=20.0).contains(&spacing) {
        return Err(ParameterError::new("spacing", spacing, "0.5 to 20 m").into());
    }
    let options = TrackOptions { spacing: [0.6 * spacing, spacing], ..TrackOptions::default() };
    let corridor = corridor.resampled(1.0)?;
    let mut track = place_cones(&mut Stream::new(0), &corridor, &options);
    track.cones.retain(|cone| !is_on_track(cone.position, &corridor));
    Ok(GeneratedTrack { track, corridor })
}

/// Minimum length of a corridor that is lined with cones (m).
const SHORTEST: f64 = 30.0;
/// The same at most: no circuit is longer.
pub(super) const LONGEST: f64 = 50_000.0;

/// Distance inside an edge at which a point is certainly on the track (m).
const WITHIN: f64 = 0.5;

/// Whether a point lies between the edges anywhere, as the edges of a self-crossing course do.
fn is_on_track(place: Point, corridor: &Corridor) -> bool {
    corridor.stations().iter().any(|station| {
        let away = place - station.position;
        let left = away.dot(&station.normal);
        cross(away, station.normal).abs() < 1.0
            && (WITHIN - station.right..station.left - WITHIN).contains(&left)
    })
}

fn attempt_track(random: &mut Stream, options: &TrackOptions, hairpins: usize) -> Option<GeneratedTrack> {
    let wanted = random.between(options.length[0], options.length[1]);
    let corners = outline(random, hairpins);
    let rough = ClosedSpline::through(&corners).ok()?;
    let scale = wanted / rough.length();
    let mut middle: Vec<Point> = rough.resample(1.0 / scale).iter().map(|p| p.position * scale).collect();
    relax(&mut middle, options.radius);
    middle = ClosedSpline::through(&middle).ok()?.resample(1.0).iter().map(|p| p.position).collect();
    if random.chance(0.5) {
        middle.reverse();
    }
    let begin = straightest(&middle);
    middle.rotate_left(begin);
    let widths = widths(random, &middle, options);
    if !is_legal(&middle, options) {
        return None;
    }
    let rows: Vec<_> = middle.iter().zip(&widths).map(|(&p, &w)| (p, 0.5 * w, 0.5 * w)).collect();
    let corridor = Corridor::closed(&rows).ok()?;
    let track = place_cones(random, &corridor, options);
    Some(GeneratedTrack { track, corridor })
}

/// Corners of a rough shape around the origin; a hairpin is a narrow bay.
fn outline(random: &mut Stream, hairpins: usize) -> Vec<Point> {
    let count = 7 + random.below(5);
    let bays: Vec<usize> = (0..hairpins).map(|_| random.below(count)).collect();
    let mut corners = Vec::new();
    for k in 0..count {
        let angle = TAU * (k as f64 + random.between(-0.25, 0.25)) / count as f64;
        let radius = random.between(0.6, 1.1);
        if bays.contains(&k) {
            let half = random.between(0.16, 0.24);
            let depth = random.between(0.25, 0.5);
            let outer = random.between(1.0, 1.2);
            for (turn, reach) in
                [(-1.6, outer), (-0.9, 0.7 * outer), (0.0, depth * outer), (0.9, 0.7 * outer), (1.6, outer)]
            {
                corners.push(Point::origin() + direction(angle + turn * half) * reach);
            }
        } else {
            corners.push(Point::origin() + direction(angle) * radius);
        }
    }
    corners
}

/// Rounds bends that are tighter than a radius.
fn relax(points: &mut [Point], radius: f64) {
    let n = points.len();
    let most = 0.93 / radius;
    for _ in 0..600 {
        let sharp: Vec<bool> = (0..n)
            .map(|i| curvature([points[(i + n - 2) % n], points[i], points[(i + 2) % n]]).abs() > most)
            .collect();
        if !sharp.contains(&true) {
            return;
        }
        let old = points.to_vec();
        for i in 0..n {
            if (0..7).any(|k| sharp[(i + n + k - 3) % n]) {
                let between = nalgebra::center(&old[(i + n - 1) % n], &old[(i + 1) % n]);
                points[i] += (between - old[i]) * 0.5;
            }
        }
    }
}

/// Index of the start line: the middle of the straightest part.
fn straightest(points: &[Point]) -> usize {
    let n = points.len();
    let bends: Vec<f64> =
        (0..n).map(|i| curvature([points[(i + n - 2) % n], points[i], points[(i + 2) % n]]).abs()).collect();
    let sum = |i: usize| (0..24).map(|k| bends[(i + n + k - 12) % n]).sum::<f64>();
    (0..n).min_by(|&a, &b| sum(a).total_cmp(&sum(b))).unwrap_or(0)
}

/// Slowly varying widths, limited so that inner edges do not fold.
fn widths(random: &mut Stream, points: &[Point], options: &TrackOptions) -> Vec<f64> {
    let n = points.len();
    let [low, high] = options.width;
    let waves: [(f64, f64); 3] = std::array::from_fn(|k| ((k + 1) as f64, TAU * random.uniform()));
    (0..n)
        .map(|i| {
            let at = TAU * i as f64 / n as f64;
            let sum: f64 = waves.iter().map(|(k, phase)| math::sin(k * at + phase)).sum();
            low + (high - low) * (0.5 + sum / 6.0)
        })
        .collect()
}

fn is_legal(points: &[Point], options: &TrackOptions) -> bool {
    let n = points.len();
    let length: f64 = (0..n).map(|i| (points[(i + 1) % n] - points[i]).norm()).sum();
    if length < options.length[0] || length > options.length[1] {
        return false;
    }
    let bend = |i: usize| curvature([points[(i + n - 1) % n], points[i], points[(i + 1) % n]]);
    if (0..n).any(|i| bend(i).abs() > 1.0 / options.radius) {
        return false;
    }
    // A straight turns by less than a degree in 2 m.
    let mut straight = 0;
    for i in 0..2 * n {
        straight = if bend(i % n).abs() < 0.008 { straight + 1 } else { 0 };
        if straight > 80 {
            return false;
        }
    }
    let apart = options.width[1] + APART;
    // Points closer along the track than the arc of a hairpin may be close to each other.
    let along = (2.0 * apart + 4.0) as usize;
    for i in 0..n {
        for j in i + 1..n {
            let distance = (j - i).min(n - (j - i));
            if distance > along && (points[i] - points[j]).norm_squared() < apart * apart {
                return false;
            }
        }
    }
    turns_once(points)
}

/// Whether the loop does not cross itself: its heading turns by exactly one full turn.
fn turns_once(points: &[Point]) -> bool {
    let n = points.len();
    let leg = |i: usize| points[(i + 1) % n] - points[i % n];
    let turned: f64 = (0..n)
        .map(|i| {
            let (a, b) = (leg(i), leg(i + 1));
            math::atan2(crate::geometry::cross(a, b), a.dot(&b))
        })
        .sum();
    (turned.abs() - TAU).abs() < 1e-6
}

fn place_cones(random: &mut Stream, corridor: &Corridor, options: &TrackOptions) -> ConeTrack {
    let mut track = ConeTrack::default();
    for left in [true, false] {
        let colour = if left { ConeColour::Blue } else { ConeColour::Yellow };
        let edge = Edge::new(corridor.edge(left));
        // Two large cones at the line, half a metre from it.
        let gate = [-GATE, GATE].map(|offset| edge.points[0] + edge.along() * offset);
        track.cones.extend(gate.map(|place| Cone::new(place, ConeColour::BigOrange)));
        let places = edge.places(random, options.spacing);
        let closing = edge.closing(&places, gate, options.spacing[1]);
        let all = places.iter().map(|(_, place)| *place).chain(closing);
        track.cones.extend(all.map(|place| Cone::new(place, colour)));
    }
    let n = corridor.stations().len();
    let behind = corridor.stations()[n - RUN_UP as usize];
    let heading = math::atan2(-behind.normal.x, behind.normal.y);
    track.start = Some(Pose::new(behind.position.x, behind.position.y, heading));
    let line = corridor.stations()[0];
    track.gates = vec![[line.aside(line.left), line.aside(-line.right)]];
    track
}

/// Distance from the line to the large cones beside it (m).
const GATE: f64 = 0.5;
/// Distance from the line to the first small cone after it (m).
const FIRST: f64 = 3.0;
/// Minimum distance from the last small cone before the line to the line (m).
const LAST: f64 = 2.0;

/// A closed edge along which cones are placed.
struct Edge {
    points: Vec<Point>,
    /// Length (m).
    total: f64,
}

impl Edge {
    fn new(points: Vec<Point>) -> Self {
        let n = points.len();
        let total = (0..n).map(|i| (points[(i + 1) % n] - points[i]).norm()).sum();
        Self { points, total }
    }

    fn tip(&self, i: usize) -> Point {
        self.points[i % self.points.len()]
    }

    /// Direction at the start line.
    fn along(&self) -> Vector {
        (self.tip(1) - self.tip(0)).normalize()
    }

    /// Positions of the small cones, with their distances from the line (m); closer together in bends.
    fn places(&self, random: &mut Stream, [tight, wide]: [f64; 2]) -> Vec<(f64, Point)> {
        let n = self.points.len();
        let mut found = Vec::new();
        let (mut passed, mut next) = (0.0, FIRST.min(GATE + wide));
        for i in 0..n {
            let piece = self.tip(i + 1) - self.tip(i);
            let length = piece.norm();
            while next < passed + length && next < self.total - LAST {
                let place = self.tip(i) + piece * ((next - passed) / length);
                let jitter = Vector::new(random.between(-0.05, 0.05), random.between(-0.05, 0.05));
                found.push((next, place + jitter));
                let bend = curvature([self.tip(i + n - 3), self.tip(i), self.tip(i + 3)]).abs();
                let share = (1.0 - 8.0 * bend).clamp(0.0, 1.0);
                next += (tight + (wide - tight) * share) * random.between(0.9, 1.0);
            }
            passed += length;
        }
        found
    }

    /// Additional cones between the last one and the large cone before the line, if these are too far apart.
    fn closing(&self, places: &[(f64, Point)], gate: [Point; 2], most: f64) -> Vec<Point> {
        let (from, last) = places.last().copied().unwrap_or((GATE, gate[1]));
        let parts = ((gate[0] - last).norm() / most).ceil().max(1.0);
        let gap = (self.total - GATE - from) / parts;
        (1..parts as usize).map(|k| self.at(from + gap * k as f64)).collect()
    }

    /// The point at a distance behind the line.
    fn at(&self, way: f64) -> Point {
        let mut passed = 0.0;
        for i in 0..self.points.len() {
            let piece = self.tip(i + 1) - self.tip(i);
            let length = piece.norm();
            if way < passed + length {
                return self.tip(i) + piece * ((way - passed) / length);
            }
            passed += length;
        }
        self.tip(0)
    }
}
