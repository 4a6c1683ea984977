use std::f64::consts::FRAC_PI_2;
use std::ops::ControlFlow;

use super::a_to_b::dog_twist;
use super::{Hermite, Method, PathFollowerParameters};
use crate::geometry::{Pose, Twist};
use crate::io::control::{Behaviour, Decision, SensedBy, Senses, halts};
use crate::io::reading::pose_in_words;
use crate::io::{Error, Odometry, Result, StallDetector};
use crate::parameter::{require_positive, require_up_to};

/// Parameters of [`Chase`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChaseParameters {
    /// Limits of speed, turn rate and deceleration.
    pub follower: PathFollowerParameters,
    /// Distance at which the goal is caught (m).
    pub distance: f64,
    /// The book's k of splines.
    pub spline_scale: f64,
    /// Bearing beyond which [`Method::Turn`] stops and turns on the spot (rad).
    pub turn_threshold: f64,
    /// Control period (s).
    pub period: f64,
}

impl Default for ChaseParameters {
    fn default() -> Self {
        Self {
            follower: PathFollowerParameters::default(),
            distance: 0.05,
            spline_scale: 1.0,
            turn_threshold: 0.2,
            period: 0.05,
        }
    }
}

/// Observation of a [`Chase`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ChaseObservation {
    /// Goal's pose in the robot's frame.
    pub goal: Pose,
    /// Whether the drive has stalled.
    pub stalled: bool,
}

/// Outcome of a chase.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ChaseOutcome {
    /// The goal is within the catching distance.
    Caught,
    /// The drive has stalled.
    Blocked,
    /// The time limit came first.
    TimedOut,
    /// The observer stopped the run.
    Stopped,
}

halts!(ChaseOutcome { Caught: "the goal is caught", Blocked: "something holds the robot" });

/// Drives towards a moving goal: plans anew by one of chapter 3's methods at each step, and drives the first
/// piece of the plan.
///
/// ```
/// use roverlab::drive::{Chase, ChaseParameters, Method};
/// use roverlab::geometry::Pose;
/// let mut chase = Chase::new(Method::Arc, ChaseParameters::default())?;
/// // A goal ahead to the left.
/// let twist = chase.step(Pose::new(1.0, 0.5, 0.0))?.unwrap();
/// assert!(twist.linear > 0.0 && twist.angular > 0.0);
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chase {
    method: Method,
    parameters: ChaseParameters,
    turning: bool,
}

impl Chase {
    /// A chase by a method.
    ///
    /// # Errors
    ///
    /// If a parameter is out of range; the error names it.
    pub fn new(method: Method, parameters: ChaseParameters) -> Result<Self> {
        parameters.follower.validate()?;
        require_positive("distance", parameters.distance)?;
        require_up_to("spline scale", parameters.spline_scale, 100.0)?;
        require_positive("turn threshold", parameters.turn_threshold)?;
        require_positive("control period", parameters.period)?;
        Ok(Self { method, parameters, turning: true })
    }

    /// The velocity towards a goal given in the robot's frame; `None` when it is caught. Only splines use the
    /// goal's heading. Fails if the goal is not finite.
    pub fn step(&mut self, goal: Pose) -> Result<Option<Twist>> {
        if !goal.is_finite() {
            return Err(Error::invalid_input("goal", pose_in_words(&goal), "finite numbers"));
        }
        let robot = Pose::default();
        let distance = robot.distance_to(goal.position());
        if distance <= self.parameters.distance {
            return Ok(None);
        }
        let bearing = robot.bearing_to(goal.position());
        let follower = &self.parameters.follower;
        Ok(Some(match self.method {
            Method::Turn => self.turn_or_drive(bearing, distance),
            // No braking for a goal that moves.
            Method::Dog => {
                let follower = PathFollowerParameters { deceleration: f64::INFINITY, ..*follower };
                dog_twist(&follower, bearing, distance)
            }
            // Forward arcs to goals behind are long: turn towards them first.
            Method::Arc | Method::Spline if bearing.abs() > FRAC_PI_2 => {
                Twist::new(0.0, follower.turn_rate.copysign(bearing))
            }
            Method::Arc => self.along(2.0 * goal.y / (distance * distance)),
            Method::Spline => {
                let spline = Hermite::between(robot, goal, self.parameters.spline_scale);
                self.along(spline.curvature(0.0))
            }
        }))
    }

    /// The behaviour that chases `goal`, a function from the time since the first step (s) to the goal's pose
    /// in the odometry frame.
    pub fn after<R: Odometry + StallDetector + ?Sized>(
        &mut self,
        mut goal: impl FnMut(&mut R, f64) -> Result<Pose>,
    ) -> impl Senses<R, Observation = ChaseObservation, Command = Twist, Outcome = ChaseOutcome> {
        let mut begin = None;
        SensedBy::new(self, move |robot: &mut R, time: f64, seen: &mut ChaseObservation| {
            let pose = robot.pose()?;
            let place = goal(robot, time - *begin.get_or_insert(time))?;
            *seen = ChaseObservation { goal: pose.inverse().compose(&place), stalled: robot.is_stalled()? };
            Ok(())
        })
    }

