use std::f64::consts::FRAC_PI_2;
use std::ops::ControlFlow;

use super::body::{Body, GoalView};
use super::parameters::BugParameters;
use super::progress::{Lap, LoopProgress};
use super::report::{BugEvent, BugOutcome, BugPhase};
use super::strategy::{Decision, Place, Sight, Strategy};
use crate::geometry::WallSide;
use crate::geometry::{Point, Twist, math, normalize_angle};
use crate::io::Result;
use crate::io::control::LidarObservation;
use crate::nav::boundary::BoundaryFollower;

/// A body driven by a strategy: to the goal, along boundaries, and to a verdict.
#[derive(Debug, Clone)]
pub(super) struct Engine<S> {
    pub(super) body: Body,
    strategy: S,
    following: Option<Following>,
}

/// The boundary of the current obstacle, as far as it has been followed.
#[derive(Debug, Clone)]
struct Following {
    side: WallSide,
    boundary: BoundaryFollower,
    progress: LoopProgress,
    /// Distance travelled since the obstacle was met (m), and the position where it was last updated.
    travelled: f64,
    last: Point,
    /// Whether the last heading was nearly the robot's own.
    in_line: bool,
}

/// Angle up to which a heading counts as along the boundary (rad).
const IN_LINE: f64 = 0.5;

impl<S: Strategy> Engine<S> {
    pub(super) fn new(goal: Point, parameters: BugParameters, strategy: S) -> Result<Self> {
        Ok(Self { body: Body::new(goal, parameters, strategy.slows_to_pass())?, strategy, following: None })
    }

    /// The velocity until the next step, or the outcome of the run.
    pub(super) fn decide(&mut self, seen: &LidarObservation) -> Result<ControlFlow<BugOutcome, Twist>> {
        let Self { body, strategy, following } = self;
        Decider { body, strategy, following }.decide(seen)
    }
}

/// An engine independent of its strategy type, so that the code below is compiled once.
struct Decider<'e> {
    body: &'e mut Body,
    strategy: &'e mut dyn Strategy,
    following: &'e mut Option<Following>,
}

