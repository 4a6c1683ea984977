use super::algorithm::bug_algorithm;
use super::body::{Body, GoalView};
use super::circumnavigation::MISSED;
use super::doubt::Doubt;
use super::panorama::{Edge, Panorama};
use super::strategy::{Decision, Sight, Strategy};
use crate::geometry::WallSide;
use crate::geometry::{Point, direction, math, normalize_angle};

bug_algorithm! {
    /// TangentBug: drives towards the ends of obstacles seen from afar (I. Kamon, E. Rimon and E. Rivlin,
    /// "TangentBug: a range-sensor-based navigation algorithm", International Journal of Robotics Research
    /// 17(9), 1998).
    ///
    /// The nodes of the *local tangent graph* are the ends of the blocking obstacles, where the free range
    /// jumps, and the goal if the way to it is free. Among the nodes that bring the robot nearer to the goal,
    /// it drives to the one with the shortest way over it. If there is none, in a local minimum, it drives up
    /// to the obstacle and follows its boundary on the side of the best node. It records `d_followed`, the
    /// smallest distance of the visible boundary from the goal, and `d_reach`, the smallest distance among
    /// the places it can move straight to. As soon as `d_reach < d_followed` by STEP, it leaves for that
    /// place. All round without having left, it reports that no way exists.
    ///
    /// # Guarantee
    ///
    /// Complete: every leave brings the robot nearer to the goal than all of the earlier boundary, and the
    /// distance to the goal decreases in between.
    ///
    /// # Model
    ///
    /// As for [`DistBug`](super::DistBug): free ranges are those of the whole disc. Places count up to 33
    /// robot radii away, since walls farther off may hide between the beams. After a leave that led no nearer,
    /// a shorter part of the free range counts, and more room must be beside the way.
    TangentBug, "TangentBug", Tangent, PathBound::Unknown
}

/// Motion to the goal over the nodes of the local tangent graph, and boundary following until `d_reach <
/// d_followed`.
#[derive(Debug, Clone)]
pub(super) struct Tangent {
    panorama: Panorama,
    /// Smallest distance of the boundaries to the goal where the robot was: each leave is nearer than all
    /// before.
    passed: f64,
    /// The same for the visible part of the current boundary.
    seen: f64,
    /// Smallest `d_reach` along the current boundary.
    reach: f64,
    /// Whether seen but unvisited boundary no longer counts, as it may belong to another obstacle.
    distrustful: bool,
    doubt: Doubt,
    /// The place that the obstacle was left for, until it is reached.
    leaving_for: Option<Point>,
    /// Side of the goal's direction on which the robot passes the obstacle, as [`Edge::obstacle`].
    passing: Option<f64>,
}

/// Distance within which points count (robot radii).
const REACH: f64 = 33.0;
/// Minimum cosine between the direction to a node and that to the goal.
const LEAST_PROGRESS: f64 = 0.1;
/// Maximum length of the path over a node on the other side relative to the current one, which prevents
/// wavering.
const LOYALTY: f64 = 1.1;
/// Turn away from an edge that is as near as it may be (rad).
const YIELD: f64 = 0.5;
/// Distance up to which the ends of free ranges in neighbouring directions belong to one obstacle (robot
/// radii): the robot does not fit between them.
const LINK: f64 = 2.0;
/// Distance at which the place is reached for which an obstacle was left (robot radii).
const ARRIVAL: f64 = 0.5;

impl Default for Tangent {
    fn default() -> Self {
        Self {
            panorama: Panorama::default(),
            passed: f64::INFINITY,
            seen: f64::INFINITY,
            reach: f64::INFINITY,
            distrustful: false,
            doubt: Doubt::default(),
            leaving_for: None,
            passing: None,
        }
    }
}

impl Tangent {
    /// Length of the way over a node.
    fn length(edge: &Edge, view: &GoalView) -> f64 {
        let node = direction(edge.bearing) * edge.distance;
        edge.distance + (direction(view.bearing) * view.distance - node).norm()
    }

    /// The best node among those accepted by `pick`.
    fn best_node(&self, body: &Body, view: &GoalView, pick: impl Fn(&Edge) -> bool) -> Option<Edge> {
        let depth = MISSED * body.parameters.robot_radius;
        let weighed = |edge: &Edge| {
            let other_side = self.passing.is_some_and(|side| side != edge.obstacle);
            Self::length(edge, view) * if other_side { LOYALTY } else { 1.0 }
        };
        self.panorama.edges(depth).filter(|edge| pick(edge)).min_by(|a, b| weighed(a).total_cmp(&weighed(b)))
    }

