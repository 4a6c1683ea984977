use super::spline::{Hermite, catmull_rom};
use crate::geometry::units::NEGLIGIBLE;
use crate::geometry::{Point, Pose, angle_difference, math, normalize_angle};
use crate::io::reading::pose_in_words;
use crate::io::{Error, Result};
use crate::kinematics::{Displacement, advance};

/// A point of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathPoint {
    /// Position, and direction of the path.
    pub pose: Pose,
    /// Curvature (1/m), positive to the left.
    pub curvature: f64,
    /// Distance from the start of the path (m).
    pub distance: f64,
}

/// A point to pass, with an optional direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Waypoint {
    /// Position.
    pub position: Point,
    /// Direction of travel (rad); `None` lets the chain choose.
    pub heading: Option<f64>,
}

/// A path for a robot: densely sampled points with direction and curvature.
///
/// ```
/// use roverlab::drive::Path;
/// use roverlab::geometry::{Point, Pose};
/// let path = Path::arc(Pose::default(), Point::new(1.0, 1.0))?;
/// // A quarter of a circle.
/// assert!((path.length() - std::f64::consts::FRAC_PI_2).abs() < 1e-9);
/// assert!((path.at(0.3).curvature - 1.0).abs() < 1e-9);
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Path {
    points: Vec<PathPoint>,
}

/// Distance between points of a path (m).
pub(super) const SPACING: f64 = 0.005;
/// Maximum length of a path (m): longer ones come from wrong numbers.
const LONGEST: f64 = 10_000.0;

impl Path {
    /// A path of arcs from `start`, each given by length (m) and curvature (1/m). Fails for a length that is
    /// not positive and for more than 10 km in all.
    pub fn of_arcs(start: Pose, pieces: &[(f64, f64)]) -> Result<Self> {
        check_pose("start", start)?;
        let mut points = Vec::new();
        let (mut begin, mut distance) = (start, 0.0);
        for &(length, curvature) in pieces {
            if !(length > 0.0 && curvature.is_finite() && distance + length <= LONGEST) {
                let found = format!("{length} m long with a curvature of {curvature} per metre");
                return Err(Error::invalid_input(
                    "piece of a path",
                    found,
                    "a length above 0, at most 10 km in all",
                ));
            }
            let steps = (length / SPACING).ceil().max(1.0);
            for step in 0..=steps as usize {
                let along = length * step as f64 / steps;
                let motion = Displacement { length: along, angle: along * curvature };
                points.push(PathPoint {
                    pose: advance(begin, motion),
                    curvature,
                    distance: distance + along,
                });
            }
            begin = advance(begin, Displacement { length, angle: length * curvature });
            distance += length;
        }
        Self::checked(points)
    }

    /// The straight line between two points. Fails if they coincide or are too far apart.
    pub fn straight(start: Point, goal: Point) -> Result<Self> {
        let along = goal - start;
        check_apart(start, goal)?;
        let heading = math::atan2(along.y, along.x);
        Self::of_arcs(Pose::new(start.x, start.y, heading), &[(along.norm(), 0.0)])
    }

    /// The single arc that leaves a pose forward and ends at a point (book, section 3.4). A point behind
    /// needs more than a half turn. Fails for a point straight behind.
    pub fn arc(start: Pose, goal: Point) -> Result<Self> {
        check_apart(start.position(), goal)?;
        let local = start.to_local(goal);
        let chord = local.coords.norm();
        let half = math::atan2(local.y, local.x);
        let curvature = 2.0 * local.y / (chord * chord);
        if half.abs() < 1e-9 {
            return Self::of_arcs(start, &[(chord, 0.0)]);
        }
        let length = 2.0 * half / curvature;
        if length.is_nan() || length > LONGEST {
            return Err(Error::invalid_input("goal", "straight behind", "a point that one arc can reach"));
        }
        Self::of_arcs(start, &[(length, curvature)])
    }

