use super::behaviour::{Behaviour, Command, Decision, Halt, Senses};
use crate::geometry::{Pose, Twist};
use crate::io::{Drive, Lidar, LidarScan, Manoeuvres, Odometry, Result};

/// A scan with the pose and speed by odometry: the observation of navigation and racing.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LidarObservation {
    /// Lidar scan.
    pub scan: LidarScan,
    /// Pose by odometry at the time of the scan.
    pub odometry: Pose,
    /// Velocity by odometry.
    pub speed: Twist,
}

impl LidarObservation {
    /// Reads the sensors of a robot.
    pub fn read<R: Odometry + Lidar + ?Sized>(&mut self, robot: &mut R) -> Result<()> {
        robot.scan_into(&mut self.scan)?;
        self.odometry = robot.pose()?;
        self.speed = robot.speed()?;
        Ok(())
    }
}

impl<R: Drive + ?Sized> Command<R> for Twist {
    fn apply(&self, robot: &mut R) -> Result<()> {
        robot.set_speed(*self)
    }

    fn stop(robot: &mut R) -> Result<()> {
        robot.stop()
    }
}

/// A velocity, or a short manoeuvre executed by the drive itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Manoeuvre {
    /// Drive at this speed.
    Speed(Twist),
    /// Drive straight for a distance (m) at a speed (m/s).
    Straight(f64, f64),
    /// Turn on the spot by an angle (rad) at a rate (rad/s).
    Turn(f64, f64),
    /// Continue with the previous command.
    Continue,
}

impl<R: Drive + Manoeuvres + ?Sized> Command<R> for Manoeuvre {
    fn apply(&self, robot: &mut R) -> Result<()> {
        match *self {
            Self::Speed(twist) => robot.set_speed(twist),
            Self::Straight(distance, speed) => robot.straight(distance, speed),
            Self::Turn(angle, speed) => robot.turn(angle, speed),
            Self::Continue => Ok(()),
        }
    }

    fn stop(robot: &mut R) -> Result<()> {
        robot.stop()
    }
}

/// A behaviour with a function that reads its observations from the robot at a time: from other sensors, or
/// with a better pose estimate than odometry. The function also [prepares](Senses::prepare) the robot if
/// necessary.
///
/// ```
/// use roverlab::drive::{AToB, AToBObservation, AToBOutcome, AToBParameters, Goal, Method};
/// use roverlab::geometry::{Point, Pose};
/// use roverlab::io::Manoeuvres;
/// use roverlab::io::control::{SensedBy, run};
/// use roverlab::io::sim::{SimOptions, SimRobot, Simulation};
/// use roverlab::world::{RobotSpec, Scene, World};
/// let scene = Scene::with_robot(World::empty(2.0, 2.0), RobotSpec::s4(), Pose::new(0.5, 0.5, 0.0));
/// let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 1))?;
/// let truth = simulation.truth();
/// // Another pose estimate than odometry: here the ground truth, relative to the start.
/// let mut drive = AToB::new(Method::Turn, Goal::point(Point::new(1.0, 0.5)), AToBParameters::default())?;
/// let mut sensed = SensedBy::new(&mut drive, |robot: &mut SimRobot, _, seen: &mut AToBObservation| {
///     seen.done = robot.is_done()?;
///     seen.pose = scene.robots[0].pose.inverse().compose(&truth.pose(0)?);
///     Ok(())
/// });
/// assert_eq!(run(&mut simulation.robot(0)?, &mut sensed, 60.0, |_, _, _| {})?, AToBOutcome::Reached);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct SensedBy<'b, B: ?Sized, F> {
    behaviour: &'b mut B,
    sense: F,
}

impl<'b, B: ?Sized, F> SensedBy<'b, B, F> {
    /// Binds a behaviour to a sensing function.
    pub fn new(behaviour: &'b mut B, sense: F) -> Self {
        Self { behaviour, sense }
    }

    /// Who decides.
    pub fn behaviour(&self) -> &B {
        self.behaviour
    }
}

impl<B: Behaviour + ?Sized, F> Behaviour for SensedBy<'_, B, F> {
    type Observation = B::Observation;
    type Command = B::Command;
    type Outcome = B::Outcome;

    fn period(&self) -> f64 {
        self.behaviour.period()
    }

    fn step(&mut self, time: f64, seen: &B::Observation) -> Decision<B> {
        self.behaviour.step(time, seen)
    }

    fn halt(&mut self, halt: Halt) -> B::Outcome {
        self.behaviour.halt(halt)
    }
}

impl<R: ?Sized, B, F> Senses<R> for SensedBy<'_, B, F>
where
    B: Behaviour + ?Sized,
    F: FnMut(&mut R, f64, &mut B::Observation) -> Result<()>,
{
    fn sense(&mut self, robot: &mut R, time: f64, seen: &mut B::Observation) -> Result<()> {
        (self.sense)(robot, time, seen)
    }
}
