use std::ops::ControlFlow;

use super::behaviour::{Behaviour, Command, Decision, Halt, Senses, Verdict};
use super::clock::Stopwatch;
use crate::io::{Clock, Result};
use crate::parameter::require_positive;

/// A step of a run, as seen by its observer.
#[derive(Debug)]
pub struct Step<'a, O> {
    /// Start of the step by the robot's clock (s).
    pub time: f64,
    /// Observation of the step; at a halt, the last one.
    pub seen: &'a O,
}

/// Runs a behaviour on a robot for at most `time_limit` seconds; infinity disables the limit. `watch` is
/// called at each step, before the command is applied, and at the end, unless the time is over before the
/// first observation; if it breaks or fails, the run ends.
///
/// Steps are one period apart. After a late step the next one starts at once; missed steps are not made up
/// for. The robot is stopped at every kind of end; an error while stopping does not hide an earlier one.
///
/// Fails if the robot does, or if its clock stands still, runs backwards or is not finite. A clock that jumps
/// ahead counts as elapsed time.
pub fn run<R, B, V>(
    robot: &mut R,
    behaviour: &mut B,
    time_limit: f64,
    mut watch: impl FnMut(&mut R, &mut B, Step<'_, B::Observation>) -> V,
) -> Result<B::Outcome>
where
    R: Clock + ?Sized,
    B: Senses<R> + ?Sized,
    B::Command: Command<R>,
    V: Verdict,
{
    let mut run = Run::new(behaviour, time_limit)?;
    let ended = loop {
        let decision = match run.decide(robot, behaviour) {
            Ok(decision) => decision,
            Err(error) => break Err(error),
        };
        let watched = match run.clock {
            Some(clock) if run.has_sensed => {
                watch(robot, behaviour, Step { time: clock.time(), seen: &run.seen }).verdict()
            }
            _ => Ok(ControlFlow::Continue(())),
        };
        match (watched, decision) {
            (Err(error), _) => break Err(error),
            (Ok(_), ControlFlow::Break(outcome)) => break Ok(outcome),
            (Ok(ControlFlow::Break(())), _) => break Ok(behaviour.halt(Halt::Stopped)),
            (Ok(ControlFlow::Continue(())), ControlFlow::Continue(command)) => {
                if let Err(error) = command.apply(robot).and_then(|()| run.rest(robot)) {
                    break Err(error);
                }
            }
        }
    };
    stopping::<_, B::Command, _>(robot, ended)
}

/// Stops a robot after its run, and returns the run's result.
pub(crate) fn stopping<R: ?Sized, C: Command<R>, T>(robot: &mut R, result: Result<T>) -> Result<T> {
    let stopped = C::stop(robot);
    result.and_then(|value| stopped.map(|()| value))
}

/// A behaviour's run with steps paced from outside, such as by a [`Fleet`](crate::io::sim::Fleet):
///
/// ```
/// use roverlab::drive::{RandomDrive, RandomDriveParameters};
/// use roverlab::geometry::Pose;
/// use roverlab::io::control::{Behaviour, Run};
/// use roverlab::io::sim::{Fleet, SimOptions};
/// use roverlab::random::Stream;
/// use roverlab::world::{RobotSpec, Scene, World};
///
/// # fn main() -> roverlab::io::Result<()> {
/// let scene = Scene::with_robot(World::walled(1.5, 1.5), RobotSpec::s4(), Pose::new(0.7, 0.7, 0.3));
/// let mut fleet = Fleet::new(&scene, SimOptions::with_noise(1.0, 1))?;
/// let mut drive = RandomDrive::new(RandomDriveParameters::default(), Stream::new(1))?;
/// let mut run = Run::new(&drive, 20.0)?;
/// fleet.control(0, drive.period(), move |robot| Ok(run.step(robot, &mut drive)?.map_break(|_| ())))?;
/// fleet.run_for(60.0)?;
/// assert!((fleet.time() - 20.0).abs() < 0.1, "the run was over, and the fleet's with it");
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Run<B: Behaviour + ?Sized> {
    seen: B::Observation,
    has_sensed: bool,
    period: f64,
    limit: f64,
    /// Set at the first step.
    clock: Option<Stopwatch>,
    due: f64,
}

impl<B: Behaviour + ?Sized> Run<B> {
    /// Creates a run that starts with its first step and takes at most `time_limit` seconds. Fails for a
    /// limit that is NaN and a period that is not positive.
    pub fn new(behaviour: &B, time_limit: f64) -> Result<Self> {
        let period = behaviour.period();
        require_positive("control period", period)?;
        Stopwatch::check_limit(time_limit)?;
        Ok(Self {
            seen: B::Observation::default(),
            has_sensed: false,
            period,
            limit: time_limit,
            clock: None,
            due: 0.0,
        })
    }

    /// Makes one step: reads, decides, and applies the command. Stops the robot at the end and at an error.
    pub fn step<R>(&mut self, robot: &mut R, behaviour: &mut B) -> Result<ControlFlow<B::Outcome>>
    where
        R: Clock + ?Sized,
        B: Senses<R>,
        B::Command: Command<R>,
    {
        let applied = self.decide(robot, behaviour).and_then(|decision| match decision {
            ControlFlow::Continue(command) => command.apply(robot).map(ControlFlow::Continue),
            ControlFlow::Break(outcome) => Ok(ControlFlow::Break(outcome)),
        });
        match applied {
            Ok(ControlFlow::Continue(())) => applied,
            ended => stopping::<_, B::Command, _>(robot, ended),
        }
    }

    /// Reads and decides, unless the time limit is reached.
    fn decide<R>(&mut self, robot: &mut R, behaviour: &mut B) -> Decision<B>
    where
        R: Clock + ?Sized,
        B: Senses<R>,
    {
        let clock = match &mut self.clock {
            Some(clock) => clock,
            clock => {
                behaviour.prepare(robot)?;
                let begun = clock.insert(Stopwatch::start(robot, self.limit)?);
                self.due = begun.time();
                begun
            }
        };
        let time = clock.step(robot)?;
        if clock.is_over() {
            return Ok(ControlFlow::Break(behaviour.halt(Halt::TimedOut)));
        }
        behaviour.sense(robot, time, &mut self.seen)?;
        self.has_sensed = true;
        behaviour.step(time, &self.seen)
    }

    /// Waits until the next step is due or the time limit is reached.
    pub fn rest<R: Clock + ?Sized>(&mut self, robot: &mut R) -> Result<()> {
        if let Some(clock) = &mut self.clock {
            self.due = clock.wait_until(robot, self.due + self.period)?;
        }
        Ok(())
    }
}
