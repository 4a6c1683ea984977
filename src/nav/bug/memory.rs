use super::body::{Body, GoalView};
use super::family::family;
use super::leave_rule::{LeaveRule, Nearer, OnMainLine};
use super::strategy::{Decision, Place, Sight, Strategy};
use crate::nav::boundary::WallSide;

family! {
    /// Alg1: Bug2 with a memory of its hit and leave points (A. Sankaranarayanan and M. Vidyasagar, "A new path planning
    /// algorithm for moving a point object amidst unknown obstacles in a plane", IEEE International Conference on Robotics
    /// and Automation, 1990).
    ///
    /// The robot leaves an obstacle where it meets the straight line from start to goal, nearer to the goal than it has ever
    /// been on that line, with the way along it open. If it comes to a hit or leave point of before while it follows a
    /// boundary, it returns to the present hit point and follows the boundary the other way; once for each hit point. Back
    /// at the hit point without having left, it knows that there is no way.
    ///
    /// # Guarantee
    ///
    /// Complete, and no part of a boundary is followed for a third time in the same sense, as [`Bug2`](super::Bug2) may do
    /// in a maze.
    ///
    /// # Model
    ///
    /// As for [`Bug2`](super::Bug2), whose M-line it is. A point is met again where both the place and the direction of the
    /// wall are those of before, which tells the two sides of a thin wall apart.
    Alg1, "Alg1", Remembering<OnMainLine<true>, false>, PathBound::Unknown
}

family! {
    /// Alg2: leaves as [`Class1`](super::Class1) does, with a memory of hit and leave points (A. Sankaranarayanan and
    /// M. Vidyasagar, "Path planning for moving a point object amidst unknown obstacles in a plane: a new algorithm and a
    /// general theory for algorithm development", IEEE Conference on Decision and Control, 1990).
    ///
    /// The robot leaves an obstacle as soon as it can move towards the goal and is nearer to it than ever before. If it comes
    /// to a hit or leave point of before while it follows a boundary, it returns to the present hit point and follows the
    /// boundary the other way; once for each hit point. Back at the hit point without having left, it knows that there is
    /// no way.
    ///
    /// # Guarantee
    ///
    /// Complete. See [`Alg1`] for the model.
    Alg2, "Alg2", Remembering<Nearer<true>, false>, PathBound::Unknown
}

family! {
    /// Rev1: [`Alg1`] that follows obstacles on alternate sides (Y. Horiuchi and H. Noborio, "Evaluation of path length made
    /// in sensor-based path-planning with the alternative following", IEEE International Conference on Robotics and
    /// Automation, 2001).
    ///
    /// At every hit point it takes the other side than it followed last, so that it does not run round a maze the same way
    /// for ever.
    ///
    /// # Guarantee
    ///
    /// Complete, as Alg1 is, for which either side is as good.
    Rev1, "Rev1", Remembering<OnMainLine<true>, true>, PathBound::Unknown
}

family! {
    /// Rev2: [`Alg2`] that follows obstacles on alternate sides (Y. Horiuchi and H. Noborio, "Evaluation of path length made
    /// in sensor-based path-planning with the alternative following", IEEE International Conference on Robotics and
    /// Automation, 2001).
    ///
    /// At every hit point it takes the other side than it followed last.
    ///
    /// # Guarantee
    ///
    /// Complete, as Alg2 is, for which either side is as good.
    Rev2, "Rev2", Remembering<Nearer<true>, true>, PathBound::Unknown
}

/// Follows until a rule allows to leave, turns back once at a point that it remembers, and with `ALTERNATING` takes the
/// other side at every obstacle.
#[derive(Debug, Clone, Default)]
pub(super) struct Remembering<R, const ALTERNATING: bool> {
    rule: R,
    /// Hit and leave points of before.
    remembered: Vec<Remembered>,
    hit: Option<Place>,
    /// The side that was followed last.
    side: Option<WallSide>,
    course: Course,
}

#[derive(Debug, Clone, Copy)]
struct Remembered {
    place: Place,
    /// Whether the robot has been away from it since the present hit point, so that meeting it is news.
    left_behind: bool,
}

/// How the present obstacle is being followed.
#[derive(Debug, Clone, Copy, Default)]
enum Course {
    /// The first way.
    #[default]
    First,
    /// Back to the hit point, so many metres, since so many.
    Back { length: f64, from: f64 },
    /// The other way.
    Other,
}

/// How near, in robot radii, a remembered place is met, and how far away it is left behind.
const MEETING: f64 = 1.0;
const AWAY: f64 = 2.5;
/// The same for the hit point on the way back: it lies before the boundary rather than on its way.
const HIT_POINT: f64 = 1.5;
/// The parts of the way back after which the hit point can be met, and after which it has been missed.
const EARLIEST: f64 = 0.6;
const LATEST: f64 = 1.4;

impl<R, const ALTERNATING: bool> Remembering<R, ALTERNATING> {
    /// Whether the robot meets a place that it remembers.
    fn meets_remembered(&mut self, sight: &Sight) -> bool {
        let mut met = false;
        for remembered in &mut self.remembered {
            let distance = (remembered.place.point - sight.place.point).norm();
            remembered.left_behind |= distance > AWAY * sight.radius;
            let here = sight.in_line && remembered.place.is(&sight.place, MEETING * sight.radius);
            met |= remembered.left_behind && here;
        }
        met
    }

    /// Whether the way back of a length has come to the hit point.
    fn is_back(&self, sight: &Sight, length: f64, from: f64) -> bool {
        let way = sight.travelled - from;
        let here = self.hit.is_none_or(|hit| hit.is(&sight.place, HIT_POINT * sight.radius));
        way >= EARLIEST * length && here || way > LATEST * length + sight.radius
    }

    fn remember(&mut self, place: Place) {
        self.remembered.push(Remembered { place, left_behind: false });
    }
}

impl<R: LeaveRule, const ALTERNATING: bool> Strategy for Remembering<R, ALTERNATING> {
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

    fn consider(&mut self, body: &Body, sight: &Sight) -> Decision {
        self.side = Some(sight.side);
        let allowed = self.rule.allows(body.goal, sight);
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
