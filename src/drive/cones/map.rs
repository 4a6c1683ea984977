use nalgebra::{Matrix3, Vector3};

use super::cone::{Cone, ConeColour};
use super::registration::{Expected, register, spread};
use super::sight::Sighting;
use crate::geometry::{Point, Pose, cross, direction, normalize_angle};

/// How a map of cones is made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConeMapParameters {
    /// Metres from a cone of the map within which a sighting is that cone.
    pub gate: f64,
    /// Metres from the scanner beyond which nothing is added.
    pub farthest: f64,
    /// Times that a cone has to be seen before it counts.
    pub confirmed: u32,
    /// Metres from the car's origin to the sensor, ahead.
    pub sensor: f64,
    /// How far odometry may be wrong after a step of one metre: metres, and radians.
    pub drift: [f64; 2],
}

impl Default for ConeMapParameters {
    fn default() -> Self {
        Self { gate: 0.9, farthest: 15.0, confirmed: 4, sensor: 2.15, drift: [0.03, 0.006] }
    }
}

/// A cone of the map.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Landmark {
    position: Point,
    seen: u32,
    missed: u32,
    /// Times that it was seen blue, yellow and orange.
    colours: [u16; 3],
    /// Times that it was taken for one of the left edge, less those for the right one.
    side: i16,
    /// Metres that the car had gone when it was seen first, last, and in the mean.
    first: f64,
    last: f64,
    mean: f64,
}

impl Landmark {
    /// The colour that it was seen in most often, or else that of the edge for which it was taken, once that is more than chance.
    fn colour(&self) -> ConeColour {
        match self.painted() {
            ConeColour::Unknown if self.side >= SURE => ConeColour::Blue,
            ConeColour::Unknown if self.side <= -SURE => ConeColour::Yellow,
            painted => painted,
        }
    }

    fn painted(&self) -> ConeColour {
        let [blue, yellow, orange] = self.colours;
        let most = blue.max(yellow).max(orange);
        if most < 3 || blue + yellow + orange >= 2 * most {
            ConeColour::Unknown
        } else if most == blue {
            ConeColour::Blue
        } else if most == yellow {
            ConeColour::Yellow
        } else {
            ConeColour::Orange
        }
    }

    fn vote(&mut self, colour: ConeColour) {
        let index = match colour {
            ConeColour::Blue => 0,
            ConeColour::Yellow => 1,
            ConeColour::Orange | ConeColour::BigOrange => 2,
            ConeColour::Unknown => return,
        };
        // Halved before it overflows, so that late votes count as well.
        if self.colours[index] >= 1000 {
            self.colours = self.colours.map(|count| count / 2);
        }
        self.colours[index] += 1;
    }

    /// A cone that is seen for the first time.
    fn new(position: Point, colour: ConeColour, way: f64) -> Self {
        let mut new =
            Self { position, seen: 1, missed: 0, colours: [0; 3], side: 0, first: way, last: way, mean: way };
        new.vote(colour);
        new
    }

    /// Takes in that it was seen again.
    fn see(&mut self, place: Point, colour: ConeColour, way: f64) {
        self.seen = (self.seen + 1).min(MEMORY);
        self.missed = 0;
        self.vote(colour);
        let share = 1.0 / f64::from(self.seen);
        self.position += (place - self.position) * share;
        self.mean += (way - self.mean) * share;
        self.last = way;
    }

    /// Takes in what was held to be another cone.
    fn join(&mut self, other: &Self) {
        let share = f64::from(other.seen) / f64::from(self.seen + other.seen);
        self.position += (other.position - self.position) * share;
        self.seen = (self.seen + other.seen).min(MEMORY);
        self.missed = self.missed.min(other.missed);
        for (mine, theirs) in self.colours.iter_mut().zip(other.colours) {
            *mine = (*mine + theirs).min(1000);
        }
        self.side = (self.side + other.side).clamp(-MOST_VOTES, MOST_VOTES);
        self.last = self.last.max(other.last);
    }
}

