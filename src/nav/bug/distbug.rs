use super::algorithm::{Bug, bug_algorithm};
use super::body::Body;
use super::doubt::Doubt;
use super::progress::LapRule;
use super::report::{BugEvent, BugPhase};
use super::strategy::{Decision, Sight, Strategy};
use crate::geometry::{Point, Pose};

bug_algorithm! {
    /// DistBug: to a goal among unknown obstacles, with a proof when no way exists (book, sections 10.1 and
    /// 10.2; I. Kamon and E. Rivlin, "Sensory-based motion planning with global proofs", IEEE Transactions on
    /// Robotics and Automation 13(6), 1997).
    ///
    /// The robot drives straight towards the goal until an obstacle blocks it: the *hit point*. It then
    /// follows the obstacle's boundary and records the boundary's smallest distance to the goal, `d_min`. As
    /// soon as `d - F <= d_min - STEP`, where `d` is the distance to the goal and `F` the free range towards
    /// it, it leaves: the *leave point*. Back at the hit point without having left, it reports that the goal
    /// cannot be reached.
    ///
    /// # Model
    ///
    /// The robot is a disc; boundaries are those of obstacles inflated by its radius plus the least
    /// clearance. So the proof holds for a robot of that size: a passage narrower than `2 (radius + least
    /// clearance)` counts as closed. A passage between that width and one and a half robot widths may be open
    /// from one side and closed from the other, depending on how beams hit its edges; with such passages a
    /// verdict may be wrong. `F` is the distance that the whole disc can move towards the goal. `d_min`
    /// starts at the point where the disc would touch the obstacle, so that the clearance does not affect the
    /// comparison. A way that ends within a few margins at the followed obstacle itself, as in a corner, is
    /// not a leave point: its end is one more point of the boundary.
    ///
    /// # Failure modes
    ///
    /// Odometry errors shift the goal and can hide the return to the hit point; with
    /// [`match_scans`](super::BugParameters::match_scans) the scans themselves correct the poses.
    DistBug, "DistBug", DistRule, PathBound::Unknown
}

/// Leaves as soon as the free range leads nearer to the goal than the boundary has been.
#[derive(Debug, Clone)]
pub(super) struct DistRule {
    /// `d_min`: smallest distance of a boundary to the goal (m).
    least_distance: f64,
    doubt: Doubt,
}

impl Default for DistRule {
    fn default() -> Self {
        Self { least_distance: f64::INFINITY, doubt: Doubt::default() }
    }
}

impl Strategy for DistRule {
    /// The robot turns to the nearer side, which leads past.
    fn slows_to_pass(&self) -> bool {
        false
    }

    /// Free ranges show the way out of a spiral before the robot has unwound.
    fn laps(&self) -> LapRule {
        LapRule { lost_turns: 2.0 }
    }

    /// Records how near to the goal the boundary of a new obstacle begins. If the last leave did not bring
    /// the robot as much nearer as predicted, free ranges are trusted less; this prevents endless shuttling.
    fn meet(&mut self, meeting: &Sight) {
        let distance = meeting.distance - meeting.free;
        if distance > self.least_distance - 0.5 * meeting.step && self.least_distance.is_finite() {
            self.doubt.grow(meeting.place.point);
        }
        self.least_distance = self.least_distance.min(distance);
    }

    fn consider(&mut self, _body: &Body, sight: &Sight) -> Decision {
        self.least_distance = self.least_distance.min(sight.corner_distance());
        if !sight.is_open() {
            return Decision::Follow;
        }
        let promising = sight.distance - self.doubt.trusted(sight) <= self.least_distance - sight.step;
        if promising { Decision::Leave } else { Decision::Follow }
    }
}

impl DistBug {
    /// Current phase.
    pub fn phase(&self) -> BugPhase {
        Bug::phase(self)
    }

    /// Estimated pose relative to the start.
    pub fn pose(&self) -> Pose {
        Bug::pose(self)
    }

    /// Estimated distance to the goal (m).
    pub fn goal_distance(&self) -> f64 {
        Bug::goal_distance(self)
    }

    /// Noise-filtered points of the current scan, in the robot's frame.
    pub fn visible_points(&self) -> &[Point] {
        Bug::visible_points(self)
    }

    /// Takes the events since the last call.
    pub fn take_events(&mut self) -> Vec<BugEvent> {
        Bug::take_events(self)
    }
}
