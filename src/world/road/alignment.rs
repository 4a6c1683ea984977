use crate::geometry::{Point, Pose, Vector, angle_difference, direction, math, normalize_angle};

/// A part of a road's middle: its curvature changes evenly from one end to the other.
///
/// ```
/// use roverlab::world::road::Element;
/// let quarter = Element::arc(1.5, std::f64::consts::FRAC_PI_2);
/// assert!((quarter.length - 2.356).abs() < 1e-3 && quarter.curvature == [1.0 / 1.5; 2]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Element {
    /// Metres.
    pub length: f64,
    /// The curvature at its beginning and at its end, in 1/m; positive to the left.
    pub curvature: [f64; 2],
}

impl Element {
    /// A straight of some metres.
    pub fn straight(length: f64) -> Self {
        Self { length, curvature: [0.0; 2] }
    }

    /// An arc of a radius in metres through an angle in radians, positive to the left.
    pub fn arc(radius: f64, angle: f64) -> Self {
        Self { length: radius * angle.abs(), curvature: [1.0_f64.copysign(angle) / radius; 2] }
    }

    /// A clothoid of some metres between two curvatures.
    pub fn clothoid(length: f64, from: f64, to: f64) -> Self {
        Self { length, curvature: [from, to] }
    }

    fn curvature_at(&self, along: f64) -> f64 {
        let [from, to] = self.curvature;
        if self.length > 0.0 { from + (to - from) * along / self.length } else { from }
    }

    /// The heading beyond that at its beginning.
    fn turned(&self, along: f64) -> f64 {
        0.5 * along * (self.curvature[0] + self.curvature_at(along))
    }

    /// The pose at its end, seen from its beginning.
    pub(super) fn end(&self) -> Pose {
        let pieces = (self.length / STEP).ceil().max(1.0) as usize;
        let piece = self.length / pieces as f64;
        (0..pieces).fold(Pose::default(), |pose, i| {
            let place = pose.position() + self.chord(0.0, piece * i as f64, piece);
            Pose::new(place.x, place.y, self.turned(piece * (i + 1) as f64))
        })
    }

    /// The way from one place of it to another a short piece on, by Simpson's rule.
    fn chord(&self, heading: f64, from: f64, piece: f64) -> Vector {
        let at = |share: f64| direction(heading + self.turned(from + share * piece));
        (at(0.0) + at(0.5) * 4.0 + at(1.0)) * (piece / 6.0)
    }
}

/// A place on a line: its pose, and how the line bends there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Station {
    /// Position and direction of the line.
    pub pose: Pose,
    /// In 1/m, positive to the left.
    pub curvature: f64,
}

/// The middle of a road: a closed chain of [elements](Element), known by its length.
#[derive(Debug, Clone, PartialEq)]
pub struct Alignment {
    elements: Vec<Element>,
    /// Evenly spaced, the last one before the first one again.
    stations: Vec<Station>,
    length: f64,
    gap: Pose,
}

/// Metres from station to station at most.
const STEP: f64 = 0.02;

impl Alignment {
    /// The chain of some elements from a start on. What is missing to its closing is spread evenly over it; see
    /// [`gap`](Alignment::gap). Zero elements, or elements without length, give a line without stations.
    pub fn new(start: Pose, elements: Vec<Element>) -> Self {
        let length: f64 = elements.iter().map(|element| element.length).sum();
        let count = if length.is_finite() { (length / STEP).ceil() as usize } else { 0 };
        let mut line = Self { elements, stations: Vec::with_capacity(count), length, gap: Pose::default() };
        let end = line.lay(start, count);
        let closing = angle_difference(start.heading, end.heading);
        line.gap = Pose::new(start.x - end.x, start.y - end.y, closing);
        let gap = line.gap;
        for (i, station) in line.stations.iter_mut().enumerate() {
            let share = i as f64 / count as f64;
            let pose = &mut station.pose;
            let heading = normalize_angle(pose.heading + share * gap.heading);
            *pose = Pose::new(pose.x + share * gap.x, pose.y + share * gap.y, heading);
        }
        line
    }

    /// The same line in another size.
    pub(super) fn scaled(&self, factor: f64) -> Self {
        let start = self.stations.first().map_or(Pose::default(), |station| station.pose);
        let elements = self.elements.iter().map(|element| Element {
            length: element.length * factor,
            curvature: element.curvature.map(|bend| bend / factor),
        });
        Self::new(Pose::new(start.x * factor, start.y * factor, start.heading), elements.collect())
    }

