use std::f64::consts::TAU;

use crate::geometry::WallSide;
use crate::geometry::{Point, Pose, angle_difference, normalize_angle};

/// Detects when the robot has gone all round a boundary.
#[derive(Debug, Clone)]
pub(super) struct LoopProgress {
    begin: Option<Begin>,
    last: Pose,
    /// The point of the wall that was followed at the previous step.
    anchor: Option<Point>,
    /// Distance travelled since the boundary was met, and since the loop began (m).
    approach: f64,
    travelled: f64,
    /// Rotation of the boundary since the loop began (rad).
    turned: f64,
    spin: Spin,
    side: WallSide,
    /// Number of steps without a free heading.
    boxed_in: u32,
    /// Distance to the loop's start at the previous step (m), if the robot was practically there.
    closing: Option<f64>,
    /// Whether the robot has left the loop's start, and how often it returned in the same direction.
    away: bool,
    returns: u32,
    rule: LapRule,
}

/// Where a loop began.
#[derive(Debug, Clone, Copy)]
struct Begin {
    pose: Pose,
    /// The point of the wall that was followed there.
    anchor: Point,
}

/// Criterion for having gone round a boundary.
#[derive(Debug, Clone, Copy)]
pub(super) struct LapRule {
    /// Full turns after which the loop's start should have been found; otherwise its estimate was wrong, and
    /// the loop begins anew.
    pub(super) lost_turns: f64,
}

/// Result of the latest step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Lap {
    /// Part of the boundary is still ahead.
    Open,
    /// The robot is back at the loop's start; the loop's length (m).
    Closed(f64),
    /// No heading is free.
    BoxedIn,
}

/// Rotation more or less on the spot.
#[derive(Debug, Clone, Copy)]
struct Spin {
    from: Point,
    turned: f64,
}

/// Turn on the spot towards the wall above which a robot turns around (rad): it would drive around the end of
/// a wall.
const TURNING_ROUND: f64 = 2.2;
/// Distance within which places are the same (robot radii): less than any gap that the robot fits through.
const NEAR: f64 = 1.5;
/// Distance travelled along a boundary after which the loop has begun in any case (robot radii).
const START: f64 = 6.0;
/// Number of returns to the same place after which a loop is closed, however the robot has turned on it.
const CERTAIN_RETURNS: u32 = 2;
/// Number of steps without a free heading after which the robot is boxed in.
const BOXED_IN_STEPS: u32 = 40;

impl LoopProgress {
    /// A loop that begins about here, with the boundary on one side.
    pub(super) fn new(pose: Pose, side: WallSide, rule: LapRule) -> Self {
        Self {
            begin: None,
            last: pose,
            anchor: None,
            approach: 0.0,
            travelled: 0.0,
            turned: 0.0,
            spin: Spin { from: pose.position(), turned: 0.0 },
            side,
            boxed_in: 0,
            closing: None,
            away: false,
            returns: 0,
            rule,
        }
    }