    /// The Hermite spline between two poses (book, section 3.6). `scale` is the book's k: tangent length as a
    /// multiple of the distance.
    ///
    /// # Errors
    ///
    /// If a pose is not finite, both are in one place, or the scale is not more than 0 and at most 100.
    pub fn hermite(start: Pose, goal: Pose, scale: f64) -> Result<Self> {
        check_pose("start", start)?;
        check_pose("goal", goal)?;
        check_apart(start.position(), goal.position())?;
        if !(scale > 0.0 && scale <= 100.0) {
            return Err(Error::invalid_input("spline scale", scale, "more than 0 and at most 100"));
        }
        Self::of_splines(&[Hermite::between(start, goal, scale)])
    }

    /// A smooth path through waypoints: a centripetal Catmull-Rom chain that keeps the given directions and
    /// chooses the others. It has no kinks. Fails for fewer than two waypoints.
    pub fn through(waypoints: &[Waypoint]) -> Result<Self> {
        if waypoints.len() < 2 {
            return Err(Error::invalid_input("number of waypoints", waypoints.len(), "at least 2"));
        }
        for waypoint in waypoints {
            let Waypoint { position, heading } = *waypoint;
            check_pose("waypoint", Pose::new(position.x, position.y, heading.unwrap_or(0.0)))?;
        }
        waypoints.windows(2).try_for_each(|pair| check_apart(pair[0].position, pair[1].position))?;
        let points: Vec<_> = waypoints.iter().map(|waypoint| (waypoint.position, waypoint.heading)).collect();
        Self::of_splines(&catmull_rom(&points))
    }

    fn of_splines(splines: &[Hermite]) -> Result<Self> {
        let mut points: Vec<PathPoint> = Vec::new();
        for spline in splines {
            // The control polygon is at least as long as the curve.
            let [a, b] = spline.ends;
            let [m, n] = spline.tangents.map(|tangent| tangent / 3.0);
            let bound = m.norm() + ((b - n) - (a + m)).norm() + n.norm();
            if bound.is_nan() || bound > LONGEST {
                return Err(Error::invalid_input("path", format!("{bound} m long"), "at most 10 km"));
            }
            let steps = (2.0 * bound / SPACING).ceil().max(8.0) as usize;
            for step in 0..=steps {
                let u = step as f64 / steps as f64;
                let position = spline.point(u);
                let last =
                    points.last().map_or((0.0, position), |last| (last.distance, last.pose.position()));
                points.push(PathPoint {
                    pose: Pose::new(position.x, position.y, spline.heading(u)),
                    curvature: spline.curvature(u),
                    distance: last.0 + (position - last.1).norm(),
                });
            }
        }
        Self::checked(points)
    }

    fn checked(points: Vec<PathPoint>) -> Result<Self> {
        let finite = |point: &PathPoint| point.pose.is_finite() && point.distance.is_finite();
        if points.is_empty() || !points.iter().all(finite) {
            return Err(Error::invalid_input("path", "empty or not finite", "finite points"));
        }
        Ok(Self { points })
    }

    /// Length (m).
    pub fn length(&self) -> f64 {
        self.points[self.points.len() - 1].distance
    }

    /// The sampled points, a few millimetres apart.
    pub fn points(&self) -> &[PathPoint] {
        &self.points
    }

    /// Pose at the start.
    pub fn start(&self) -> Pose {
        self.points[0].pose
    }

    /// Pose at the end.
    pub fn end(&self) -> Pose {
        self.points[self.points.len() - 1].pose
    }

    /// Maximum absolute curvature (1/m).
    pub fn max_curvature(&self) -> f64 {
        self.points.iter().map(|point| point.curvature.abs()).fold(0.0, f64::max)
    }

    /// Maximum change of direction between neighbouring points (rad); large at a cusp.
    pub fn sharpest_turn(&self) -> f64 {
        let turns =
            self.points.windows(2).map(|pair| angle_difference(pair[1].pose.heading, pair[0].pose.heading));
        turns.map(f64::abs).fold(0.0, f64::max)
    }

    /// Splits the path where its curvature jumps by more than `jump` (1/m): there a car must stop to turn its
    /// wheels.
    pub fn split_at_jumps(&self, jump: f64) -> Vec<Path> {
        let jumps = |pair: &[PathPoint]| (pair[1].curvature - pair[0].curvature).abs() > jump;
        let mut pieces = Vec::new();
        let mut begin = 0;
        for (index, pair) in self.points.windows(2).enumerate() {
            let same_place = pair[0].distance == pair[1].distance;
            if same_place && jumps(pair) {
                pieces.push(self.piece(begin, index));
                begin = index + 1;
            }
        }
        pieces.push(self.piece(begin, self.points.len() - 1));
        pieces
    }

