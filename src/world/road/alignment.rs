use crate::geometry::{Point, Pose, Vector, angle_difference, direction, math, normalize_angle};

/// A part of a road's centre line with linearly varying curvature.
///
/// ```
/// use roverlab::world::road::Element;
/// let quarter = Element::arc(1.5, std::f64::consts::FRAC_PI_2);
/// assert!((quarter.length - 2.356).abs() < 1e-3 && quarter.curvature == [1.0 / 1.5; 2]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Element {
    /// Length (m).
    pub length: f64,
    /// Curvature at its beginning and end, positive to the left (1/m).
    pub curvature: [f64; 2],
}

impl Element {
    /// A straight of a length (m).
    pub fn straight(length: f64) -> Self {
        Self { length, curvature: [0.0; 2] }
    }

    /// An arc with a radius (m) and an angle (rad), positive to the left.
    pub fn arc(radius: f64, angle: f64) -> Self {
        Self { length: radius * angle.abs(), curvature: [1.0_f64.copysign(angle) / radius; 2] }
    }

    /// A clothoid of a length (m) between two curvatures.
    pub fn clothoid(length: f64, from: f64, to: f64) -> Self {
        Self { length, curvature: [from, to] }
    }

    fn curvature_at(&self, along: f64) -> f64 {
        let [from, to] = self.curvature;
        if self.length > 0.0 { from + (to - from) * along / self.length } else { from }
    }

    /// Change of heading since its beginning.
    fn turned(&self, along: f64) -> f64 {
        0.5 * along * (self.curvature[0] + self.curvature_at(along))
    }

    /// Pose of its end relative to its beginning.
    pub(super) fn end(&self) -> Pose {
        let pieces = (self.length / STEP).ceil().max(1.0) as usize;
        let piece = self.length / pieces as f64;
        (0..pieces).fold(Pose::default(), |pose, i| {
            let place = pose.position() + self.chord(0.0, piece * i as f64, piece);
            Pose::new(place.x, place.y, self.turned(piece * (i + 1) as f64))
        })
    }

    /// Displacement over a short piece, by Simpson's rule.
    fn chord(&self, heading: f64, from: f64, piece: f64) -> Vector {
        let at = |share: f64| direction(heading + self.turned(from + share * piece));
        (at(0.0) + at(0.5) * 4.0 + at(1.0)) * (piece / 6.0)
    }
}

/// A point on a line: pose and curvature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AlignmentStation {
    /// Position and direction of the line.
    pub pose: Pose,
    /// Curvature, positive to the left (1/m).
    pub curvature: f64,
}

/// Centre line of a road: a closed chain of [elements](Element), parametrised by length.
#[derive(Debug, Clone, PartialEq)]
pub struct Alignment {
    elements: Vec<Element>,
    /// Evenly spaced; the first one follows the last one.
    stations: Vec<AlignmentStation>,
    length: f64,
    gap: Pose,
}

/// Length above which a line has no stations (m).
const LONGEST: f64 = 1e5;
/// Largest distance between stations (m).
const STEP: f64 = 0.02;

impl Alignment {
    /// The chain of some elements from a start pose. The closing error is spread evenly over it; see
    /// [`gap`](Alignment::gap). Without elements, with elements of zero length, or above 100 km, the line has no
    /// stations.
    pub fn new(start: Pose, elements: Vec<Element>) -> Self {
        let length: f64 = elements.iter().map(|element| element.length).sum();
        let count = if length <= LONGEST { (length / STEP).ceil() as usize } else { 0 };
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

    /// The same line at a different scale.
    pub(super) fn scaled(&self, factor: f64) -> Self {
        let start = self.stations.first().map_or(Pose::default(), |station| station.pose);
        let elements = self.elements.iter().map(|element| Element {
            length: element.length * factor,
            curvature: element.curvature.map(|bend| bend / factor),
        });
        Self::new(Pose::new(start.x * factor, start.y * factor, start.heading), elements.collect())
    }

    /// Computes the stations from the elements. Returns the pose at the end.
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
                self.stations.push(AlignmentStation { pose, curvature: element.curvature_at(along) });
                next += 1;
            }
            place += element.chord(pose.heading, along, element.length - along);
            pose = Pose::new(place.x, place.y, pose.heading + element.turned(element.length));
            begun += element.length;
        }
        pose
    }

    /// Total length (m).
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Its elements.
    pub fn elements(&self) -> &[Element] {
        &self.elements
    }

    /// Its stations, evenly spaced by at most 20 mm.
    pub fn stations(&self) -> &[AlignmentStation] {
        &self.stations
    }

    /// Closing error between the end of the last element and the beginning of the first: metres along x and
    /// y, and radians.
    pub fn gap(&self) -> Pose {
        self.gap
    }

    /// The station at a distance along it (m), over any number of rounds; the origin on a line without stations.
    pub fn at(&self, along: f64) -> AlignmentStation {
        let count = self.stations.len();
        if count == 0 {
            return AlignmentStation { pose: Pose::default(), curvature: 0.0 };
        }
        let place = along.rem_euclid(self.length) / self.length * count as f64;
        let index = (place as usize).min(count - 1);
        let share = place - index as f64;
        let (a, b) = (self.stations[index], self.stations[(index + 1) % count]);
        let between = |a: f64, b: f64| a + share * (b - a);
        let turn = angle_difference(b.pose.heading, a.pose.heading);
        let heading = normalize_angle(a.pose.heading + share * turn);
        AlignmentStation {
            pose: Pose::new(between(a.pose.x, b.pose.x), between(a.pose.y, b.pose.y), heading),
            curvature: between(a.curvature, b.curvature),
        }
    }

    /// The point at a distance along it and to its left (m).
    pub fn beside(&self, along: f64, left: f64) -> Point {
        self.at(along).pose.to_world(Point::new(0.0, left))
    }

    /// Distance of a point along the line and to its left (m), at the nearest station within `window` metres
    /// of `near`, or on the whole line without `near`.
    pub fn locate(&self, point: Point, near: Option<(f64, f64)>) -> (f64, f64) {
        let count = self.stations.len();
        if count == 0 {
            return (0.0, 0.0);
        }
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
