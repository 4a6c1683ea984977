use super::algorithm::{Bug, bug_algorithm};
use super::body::Body;
use super::doubt::Doubt;
use super::progress::LapRule;
use super::report::{BugEvent, BugPhase};
use super::strategy::{Decision, Sight, Strategy};
use crate::geometry::{Point, Pose};

bug_algorithm! {
    /// DistBug: to a goal through unknown obstacles, with a proof when there is no way (book, sections 10.1 and 10.2;
    /// I. Kamon and E. Rivlin, "Sensory-based motion planning with global proofs", IEEE Transactions on Robotics and
    /// Automation 13(6), 1997).
    ///
    /// The robot drives straight at the goal until something is in the way: the *hit point*. It then follows the
    /// obstacle's boundary and keeps the smallest distance `d_min` that the boundary has had to the goal. As soon as
    /// `d - F <= d_min - STEP`, where `d` is the distance to the goal and `F` the free range towards it, it leaves: the
    /// *leave point*. Back at the hit point without having left, it knows that the goal cannot be reached.
    ///
    /// # Model
    ///
    /// The robot is a disc; an obstacle grown by its radius and the least clearance is what the boundary is of. So the
    /// proof holds for a robot of that size: a passage narrower than `2 (radius + least clearance)` counts as closed.
    /// One between that and one and a half robot widths may be open from one side and closed from the other, as beams see its
    /// edges: where there are such, a verdict may be wrong.
    /// `F` is the distance that the whole disc can move towards the goal, and `d_min` starts at the place where the
    /// disc would have touched the obstacle, so that the margins kept from obstacles do not enter the
    /// comparison. A way that ends within a few margins at the followed obstacle itself, as in a corner, is
    /// no place to leave: its end is one more point of the boundary.
    ///
    /// # Failure modes
    ///
    /// Odometry errors move the goal and can hide that the robot has come back to its hit point; with
    /// [`match_scans`](super::BugParameters::match_scans) poses are corrected by the scans themselves.
    DistBug, "DistBug", DistRule, PathBound::Unknown
}

/// Leaves as soon as free range promises to get nearer than the boundary has been.
#[derive(Debug, Clone)]
pub(super) struct DistRule {
    /// `d_min`: the smallest distance to the goal that a boundary has had.
    least_distance: f64,
    doubt: Doubt,
}

impl Default for DistRule {
    fn default() -> Self {
        Self { least_distance: f64::INFINITY, doubt: Doubt::default() }
    }
}

impl Strategy for DistRule {
    /// It turns the nearer way, which leads past.
    fn slows_to_pass(&self) -> bool {
        false
    }

    /// By its free ranges it knows the last piece of a boundary beforehand.
    fn laps(&self) -> LapRule {
        LapRule { lost_turns: 2.0, to_the_end: false }
    }

    /// Takes in how near to the goal the boundary of a new obstacle begins. If the last leave has not brought the
    /// robot as much nearer as it promised, free ranges are relied upon less from now on; so the robot cannot go back
    /// and forth for ever because of errors.
    fn meet(&mut self, meeting: &Sight) {
        let distance = meeting.distance - meeting.free;
        if distance > self.least_distance - 0.5 * meeting.step && self.least_distance.is_finite() {
            self.doubt.grow();
        }
        self.least_distance = self.least_distance.min(distance);
    }

    fn consider(&mut self, _body: &Body, sight: &Sight) -> Decision {
        self.least_distance = self.least_distance.min(sight.corner_distance());
        if !sight.is_open() {
            return Decision::Follow;
        }
        let free = sight.free.min(sight.distance) * self.doubt.trust();
        let promising = sight.distance - free <= self.least_distance - sight.step;
        if promising { Decision::Leave } else { Decision::Follow }
    }
}

impl DistBug {
    /// What the robot is doing.
    pub fn phase(&self) -> BugPhase {
        Bug::phase(self)
    }

    /// Where the robot takes itself to be, relative to its start.
    pub fn pose(&self) -> Pose {
        Bug::pose(self)
    }

    /// The distance to the goal that the robot takes itself to have.
    pub fn goal_distance(&self) -> f64 {
        Bug::goal_distance(self)
    }

    /// What it sees at the moment: the noise-filtered hits of the scan in the robot's frame.
    pub fn visible_points(&self) -> &[Point] {
        Bug::visible_points(self)
    }

    /// Takes the events that have happened since the last call.
    pub fn take_events(&mut self) -> Vec<BugEvent> {
        Bug::take_events(self)
    }
}