/// A map of cones and the car's pose in it, from odometry and sightings (simultaneous localisation and mapping).
///
/// The pose is predicted by odometry; sightings are matched to the nearest cone of the map; the pose that fits both best, by
/// least squares, is the new one; then the cones move to the mean of where they were seen. The frame is that of the start.
///
/// In the first lap errors add up with the way, so a cone is matched only while it was seen lately. [`close`](Self::close) ends
/// that: back at the start, it finds the first cones again and takes what has added up out of the whole lap.
#[derive(Debug, Clone)]
pub struct ConeMap {
    parameters: ConeMapParameters,
    landmarks: Vec<Landmark>,
    pose: Pose,
    odometry: Option<Pose>,
    /// Metres that the car has gone.
    way: f64,
    /// Where it was in the first lap, and how far it had gone.
    trail: Vec<(Pose, f64)>,
    closed: bool,
}

/// Votes for an edge by which a cone belongs to it, and votes that are counted.
const SURE: i16 = 6;
const MOST_VOTES: i16 = 30;
/// Sightings after which a cone moves no more slowly.
const MEMORY: u32 = 80;
/// Metres from the sensor, and radians from straight ahead, within which a cone that is not seen is missed.
const VIEW: (f64, f64) = (9.0, 0.8);
/// Metres that the car goes while a cone is fresh: so far, odometry and sightings are good.
const FRESH: f64 = 25.0;
/// Metres from place to place of the trail.
const STRIDE: f64 = 2.0;
/// Metres of the way in which the first cones were seen.
const BEGINNING: f64 = 30.0;
/// Metres of the way in which the last cones were seen.
const END: f64 = 8.0;
/// Metres between two cones that are the same one, after a loop was closed.
const SAME: f64 = 0.6;
/// By how much a map may be wrong when it is closed: metres, metres after one metre, radians.
const WRONG: (f64, f64, f64) = (4.0, 0.02, 0.4);

impl ConeMap {
    /// An empty map; the car is at its origin.
    pub fn new(parameters: ConeMapParameters) -> Self {
        Self {
            parameters,
            landmarks: Vec::new(),
            pose: Pose::default(),
            odometry: None,
            way: 0.0,
            trail: Vec::new(),
            closed: false,
        }
    }

    /// The car's pose in the map.
    pub fn pose(&self) -> Pose {
        self.pose
    }

