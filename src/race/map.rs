mod closure;

use nalgebra::{Matrix3, Vector3};

use super::cone::{APART, Cone, ConeColour};
use super::landmark::Landmark;
use super::sight::ConeSighting;
use super::view::{VIEW, hides, in_view};
use crate::ParameterError;
use crate::geometry::{Point, Pose, normalize_angle};
use crate::parameter::{require_finite, require_not_negative, require_positive};

/// Parameters of [`ConeMap`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConeMapParameters {
    /// Maximum distance between a detection and its cone in the map (m).
    pub gate: f64,
    /// Distance from the scanner beyond which no cone is added (m).
    pub farthest: f64,
    /// Number of detections that confirm a cone.
    pub confirmed: u32,
    /// Distance of the sensor ahead of the car's origin (m).
    pub sensor: f64,
    /// Error of odometry per metre (m, rad).
    pub drift: [f64; 2],
}

impl Default for ConeMapParameters {
    fn default() -> Self {
        Self { gate: 0.9, farthest: 20.0, confirmed: 4, sensor: 2.15, drift: [0.03, 0.006] }
    }
}

impl ConeMapParameters {
    /// Checks the parameters.
    ///
    /// # Errors
    ///
    /// If one is out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        require_positive("gate", self.gate)?;
        require_positive("farthest", self.farthest)?;
        require_finite("sensor", self.sensor)?;
        let [metres, radians] = self.drift;
        require_not_negative("drift", metres)?;
        require_not_negative("drift in radians", radians)
    }
}

/// A map of cones and the car's pose in it, from odometry and detections (simultaneous localisation and
/// mapping).
///
/// In each update, odometry predicts the pose, detections are matched to the nearest cones of the map, least
/// squares correct the pose, and the cones move to the mean of their detections. The frame is that of the
/// start.
///
/// In the first lap, errors accumulate with the distance, so only recently seen cones are matched.
/// [`close`](Self::close) ends that: back at the start, it recognises the first cones and distributes the
/// accumulated error over the lap.
///
/// ```
/// use roverlab::geometry::{Point, Pose};
/// use roverlab::race::{ConeColour, ConeMap, ConeMapParameters, ConeSighting};
/// let mut map = ConeMap::new(ConeMapParameters::default())?;
/// for step in 0..20 {
///     // A cone at (8, 1), which the car drives towards.
///     let car = Pose::new(0.2 * f64::from(step), 0.0, 0.0);
///     let position = car.to_local(Point::new(8.0, 1.0));
///     let range = position.coords.norm();
///     let colour = ConeColour::Unknown;
///     map.update(car, &[ConeSighting { position, size: 0.2, confidence: 1.0, range, error: 0.05, colour }]);
/// }
/// let cones: Vec<Point> = map.cones().map(|cone| cone.position).collect();
/// assert!(cones.len() == 1 && (cones[0] - Point::new(8.0, 1.0)).norm() < 0.1);
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone)]
pub struct ConeMap {
    parameters: ConeMapParameters,
    landmarks: Vec<Landmark>,
    pose: Pose,
    odometry: Option<Pose>,
    /// Distance driven (m).
    way: f64,
    /// Poses of the mapped lap (the first one, once that is closed), each with the distance driven; `begun`
    /// is the distance at which that lap begins (m).
    trail: Vec<(Pose, f64)>,
    begun: f64,
    closed: bool,
    /// Distance driven when the map was closed (m).
    known: f64,
    fits: Option<bool>,
}

/// Minimum ratio of coloured to colourless detections by the camera.
const MANY: usize = 4;
/// Distance driven during which a cone counts as recent: odometry and detections are consistent over it (m).
/// The first cones were seen within at most this distance.
pub(super) const FRESH: f64 = 25.0;
/// Length of the path just behind the car in which the last cones were seen: no lane turns back within it
/// (m).
const BEHIND: f64 = 8.0;
/// Distance between positions of the trail (m).
pub(super) const STRIDE: f64 = 2.0;
/// Minimum length of a lap (m).
pub(super) const SHORTEST_LAP: f64 = 12.0;
/// Maximum distance between a cone and its earlier detections in the first lap: the accumulated drift, and
/// less than a lane (m).
const EARLIER: f64 = 1.5;
/// Cosine of the angle between two directions below which they cross.
const ATHWART: f64 = 0.5;
/// Maximum error of a map at loop closure: constant (m), per distance driven (m/m), and in heading (rad).
const WRONG: (f64, f64, f64) = (4.0, 0.02, 0.4);

impl ConeMap {
    /// An empty map, with the car at its origin.
    ///
    /// # Errors
    ///
    /// If a parameter is out of range.
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

    /// Pose of the car in the map.
    pub fn pose(&self) -> Pose {
        self.pose
    }