    /// Updates the loop with the robot's pose, the heading along the boundary, and the point of the wall that
    /// bounds it. Returns whether it is closed.
    pub(super) fn update(&mut self, pose: Pose, heading: Option<f64>, anchor: Point, radius: f64) -> Lap {
        let moved = pose.distance_to(self.last.position());
        let turned = angle_difference(pose.heading, self.last.heading);
        self.last = pose;
        let jump = self.anchor.replace(anchor).map_or(0.0, |before| (anchor - before).norm());
        let Some(heading) = heading else {
            self.boxed_in += 1;
            return if self.boxed_in > BOXED_IN_STEPS { Lap::BoxedIn } else { Lap::Open };
        };
        self.boxed_in = 0;
        let Some(begin) = self.begin else {
            self.approach += moved;
            // The loop begins once the robot drives in line with the boundary.
            let in_line = heading.abs() < 0.3 && self.approach > 0.5 * radius;
            if in_line || self.approach > START * radius {
                self.begin = Some(Begin { pose, anchor });
            }
            return Lap::Open;
        };
        self.travelled += moved;
        self.turned += self.turn_of_boundary(pose, turned, radius);
        if jump > NEAR * radius && self.approach + self.travelled < START * radius {
            self.begin_behind_gap(Begin { pose, anchor });
            return Lap::Open;
        }
        let from_begin = pose.distance_to(begin.pose.position());
        let near = from_begin < NEAR * radius;
        let same_way = normalize_angle(pose.heading - begin.pose.heading).abs() < 1.2;
        let been_away = self.travelled > 6.0 * radius || self.turned.abs() > 1.1 * TAU;
        self.away |= from_begin > 4.0 * radius;
        if self.away && near && same_way {
            self.away = false;
            self.returns += 1;
        }
        // Before a gap the robot may be near the start of a loop that began behind it: the walls are two.
        let same_wall = (anchor - begin.anchor).norm() < NEAR * radius || self.returns >= CERTAIN_RETURNS;
        // Once round any closed curve the heading turns by one full turn; back and forth, by none.
        let all_round = self.turned.abs() > 0.6 * TAU || self.returns >= CERTAIN_RETURNS;
        if self.turned.abs() > self.rule.lost_turns * TAU {
            // It went round without finding the start, so the start's pose was wrong. The loop begins anew
            // here.
            *self = Self { begin: Some(Begin { pose, anchor }), ..Self::new(pose, self.side, self.rule) };
            return Lap::Open;
        }
        let there = near && same_wall && same_way && been_away && all_round;
        if self.is_over(there, &pose, &begin.pose) { Lap::Closed(self.travelled) } else { Lap::Open }
    }

    /// Begins the loop anew behind a gap at its start. A robot that meets the wall askew may pass over a gap
    /// which, when it comes back along the wall, it fits through.
    fn begin_behind_gap(&mut self, begin: Begin) {
        self.begin = Some(begin);
        self.approach += self.travelled;
        (self.travelled, self.turned) = (0.0, 0.0);
    }

    /// Rotation of the boundary as the robot turns. In a dead end the boundary turns away from the wall by
    /// half a turn, but the robot may turn the other way and end with the same heading.
    fn turn_of_boundary(&mut self, pose: Pose, turned: f64, radius: f64) -> f64 {
        if pose.distance_to(self.spin.from) > radius {
            self.spin = Spin { from: pose.position(), turned: 0.0 };
        }
        self.spin.turned += turned;
        let away = self.side.sense();
        if self.spin.turned * away > -TURNING_ROUND {
            return turned;
        }
        self.spin.turned += away * TAU;
        turned + away * TAU
    }