    /// The cones that were seen often enough.
    pub fn cones(&self) -> impl Iterator<Item = Cone> + '_ {
        self.confirmed().map(|landmark| Cone::new(landmark.position, landmark.colour()))
    }

    /// Those of them that fit where the car is now: all of them once the map is closed, and those that were seen lately before
    /// that.
    pub fn fresh_cones(&self) -> impl Iterator<Item = Cone> + '_ {
        let fresh = self.confirmed().filter(|landmark| self.is_fresh(landmark));
        fresh.map(|landmark| Cone::new(landmark.position, landmark.colour()))
    }

    /// Whether the first lap is closed to a loop.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// Where the car was in the first lap, about every two metres.
    pub fn trail(&self) -> impl Iterator<Item = Pose> + '_ {
        self.trail.iter().map(|(pose, _)| *pose)
    }

    /// Metres by which the pose may be wrong that is compared with that of the start.
    pub fn tolerance(&self) -> f64 {
        if self.closed { WRONG.0 } else { WRONG.0 + WRONG.1 * self.way }
    }

    fn confirmed(&self) -> impl Iterator<Item = &Landmark> + '_ {
        self.landmarks.iter().filter(|landmark| landmark.seen >= self.parameters.confirmed)
    }

    fn is_fresh(&self, landmark: &Landmark) -> bool {
        self.closed || self.way - landmark.last < FRESH
    }

    /// Takes in where odometry is and what a scan showed there.
    pub fn update(&mut self, odometry: Pose, sightings: &[Sighting]) {
        let step =
            self.odometry.replace(odometry).map_or(Pose::default(), |last| last.inverse().compose(&odometry));
        self.pose = self.pose.compose(&step);
        let way = step.position().coords.norm();
        self.way += way;
        let seen: Vec<&Sighting> = sightings.iter().filter(|s| s.is_cone()).collect();
        // Matched again after the first correction, which brings what was just outside of the gate into it.
        for _ in 0..2 {
            let matches = self.matches(&seen);
            if matches.iter().any(Option::is_some) {
                self.correct(&seen, &matches, way);
            }
        }
        let matches = self.matches(&seen);
        self.learn(&seen, &matches);
        if !self.closed && self.trail.last().is_none_or(|(_, way)| self.way - way >= STRIDE) {
            self.trail.push((self.pose, self.way));
        }
    }

    /// Takes in that cones at some places are those of an edge: 1 for the left one, -1 for the right one.
    pub(super) fn vote_side(&mut self, places: impl Iterator<Item = Point>, side: i16) {
        for place in places {
            if let Some(landmark) = self.landmarks.iter_mut().find(|landmark| landmark.position == place) {
                landmark.side = (landmark.side + side).clamp(-MOST_VOTES, MOST_VOTES);
            }
        }
    }

    /// Closes the first lap to a loop, if the first cones are among those that are seen now: what pose and map are wrong by is
    /// spread over the lap, and cones that are there twice become one. Whether it is closed.
    pub fn close(&mut self) -> bool {
        if self.closed {
            return true;
        }
        let first = |l: &&Landmark| l.first < BEGINNING && !self.is_fresh(l);
        let last = |l: &&Landmark| self.way - l.last < END && l.first > BEGINNING;
        let at = |landmark: &Landmark| landmark.position;
        let onto: Vec<Point> = self.confirmed().filter(first).map(at).collect();
        let points: Vec<Point> = self.confirmed().filter(last).map(at).collect();
        let expected = Expected { place: self.pose.position(), wrong: (self.tolerance(), WRONG.2) };
        let Some(motion) = register(&points, &onto, expected) else { return false };
        self.bend(motion);
        self.merge();
        self.closed = true;
        true
    }

    /// Moves the end of the lap by a motion, its beginning not at all, and what is between in proportion to the way.
    fn bend(&mut self, motion: Pose) {
        self.trail.push((self.pose, self.way));
        let until = (self.way - END - BEGINNING).max(BEGINNING + STRIDE);
        let share = |way: f64| ((way - BEGINNING) / (until - BEGINNING)).clamp(0.0, 1.0);
        let (before, shares): (Vec<Pose>, Vec<f64>) =
            self.trail.iter().map(|(pose, way)| (*pose, share(*way))).unzip();
        let after = spread(&before, &shares, motion);
        for landmark in &mut self.landmarks {
            let node = self.trail.partition_point(|(_, way)| *way < landmark.mean).min(before.len() - 1);
            landmark.position = after[node].to_world(before[node].to_local(landmark.position));
        }
        for ((pose, _), new) in self.trail.iter_mut().zip(&after) {
            *pose = *new;
        }
        self.pose = after[after.len() - 1];
        // The lap ends where it began, not where that was noticed.
        let begin = self.trail[0].0.x;
        while self.trail.len() > 2 && self.trail.last().is_some_and(|(pose, _)| pose.x > begin - STRIDE) {
            self.trail.pop();
        }
    }

    /// Makes one cone of those that are too near each other to be two.
    fn merge(&mut self) {
        let mut kept: Vec<Landmark> = Vec::with_capacity(self.landmarks.len());
        for landmark in &self.landmarks {
            let near = |other: &&mut Landmark| (other.position - landmark.position).norm() < SAME;
            match kept.iter_mut().find(near) {
                Some(other) => other.join(landmark),
                None => kept.push(*landmark),
            }
        }
        self.landmarks = kept;
    }

    fn matches(&self, seen: &[&Sighting]) -> Vec<Option<usize>> {
        let gate = self.parameters.gate * self.parameters.gate;
        let nearest = |point: Point| {
            let mut best = (gate, None);
            for (index, landmark) in self.landmarks.iter().enumerate() {
                let distance = (landmark.position - point).norm_squared();
                if distance < best.0 && self.is_fresh(landmark) {
                    best = (distance, Some(index));
                }
            }
            best.1
        };
        seen.iter().map(|sighting| nearest(self.pose.to_world(sighting.position))).collect()
    }

    /// Moves the pose to where sightings and odometry agree best.
    fn correct(&mut self, seen: &[&Sighting], matches: &[Option<usize>], way: f64) {
        let p = &self.parameters;
        let prior = [0.004 + p.drift[0] * way, 0.001 + p.drift[1] * way].map(|error| 1.0 / (error * error));
        let mut matrix = Matrix3::from_diagonal(&Vector3::new(prior[0], prior[0], prior[1]));
        let mut right = Vector3::zeros();
        for (sighting, landmark) in seen.iter().zip(matches) {
            let Some(landmark) = landmark.map(|index| self.landmarks[index]) else { continue };
            if landmark.seen < 2 {
                continue;
            }
            let place = self.pose.to_world(sighting.position);
            let missing = landmark.position - place;
            let unsure = sighting.error
                * sighting.error
                * (1.0 + 4.0 / f64::from(landmark.seen) + 0.004 * sighting.range * sighting.range);
            // What is far off counts less: it may be another cone.
            let weight = 1.0 / (unsure * (1.0 + missing.norm_squared() / 0.09));
            let arm = place - self.pose.position();
            // The place moves by (dx - arm.y da, dy + arm.x da).
            for (row, wanted) in
                [(Vector3::new(1.0, 0.0, -arm.y), missing.x), (Vector3::new(0.0, 1.0, arm.x), missing.y)]
            {
                matrix += row * row.transpose() * weight;
                right += row * (weight * wanted);
            }
        }
        let Some(inverse) = matrix.try_inverse() else { return };
        let change = inverse * right;
        self.pose.x += change.x;
        self.pose.y += change.y;
        self.pose.heading = normalize_angle(self.pose.heading + change.z);
    }

    /// Moves, adds and forgets cones.
    fn learn(&mut self, seen: &[&Sighting], matches: &[Option<usize>]) {
        let mut matched = vec![false; self.landmarks.len()];
        for (sighting, landmark) in seen.iter().zip(matches) {
            let place = self.pose.to_world(sighting.position);
            if let Some(index) = *landmark {
                let landmark = &mut self.landmarks[index];
                if matched[index] || sighting.range > self.parameters.farthest {
                    matched[index] = true;
                    continue;
                }
                matched[index] = true;
                landmark.see(place, sighting.colour, self.way);
            } else if sighting.range < self.parameters.farthest {
                self.landmarks.push(Landmark::new(place, sighting.colour, self.way));
                matched.push(true);
            }
        }
        self.forget(&matched);
    }

    /// Forgets what should have been seen and was not.
    fn forget(&mut self, matched: &[bool]) {
        let ahead = direction(self.pose.heading);
        let eye = self.pose.position() + ahead * self.parameters.sensor;
        let mut index = 0;
        let (confirmed, closed, way) = (self.parameters.confirmed, self.closed, self.way);
        self.landmarks.retain_mut(|landmark| {
            index += 1;
            let away = landmark.position - eye;
            let distance = away.norm();
            let angle = crate::geometry::math::atan2(cross(ahead, away), ahead.dot(&away));
            let in_view = distance < VIEW.0 && distance > 1.0 && angle.abs() < VIEW.1;
            let fresh = closed || way - landmark.last < FRESH;
            if matched[index - 1] || !fresh || !(in_view || landmark.seen < confirmed) {
                return true;
            }
            landmark.missed += 1;
            // A phantom is seen once; a cone now and then not.
            landmark.missed <= if landmark.seen < confirmed { 3 + landmark.seen } else { 8 }
        });
    }
}
