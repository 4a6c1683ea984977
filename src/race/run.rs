use std::ops::ControlFlow;

use super::event::{EventPhase, EventRacer};
use super::racer::{RacePhase, Racer};
use super::sight::{ConeSighting, sightings};
use crate::geometry::{Pose, Twist};
use crate::io::control::{Behaviour, Decision, Senses, halts};
use crate::io::reading::check_scan;
use crate::io::{Lidar, LidarScan, Odometry, Result};

/// Observation of a racer.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RaceObservation {
    /// Odometry pose.
    pub odometry: Pose,
    /// Odometry speed.
    pub speed: Twist,
    /// Cones detected by lidar or camera.
    pub cones: Vec<ConeSighting>,
    /// Scan with the cones; unused with a camera.
    pub scan: LidarScan,
}

/// Outcome of a race or an event.
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
    ($racer:ident, $phase:ident, $look:expr) => {
        impl Behaviour for $racer {
            type Observation = RaceObservation;
            type Command = Twist;
            type Outcome = RaceOutcome;

            fn period(&self) -> f64 {
                self.parameters.period
            }

            fn step(&mut self, _time: f64, seen: &RaceObservation) -> Decision<Self> {
                check_scan(&seen.scan)?;
                $look(self, &seen.scan);
                let command = self.decide(seen.odometry, seen.speed, &seen.cones);
                Ok(match self.phase() {
                    _ if !self.is_done(seen.speed) => ControlFlow::Continue(command),
                    $phase::Lost => ControlFlow::Break(RaceOutcome::Lost),
                    _ => ControlFlow::Break(RaceOutcome::Finished),
                })
            }
        }

        impl<R: Odometry + Lidar + ?Sized> Senses<R> for $racer {
            fn sense(&mut self, robot: &mut R, _time: f64, seen: &mut RaceObservation) -> Result<()> {
                robot.scan_into(&mut seen.scan)?;
                seen.cones = sightings(&seen.scan);
                (seen.odometry, seen.speed) = (robot.pose()?, robot.speed()?);
                Ok(())
            }
        }
    };
}

races!(Racer, RacePhase, Racer::see_others);
// Events are driven alone.
races!(EventRacer, EventPhase, |_: &mut EventRacer, _: &LidarScan| ());
