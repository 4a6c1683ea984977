use nalgebra::{Matrix3, Vector3};

use super::cone::{APART, Cone, ConeColour};
use super::landmark::Landmark;
use super::registration::{Expected, GATE, register, spread};
use super::sight::ConeSighting;
use crate::ParameterError;
use crate::geometry::{Point, Pose, Vector, cross, math, normalize_angle};
use crate::parameter::{require_finite, require_not_negative, require_positive};

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
        Self { gate: 0.9, farthest: 20.0, confirmed: 4, sensor: 2.15, drift: [0.03, 0.006] }
    }
}

impl ConeMapParameters {
    /// Fails with the name of the parameter that is out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        require_positive("gate", self.gate)?;
        require_positive("farthest", self.farthest)?;
        require_finite("sensor", self.sensor)?;
        let [metres, radians] = self.drift;
        require_not_negative("drift", metres)?;
        require_not_negative("drift in radians", radians)
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
    /// Where it was in the lap that the map is of, the first one if that is closed, and how far it had gone; and how far where that
    /// lap begins.
    trail: Vec<(Pose, f64)>,
    begun: f64,
    closed: bool,
    /// Metres that the car had gone when it was closed.
    known: f64,
    fits: Option<bool>,
}

/// Cones with colours that there have to be for each thing that a camera shows to have none.
const MANY: usize = 4;
/// Metres from the sensor, and radians from straight ahead, within which a cone that is not seen is missed.
const VIEW: (f64, f64) = (9.0, 0.8);
/// Metres that the car goes while a cone is fresh: so far, odometry and sightings are good. The first cones were seen in so many
/// metres, at most.
pub(super) const FRESH: f64 = 25.0;
/// Metres of the way that lie just behind the car, in which the last cones were seen: no lane turns back within so many.
const BEHIND: f64 = 8.0;
/// Metres from place to place of the trail.
pub(super) const STRIDE: f64 = 2.0;
/// Metres that a lap takes at least.
pub(super) const SHORTEST_LAP: f64 = 12.0;
/// Metres from a place within which a lap has led back to it.
const AROUND: f64 = 2.5;
/// Metres between a cone and what was seen of it earlier in the first lap, at most: what has added up since, and less than a lane.
const EARLIER: f64 = 1.5;
/// The cosine of the angle between two ways below which they cross.
const ATHWART: f64 = 0.5;
/// By how much a map may be wrong when it is closed: metres, metres after one metre, radians.
const WRONG: (f64, f64, f64) = (4.0, 0.02, 0.4);

impl ConeMap {
    /// An empty map; the car is at its origin.
    pub fn new(parameters: ConeMapParameters) -> Result<Self, ParameterError> {
        parameters.validate()?;
        Ok(Self {
            parameters,
            landmarks: Vec::new(),
            pose: Pose::default(),
            odometry: None,
            way: 0.0,
            trail: Vec::new(),
            begun: 0.0,
            closed: false,
            known: f64::INFINITY,
            fits: None,
        })
    }

    /// The car's pose in the map.
    pub fn pose(&self) -> Pose {
        self.pose
    }

