use std::fmt::Debug;

use super::parameters::BugParameters;
use super::report::{BugEvent, BugOutcome, BugPhase};
use crate::geometry::{Point, Pose, Twist};
use crate::io::control::{Behaviour, LidarObservation, Senses};
use crate::io::{Lidar, Odometry, Result};

/// A bug algorithm: to a goal through unknown obstacles by what a robot senses around it.
///
/// All drive at the goal until something is in the way, follow its boundary, and leave it again; they differ in when
/// they leave, when they turn back, and when they give up.
pub trait Bug:
    Behaviour<Observation = LidarObservation, Command = Twist, Outcome = BugOutcome> + Debug
{
    /// What the algorithm is called.
    fn name(&self) -> &'static str;

    /// What is proved about it.
    fn guarantee(&self) -> Guarantee;

    /// What it goes by.
    fn parameters(&self) -> &BugParameters;

    /// What the robot is doing.
    fn phase(&self) -> BugPhase;

    /// Where the robot takes itself to be, relative to its start.
    fn pose(&self) -> Pose;

    /// The distance to the goal that the robot takes itself to have.
    fn goal_distance(&self) -> f64;

    /// What it sees at the moment: the noise-filtered hits of the scan in the robot's frame.
    fn visible_points(&self) -> &[Point];

    /// Takes the events that have happened since the last call.
    fn take_events(&mut self) -> Vec<BugEvent>;
}

/// What is proved about an algorithm, for a robot whose position and sensors are exact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Guarantee {
    /// Whether it always comes to the goal, or to the verdict that there is no way.
    pub complete: bool,
    /// How long its path can become.
    pub path_bound: PathBound,
}

/// A bound of a path's length, by the straight distance `D` from start to goal and the boundaries that are met, of
/// perimeters `p`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum PathBound {
    /// `D + 1.5 sum(p)`.
    Perimeters,
    /// `D + 2 sum(p)`.
    TwicePerimeters,
    /// `D + sum(n p) / 2`, where the line from start to goal crosses a boundary `n` times; `n` counts as even, because
    /// one more time leads into an obstacle that the goal is in.
    Crossings,
    /// None is known in these terms.
    Unknown,
}

impl PathBound {
    /// The bound in metres, for boundaries given by their perimeters in metres and how often the line from start to goal
    /// crosses them; `None` if none is known.
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

/// Defines a bug: its name, the strategy that an engine acts by, and the path's bound. All are complete.
macro_rules! bug_algorithm {
    ($(#[$doc:meta])* $bug:ident, $name:literal, $strategy:ty, PathBound::$bound:ident) => {
        $(#[$doc])*
        #[derive(Debug, Clone)]
        pub struct $bug(crate::nav::bug::engine::Engine<$strategy>);

        impl $bug {
            /// A run to a goal given relative to the robot's start: metres ahead and to the left.
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
