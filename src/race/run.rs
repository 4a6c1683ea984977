use std::ops::ControlFlow;

use super::event::{EventPhase, EventRacer};
use super::racer::{RacePhase, Racer};
use crate::geometry::Twist;
use crate::io::control::{Behaviour, Decision, LidarObservation, Senses, halts};
use crate::io::{Lidar, Odometry, Result};

/// How a race or an event ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum RaceOutcome {
    /// The car has driven all laps, or to the finish, and stands.
    Finished,
    /// It was lost, and stands.
    Lost,
    /// The time limit was exceeded.
    TimedOut,
    /// The observer stopped it.
    Stopped,
}

halts!(RaceOutcome { Finished: "the race is finished", Lost: "the car is lost" });

/// Implements the behaviour traits for a racer with phases.
macro_rules! races {
    ($racer:ident, $phase:ident) => {
        impl Behaviour for $racer {
            type Observation = LidarObservation;
            type Command = Twist;
            type Outcome = RaceOutcome;

            fn period(&self) -> f64 {
                self.parameters.period
            }

            fn step(&mut self, _time: f64, seen: &LidarObservation) -> Decision<Self> {
                let command = $racer::step(self, seen.odometry, seen.speed, &seen.scan);
                Ok(match self.phase() {
                    _ if !self.is_done(seen.speed) => ControlFlow::Continue(command),
                    $phase::Lost => ControlFlow::Break(RaceOutcome::Lost),
                    _ => ControlFlow::Break(RaceOutcome::Finished),
                })
            }
        }

        impl<R: Odometry + Lidar + ?Sized> Senses<R> for $racer {
            fn sense(&mut self, robot: &mut R, _time: f64, seen: &mut LidarObservation) -> Result<()> {
                seen.read(robot)
            }
        }
    };
}

races!(Racer, RacePhase);
races!(EventRacer, EventPhase);
