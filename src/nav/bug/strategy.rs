use super::body::{Body, GoalView};
use super::progress::LapRule;
use crate::geometry::WallSide;
use crate::geometry::{Point, angle_difference};

/// What distinguishes one bug from another: when it leaves an obstacle, turns back, and gives up.
///
/// The engine drives the body accordingly. All lengths are in metres.
pub(super) trait Strategy {
    /// Whether the robot, on its way to the goal, slows down for obstacles it would pass with less than the
    /// least clearance. Required for a strategy that may turn either way there, since the robot rolls on
    /// while it turns.
    fn slows_to_pass(&self) -> bool {
        true
    }

    /// Criterion for having gone round a boundary. Along a spiral the robot turns several times before it
    /// unwinds, and the leave point may lie right before the end.
    fn laps(&self) -> LapRule {
        LapRule { lost_turns: 4.0 }
    }

    /// Another heading than straight to the goal, if the strategy has one.
    fn detour(&mut self, _body: &Body, _view: &GoalView) -> Option<f64> {
        None
    }

    /// Side on which to follow a newly met obstacle, if not the usual one.
    fn side(&mut self, _body: &Body, _view: &GoalView) -> Option<WallSide> {
        None
    }

    /// Records that an obstacle has been met and will be followed.
    fn meet(&mut self, meeting: &Sight);

    /// Decision at a step along the boundary.
    fn consider(&mut self, body: &Body, sight: &Sight) -> Decision;

    /// Decision after a complete round of a boundary of `lap` metres.
    fn all_round(&mut self, _sight: &Sight, _lap: f64) -> Decision {
        Decision::GiveUp
    }
}

/// Decision of a bug.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Decision {
    /// Keep following.
    Follow,
    /// Leave for the goal.
    Leave,
    /// Turn back and follow the other way.
    Reverse,
    /// Keep following, and start a new lap here.
    BeginLap,
    /// No way leads to the goal.
    GiveUp,
}

/// Observation behind a bug's decision.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sight {
    pub(super) place: Place,
    pub(super) side: WallSide,
    pub(super) goal: Point,
    /// Distance to the goal.
    pub(super) distance: f64,
    /// How far the disc can move towards the goal.
    pub(super) free: f64,
    /// Sine of the goal's direction relative to the wall, positive into the wall; -1 is straight away from
    /// it.
    pub(super) into_wall: f64,
    /// Whether the disc pushed towards the goal would touch the followed obstacle within its margin.
    pub(super) at_boundary: bool,
    /// Whether the robot drives along the boundary, rather than turning on the spot.
    pub(super) in_line: bool,
    /// Distance along this obstacle since it was met, back and forth.
    pub(super) travelled: f64,
    /// Distance between the path along the boundary and the boundary itself.
    pub(super) margin: f64,
    pub(super) step: f64,
    pub(super) radius: f64,
}

impl Sight {
    /// Distance of the boundary here from the goal, with the disc pushed up to it.
    pub(super) fn boundary_distance(&self) -> f64 {
        if self.at_boundary { self.distance - self.free } else { self.distance }
    }

    /// The same where the robot keeps farther away than its margin, as in an acute corner. The way must lead
    /// straight into the wall, so that this wall ends it.
    pub(super) fn corner_distance(&self) -> f64 {
        let in_corner = self.into_wall > STRAIGHT_INTO && self.free < RECESS * self.margin;
        if in_corner { self.distance - self.free } else { self.boundary_distance() }
    }

    /// Whether the followed obstacle lets the robot move towards the goal. A way that leads into a straight
    /// wall is not open.
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

/// Depth above which a recess is more than a corner of the wall (margins).
const RECESS: f64 = 2.5;
/// Sine of the angle from which a direction leads straight into the wall: a disc that moves in an arc around
/// the end of a wall still touches it.
const STRAIGHT_INTO: f64 = 0.8;

/// A recognisable point of a boundary: the robot's position and the direction of the wall. Only both together
/// distinguish the two sides of a thin wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Place {
    pub(super) point: Point,
    /// Direction of the wall in the frame of the start (rad).
    pub(super) wall: f64,
}

/// Difference of direction above which two walls are different (rad).
const SAME_WALL: f64 = 1.2;

impl Place {
    /// Whether two places are the same to within a distance.
    pub(super) fn is(&self, other: &Place, within: f64) -> bool {
        (self.point - other.point).norm() < within
            && angle_difference(self.wall, other.wall).abs() < SAME_WALL
    }
}