    /// Lays the stations as the elements say. Returns the pose at the end.
    fn lay(&mut self, start: Pose, count: usize) -> Pose {
        let piece = self.length / count.max(1) as f64;
        let mut next = 0;
        let (mut pose, mut begun) = (start, 0.0);
        for element in &self.elements {
            let (mut place, mut along) = (pose.position(), 0.0);
            while next < count && piece * next as f64 <= begun + element.length {
                let due = piece * next as f64 - begun;
                place += element.chord(pose.heading, along, due - along);
                along = due;
                let heading = normalize_angle(pose.heading + element.turned(along));
                let pose = Pose::new(place.x, place.y, heading);
                self.stations.push(Station { pose, curvature: element.curvature_at(along) });
                next += 1;
            }
            place += element.chord(pose.heading, along, element.length - along);
            pose = Pose::new(place.x, place.y, pose.heading + element.turned(element.length));
            begun += element.length;
        }
        pose
    }

    /// Metres around.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Its elements.
    pub fn elements(&self) -> &[Element] {
        &self.elements
    }

    /// Its stations, evenly spaced, at most 20 mm apart.
    pub fn stations(&self) -> &[Station] {
        &self.stations
    }

    /// What was missing from the end of the last element to the beginning of the first: metres along x and y, and radians.
    pub fn gap(&self) -> Pose {
        self.gap
    }

    /// The place some metres along it, any number of times around.
    pub fn at(&self, along: f64) -> Station {
        let count = self.stations.len();
        let place = along.rem_euclid(self.length) / self.length * count as f64;
        let index = (place as usize).min(count - 1);
        let share = place - index as f64;
        let (a, b) = (self.stations[index], self.stations[(index + 1) % count]);
        let between = |a: f64, b: f64| a + share * (b - a);
        let turn = angle_difference(b.pose.heading, a.pose.heading);
        let heading = normalize_angle(a.pose.heading + share * turn);
        Station {
            pose: Pose::new(between(a.pose.x, b.pose.x), between(a.pose.y, b.pose.y), heading),
            curvature: between(a.curvature, b.curvature),
        }
    }

    /// The point some metres along it and some to its left.
    pub fn beside(&self, along: f64, left: f64) -> Point {
        self.at(along).pose.to_world(Point::new(0.0, left))
    }

    /// Metres along it, and to its left, of a point: at the nearest place within `window` metres of `near`, or on the whole
    /// line without it.
    pub fn locate(&self, point: Point, near: Option<(f64, f64)>) -> (f64, f64) {
        let count = self.stations.len();
        let piece = self.length / count as f64;
        let (first, number) = match near {
            Some((near, window)) if 2.0 * window < self.length => {
                let first = ((near - window).rem_euclid(self.length) / piece) as usize;
                (first, (2.0 * window / piece).ceil() as usize + 1)
            }
            _ => (0, count),
        };
        let away = |index: usize| (self.stations[index % count].pose.position() - point).norm_squared();
        let nearest =
            (first..first + number).min_by(|&a, &b| away(a).total_cmp(&away(b))).unwrap_or(0) % count;
        let own = self.stations[nearest].pose.to_local(point);
        // On a circle, the angle to the foot is that of the point about the centre.
        let bend = 1.0 - own.y * self.stations[nearest].curvature;
        let along = (piece * nearest as f64 + math::atan(own.x / bend.max(0.2))).rem_euclid(self.length);
        (along, self.at(along).pose.to_local(point).y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn oval() -> Alignment {
        let bend = [
            Element::clothoid(0.8, 0.0, 1.0 / 1.5),
            Element::arc(1.5, PI - 0.8 / 1.5),
            Element::clothoid(0.8, 1.0 / 1.5, 0.0),
        ];
        let side = [Element::straight(2.0)];
        Alignment::new(Pose::new(3.0, 1.0, 0.0), [&side[..], &bend, &side, &bend].concat())
    }

    #[test]
    fn clothoids_and_arcs_close_where_geometry_says() {
        let gap = oval().gap();
        assert!(math::hypot(gap.x, gap.y) < 1e-6 && gap.heading.abs() < 1e-9, "{gap:?}");
        let end = Element::arc(2.0, -PI / 2.0).end();
        assert!((end.x - 2.0).abs() < 1e-7 && (end.y + 2.0).abs() < 1e-7, "{end:?}");
    }

    #[test]
    fn places_are_found_again() {
        let line = oval();
        for i in 0..200 {
            let (along, left) = (0.07 * f64::from(i) % line.length(), 0.01 * f64::from(i % 60) - 0.3);
            let point = line.beside(along, left);
            for near in [None, Some((along + 0.1, 0.5))] {
                let (found, aside) = line.locate(point, near);
                let error = (found - along).abs();
                let error = error.min(line.length() - error);
                assert!(error < 2e-3 && (aside - left).abs() < 1e-4, "{along} {left}: {found} {aside}");
            }
        }
    }

    #[test]
    fn what_is_missing_is_spread_evenly() {
        let arc = Element::arc(1.0, PI - 0.01);
        let line = Alignment::new(Pose::default(), vec![arc, arc]);
        assert!((line.gap().heading - 0.02).abs() < 1e-9);
        let (first, last) = (line.stations()[0].pose, line.stations().last().unwrap().pose);
        assert!((first.position() - last.position()).norm() < 0.025);
    }
}
