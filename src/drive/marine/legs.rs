use crate::geometry::{Point, Pose, Vector, angle_difference, direction, math};

/// Line-of-sight guidance along the legs of a course, with integral action, which takes out wind and current
/// (Fossen 2021, section 12.3).
#[derive(Debug, Clone)]
pub(super) struct Legs {
    /// Where the course begins, and its waypoints.
    points: Vec<Point>,
    /// The waypoint ahead, by its index; the number of points at the end.
    next: usize,
    /// The integral of the cross-track error (m).
    offset: f64,
    speed: f64,
    lookahead: f64,
    reached: f64,
}

/// Fraction of the speed at which a waypoint is passed.
const PASSING: f64 = 0.3;
/// Distance to a waypoint per speed above that of passing it (s).
const SLOWING: f64 = 2.5;
/// How fast the cross-track error is integrated, per second.
const INTEGRAL: f64 = 0.15;

impl Legs {
    /// A course at a speed, by steering for a place so far ahead on each leg; waypoints are reached within a
    /// distance.
    pub(super) fn new(points: Vec<Point>, speed: f64, lookahead: f64, reached: f64) -> Self {
        Self { points, next: 1, offset: 0.0, speed, lookahead, reached }
    }

    /// Index of the waypoint ahead, the start not counted; the number of waypoints at the end.
    pub(super) fn leg(&self) -> usize {
        self.next - 1
    }

    pub(super) fn is_over(&self) -> bool {
        self.next >= self.points.len()
    }

    /// The last waypoint.
    pub(super) fn end(&self) -> Point {
        self.points[self.points.len() - 1]
    }

    /// Goes on to further waypoints.
    pub(super) fn extend(&mut self, waypoints: Vec<Point>) {
        self.points.extend(waypoints);
    }

    /// Leaves the leg at a place, for another one and back. The course must not be over.
    pub(super) fn detour(&mut self, place: Point, aside: Point) {
        self.points.splice(self.next..self.next, [place, aside, place]);
    }

    /// The leg to the waypoint ahead. The course must not be over.
    pub(super) fn way(&self) -> Vector {
        self.points[self.next] - self.points[self.next - 1]
    }

    /// Takes notice of where the craft is. Returns whether it has reached a waypoint.
    pub(super) fn pass(&mut self, place: Point) -> bool {
        let before = self.next;
        while !self.is_over() && (place - self.points[self.next]).norm() < self.reached {
            (self.next, self.offset) = (self.next + 1, 0.0);
        }
        self.next > before
    }

    /// The velocity over ground by which to move on along the leg, `seconds` after the step before. The
    /// course must not be over.
    pub(super) fn guide(&mut self, place: Point, seconds: f64) -> Vector {
        let (from, to) = (self.points[self.next - 1], self.points[self.next]);
        let leg = to - from;
        let along = leg.try_normalize(1e-9).unwrap_or_else(Vector::x);
        let left = (place - from).dot(&Vector::new(-along.y, along.x));
        let direct = to - place;
        // Near its end, and beyond it, the leg is the way to the waypoint itself.
        let heading = if direct.dot(&along) < self.lookahead {
            math::atan2(direct.y, direct.x)
        } else {
            // The integral grows less the farther the craft is from the leg.
            let aim = left + self.offset;
            let square = self.lookahead * self.lookahead;
            self.offset += INTEGRAL * left * square / (square + aim * aim) * seconds;
            math::atan2(leg.y, leg.x) - math::atan2(aim, self.lookahead)
        };
        let slow = PASSING * self.speed + (direct.norm() - self.reached).max(0.0) / SLOWING;
        direction(heading) * self.speed.min(slow)
    }
}

/// How a craft that pushes only ahead comes to a velocity over ground.
#[derive(Debug, Clone, Copy)]
pub(super) struct Steered {
    /// Turn rate (rad/s).
    pub(super) turn: f64,
    /// Speed ahead (m/s): negative as long as the bow points away from the course.
    pub(super) speed: f64,
}

/// Turn rate per angle off the course (1/s).
const GAIN: f64 = 1.2;
/// Largest turn rate (rad/s).
const FASTEST: f64 = 1.0;
/// The share of the missing velocity by which a craft points beyond the wanted one: without a keel, only its
/// thrust takes out a drift aside.
const LEAD: f64 = 1.5;
/// The speed (m/s) below which there is nothing to point for.
const LITTLE: f64 = 0.03;

/// Steers a craft, which moves over ground, for another velocity.
pub(super) fn steer(pose: &Pose, moves: Vector, wanted: Vector) -> Steered {
    let (turn, ahead) = turn_towards(pose, moves, wanted);
    Steered { turn, speed: wanted.norm() * ahead }
}

/// The same beside walls. Backing moves the craft aside too, towards a wall it has just come along: so it is
/// slow.
pub(super) fn steer_beside_walls(pose: &Pose, moves: Vector, wanted: Vector) -> Steered {
    let (turn, ahead) = turn_towards(pose, moves, wanted);
    let share = if ahead < 0.0 { -ahead * ahead } else { ahead };
    Steered { turn, speed: wanted.norm() * share }
}

/// The turn rate, and the cosine of the angle off the course.
fn turn_towards(pose: &Pose, moves: Vector, wanted: Vector) -> (f64, f64) {
    let aim = wanted + (wanted - moves) * LEAD;
    let points = aim.norm() > LITTLE;
    let off = if points { angle_difference(math::atan2(aim.y, aim.x), pose.heading) } else { 0.0 };
    ((GAIN * off).clamp(-FASTEST, FASTEST), math::cos(off))
}

/// A velocity in a craft's frame as the world sees it.
pub(super) fn over_ground(pose: &Pose, velocity: Vector) -> Vector {
    pose.to_world(Point::from(velocity)) - pose.position()
}