impl Decider<'_> {
    fn decide(&mut self, seen: &LidarObservation) -> Result<ControlFlow<BugOutcome, Twist>> {
        let twist = self.steer(seen)?;
        Ok(match self.body.phase {
            BugPhase::Ended(outcome) => ControlFlow::Break(outcome),
            _ => ControlFlow::Continue(twist),
        })
    }

    fn steer(&mut self, observation: &LidarObservation) -> Result<Twist> {
        self.body.perceive(observation)?;
        if self.body.phase == BugPhase::LookingRound {
            return Ok(self.body.look_round());
        }
        self.body.learn();
        if self.body.goal_distance() <= self.body.parameters.goal_tolerance {
            self.body.end(BugOutcome::Reached);
        } else {
            self.body.look_for_room();
        }
        let heading = match self.body.phase {
            BugPhase::ToGoal => self.head_for_goal(),
            BugPhase::Following(_) => self.follow(),
            BugPhase::LookingRound | BugPhase::Ended(_) => None,
        };
        Ok(heading.map_or(Twist::STOP, |heading| self.body.steer(heading, observation.speed)))
    }

    /// Drives towards the goal; returns the heading to take.
    fn head_for_goal(&mut self) -> Option<f64> {
        let view = self.body.look_at_goal();
        if view.at_hand.is_some() {
            return view.at_hand;
        }
        if let Some(heading) = self.strategy.detour(self.body, &view) {
            return Some(heading);
        }
        match view.obstacle {
            Some(obstacle) if self.body.is_blocked(&view) => self.hit(&view, obstacle),
            _ => Some(view.bearing),
        }
    }

    /// Starts to follow the obstacle in the way.
    fn hit(&mut self, view: &GoalView, obstacle: Point) -> Option<f64> {
        let body = &mut *self.body;
        let own = self.strategy.side(body, view);
        let side = own.unwrap_or_else(|| body.usual_side(view, obstacle));
        let (pose, point) = (body.pose, body.pose.position());
        let anchor = pose.to_world(obstacle);
        *self.following = Some(Following {
            side,
            boundary: BoundaryFollower::new(side, body.parameters.follow_distances(), anchor),
            progress: LoopProgress::new(pose, side, self.strategy.laps()),
            travelled: 0.0,
            last: point,
            in_line: false,
        });
        body.phase = BugPhase::Following(side);
        body.events.push(BugEvent::Hit { point, side });
        let to_wall = anchor - point;
        let place = Place { point, wall: math::atan2(to_wall.y, to_wall.x) };
        let meeting = Sight { place, at_boundary: true, ..self.sight(view)? };
        self.strategy.meet(&meeting);
        self.follow()
    }

    /// The observation for the strategy's decision.
    fn sight(&self, view: &GoalView) -> Option<Sight> {
        let (body, following) = (&*self.body, self.following.as_ref()?);
        let distances = body.parameters.follow_distances();
        let sense = following.side.sense();
        let wall = normalize_angle(body.pose.heading - sense * FRAC_PI_2);
        Some(Sight {
            place: Place { point: body.pose.position(), wall },
            side: following.side,
            goal: body.goal,
            distance: view.distance,
            free: view.free,
            into_wall: -sense * math::sin(view.bearing),
            at_boundary: body.is_at_followed_boundary(view, following.side),
            in_line: following.in_line,
            travelled: following.travelled,
            margin: distances.wished - distances.least + body.parameters.step,
            step: body.parameters.step,
            radius: body.parameters.robot_radius,
        })
    }

    /// Follows the boundary until it can be left or is closed; returns the heading to take.
    fn follow(&mut self) -> Option<f64> {
        let view = self.body.look_at_goal();
        let position = self.body.pose.position();
        let following = self.following.as_mut()?;
        following.travelled += (position - following.last).norm();
        following.last = position;
        let sight = self.sight(&view)?;
        let decision = self.strategy.consider(self.body, &sight);
        let decision = if view.at_hand.is_some() { Decision::Leave } else { decision };
        if let Some(heading) = self.obey(decision, &view)? {
            return Some(heading);
        }
        let (heading, lap) = self.along_boundary()?;
        let decision = match lap {
            Lap::Open => return heading,
            Lap::Closed(length) => self.strategy.all_round(&sight, length),
            Lap::BoxedIn => Decision::GiveUp,
        };
        match self.obey(decision, &view)? {
            None => self.along_boundary()?.0,
            heading => heading,
        }
    }

    /// Executes the strategy's decision. `None`: the run has ended; `Some(None)`: keep following the
    /// boundary.
    #[allow(
        clippy::option_option,
        reason = "the end of the run is not the lack of a heading, and `?` leads there"
    )]
    fn obey(&mut self, decision: Decision, view: &GoalView) -> Option<Option<f64>> {
        match decision {
            Decision::Follow => Some(None),
            Decision::Leave => {
                self.leave(view);
                Some(Some(view.at_hand.unwrap_or(view.bearing)))
            }
            Decision::Reverse => {
                self.reverse()?;
                Some(None)
            }
            Decision::BeginLap => {
                let following = self.following.as_mut()?;
                following.progress = LoopProgress::new(self.body.pose, following.side, self.strategy.laps());
                Some(None)
            }
            Decision::GiveUp => {
                self.body.give_up();
                None
            }
        }
    }

    /// The heading along the boundary, and the progress of the lap.
    fn along_boundary(&mut self) -> Option<(Option<f64>, Lap)> {
        let body = &mut *self.body;
        let following = self.following.as_mut()?;
        let heading = following.boundary.heading(&body.pose, &mut body.surroundings);
        let (anchor, radius) = (following.boundary.anchor(), body.parameters.robot_radius);
        let lap = following.progress.update(body.pose, heading, anchor, radius);
        following.in_line = heading.is_some_and(|heading| heading.abs() < IN_LINE);
        Some((heading, lap))
    }

    fn reverse(&mut self) -> Option<()> {
        let following = self.following.as_mut()?;
        let (pose, side) = (self.body.pose, following.side.other());
        following.side = side;
        following.boundary.turn_back();
        following.progress = LoopProgress::new(pose, side, self.strategy.laps());
        following.in_line = false;
        self.body.phase = BugPhase::Following(side);
        self.body.events.push(BugEvent::Reverse { point: pose.position(), side });
        Some(())
    }

    fn leave(&mut self, view: &GoalView) {
        *self.following = None;
        self.body.phase = BugPhase::ToGoal;
        let point = self.body.pose.position();
        self.body.events.push(BugEvent::Leave { point, free: view.free.min(view.distance) });
    }
}
