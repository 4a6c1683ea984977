//! Passing obstacles: when, how far aside, and how fast.

use super::{Lateral, TrafficDriver};
use crate::drive::traffic::obstacles::{MOVES, Obstacle, SAME, comes};
use crate::drive::traffic::shift::Shift;
use crate::geometry::math;

/// Distance from the car's front at which it begins to pass an obstacle (m).
const NOTICE: f64 = 0.95;
/// Free length of the other lane beyond an obstacle that it takes to return (m).
const FREE_LANE: f64 = 1.0;
/// Longest time for which an obstacle beside the car is not seen (s).
const MEMORY: f64 = 3.0;
/// Distance ahead of the origin below which the view cuts what is in the lane beside the car (m).
const CUT: f64 = 0.5;
/// Speed of boxes that move, by the rules (m/s).
const DRIVES: f64 = 0.6;
/// Distance before an obstacle at which a car waits for oncoming traffic (m): from there it can change lanes.
const WAITS: f64 = 0.85;
/// Distance before an obstacle up to which a car that changes lanes returns to give way (m): the other half
/// of the change is behind it.
const YIELDS: f64 = 0.5;
/// Additional distance to an obstacle, for the error of the path (m).
const ASIDE: f64 = 0.02;
/// Speed while something comes towards the car (m/s): slow enough to wait where it sees past the obstacle.
const MEETING: f64 = 0.6;
/// Least speed beside a barred area (m/s).
const CREEPS: f64 = 0.2;
/// Distance before an obstacle at which a car stands that passes it but is not yet aside (m).
const SAFE: f64 = 0.06;
/// Time in which a car that is too near falls back (s).
const FALL_BACK: f64 = 0.5;
/// Speed below which the car changes lanes as from a standstill (m/s).
const SLOW: f64 = 0.3;

impl TrafficDriver {
    /// Keeps the obstacle that the car passes until it is behind, although it leaves the view before or is
    /// not recognised beside the car.
    pub(super) fn remember(&mut self, time: f64, obstacles: &mut Vec<Obstacle>) {
        if self.lateral != Lateral::Pass {
            // The next one to be passed.
            let reach = self.reach();
            let next = obstacles.iter().find(|it| it.is_in_way(reach) && it.ahead + it.length > 0.0);
            self.passed = next.map(|it| (*it, time, self.driven));
            return;
        }
        let Some((last, seen, driven)) = self.passed else { return };
        let moves = last.speed > MOVES;
        let speed = if moves { self.road_size * DRIVES } else { 0.0 };
        let ahead = last.ahead + speed * (time - seen) - (self.driven - driven);
        let index = obstacles.iter().position(|it| (it.ahead - ahead).abs() < self.road_size * SAME);
        // Of what drives beside the car, a part is seen, and the car's own motion makes it seem to stand.
        let index = if moves && ahead < self.road_size * CUT {
            obstacles.retain(|it| (it.ahead - ahead).abs() >= self.road_size * SAME);
            None
        } else {
            index
        };
        if let Some(index) = index {
            self.passed = Some((obstacles[index], time, self.driven));
        } else if time - seen < MEMORY {
            obstacles.push(Obstacle { ahead, ..last });
        }
    }

    /// Distance to the left and right of the lane's centre within which obstacles are in the way (m).
    fn reach(&self) -> f64 {
        self.parameters.body[1] + self.parameters.clearance
    }

    /// Whether something comes in the other lane.
    fn comes(&self) -> bool {
        comes(self.finder.in_other_lane(), self.parameters.body[0], self.road_size)
    }

    /// Whether the car stays in its lane on a path at a distance beside the lane's centre (m).
    fn stays_in_lane(&self, beside: f64) -> bool {
        let half = self.keeper.lane().map_or(0.0, |lane| 0.5 * lane.edge);
        beside + ASIDE + self.parameters.body[1] < half
    }

    /// Whether the car still can let pass what comes, as it has only begun to change lanes.
    fn has_to_yield(&self, beside: f64, obstacles: &[Obstacle]) -> bool {
        let reach = self.reach();
        let is_near = |it: &Obstacle| it.is_in_way(reach) && self.gap(it.ahead) < self.road_size * YIELDS;
        self.lateral == Lateral::Pass
            && self.comes()
            && !self.stays_in_lane(beside)
            && !obstacles.iter().any(is_near)
    }

