use crate::geometry::{Point, Pose, Vector, angle_difference, math};

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

/// Where to head, and how fast to move.
#[derive(Debug, Clone, Copy)]
pub(super) struct Guided {
    /// Radians.
    pub(super) heading: f64,
    /// Metres per second.
    pub(super) speed: f64,
}

/// The share of the speed at which a waypoint is passed, and the seconds in which it is slowed to.
const PASSING: f64 = 0.3;
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

    /// Takes notice of where the craft is. Returns whether it has reached a waypoint.
    pub(super) fn pass(&mut self, place: Point) -> bool {
        let before = self.next;
        while !self.is_over() && (place - self.points[self.next]).norm() < self.reached {
            (self.next, self.offset) = (self.next + 1, 0.0);
        }
        self.next > before
    }

    /// How to move on along the leg, `seconds` after the step before. The course must not be over.
    pub(super) fn guide(&mut self, pose: &Pose, seconds: f64) -> Guided {
        let (from, to) = (self.points[self.next - 1], self.points[self.next]);
        let leg = to - from;
        let along = leg.try_normalize(1e-9).unwrap_or_else(Vector::x);
        let left = (pose.position() - from).dot(&Vector::new(-along.y, along.x));
        let direct = to - pose.position();
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
        let off = angle_difference(heading, pose.heading);
        Guided { heading, speed: self.speed.min(slow) * math::cos(off).max(0.0) }
    }
}
