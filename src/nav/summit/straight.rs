use super::drive::Step;
use super::parameters::SummitParameters;
use crate::geometry::{Point, Pose, Twist, Vector, direction, math};

/// Drives along the middle line of a ramp, from level ground to level ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Straight {
    /// A point of the line, and its direction.
    line: Pose,
    before: Option<Point>,
    /// Distance driven, and since the robot is level again (m).
    driven: f64,
    level: f64,
    /// Whether it has been tilted.
    tilted: bool,
}

/// Largest tilt of a robot that stands on a level (rad).
const FLAT: f64 = 0.06;
/// Least tilt of a robot on a ramp (rad).
const TILTED: f64 = 0.1;
/// Distance ahead on the line to which the robot steers (m): 1.5 times its length.
const AHEAD: f64 = 0.4;
/// Distance that a robot has to be level to have arrived (m).
const ARRIVED: f64 = 0.08;
/// Distance after which there should have been a level (m): a ramp of 3 m, and as much slip.
const LONGEST: f64 = 6.0;

impl Straight {
    pub(super) fn along(from: Point, towards: Vector) -> Self {
        let line = Pose::new(from.x, from.y, math::atan2(towards.y, towards.x));
        Self { line, before: None, driven: 0.0, level: 0.0, tilted: false }
    }

    pub(super) fn step(&mut self, pose: Pose, tilt: f64, parameters: &SummitParameters) -> Step {
        let here = pose.position();
        let way = self.before.replace(here).map_or(0.0, |before| (here - before).norm());
        self.driven += way;
        self.tilted |= tilt > TILTED;
        self.level = if tilt < FLAT { self.level + way } else { 0.0 };
        if self.tilted && self.level > ARRIVED {
            return Step::Arrived;
        }
        // Ramps do not lead over the border.
        if self.driven > LONGEST || !parameters.holds(here, 0.0) {
            return Step::NoWay { ahead: here, sign: 1.0 };
        }
        let along = self.line.to_local(here).x + AHEAD;
        let goal = self.line.position() + direction(self.line.heading) * along;
        let turn = 2.0 * pose.bearing_to(goal);
        Step::Go(Twist::new(parameters.speed, turn.clamp(-parameters.turn_rate, parameters.turn_rate)))
    }
}