    fn piece(&self, first: usize, last: usize) -> Path {
        let behind = self.points[first].distance;
        let points = self.points[first..=last].iter();
        Path {
            points: points.map(|point| PathPoint { distance: point.distance - behind, ..*point }).collect(),
        }
    }

    /// The point at a distance from the start (m); the path continues straight beyond both ends.
    pub fn at(&self, distance: f64) -> PathPoint {
        let (first, last) = (self.points[0], self.points[self.points.len() - 1]);
        if distance.is_nan() {
            let pose = Pose::new(distance, distance, distance);
            return PathPoint { pose, curvature: distance, distance };
        }
        if distance <= 0.0 || distance >= last.distance {
            let end = if distance <= 0.0 { first } else { last };
            let ahead = end.pose.position() + end.pose.forward() * (distance - end.distance);
            // An end keeps its curvature; the extension has none.
            let curvature = if distance == end.distance { end.curvature } else { 0.0 };
            return PathPoint { pose: Pose::new(ahead.x, ahead.y, end.pose.heading), curvature, distance };
        }
        let next = self.points.partition_point(|point| point.distance <= distance);
        let (a, b) = (self.points[next - 1], self.points[next]);
        let share = (distance - a.distance) / (b.distance - a.distance);
        let between = |a: f64, b: f64| a + share * (b - a);
        let turned = share * angle_difference(b.pose.heading, a.pose.heading);
        PathPoint {
            pose: Pose::new(
                between(a.pose.x, b.pose.x),
                between(a.pose.y, b.pose.y),
                normalize_angle(a.pose.heading + turned),
            ),
            curvature: between(a.curvature, b.curvature),
            distance,
        }
    }

    /// The distance along the path of the point nearest to `point`, among those from `from` to `to` (m).
    pub fn nearest(&self, point: Point, from: f64, to: f64) -> f64 {
        let first = self.points.partition_point(|p| p.distance < from).saturating_sub(1);
        let last = self.points.partition_point(|p| p.distance <= to).min(self.points.len() - 1);
        let last = last.max(first);
        let pieces = self.points[first..=last].windows(2).map(|pair| {
            let (a, b) = (pair[0], pair[1]);
            let along = b.pose.position() - a.pose.position();
            let squared = along.norm_squared();
            let share = if squared > 0.0 { (point - a.pose.position()).dot(&along) / squared } else { 0.0 };
            let share = share.clamp(0.0, 1.0);
            let away = (a.pose.position() + along * share - point).norm();
            (away, a.distance + share * (b.distance - a.distance))
        });
        let best = pieces.fold(None, |best: Option<(f64, f64)>, piece| match best {
            Some(best) if best.0 <= piece.0 => Some(best),
            _ => Some(piece),
        });
        best.map_or(from, |(_, distance)| distance)
    }
}

fn check_pose(name: &str, pose: Pose) -> Result<()> {
    if pose.is_finite() {
        return Ok(());
    }
    Err(Error::invalid_input(name, pose_in_words(&pose), "finite numbers"))
}

