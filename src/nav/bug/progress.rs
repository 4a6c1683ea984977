use std::f64::consts::TAU;

use crate::geometry::{Pose, angle_difference, normalize_angle};

/// Whether the robot has been all round.
#[derive(Debug, Clone)]
pub(super) struct LoopProgress {
    begin: Option<Pose>,
    last: Pose,
    /// Metres since the boundary was met, and since the loop began.
    approach: f64,
    travelled: f64,
    /// Radians turned since the loop began.
    turned: f64,
    /// Steps without a free heading.
    boxed_in: u32,
    /// How near the robot was to the loop's begin at the last step, if it was as good as there.
    closing: Option<f64>,
    /// Whether the robot has left the place where the loop began, and how often it came back the same way.
    away: bool,
    returns: u32,
    rule: LapRule,
}

/// When a boundary counts as gone round.
#[derive(Debug, Clone, Copy)]
pub(super) struct LapRule {
    /// Full turns after which the place where the loop began should have been found; if not, the robot has been wrong
    /// about it, and the loop begins anew.
    pub(super) lost_turns: f64,
    /// Whether the loop is followed to its very end, rather than until that is near.
    pub(super) to_the_end: bool,
}

/// What the latest step has shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Lap {
    /// There is more of the boundary to come.
    Open,
    /// The robot is back where the loop began, which is so many metres long.
    Closed(f64),
    /// There is no way on at all.
    BoxedIn,
}

/// Returns the same way after which a loop is closed, however the robot has turned on it: in a dead end it may turn the wrong
/// way round, and then a lap has no net turn, each time.
const CERTAIN_RETURNS: u32 = 2;
/// Steps without a free heading after which the robot is boxed in.
const BOXED_IN_STEPS: u32 = 40;

impl LoopProgress {
    /// A loop that begins about here.
    pub(super) fn new(pose: Pose, rule: LapRule) -> Self {
        Self {
            begin: None,
            last: pose,
            approach: 0.0,
            travelled: 0.0,
            turned: 0.0,
            boxed_in: 0,
            closing: None,
            away: false,
            returns: 0,
            rule,
        }
    }

    /// Takes in where the robot is and the heading that it takes; whether it is back where the loop began.
    pub(super) fn update(&mut self, pose: Pose, heading: Option<f64>, radius: f64) -> Lap {
        let moved = pose.distance_to(self.last.position());
        let turned = angle_difference(pose.heading, self.last.heading);
        self.last = pose;
        let Some(heading) = heading else {
            self.boxed_in += 1;
            return if self.boxed_in > BOXED_IN_STEPS { Lap::BoxedIn } else { Lap::Open };
        };
        self.boxed_in = 0;
        let Some(begin) = self.begin else {
            self.approach += moved;
            // The loop begins once the robot has come into line with the boundary.
            let in_line = heading.abs() < 0.3 && self.approach > 0.5 * radius;
            if in_line || self.approach > 6.0 * radius {
                self.begin = Some(pose);
            }
            return Lap::Open;
        };
        self.travelled += moved;
        self.turned += turned;
        let near = pose.distance_to(begin.position()) < 1.5 * radius;
        let same_way = normalize_angle(pose.heading - begin.heading).abs() < 1.2;
        let been_away = self.travelled > 6.0 * radius || self.turned.abs() > 1.1 * TAU;
        self.away |= pose.distance_to(begin.position()) > 4.0 * radius;
        if self.away && near && same_way {
            self.away = false;
            self.returns += 1;
        }
        // Once round a closed curve, the heading turns by one full turn, whatever the curve; back and forth, by none.
        let all_round = self.turned.abs() > 0.6 * TAU || self.returns >= CERTAIN_RETURNS;
        if self.turned.abs() > self.rule.lost_turns * TAU {
            // It has been round without finding the place, so its pose there was wrong. The loop begins anew here.
            *self = Self { begin: Some(pose), ..Self::new(pose, self.rule) };
            return Lap::Open;
        }
        let there = near && same_way && been_away && all_round;
        if self.is_over(there, pose.distance_to(begin.position())) {
            Lap::Closed(self.travelled)
        } else {
            Lap::Open
        }
    }

    /// Whether the loop is over for a robot that is, or is not, as good as at its begin.
    fn is_over(&mut self, there: bool, distance: f64) -> bool {
        if !self.rule.to_the_end {
            return there;
        }
        let before = self.closing;
        self.closing = there.then_some(distance);
        before.is_some_and(|before| !there || distance >= before)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::math;

    /// Follows a closed line round and round. How many rounds it takes until the loop is closed.
    fn rounds(place: impl Fn(f64) -> (f64, f64)) -> f64 {
        let at = |t: f64| {
            let ((x, y), (ahead_x, ahead_y)) = (place(t), place(t + 1e-3));
            Pose::new(x, y, math::atan2(ahead_y - y, ahead_x - x))
        };
        let rule = LapRule { lost_turns: 1.6, to_the_end: false };
        let mut progress = LoopProgress::new(at(0.0), rule);
        let steps = (0..5000).map(|step| f64::from(step) * 0.01);
        let mut laps = steps.map(|t| (t, progress.update(at(t), Some(0.0), 0.06)));
        let closed = laps.find(|(_, lap)| matches!(lap, Lap::Closed(_)));
        closed.expect("the loop is closed in the end").0 / TAU
    }

    #[test]
    fn a_closed_line_is_gone_round_once() {
        let round = rounds(|t| (math::cos(t), math::sin(t)));
        assert!((0.9..1.1).contains(&round), "{round}");
    }

    #[test]
    fn a_line_without_a_net_turn_is_gone_round_twice() {
        // A figure of eight.
        let round = rounds(|t| (math::sin(t), 0.5 * math::sin(2.0 * t)));
        assert!((1.9..2.1).contains(&round), "{round}");
    }
}