    /// Whether the loop is over for a robot that is, or is not, practically at its start.
    ///
    /// Beside a passage, two boundaries are near each other: one along the wall, the other one through the
    /// passage. So the robot must pass the start itself. If it turns off before that twice, the start was not
    /// on the boundary, and the nearest place counts.
    fn is_over(&mut self, there: bool, pose: &Pose, begin: &Pose) -> bool {
        let distance = pose.distance_to(begin.position());
        let before = self.closing;
        self.closing = there.then_some(distance);
        let has_passed = there && begin.to_local(pose.position()).x >= 0.0;
        let turns_off = before.is_some_and(|before| !there || distance >= before);
        has_passed || turns_off && self.returns >= CERTAIN_RETURNS
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::math;
    use std::f64::consts::PI;

    /// Follows a closed line repeatedly. Returns the number of rounds until the loop is closed.
    fn rounds(place: impl Fn(f64) -> (f64, f64)) -> f64 {
        let at = |t: f64| {
            let ((x, y), (ahead_x, ahead_y)) = (place(t), place(t + 1e-3));
            Pose::new(x, y, math::atan2(ahead_y - y, ahead_x - x))
        };
        let rule = LapRule { lost_turns: 1.6 };
        let mut progress = LoopProgress::new(at(0.0), WallSide::Right, rule);
        let steps = (0..5000).map(|step| f64::from(step) * 0.01);
        let mut laps = steps.map(|t| (t, progress.update(at(t), Some(0.0), at(t).position(), 0.06)));
        let closed = laps.find(|(_, lap)| matches!(lap, Lap::Closed(_)));
        closed.expect("the loop is closed in the end").0 / TAU
    }

    #[test]
    fn a_closed_line_is_gone_round_once() {
        let round = rounds(|t| (math::cos(t), math::sin(t)));
        assert!((0.9..1.1).contains(&round), "{round}");
    }

    /// Follows a circle repeatedly; the point of the wall that is followed is some distance ahead (m).
    /// Returns the number of rounds until the loop is closed.
    fn rounds_beside(wall: impl Fn(f64) -> f64) -> f64 {
        let rule = LapRule { lost_turns: 3.0 };
        let at = |t: f64| Pose::new(math::cos(t), math::sin(t), t + 0.5 * PI);
        let anchor = |t: f64| at(t).to_world(Point::new(wall(t), -0.1));
        let mut progress = LoopProgress::new(at(0.0), WallSide::Right, rule);
        let steps = (0..5000).map(|step| f64::from(step) * 0.01);
        let mut laps = steps.map(|t| (t, progress.update(at(t), Some(0.0), anchor(t), 0.06)));
        laps.find(|(_, lap)| matches!(lap, Lap::Closed(_))).expect("the loop is closed in the end").0 / TAU
    }

    /// Before a gap, the robot is near a start behind it, but at another wall; and a gap at the start itself
    /// may have been passed over.
    #[test]
    fn a_loop_ends_at_the_wall_at_which_it_began() {
        let at_another = rounds_beside(|t| if (5.0..6.5).contains(&t) { -0.25 } else { 0.0 });
        assert!(at_another > 1.5, "{at_another}");
        let behind_gap = rounds_beside(|t| if t < 0.1 { 0.0 } else { 0.16 });
        assert!((1.01..1.1).contains(&behind_gap), "{behind_gap}");
    }

    /// Into a blind alley and back: this covers all of its boundary.
    #[test]
    fn a_dead_end_is_left_whichever_way_the_robot_turns_round() {
        for (side, towards_the_wall) in [(WallSide::Right, -PI), (WallSide::Left, PI), (WallSide::Right, PI)]
        {
            let rule = LapRule { lost_turns: 1.6 };
            let mut progress = LoopProgress::new(Pose::default(), side, rule);
            let mut lap = |pose: Pose| progress.update(pose, Some(0.0), pose.position(), 0.06) != Lap::Open;
            let step = |i: u32| 0.01 * f64::from(i);
            let straight = |from: f64, heading: f64| {
                (0..=100).map(move |i| Pose::new(from + step(i) * math::cos(heading), 0.0, heading))
            };
            let turn = |x: f64, from: f64, by: f64| {
                (0..=50).map(move |i| Pose::new(x, 0.0, from + 2.0 * step(i) * by))
            };
            let away = side.sense() * PI;
            let way = straight(0.0, 0.0)
                .chain(turn(1.0, 0.0, towards_the_wall))
                .chain(straight(1.0, PI))
                .chain(turn(0.0, PI, away))
                .chain(straight(0.0, 0.0));
            let closed = way.enumerate().find_map(|(index, pose)| lap(pose).then_some(index));
            assert!(closed.is_some_and(|index| (250..420).contains(&index)), "{side:?} {closed:?}");
        }
    }

    #[test]
    fn a_line_without_a_net_turn_is_gone_round_twice() {
        // A figure of eight.
        let round = rounds(|t| (math::sin(t), 0.5 * math::sin(2.0 * t)));
        assert!((1.9..2.1).contains(&round), "{round}");
    }
}