    /// Confirmed cones. If a camera shows the colours of most of them, those without a colour are excluded:
    /// they are [others](Self::fresh_others).
    pub fn cones(&self) -> impl Iterator<Item = Cone> + '_ {
        self.real().map(|landmark| Cone::new(landmark.position, landmark.colour()))
    }

    /// Confirmed cones that are consistent with the present pose: all once the map is closed, otherwise the
    /// recently seen ones.
    pub fn fresh_cones(&self) -> impl Iterator<Item = Cone> + '_ {
        let fresh = self.real().filter(|landmark| self.is_fresh(landmark));
        fresh.map(|landmark| Cone::new(landmark.position, self.colour_of(landmark)))
    }

    /// Positions of objects of a cone's size without a cone's colour, as recent as the fresh cones: they are
    /// no edge of the track, but obstacles.
    pub fn fresh_others(&self) -> impl Iterator<Item = Point> + '_ {
        let painted = self.is_painted();
        let others = self.confirmed().filter(move |landmark| painted && landmark.is_pale());
        others.filter(|landmark| self.is_fresh(landmark)).map(|landmark| landmark.position)
    }

    /// Colour of a cone, or else that of a nearby one passed earlier in the first lap. Between crossings, a
    /// circuit has all cones of its inside on one hand; at a crossing, the hands swap.
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

    /// Whether the first lap is closed.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// Poses of the first lap, about one every two metres.
    pub fn trail(&self) -> impl Iterator<Item = Pose> + '_ {
        self.trail.iter().map(|(pose, _)| *pose)
    }

    /// Poses of the first lap within `near` metres of the car, except the most recent ones.
    pub(super) fn earlier(&self, near: f64) -> impl Iterator<Item = Pose> + '_ {
        let place = self.pose.position();
        let old = self.trail.iter().filter(|(_, way)| self.way - way > BEHIND).map(|(pose, _)| *pose);
        old.filter(move |pose| (pose.position() - place).norm_squared() < near * near)
    }

    /// Possible error of the pose relative to that at the start (m).
    pub fn tolerance(&self) -> f64 {
        if self.closed { WRONG.0 } else { wrong_after(self.way) }
    }

    fn confirmed(&self) -> impl Iterator<Item = &Landmark> + '_ {
        self.landmarks.iter().filter(|landmark| landmark.seen >= self.parameters.confirmed)
    }

    /// Confirmed cones that have, or may have, a cone's colour.
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

    /// Takes a pose by odometry and the detections made there.
    pub fn update(&mut self, odometry: Pose, sightings: &[ConeSighting]) {
        let step =
            self.odometry.replace(odometry).map_or(Pose::default(), |last| last.inverse().compose(&odometry));
        self.pose = self.pose.compose(&step);
        let way = step.position().coords.norm();
        self.way += way;
        let seen: Vec<&ConeSighting> = sightings.iter().filter(|s| s.is_cone()).collect();
        // Match again after the first correction, which brings further detections into the gate.
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

    /// Places the car elsewhere in the map, where odometry begins again.
    pub(super) fn relocate(&mut self, pose: Pose) {
        (self.pose, self.odometry, self.fits) = (pose, None, None);
    }

    /// Whether the latest detections near the car agree with a closed map; `None` before it is closed, and if
    /// neither shows anything.
    pub(super) fn fits(&self) -> Option<bool> {
        self.fits
    }

    /// Compares detections with the cones known when the map was closed; later ones may result from a wrong
    /// pose.
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
        // A single cone may have been knocked over.
        (expected >= 2).then_some(false)
    }

    /// Records that cones belong to an edge: 1 for the left one, -1 for the right one.
    pub(super) fn vote_side(&mut self, places: impl Iterator<Item = Point>, side: i16) {
        for place in places {
            if let Some(landmark) = self.landmarks.iter_mut().find(|landmark| landmark.position == place) {
                landmark.vote_side(side);
            }
        }
    }

    /// Matches each detection to a cone of the map, each cone at most once, nearest first.
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

    /// Corrects the pose by least squares of detections and odometry.
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
            // Distant matches weigh less: they may be other cones.
            let weight = 1.0 / (unsure * (1.0 + missing.norm_squared() / 0.09));
            let arm = place - self.pose.position();
            // The position changes by (dx - arm.y da, dy + arm.x da).
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

    /// Updates and adds cones.
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

    /// Removes cones that should have been seen but were not, among the first `known`; new ones are at the
    /// end.
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
            // Phantoms are seen once; real cones are missed occasionally.
            landmark.missed <= if landmark.seen < confirmed { 3 + landmark.seen } else { 8 }
        });
    }
}

/// Whether a new detection is a part of another one: no two cones stand so close together.
fn is_part(new: &ConeSighting, other: &ConeSighting) -> bool {
    let away = (new.position - other.position).norm();
    away > 0.0 && away < APART
}

/// Possible error of a pose after a distance (m).
fn wrong_after(way: f64) -> f64 {
    WRONG.0 + WRONG.1 * way
}

#[cfg(test)]
mod tests;
