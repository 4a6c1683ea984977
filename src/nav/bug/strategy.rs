use super::body::{Body, GoalView};
use super::progress::LapRule;
use crate::geometry::WallSide;
use crate::geometry::{Point, angle_difference};

/// What makes one bug differ from another: when it leaves an obstacle, when it turns back, and when it gives up.
///
/// The engine drives the body by it. All lengths are in metres.
pub(super) trait Strategy {
    /// Whether the robot slows down on its way to the goal for what it would pass with less than the least clearance.
    /// Whoever may turn either way then must, since a robot rolls on while it turns.
    fn slows_to_pass(&self) -> bool {
        true
    }

    /// When a boundary counts as gone round. Along a spiral the robot turns several times before it unwinds, and the
    /// place to leave may lie right before the end.
    fn laps(&self) -> LapRule {
        LapRule { lost_turns: 4.0, to_the_end: true }
    }

    /// While the goal is driven at: another heading than straight to it, if the algorithm has one.
    fn detour(&mut self, _body: &Body, _view: &GoalView) -> Option<f64> {
        None
    }

    /// The side on which a newly met obstacle is to be kept, if not the usual one.
    fn side(&mut self, _body: &Body, _view: &GoalView) -> Option<WallSide> {
        None
    }

    /// Takes in that an obstacle has been met, which is now going to be followed.
    fn meet(&mut self, meeting: &Sight);

    /// What to do at a step along the boundary.
    fn consider(&mut self, body: &Body, sight: &Sight) -> Decision;

    /// What to do once the robot has been all round a boundary, which is `lap` metres long.
    fn all_round(&mut self, _sight: &Sight, _lap: f64) -> Decision {
        Decision::GiveUp
    }
}

/// What a bug decides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Decision {
    /// To follow on.
    Follow,
    /// To leave for the goal.
    Leave,
    /// To turn back and follow the other way.
    Reverse,
    /// To follow on, with the count of what has been seen of this boundary begun anew.
    BeginLap,
    /// That there is no way to the goal.
    GiveUp,
}

/// What a bug decides by.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sight {
    pub(super) place: Place,
    pub(super) side: WallSide,
    /// The distance to the goal.
    pub(super) distance: f64,
    /// How far the disc can move towards the goal.
    pub(super) free: f64,
    /// The sine of the goal's direction with respect to the wall, positive into it: -1 straight away from it.
    pub(super) into_wall: f64,
    /// Whether the disc pushed towards the goal would touch the followed obstacle within its margin.
    pub(super) at_boundary: bool,
    /// Whether the robot drives along the boundary, rather than turning on the spot.
    pub(super) in_line: bool,
    /// Metres along this obstacle since it was met, back and forth.
    pub(super) travelled: f64,
    /// The room between where the boundary is followed and where it is.
    pub(super) margin: f64,
    pub(super) step: f64,
    pub(super) radius: f64,
}

impl Sight {
    /// How near the boundary here is to the goal: that of the disc pushed up to it.
    pub(super) fn boundary_distance(&self) -> f64 {
        if self.at_boundary { self.distance - self.free } else { self.distance }
    }

    /// The same for a boundary that the robot keeps farther from than its margin, as in an acute corner. The way must
    /// lead straight into the wall then, for it to be this wall that ends it.
    pub(super) fn corner_distance(&self) -> f64 {
        let in_corner = self.into_wall > STRAIGHT_INTO && self.free < RECESS * self.margin;
        if in_corner { self.distance - self.free } else { self.boundary_distance() }
    }

    /// Whether the robot can move towards the goal, as far as the followed obstacle goes: not if the way leads into a
    /// wall that goes on straight.
    pub(super) fn is_open(&self) -> bool {
        if self.free >= self.distance {
            return true;
        }
        if self.into_wall > 0.0 {
            self.free * self.into_wall >= RECESS * self.margin
        } else {
            !self.at_boundary
        }
    }
}

/// What is deeper than this, in margins, is more than a corner of the wall.
const RECESS: f64 = 2.5;
/// The sine from which on a direction leads straight into the wall: round the end of a wall, in an arc, a disc that
/// moves so still touches it.
const STRAIGHT_INTO: f64 = 0.8;

/// A point of a boundary as a robot can recognise it: where it stands, and in which direction it has the wall. Only
/// both tell the two sides of a thin wall apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    pub(super) point: Point,
    /// The direction of the wall, radians in the frame of the start.
    pub(super) wall: f64,
}

/// Walls whose directions differ by more than this are different, in radians.
const SAME_WALL: f64 = 1.2;

impl Place {
    /// Whether two places are the same to within a distance.
    pub(super) fn is(&self, other: &Place, within: f64) -> bool {
        (self.point - other.point).norm() < within
            && angle_difference(self.wall, other.wall).abs() < SAME_WALL
    }
}