fn check_apart(a: Point, b: Point) -> Result<()> {
    let distance = (b - a).norm();
    if (NEGLIGIBLE..=LONGEST).contains(&distance) {
        return Ok(());
    }
    Err(Error::invalid_input("distance between two points of a path", distance, "0.001 mm to 10 km"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn what_is_no_distance_is_no_place() {
        let path = Path::hermite(Pose::default(), Pose::new(1.45, 0.65, 0.0), 1.0).unwrap();
        assert!(path.at(f64::NAN).pose.x.is_nan());
        assert_eq!(path.nearest(Point::new(1.0, 1.0), 1.0, 0.5), 1.0, "nothing is between");
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn arcs_end_at_their_goal(heading in -3.0..3.0f64, x in -1.0..1.0f64, y in -1.0..1.0f64) {
            let start = Pose::new(0.5, -0.5, heading);
            let goal = Point::new(x, y);
            prop_assume!(start.distance_to(goal) > 0.01 && start.bearing_to(goal).abs() < 3.1);
            let path = Path::arc(start, goal).unwrap();
            prop_assert!((path.end().position() - goal).norm() < 1e-9);
            prop_assert_eq!(path.start(), start);
        }

        #[test]
        fn the_nearest_place_is_where_the_point_was_put(share in 0.0..1.0f64, aside in -0.02..0.02f64) {
            let path = Path::hermite(Pose::default(), Pose::new(1.45, 0.65, 0.0), 1.0).unwrap();
            let distance = share * path.length();
            let place = path.at(distance).pose;
            let point = place.to_world(Point::new(0.0, aside));
            prop_assert!((path.nearest(point, 0.0, path.length()) - distance).abs() < 1e-3);
        }

        #[test]
        fn curvature_is_the_rate_of_the_heading(y in -1.0..1.0f64, heading in -1.5..1.5f64) {
            let path = Path::hermite(Pose::default(), Pose::new(1.5, y, heading), 1.2).unwrap();
            for pair in path.points().windows(2) {
                let rate = angle_difference(pair[1].pose.heading, pair[0].pose.heading);
                let length = pair[1].distance - pair[0].distance;
                let mean = 0.5 * (pair[0].curvature + pair[1].curvature);
                prop_assert!((rate - mean * length).abs() < 1e-3, "{pair:?}");
            }
        }
    }

    #[test]
    fn a_chain_takes_its_directions() {
        let waypoint = |x, y, heading| Waypoint { position: Point::new(x, y), heading };
        let chain = [waypoint(0.0, 0.0, Some(0.0)), waypoint(1.0, 0.5, None), waypoint(2.0, 0.0, Some(-1.0))];
        let path = Path::through(&chain).unwrap();
        assert!(path.start().heading == 0.0 && (path.end().heading + 1.0).abs() < 1e-12, "{:?}", path.end());
        let passed = path.at(path.nearest(chain[1].position, 0.0, path.length())).pose;
        assert!(passed.distance_to(chain[1].position) < 1e-6);
    }

    #[test]
    fn pieces_are_parts_of_the_whole() {
        let whole = Path::of_arcs(Pose::default(), &[(0.5, 2.0), (0.4, -2.0), (0.3, -1.5)]).unwrap();
        let pieces = whole.split_at_jumps(1.0);
        assert_eq!(pieces.len(), 2);
        assert!((pieces[0].length() - 0.5).abs() < 1e-12 && (pieces[1].length() - 0.7).abs() < 1e-12);
        assert_eq!((pieces[0].end(), pieces[1].end()), (pieces[1].start(), whole.end()));
        assert_eq!(whole.split_at_jumps(10.0), [whole]);
    }

    #[test]
    fn a_cusp_is_a_sharp_turn() {
        let back = Path::hermite(Pose::default(), Pose::new(-1.0, 0.0, std::f64::consts::PI), 1.0).unwrap();
        assert!(back.sharpest_turn() > 3.0);
        assert!(Path::arc(Pose::default(), Point::new(1.0, 1.0)).unwrap().sharpest_turn() < 0.01);
    }

    #[test]
    fn beyond_its_ends_it_goes_on_straight() {
        let path = Path::arc(Pose::default(), Point::new(1.0, 1.0)).unwrap();
        let beyond = path.at(path.length() + 0.5);
        assert!((beyond.pose.position() - Point::new(1.0, 1.5)).norm() < 1e-9 && beyond.curvature == 0.0);
        assert!((path.at(-0.5).pose.position() - Point::new(-0.5, 0.0)).norm() < 1e-12);
    }

    #[test]
    fn what_is_no_path_is_refused() {
        let origin = Pose::default();
        assert!(Path::arc(origin, Point::new(-1.0, 0.0)).is_err());
        assert!(Path::straight(Point::origin(), Point::origin()).is_err());
        assert!(Path::hermite(origin, Pose::new(1.0, 0.0, f64::NAN), 1.0).is_err());
        assert!(Path::hermite(origin, Pose::new(1.0, 0.0, 0.0), 0.0).is_err());
        assert!(Path::through(&[]).is_err());
        assert!(Path::of_arcs(origin, &[]).is_err());
        assert!(Path::of_arcs(origin, &[(1e9, 0.0)]).is_err());
    }
}