    fn turn_or_drive(&mut self, bearing: f64, distance: f64) -> Twist {
        let follower = &self.parameters.follower;
        // Hysteresis: once driving, the robot stops only when the goal is well off its line.
        let limit =
            if self.turning { 0.5 * self.parameters.turn_threshold } else { self.parameters.turn_threshold };
        self.turning = bearing.abs() > limit;
        if self.turning {
            // Fast enough that a goal crossing ahead does not stay beyond the limit.
            let rate = (5.0 * bearing.abs()).min(follower.turn_rate);
            Twist::new(0.0, rate.copysign(bearing))
        } else {
            self.along(2.0 * bearing / distance)
        }
    }

    /// Velocity along a curvature, slower in bends.
    fn along(&self, curvature: f64) -> Twist {
        let follower = &self.parameters.follower;
        let speed = follower.speed.min(follower.turn_rate / curvature.abs().max(1e-9));
        Twist::new(speed, speed * curvature)
    }
}

impl Behaviour for Chase {
    type Observation = ChaseObservation;
    type Command = Twist;
    type Outcome = ChaseOutcome;

    fn period(&self) -> f64 {
        self.parameters.period
    }

    fn step(&mut self, _time: f64, seen: &ChaseObservation) -> Decision<Self> {
        Ok(match Chase::step(self, seen.goal)? {
            _ if seen.stalled => ControlFlow::Break(ChaseOutcome::Blocked),
            Some(twist) => ControlFlow::Continue(twist),
            None => ControlFlow::Break(ChaseOutcome::Caught),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Point, normalize_angle};
    use crate::kinematics::{Displacement, advance};
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(crate::testing::cases(64))]
        /// The goal drives along a circle at less than half the robot's speed.
        #[test]
        fn a_slower_goal_is_caught(
            x in -1.5..1.5f64, y in -1.5..1.5f64, heading in -3.0..3.0f64, curvature in -1.0..1.0f64,
        ) {
            for method in [Method::Turn, Method::Arc, Method::Dog, Method::Spline] {
                let mut chase = Chase::new(method, ChaseParameters::default()).unwrap();
                let (mut robot, mut goal) = (Pose::default(), Pose::new(x, y, heading));
                let mut caught = false;
                for _ in 0..6000 {
                    let local = robot.to_local(goal.position());
                    let seen = Pose::new(local.x, local.y, normalize_angle(goal.heading - robot.heading));
                    let Some(twist) = chase.step(seen).unwrap() else {
                        caught = true;
                        break;
                    };
                    robot = advance(robot, Displacement { length: 0.02 * twist.linear, angle: 0.02 * twist.angular });
                    goal = advance(goal, Displacement { length: 0.002, angle: 0.002 * curvature });
                }
                prop_assert!(caught, "{method:?}: {robot:?} {goal:?}");
            }
        }
    }

    #[test]
    fn a_robot_with_noise_catches_a_goal_on_a_circle() {
        use crate::io::control::run;
        use crate::io::sim::{SimOptions, SimRobot, Simulation};
        use crate::world::{RobotSpec, Scene, World};
        let scene = Scene::with_robot(World::empty(6.0, 6.0), RobotSpec::s4(), Pose::default());
        for method in [Method::Turn, Method::Arc, Method::Dog, Method::Spline] {
            let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 3)).unwrap();
            let goal = |time: f64| {
                let begin = Pose::new(1.0, 0.8, 0.4);
                advance(begin, Displacement { length: 0.08 * time, angle: 0.05 * time })
            };
            let mut chase = Chase::new(method, ChaseParameters::default()).unwrap();
            let (mut robot, mut seconds) = (simulation.robot(0).unwrap(), 0.0);
            let told = |_: &mut SimRobot, time| {
                seconds = time;
                Ok(goal(time))
            };
            let outcome = run(&mut robot, &mut chase.after(told), 60.0, |_, _, _| {}).unwrap();
            assert_eq!(outcome, ChaseOutcome::Caught, "{method:?}");
            let truth = simulation.truth().robot(0).unwrap();
            assert!(truth.pose.distance_to(goal(seconds).position()) < 0.15, "{method:?}: {:?}", truth.pose);
            // One that is faster gets away.
            let away = |_: &mut SimRobot, time| Ok(Pose::new(1.0 + time, 0.0, 0.0));
            let outcome = run(&mut robot, &mut chase.after(away), 5.0, |_, _, _| {}).unwrap();
            assert_eq!(outcome, ChaseOutcome::TimedOut);
        }
    }

    #[test]
    fn a_goal_at_hand_is_caught_and_a_wrong_one_refused() {
        let mut chase = Chase::new(Method::Dog, ChaseParameters::default()).unwrap();
        assert_eq!(chase.step(Pose::new(0.03, 0.0, 1.0)).unwrap(), None);
        assert!(chase.step(Pose::new(f64::NAN, 0.0, 1.0)).is_err());
        let place = Point::new(1.0, 0.0);
        assert_eq!(chase.step(Pose::new(place.x, place.y, 0.0)).unwrap().unwrap().angular, 0.0);
    }
}