    /// Begins and ends passing.
    pub(super) fn change_lanes(&mut self, speed: f64, obstacles: &[Obstacle]) {
        let reach = self.reach();
        let is_near = |it: &&Obstacle| {
            it.is_in_way(reach) && it.ahead + it.length > 0.0 && self.gap(it.ahead) < self.road_size * NOTICE
        };
        let beside = obstacles.iter().filter(is_near).map(|it| it.left + reach).reduce(f64::max);
        match beside {
            Some(beside) if self.has_to_yield(beside, obstacles) => {
                self.shift = Shift::new(self.shift.at(self.driven)[0], 0.0, self.driven);
                self.lateral = Lateral::Behind;
            }
            Some(beside) if self.shift.to() < beside - 0.03 => {
                let has_way = self.stays_in_lane(beside) || !self.comes();
                let may_pass = self.lateral == Lateral::Pass || self.finder.may_pass() && has_way;
                if may_pass && self.is_free(beside, obstacles) {
                    let change = if speed < SLOW { Shift::from_rest } else { Shift::new };
                    self.shift = change(self.shift.at(self.driven)[0], beside + ASIDE, self.driven);
                    self.lateral = Lateral::Pass;
                } else if self.lateral == Lateral::Own {
                    self.lateral = Lateral::Behind;
                }
            }
            None if self.lateral == Lateral::Pass => {
                self.shift = Shift::new(self.shift.to(), 0.0, self.driven);
                self.lateral = Lateral::Return;
            }
            None if self.lateral == Lateral::Behind || self.shift.is_over(self.driven) => {
                self.lateral = Lateral::Own;
            }
            _ => {}
        }
    }

    /// Whether no other obstacle is on a path at a distance beside the lane's centre (m).
    fn is_free(&self, beside: f64, obstacles: &[Obstacle]) -> bool {
        let half = self.parameters.body[1];
        obstacles.iter().all(|it| {
            let is_in_way = it.right < beside + half && it.left > beside - half;
            let is_near =
                it.ahead + it.length > 0.0 && self.gap(it.ahead) < self.road_size * (NOTICE + FREE_LANE);
            !(is_in_way && is_near)
        })
    }

    /// Maximum speed beside obstacles, and towards those in the way.
    pub(super) fn free_speed(&self, obstacles: &[Obstacle]) -> f64 {
        let p = &self.parameters;
        let moving = obstacles.iter().any(|it| it.speed > MOVES && it.ahead > -1.0);
        let mut most = match self.lateral {
            Lateral::Pass | Lateral::Return => p.passing[usize::from(moving)],
            Lateral::Own | Lateral::Behind => p.lane.speed,
        };
        let Some(lane) = self.keeper.lane() else { return most };
        // The front is further aside than the origin while the car turns.
        let front = self.side * (lane.offset + p.body[0] * math::sin(lane.heading));
        let (may_pass, comes) = (self.finder.may_pass(), self.comes());
        let apart = match self.lateral {
            Lateral::Pass | Lateral::Return => self.road_size * SAFE,
            Lateral::Behind if may_pass => self.road_size * WAITS,
            Lateral::Own if may_pass && comes => self.road_size * WAITS,
            Lateral::Own if may_pass => self.road_size * SAFE,
            Lateral::Own | Lateral::Behind => p.following,
        };
        if comes && matches!(self.lateral, Lateral::Own | Lateral::Behind) {
            most = most.min(MEETING);
        }
        for it in obstacles {
            let is_in_way = front - p.body[1] < it.left + 0.01 && front + p.body[1] > it.right - 0.01;
            if is_in_way && self.gap(it.ahead) > -0.02 {
                let free = self.gap(it.ahead) - apart;
                // Paint does not hold a car up that is too near to change lanes before it.
                let creeps = it.is_paint && self.lateral == Lateral::Pass;
                // Too near behind what moves, the car falls back.
                let approach = if free > 0.0 { self.stoppable(free, 0.0) } else { free / FALL_BACK };
                let least = if creeps { CREEPS } else { 0.0 };
                most = most.min((approach + it.speed.max(0.0)).max(least));
            }
        }
        most
    }
}