    /// The heading to a node, past its obstacle at the wished distance.
    fn heading_to(edge: &Edge, body: &Body) -> f64 {
        let distances = body.parameters.follow_distances();
        let nearest = body.surroundings.nearest_to(Point::origin());
        let Some(nearest) = nearest.filter(|point| point.coords.norm() < distances.wished) else {
            return edge.bearing;
        };
        let towards = normalize_angle(math::atan2(nearest.y, nearest.x) - edge.bearing);
        if towards * edge.obstacle <= 0.0 {
            return edge.bearing;
        }
        let lacking = distances.wished - nearest.coords.norm();
        let most = distances.wished - body.parameters.robot_radius;
        edge.bearing - edge.obstacle * YIELD * (lacking / most).min(1.0)
    }

    /// The heading to the place that the obstacle was left for, until it is reached.
    fn leave_on(&mut self, body: &Body, view: &GoalView) -> Option<f64> {
        let place = body.pose.to_local(self.leaving_for?);
        let radius = body.parameters.robot_radius;
        let bearing = math::atan2(place.y, place.x);
        let least = body.parameters.follow_distances().least;
        let (free, _) = body.surroundings.free_distance(direction(bearing), least);
        let arrived =
            place.coords.norm() < ARRIVAL * radius || view.distance < self.passed - body.parameters.step;
        if arrived || free < place.coords.norm().min(radius) {
            self.leaving_for = None;
            return None;
        }
        Some(bearing)
    }
}

impl Strategy for Tangent {
    fn detour(&mut self, body: &Body, view: &GoalView) -> Option<f64> {
        let distances = body.parameters.follow_distances();
        if let Some(heading) = self.leave_on(body, view) {
            return Some(heading);
        }
        if view.free >= view.distance {
            self.passing = None;
            return None;
        }
        self.panorama.look(body.surroundings.points(), distances.wished);
        let nearing = |edge: &Edge| {
            let node = direction(edge.bearing) * edge.distance;
            let nearer = (direction(view.bearing) * view.distance - node).norm() < view.distance;
            nearer && math::cos(edge.bearing - view.bearing) > LEAST_PROGRESS
        };
        let node = self.best_node(body, view, nearing)?;
        let heading = Self::heading_to(&node, body);
        let (free, _) = body.surroundings.free_distance(direction(heading), distances.least);
        if free < distances.wished - body.parameters.robot_radius {
            return None;
        }
        self.passing = Some(node.obstacle);
        Some(heading)
    }

    fn side(&mut self, body: &Body, view: &GoalView) -> Option<WallSide> {
        if body.parameters.side.is_some() {
            return None;
        }
        self.panorama.look(body.surroundings.points(), body.parameters.follow_distances().wished);
        let node = self.best_node(body, view, |_| true)?;
        // An obstacle clockwise of the way past its end is on the robot's right.
        Some(if node.obstacle < 0.0 { WallSide::Right } else { WallSide::Left })
    }

    fn meet(&mut self, meeting: &Sight) {
        let distance = meeting.distance - meeting.free;
        if distance > self.passed - 0.5 * meeting.step && self.passed.is_finite() {
            // The last leave did not lead as near as predicted.
            self.doubt.grow(meeting.place.point);
        }
        let passed = self.passed.min(distance);
        let (panorama, doubt) = (std::mem::take(&mut self.panorama), std::mem::take(&mut self.doubt));
        *self = Self { panorama, passed, doubt, ..Self::default() };
    }

    fn consider(&mut self, body: &Body, sight: &Sight) -> Decision {
        self.passed = self.passed.min(sight.corner_distance());
        let distances = body.parameters.follow_distances();
        self.panorama.look(body.surroundings.points(), distances.least);
        let (pose, radius) = (body.pose, body.parameters.robot_radius);
        let goal = pose.to_local(body.goal);
        let wall = normalize_angle(sight.place.wall - pose.heading);
        let seen = self.panorama.obstacle(wall, LINK * radius).map(|end| (end - goal).norm());
        self.seen = seen.fold(self.seen, f64::min);
        // A passage through which the last way did not lead may be too narrow to steer through from afar. The
        // boundary leads through it.
        let spare = self.doubt.caution() * (distances.wished - distances.least);
        if spare > 0.0 {
            self.panorama.look(body.surroundings.points(), distances.least + spare);
        }
        let place = self.panorama.nearest_to(goal, REACH * radius, self.doubt.trust());
        let reach = (place - goal).norm();
        self.reach = self.reach.min(reach);
        let followed = if self.distrustful { self.passed } else { self.passed.min(self.seen) };
        if reach > followed - sight.step {
            return Decision::Follow;
        }
        self.leaving_for = Some(pose.to_world(place));
        Decision::Leave
    }

    fn all_round(&mut self, sight: &Sight, _lap: f64) -> Decision {
        if self.distrustful || self.reach > self.passed - sight.step {
            return Decision::GiveUp;
        }
        self.distrustful = true;
        Decision::BeginLap
    }
}