    /// The cones that were seen often enough. Where a camera shows the colours of most of them, those that it shows to have none are
    /// left out: they are [others](Self::fresh_others).
    pub fn cones(&self) -> impl Iterator<Item = Cone> + '_ {
        self.real().map(|landmark| Cone::new(landmark.position, landmark.colour()))
    }

    /// Those of them that fit where the car is now: all of them once the map is closed, and those that were seen lately before
    /// that.
    pub fn fresh_cones(&self) -> impl Iterator<Item = Cone> + '_ {
        let fresh = self.real().filter(|landmark| self.is_fresh(landmark));
        fresh.map(|landmark| Cone::new(landmark.position, self.colour_of(landmark)))
    }

    /// Where something stands that is as small as a cone and has no cone's colour, as fresh as those: no edge of a track, but nothing
    /// to drive into.
    pub fn fresh_others(&self) -> impl Iterator<Item = Point> + '_ {
        let painted = self.is_painted();
        let others = self.confirmed().filter(move |landmark| painted && landmark.is_pale());
        others.filter(|landmark| self.is_fresh(landmark)).map(|landmark| landmark.position)
    }

    /// The colour of a cone, or that of one near it that was passed earlier in the first lap: between crossings, a circuit has all
    /// cones on its inside on one hand wherever it goes by them. Where it goes by athwart, it crosses itself, which changes hands.
    fn colour_of(&self, landmark: &Landmark) -> ConeColour {
        let own = landmark.colour();
        if own != ConeColour::Unknown {
            return own;
        }
        let away = |other: &&Landmark| (other.position - landmark.position).norm();
        let ahead = self.pose.forward();
        let athwart = |other: &&Landmark| {
            let node = self.trail.partition_point(|(_, way)| *way < other.mean);
            self.trail.get(node).is_some_and(|(pose, _)| pose.forward().dot(&ahead).abs() < ATHWART)
        };
        let earlier = self.confirmed().filter(|other| {
            !other.is_pale() && !self.is_fresh(other) && away(other) < EARLIER && !athwart(other)
        });
        let nearest = earlier.min_by(|a, b| away(a).total_cmp(&away(b)));
        nearest.map_or(ConeColour::Unknown, Landmark::colour)
    }

    /// Whether the first lap is closed to a loop.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// Where the car was in the first lap, about every two metres.
    pub fn trail(&self) -> impl Iterator<Item = Pose> + '_ {
        self.trail.iter().map(|(pose, _)| *pose)
    }

    /// The way by which the car came in the first lap, but for the last metres, as far as that is within some metres of it now.
    pub(super) fn earlier(&self, near: f64) -> impl Iterator<Item = Pose> + '_ {
        let place = self.pose.position();
        let old = self.trail.iter().filter(|(_, way)| self.way - way > BEHIND).map(|(pose, _)| *pose);
        old.filter(move |pose| (pose.position() - place).norm_squared() < near * near)
    }

    /// Metres by which the pose may be wrong that is compared with that of the start.
    pub fn tolerance(&self) -> f64 {
        if self.closed { WRONG.0 } else { wrong_after(self.way) }
    }

    fn confirmed(&self) -> impl Iterator<Item = &Landmark> + '_ {
        self.landmarks.iter().filter(|landmark| landmark.seen >= self.parameters.confirmed)
    }

    /// Those of them that have a cone's colour, or may have one.
    fn real(&self) -> impl Iterator<Item = &Landmark> + '_ {
        let painted = self.is_painted();
        self.confirmed().filter(move |landmark| !(painted && landmark.is_pale()))
    }

    /// Whether a camera shows the colours of nearly all cones.
    fn is_painted(&self) -> bool {
        let pale = self.confirmed().filter(|landmark| landmark.is_pale()).count();
        let painted = self.confirmed().filter(|landmark| landmark.painted() != ConeColour::Unknown).count();
        painted >= MANY * pale
    }

    fn is_fresh(&self, landmark: &Landmark) -> bool {
        self.closed || self.way - landmark.last < FRESH
    }

    /// Takes in where odometry is and what a scan showed there.
    pub fn update(&mut self, odometry: Pose, sightings: &[ConeSighting]) {
        let step =
            self.odometry.replace(odometry).map_or(Pose::default(), |last| last.inverse().compose(&odometry));
        self.pose = self.pose.compose(&step);
        let way = step.position().coords.norm();
        self.way += way;
        let seen: Vec<&ConeSighting> = sightings.iter().filter(|s| s.is_cone()).collect();
        // Matched again after the first correction, which brings what was just outside of the gate into it.
        for _ in 0..2 {
            let matches = self.matches(&seen);
            if matches.iter().any(Option::is_some) {
                self.correct(&seen, &matches, way);
            }
        }
        let matches = self.matches(&seen);
        self.fits = self.compare(&seen, &matches);
        let known = self.landmarks.len();
        self.learn(&seen, &matches);
        self.forget(known, &matches, sightings);
        if !self.closed && self.trail.last().is_none_or(|(_, way)| self.way - way >= STRIDE) {
            self.trail.push((self.pose, self.way));
        }
    }

    /// Whether what was seen near the car at last is what a closed map has there. `None` before it is closed, and where neither
    /// shows anything.
    pub(super) fn fits(&self) -> Option<bool> {
        self.fits
    }

    /// Compares sightings with the cones that the map had when it was closed: later ones may be there for a wrong pose's sake.
    fn compare(&self, seen: &[&ConeSighting], matches: &[Option<usize>]) -> Option<bool> {
        if !self.closed {
            return None;
        }
        let is_known = |landmark: &usize| self.landmarks[*landmark].first <= self.known;
        let near = seen.iter().zip(matches).filter(|(sighting, _)| sighting.range < VIEW.0);
        let (mut all, mut known) = (0, 0);
        for (_, landmark) in near {
            all += 1;
            known += usize::from(landmark.as_ref().is_some_and(is_known));
        }
        if all > 0 {
            return Some(2 * known >= all);
        }
        let eye = self.pose.compose(&Pose::new(self.parameters.sensor, 0.0, 0.0));
        let expected = self.confirmed().filter(|cone| in_view(eye.to_local(cone.position).coords)).count();
        // One cone alone may have been knocked over.
        (expected >= 2).then_some(false)
    }

    /// Takes in that cones at some places are those of an edge: 1 for the left one, -1 for the right one.
    pub(super) fn vote_side(&mut self, places: impl Iterator<Item = Point>, side: i16) {
        for place in places {
            if let Some(landmark) = self.landmarks.iter_mut().find(|landmark| landmark.position == place) {
                landmark.vote_side(side);
            }
        }
    }

    /// Closes the first lap to a loop, if the first cones are among those that are seen now: what pose and map are wrong by is
    /// spread over the lap, and cones that are there twice become one. Whether it is closed.
    pub fn close(&mut self) -> bool {
        if self.closed {
            return true;
        }
        if self.confirmed().all(|landmark| self.is_fresh(landmark)) {
            // A short lap has led back to cones that it went by just now: pose and map are good without.
            (self.closed, self.known) = (true, self.way);
            self.drop_earlier_laps();
            return true;
        }
        let beginning = self.beginning();
        let first = |l: &&Landmark| l.first < beginning && !self.is_fresh(l);
        let last = |l: &&Landmark| self.way - l.last < BEHIND && l.first > beginning;
        let at = |landmark: &Landmark| landmark.position;
        let onto: Vec<Point> = self.confirmed().filter(first).map(at).collect();
        let points: Vec<Point> = self.confirmed().filter(last).map(at).collect();
        let expected =
            Expected { place: self.pose.position(), wrong: (wrong_after(self.way - self.begun), WRONG.2) };
        let Some(motion) = register(&points, &onto, expected) else { return false };
        self.bend(motion);
        self.merge();
        (self.closed, self.known) = (true, self.way);
        true
    }

    /// Takes the last so many metres of the way for the first lap, where that could not be closed: on a straight, rows of cones may
    /// look alike at many places, and plain farther on. Does nothing for less than twice the metres within which cones are fresh.
    pub(super) fn begin_later(&mut self, metres: f64) {
        let begun = self.way - metres;
        if self.closed || begun <= self.begun || metres < 2.0 * FRESH {
            return;
        }
        self.begun = begun;
        self.landmarks.retain(|landmark| landmark.last >= begun);
        self.trail.retain(|(_, way)| *way >= begun);
    }

    /// Moves the end of the lap by a motion, its beginning not at all, and what is between in proportion to the way.
    fn bend(&mut self, motion: Pose) {
        self.trail.push((self.pose, self.way));
        let beginning = self.beginning();
        let until = (self.way - BEHIND - (beginning - self.begun)).max(beginning + STRIDE);
        let share = |way: f64| ((way - beginning) / (until - beginning)).clamp(0.0, 1.0);
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
        let (begin, _) = self.trail[0];
        let is_beyond = |(pose, _): &(Pose, f64)| begin.to_local(pose.position()).x > -STRIDE;
        while self.trail.len() > 2 && self.trail.last().is_some_and(is_beyond) {
            self.trail.pop();
        }
    }

    /// Leaves one lap of the trail, the last one: a short lap is driven more than once before the line is crossed again.
    fn drop_earlier_laps(&mut self) {
        let (pose, way) = (self.pose, self.way);
        let away = |at: &Pose| (at.position() - pose.position()).norm();
        let around = self.trail.iter().enumerate().filter(|(_, (at, then))| {
            way - then > SHORTEST_LAP && away(at) < AROUND && at.forward().dot(&pose.forward()) > ATHWART
        });
        // Of all times that it came by here, the last one; there, the place that is nearest.
        let Some((last, _)) = around.clone().next_back() else { return };
        let once = around.filter(|(_, (_, then))| self.trail[last].1 - then < 2.0 * AROUND);
        let nearest = once.min_by(|(_, (a, _)), (_, (b, _))| away(a).total_cmp(&away(b)));
        self.trail.drain(..=nearest.map_or(last, |(at, _)| at));
        if self.trail.last().is_some_and(|(_, then)| way - then > 0.5 * STRIDE) {
            self.trail.push((pose, way));
        }
    }

    /// Metres of the way in which the first cones were seen.
    fn beginning(&self) -> f64 {
        self.begun + FRESH.min(0.5 * (self.way - self.begun))
    }

    /// Makes one cone of those that are too near each other to be two.
    fn merge(&mut self) {
        let mut kept: Vec<Landmark> = Vec::with_capacity(self.landmarks.len());
        for landmark in &self.landmarks {
            let near = |other: &&mut Landmark| (other.position - landmark.position).norm() < GATE;
            match kept.iter_mut().find(near) {
                Some(other) => other.join(landmark),
                None => kept.push(*landmark),
            }
        }
        self.landmarks = kept;
    }

    /// The cone of the map that each sighting is, no cone twice: the nearest ones first.
    fn matches(&self, seen: &[&ConeSighting]) -> Vec<Option<usize>> {
        let gate = self.parameters.gate * self.parameters.gate;
        let mut near: Vec<(f64, usize, usize)> = Vec::new();
        for (index, sighting) in seen.iter().enumerate() {
            let place = self.pose.to_world(sighting.position);
            for (at, landmark) in self.landmarks.iter().enumerate() {
                let distance = (landmark.position - place).norm_squared();
                if distance < gate && self.is_fresh(landmark) {
                    near.push((distance, index, at));
                }
            }
        }
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut found = vec![None; seen.len()];
        let mut taken = vec![false; self.landmarks.len()];
        for (_, sighting, landmark) in near {
            if found[sighting].is_none() && !taken[landmark] {
                found[sighting] = Some(landmark);
                taken[landmark] = true;
            }
        }
        found
    }

    /// Moves the pose to where sightings and odometry agree best.
    fn correct(&mut self, seen: &[&ConeSighting], matches: &[Option<usize>], way: f64) {
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

    /// Moves and adds cones.
    fn learn(&mut self, seen: &[&ConeSighting], matches: &[Option<usize>]) {
        for (at, (sighting, landmark)) in seen.iter().zip(matches).enumerate() {
            if sighting.range > self.parameters.farthest {
                continue;
            }
            let place = self.pose.to_world(sighting.position);
            let others = seen.iter().zip(matches).enumerate();
            let mut taken = others.filter(|(other, (_, landmark))| *other < at || landmark.is_some());
            if let Some(index) = *landmark {
                self.landmarks[index].see(place, sighting, self.way);
            } else if !taken.any(|(_, (other, _))| is_part(sighting, other)) {
                self.landmarks.push(Landmark::new(place, sighting, self.way));
            }
        }
    }

    /// Forgets what should have been seen and was not, of so many cones that were known before. What is new stands at the end.
    fn forget(&mut self, known: usize, matches: &[Option<usize>], sightings: &[ConeSighting]) {
        let mut matched = vec![false; self.landmarks.len()];
        matches.iter().flatten().for_each(|&landmark| matched[landmark] = true);
        let eye = self.pose.compose(&Pose::new(self.parameters.sensor, 0.0, 0.0));
        let mut index = 0;
        let (confirmed, closed, way) = (self.parameters.confirmed, self.closed, self.way);
        self.landmarks.retain_mut(|landmark| {
            index += 1;
            let away = eye.to_local(landmark.position).coords;
            let in_view = in_view(away) && !sightings.iter().any(|s| hides(s, self.parameters.sensor, away));
            let fresh = closed || way - landmark.last < FRESH;
            if index > known || matched[index - 1] || !fresh || !(in_view || landmark.seen < confirmed) {
                return true;
            }
            landmark.missed += 1;
            // A phantom is seen once; a cone now and then not.
            landmark.missed <= if landmark.seen < confirmed { 3 + landmark.seen } else { 8 }
        });
    }
}

/// Whether something new that was seen is a part of another one: no two cones stand so near each other.
fn is_part(new: &ConeSighting, other: &ConeSighting) -> bool {
    let away = (new.position - other.position).norm();
    away > 0.0 && away < APART
}

/// Metres by which a pose may be wrong after so many metres of the way.
fn wrong_after(way: f64) -> f64 {
    WRONG.0 + WRONG.1 * way
}

/// Whether a cone at a place, from the sensor, would be seen.
fn in_view(place: Vector) -> bool {
    let distance = place.norm();
    distance < VIEW.0 && distance > 1.0 && math::atan2(place.y, place.x).abs() < VIEW.1
}

/// Whether a thing stands before a place, both seen by a sensor, the thing in the frame of the car.
fn hides(thing: &ConeSighting, sensor: f64, place: Vector) -> bool {
    let beside = APART + if thing.is_cone() { 0.0 } else { 0.5 * thing.size };
    let thing = thing.position.coords - Vector::new(sensor, 0.0);
    let (distance, along) = (place.norm(), thing.dot(&place) / place.norm());
    along > 0.0 && along < distance - APART && (cross(place, thing) / distance).abs() < beside
}

#[cfg(test)]
mod tests;
