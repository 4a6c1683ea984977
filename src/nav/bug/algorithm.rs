use std::fmt::Debug;

use super::parameters::BugParameters;
use super::report::{BugEvent, BugOutcome, BugPhase};
use crate::geometry::{Point, Pose, Twist};
use crate::io::control::{Behaviour, LidarObservation, Senses};
use crate::io::{Lidar, Odometry, Result};

/// A bug algorithm: navigation to a goal among unknown obstacles by local sensing.
///
/// Every bug drives towards the goal until an obstacle blocks it, follows the obstacle's boundary, and leaves
/// it again. The algorithms differ in when they leave, turn back and give up.
///
/// # For implementers
///
/// Return [`BugOutcome::Unreachable`] only with a proof. State in `guarantee` what is proved; tests
/// compare it with the runs.
pub trait Bug:
    Behaviour<Observation = LidarObservation, Command = Twist, Outcome = BugOutcome> + Debug
{
    /// Name of the algorithm.
    fn name(&self) -> &'static str;

    /// Its proved guarantee.
    fn guarantee(&self) -> Guarantee;

    /// Its parameters.
    fn parameters(&self) -> &BugParameters;

    /// Current phase.
    fn phase(&self) -> BugPhase;

    /// Estimated pose relative to the start.
    fn pose(&self) -> Pose;

    /// Estimated distance to the goal (m).
    fn goal_distance(&self) -> f64;

    /// Noise-filtered points of the current scan, in the robot's frame.
    fn visible_points(&self) -> &[Point];

    /// Takes the events since the last call.
    fn take_events(&mut self) -> Vec<BugEvent>;
}

/// Proved properties of an algorithm, for a robot with exact position and sensors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Guarantee {
    /// Whether it always reaches the goal or reports that no way exists.
    pub complete: bool,
    /// Bound on the path length.
    pub path_bound: PathBound,
}

/// Bound on the path length, given the straight distance `D` from start to goal and the perimeters `p` of the
/// boundaries met.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum PathBound {
    /// `D + 1.5 sum(p)`.
    Perimeters,
    /// `D + 2 sum(p)`.
    TwicePerimeters,
    /// `D + sum(n p) / 2`, where the line from start to goal crosses a boundary `n` times. An odd `n` is
    /// rounded up, as one more crossing leads into an obstacle that contains the goal.
    Crossings,
    /// No bound in these terms is known.
    Unknown,
}

impl PathBound {
    /// The bound (m). Each boundary is given by its perimeter (m) and the number of times the line from start
    /// to goal crosses it. `None` if no bound is known.
    ///
    /// ```
    /// use roverlab::nav::PathBound;
    /// let boundaries = [(2.0, 2), (4.0, 6)];
    /// assert_eq!(PathBound::Perimeters.metres(3.0, &boundaries), Some(12.0));
    /// assert_eq!(PathBound::TwicePerimeters.metres(3.0, &boundaries), Some(15.0));
    /// assert_eq!(PathBound::Crossings.metres(3.0, &boundaries), Some(17.0));
    /// assert_eq!(PathBound::Unknown.metres(3.0, &boundaries), None);
    /// ```
    pub fn metres(self, distance: f64, boundaries: &[(f64, usize)]) -> Option<f64> {
        let weight = |crossings: usize| match self {
            Self::Perimeters => Some(1.5),
            Self::TwicePerimeters => Some(2.0),
            Self::Crossings => Some(crossings.div_ceil(2) as f64),
            Self::Unknown => None,
        };
        boundaries
            .iter()
            .try_fold(distance, |sum, &(perimeter, crossings)| Some(sum + weight(crossings)? * perimeter))
            .filter(|_| self != Self::Unknown)
    }
}

impl<R: Odometry + Lidar + ?Sized, B: Bug + ?Sized> Senses<R> for B {
    fn sense(&mut self, robot: &mut R, _time: f64, seen: &mut LidarObservation) -> Result<()> {
        seen.read(robot)
    }
}

/// Defines a bug by its name, its strategy and the bound on its path length. All bugs are complete.
macro_rules! bug_algorithm {
    ($(#[$doc:meta])* $bug:ident, $name:literal, $strategy:ty, PathBound::$bound:ident) => {
        $(#[$doc])*
        #[derive(Debug, Clone)]
        pub struct $bug(crate::nav::bug::engine::Engine<$strategy>);

        impl $bug {
            /// Creates a run to a goal relative to the robot's start: metres ahead and to the left. Fails for
            /// parameters out of range and a goal that is not finite.
            pub fn new(
                goal: crate::geometry::Point,
                parameters: crate::nav::BugParameters,
            ) -> crate::io::Result<Self> {
                crate::nav::bug::engine::Engine::new(goal, parameters, <$strategy>::default()).map(Self)
            }
        }

        impl crate::io::control::Behaviour for $bug {
            type Observation = crate::io::control::LidarObservation;
            type Command = crate::geometry::Twist;
            type Outcome = crate::nav::BugOutcome;

            fn period(&self) -> f64 {
                self.0.body.parameters.period
            }

            fn step(
                &mut self,
                _time: f64,
                seen: &crate::io::control::LidarObservation,
            ) -> crate::io::control::Decision<Self> {
                self.0.decide(seen)
            }

            fn halt(&mut self, halt: crate::io::control::Halt) -> crate::nav::BugOutcome {
                self.0.body.end(halt.into());
                halt.into()
            }
        }

        impl crate::nav::Bug for $bug {
            fn name(&self) -> &'static str {
                $name
            }

            fn guarantee(&self) -> crate::nav::Guarantee {
                crate::nav::Guarantee { complete: true, path_bound: crate::nav::PathBound::$bound }
            }

            fn parameters(&self) -> &crate::nav::BugParameters {
                &self.0.body.parameters
            }

            fn phase(&self) -> crate::nav::BugPhase {
                self.0.body.phase
            }

            fn pose(&self) -> crate::geometry::Pose {
                self.0.body.pose
            }

            fn goal_distance(&self) -> f64 {
                self.0.body.goal_distance()
            }

            fn visible_points(&self) -> &[crate::geometry::Point] {
                &self.0.body.points
            }

            fn take_events(&mut self) -> Vec<crate::nav::BugEvent> {
                std::mem::take(&mut self.0.body.events)
            }
        }
    };
}
pub(super) use bug_algorithm;
