use nalgebra::{Matrix3, Vector3};

use super::cone::{Cone, ConeColour};
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
}

impl Landmark {
    /// The colour that it was seen in most often, once that is more than chance.
    fn colour(&self) -> ConeColour {
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
}

/// A map of cones and the car's pose in it, from odometry and sightings (simultaneous localisation and mapping).
///
/// The pose is predicted by odometry; sightings are matched to the nearest cone of the map; the pose that fits both best, by
/// least squares, is the new one; then the cones move to the mean of where they were seen. The frame is that of the start.
#[derive(Debug, Clone)]
pub struct ConeMap {
    parameters: ConeMapParameters,
    landmarks: Vec<Landmark>,
    pose: Pose,
    odometry: Option<Pose>,
}

/// Sightings after which a cone moves no more slowly.
const MEMORY: u32 = 80;
/// Metres from the sensor, and radians from straight ahead, within which a cone that is not seen is missed.
const VIEW: (f64, f64) = (9.0, 0.8);

impl ConeMap {
    /// An empty map; the car is at its origin.
    pub fn new(parameters: ConeMapParameters) -> Self {
        Self { parameters, landmarks: Vec::new(), pose: Pose::default(), odometry: None }
    }

    /// The car's pose in the map.
    pub fn pose(&self) -> Pose {
        self.pose
    }

    /// The cones that were seen often enough.
    pub fn cones(&self) -> impl Iterator<Item = Cone> + '_ {
        let confirmed = self.landmarks.iter().filter(|landmark| landmark.seen >= self.parameters.confirmed);
        confirmed.map(|landmark| Cone::new(landmark.position, landmark.colour()))
    }

    /// Takes in where odometry is and what a scan showed there.
    pub fn update(&mut self, odometry: Pose, sightings: &[Sighting]) {
        let step =
            self.odometry.replace(odometry).map_or(Pose::default(), |last| last.inverse().compose(&odometry));
        self.pose = self.pose.compose(&step);
        let way = step.position().coords.norm();
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
    }

    fn matches(&self, seen: &[&Sighting]) -> Vec<Option<usize>> {
        let gate = self.parameters.gate * self.parameters.gate;
        let nearest = |point: Point| {
            let mut best = (gate, None);
            for (index, landmark) in self.landmarks.iter().enumerate() {
                let distance = (landmark.position - point).norm_squared();
                if distance < best.0 {
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
                landmark.seen = (landmark.seen + 1).min(MEMORY);
                landmark.missed = 0;
                landmark.vote(sighting.colour);
                landmark.position += (place - landmark.position) / f64::from(landmark.seen);
            } else if sighting.range < self.parameters.farthest {
                let mut landmark = Landmark { position: place, seen: 1, missed: 0, colours: [0; 3] };
                landmark.vote(sighting.colour);
                self.landmarks.push(landmark);
                matched.push(true);
            }
        }
        let ahead = direction(self.pose.heading);
        let eye = self.pose.position() + ahead * self.parameters.sensor;
        let mut index = 0;
        let confirmed = self.parameters.confirmed;
        self.landmarks.retain_mut(|landmark| {
            index += 1;
            let away = landmark.position - eye;
            let distance = away.norm();
            let angle = crate::geometry::math::atan2(cross(ahead, away), ahead.dot(&away));
            let in_view = distance < VIEW.0 && distance > 1.0 && angle.abs() < VIEW.1;
            if matched[index - 1] || !(in_view || landmark.seen < confirmed) {
                return true;
            }
            landmark.missed += 1;
            // A phantom is seen once; a cone now and then not.
            landmark.missed <= if landmark.seen < confirmed { 3 + landmark.seen } else { 8 }
        });
    }
}
