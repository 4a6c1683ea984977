use std::ops::ControlFlow;

use super::a_to_b::HANDOVER;
use super::{AToB, AToBObservation, AToBOutcome};
use crate::geometry::Pose;
use crate::io::control::{Behaviour, Decision, Manoeuvre, SensedBy, Senses, halts};
use crate::io::{Manoeuvres, Odometry, Result, StallDetector};

halts!(AToBOutcome {
    Reached: "the goal is reached",
    Missed: "the robot stands beside the goal",
    Blocked: "something holds the robot",
});

impl Behaviour for AToB {
    type Observation = AToBObservation;
    type Command = Manoeuvre;
    type Outcome = AToBOutcome;

    fn period(&self) -> f64 {
        self.parameters.period
    }

    fn step(&mut self, _time: f64, seen: &AToBObservation) -> Decision<Self> {
        Ok(match AToB::step(self, seen)? {
            _ if seen.stalled => ControlFlow::Break(AToBOutcome::Blocked),
            Some(command) => ControlFlow::Continue(command),
            None if seen.pose.distance_to(self.goal.position) > HANDOVER => {
                ControlFlow::Break(AToBOutcome::Missed)
            }
            None => ControlFlow::Break(AToBOutcome::Reached),
        })
    }
}

impl<R: Odometry + Manoeuvres + StallDetector + ?Sized> Senses<R> for AToB {
    fn sense(&mut self, robot: &mut R, _time: f64, seen: &mut AToBObservation) -> Result<()> {
        seen.read(robot, R::pose)
    }
}

impl AToBObservation {
    fn read<R: Odometry + Manoeuvres + StallDetector + ?Sized>(
        &mut self,
        robot: &mut R,
        estimate: impl FnOnce(&mut R) -> Result<Pose>,
    ) -> Result<()> {
        *self = Self { pose: estimate(robot)?, done: robot.is_done()?, stalled: robot.is_stalled()? };
        Ok(())
    }
}

impl AToB {
    /// The behaviour with another pose estimate than odometry, such as one corrected by landmarks.
    pub fn by<R: Odometry + Manoeuvres + StallDetector + ?Sized>(
        &mut self,
        mut estimate: impl FnMut(&mut R) -> Result<Pose>,
    ) -> impl Senses<R, Observation = AToBObservation, Command = Manoeuvre, Outcome = AToBOutcome> {
        SensedBy::new(self, move |robot: &mut R, _, seen: &mut AToBObservation| {
            seen.read(robot, &mut estimate)
        })
    }
}
