use super::body::{Body, GoalView};
use super::leave_rule::{LeaveRule, OPEN};
use super::strategy::{Decision, Place, Sight, Strategy};
use crate::geometry::WallSide;

/// Follows the boundary until a rule allows to leave, and turns back once at a remembered point. With
/// `ALTERNATING` it takes the other side at every obstacle.
#[derive(Debug, Clone, Default)]
pub(super) struct HitPointMemory<R, const ALTERNATING: bool> {
    rule: R,
    /// Earlier hit and leave points.
    remembered: Vec<Remembered>,
    hit: Option<Place>,
    /// Side followed last.
    side: Option<WallSide>,
    course: Course,
}

#[derive(Debug, Clone, Copy)]
struct Remembered {
    place: Place,
    /// Whether the robot has been away from it since the current hit point; only then does meeting it count.
    left_behind: bool,
}

/// Stage of following the current obstacle.
#[derive(Debug, Clone, Copy, Default)]
enum Course {
    /// The first direction.
    #[default]
    First,
    /// Back to the hit point: distance, and the distance travelled at the start of the return (m).
    Back { length: f64, from: f64 },
    /// The other direction.
    Other,
}

/// The same for the hit point on the way back: it is before the boundary rather than on the path along it.
const HIT_POINT: f64 = 1.5;
/// Fraction of the way back after which the hit point can be met.
const EARLIEST: f64 = 0.6;
/// Fraction of the way back after which the hit point has been missed.
const LATEST: f64 = 1.4;

impl<R, const ALTERNATING: bool> HitPointMemory<R, ALTERNATING> {
    /// Whether the robot meets a remembered point.
    fn meets_remembered(&mut self, sight: &Sight) -> bool {
        let mut met = false;
        for remembered in &mut self.remembered {
            let distance = (remembered.place.point - sight.place.point).norm();
            remembered.left_behind |= distance > OPEN * sight.radius;
            let here = sight.in_line && remembered.place.is(&sight.place, sight.radius);
            met |= remembered.left_behind && here;
        }
        met
    }

    /// Whether a return of this length has arrived at the hit point.
    fn is_back(&self, sight: &Sight, length: f64, from: f64) -> bool {
        let way = sight.travelled - from;
        let here = self.hit.is_none_or(|hit| hit.is(&sight.place, HIT_POINT * sight.radius));
        way >= EARLIEST * length && here || way > LATEST * length + sight.radius
    }

    fn remember(&mut self, place: Place) {
        self.remembered.push(Remembered { place, left_behind: false });
    }
}

impl<R: LeaveRule, const ALTERNATING: bool> Strategy for HitPointMemory<R, ALTERNATING> {
    fn side(&mut self, _body: &Body, _view: &GoalView) -> Option<WallSide> {
        self.side.filter(|_| ALTERNATING).map(WallSide::other)
    }

    fn meet(&mut self, meeting: &Sight) {
        self.rule.meet(meeting);
        self.hit = Some(meeting.place);
        self.side = Some(meeting.side);
        self.course = Course::First;
        for remembered in &mut self.remembered {
            remembered.left_behind = false;
        }
    }

    fn consider(&mut self, _body: &Body, sight: &Sight) -> Decision {
        self.side = Some(sight.side);
        let allowed = self.rule.allows(sight);
        let met = self.meets_remembered(sight);
        if let Course::Back { length, from } = self.course {
            if self.is_back(sight, length, from) {
                self.course = Course::Other;
                return Decision::BeginLap;
            }
            return Decision::Follow;
        }
        if allowed {
            if let Some(hit) = self.hit.take() {
                self.remember(hit);
            }
            self.remember(sight.place);
            return Decision::Leave;
        }
        if met && matches!(self.course, Course::First) {
            self.course = Course::Back { length: sight.travelled, from: sight.travelled };
            return Decision::Reverse;
        }
        Decision::Follow
    }

    fn all_round(&mut self, _sight: &Sight, _lap: f64) -> Decision {
        if matches!(self.course, Course::Back { .. }) {
            self.course = Course::Other;
            return Decision::BeginLap;
        }
        Decision::GiveUp
    }
}
