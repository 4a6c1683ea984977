use super::{AToB, AToBCommand, AToBObservation, AToBOutcome};
use crate::geometry::{Pose, Twist};
use crate::io::beat::Beat;
use crate::io::{Clock, Drive, Result};

impl AToB {
    /// Drives a robot to the goal by its odometry, within `time_limit` seconds. `observe` is called after every step with
    /// the behaviour and the pose.
    pub fn run<R: Clock + Drive + ?Sized>(
        &mut self,
        robot: &mut R,
        time_limit: f64,
        observe: impl FnMut(&Self, Pose),
    ) -> Result<AToBOutcome> {
        self.run_with(robot, time_limit, R::pose, observe)
    }

    /// The same by any other estimate of the pose, such as one that landmarks correct.
    pub fn run_with<R: Clock + Drive + ?Sized>(
        &mut self,
        robot: &mut R,
        time_limit: f64,
        mut estimate: impl FnMut(&mut R) -> Result<Pose>,
        mut observe: impl FnMut(&Self, Pose),
    ) -> Result<AToBOutcome> {
        let mut beat = Beat::start(robot, self.parameters.period)?;
        loop {
            let time = beat.step(robot)?;
            let pose = estimate(robot)?;
            let observation = AToBObservation { pose, done: robot.is_done()? };
            let command = self.step(&observation)?;
            observe(self, pose);
            let outcome = if time >= time_limit {
                Some(AToBOutcome::TimedOut)
            } else if robot.is_stalled()? {
                Some(AToBOutcome::Blocked)
            } else {
                (command == AToBCommand::Stop).then_some(AToBOutcome::Reached)
            };
            if let Some(outcome) = outcome {
                robot.set_speed(Twist::STOP)?;
                return Ok(outcome);
            }
            self.tell(robot, command)?;
            beat.rest(robot)?;
        }
    }

    fn tell<R: Drive + ?Sized>(&self, robot: &mut R, command: AToBCommand) -> Result<()> {
        match command {
            AToBCommand::Speed(twist) => robot.set_speed(twist),
            AToBCommand::Straight(distance) => robot.straight(distance, self.parameters.creep_speed),
            AToBCommand::Turn(angle) => robot.turn(angle, self.parameters.turn_speed),
            AToBCommand::Continue | AToBCommand::Stop => Ok(()),
        }
    }
}
