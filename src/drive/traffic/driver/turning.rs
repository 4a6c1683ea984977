//! Turns at crossings: the lane has no lines there, and odometry leads from one lane to the other.

use super::turn::Turn;
use super::{LINE, TrafficDriver};
use crate::drive::lane_keeping::LaneObservation;
use crate::geometry::{Point, Pose, Twist};
use crate::vision::lane_markings::LaneEstimate;
use crate::vision::road_elements::{RoadElement, RoadElementKind};

/// Distance of a crossing's middle from the origin at which the car begins (m): it stands a little nearer
/// before a line.
const BEGINS: f64 = 1.05;
/// Positions of an arrow's near edge relative to a crossing's middle (m): it ends 50 to 250 mm before the
/// line by the rules and is 500 mm long.
const ARROW: std::ops::Range<f64> = -1.6..-0.6;
/// Speed (m/s).
const SPEED: f64 = 0.45;
/// Angle below which the new lane is looked for (rad).
const SEES: f64 = 0.7;
/// Number of points of its lines that suffice.
const SUPPORT: f64 = 10.0;
/// Differences between what is seen and what odometry expects: offset (m) and heading (rad).
const AGREES: (f64, f64) = (0.15, 0.20);
/// Number of images that have to agree.
const IMAGES: u32 = 4;
/// Distance along the new lane behind the crossing at which the turn is over in any case (m).
const OVER: f64 = 1.2;

impl TrafficDriver {
    /// Begins a turn where an arrow tells to, before a crossing at which the car need not stop any more.
    pub(super) fn begin_turn(&mut self, odometry: &Pose) {
        let Some(lane) = self.keeper.lane().filter(|_| self.turn.is_none() && self.halt.is_none()) else {
            return;
        };
        let elements: Vec<RoadElement> = self.finder.elements().collect();
        let Some(middle) = self.middle(&elements, lane.edge).filter(|middle| *middle < BEGINS) else {
            return;
        };
        let arrow = elements.iter().find_map(|it| match it.kind {
            RoadElementKind::TurnArrow { left } if ARROW.contains(&(it.ahead - middle)) => Some(left),
            _ => None,
        });
        let Some(left) = arrow else { return };
        let angle = self.finder.crossing_angle();
        let turned = if left { angle } else { angle - std::f64::consts::PI };
        let here = lane.place(middle);
        let half = 0.5 * self.side * lane.edge;
        let centre = here.to_world(Point::new(0.0, half));
        let road = Pose::new(centre.x, centre.y, here.heading + turned);
        let place = road.to_world(Point::new(0.0, -half));
        let own = odometry.compose(&Pose::new(place.x, place.y, road.heading));
        let side = if left { 1.0 } else { -1.0 };
        self.turn = Some(Turn { lane: own, side, edge: lane.edge, agreed: 0 });
        self.finder.forget();
        self.released.clear();
    }

    /// Distance to the middle of the crossing ahead (m): seen, or behind the line at which the car has
    /// stopped.
    fn middle(&self, elements: &[RoadElement], edge: f64) -> Option<f64> {
        let seen = elements.iter().find(|it| {
            matches!(it.kind, RoadElementKind::Crossing { .. }) && it.ahead > self.parameters.body[0]
        });
        let behind = |place: &f64| place - self.driven + LINE + edge + 0.5 * LINE;
        seen.map(|it| it.ahead).or_else(|| self.released.last().map(behind))
    }

    /// Expects the new lane in the next image.
    pub(super) fn expect_lane(&mut self) {
        if let (Some(turn), Some(before)) = (self.turn, self.keeper.odometry()) {
            self.keeper.expect(&turn.on_lane(&before), turn.edge);
        }
    }

    /// The command in a turn, after an image with the new lane in it; `None` when the turn is over.
    pub(super) fn follow_turn(&mut self, seen: &LaneObservation, lane: &LaneEstimate) -> Option<Twist> {
        let mut turn = self.turn?;
        let car = turn.on_lane(&seen.odometry);
        let agrees = lane.support > SUPPORT
            && car.heading.abs() < SEES
            && (lane.offset - car.y).abs() < AGREES.0
            && (lane.heading - car.heading).abs() < AGREES.1;
        turn.agreed = if agrees { turn.agreed + 1 } else { 0 };
        let is_settled = turn.agreed >= IMAGES && Turn::is_nearly_over(&car);
        if is_settled || car.x > turn.edge + OVER {
            self.turn = None;
            return None;
        }
        self.turn = Some(turn);
        let speed = SPEED.min(self.limit);
        Some(Twist::new(speed, speed * turn.curvature(&car, turn.side == self.side)))
    }
}
