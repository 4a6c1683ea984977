use std::ops::ControlFlow;

use super::{DepthHold, DepthHoldParameters};
use crate::geometry::{Vector3, angle_difference};
use crate::io::control::{Behaviour, Command, Decision, Senses, halts};
use crate::io::{Attitude, DepthSensor, Error, ErrorKind, Inertial, Motors, Result};
use crate::kinematics::marine::{Allocation, Craft, CraftSpec, MAX_THRUSTERS, Wrench};
use crate::parameter::{require_finite, require_not_negative, require_positive};

/// Parameters of [`Dive`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiveParameters {
    /// Depth to which the sensor shall come (m).
    pub depth: f64,
    /// Heading to hold (rad).
    pub heading: f64,
    /// Seconds until the dive is over.
    pub duration: f64,
    /// Bandwidth of heading and pitch (rad/s).
    pub turning: f64,
    /// Seconds between steps.
    pub period: f64,
    /// The controller of depth.
    pub hold: DepthHoldParameters,
}

impl Default for DiveParameters {
    /// A metre deep, for 80 s.
    fn default() -> Self {
        Self {
            depth: 1.0,
            heading: 0.0,
            duration: 80.0,
            turning: 0.8,
            period: 0.1,
            hold: DepthHoldParameters::default(),
        }
    }
}

/// What [`Dive`] goes by.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DiveObservation {
    /// Metres from the surface to the sensor.
    pub depth: f64,
    /// How the craft is turned.
    pub attitude: Attitude,
    /// How it turns about its own axes (rad/s).
    pub rates: Vector3,
}

/// How a dive ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum DiveOutcome {
    /// The craft held its depth until the dive was over.
    Over,
    /// The time was over.
    TimedOut,
    /// Who watched had seen enough.
    Stopped,
}

halts!(DiveOutcome { Over: "the dive is over" });

/// A share of its full speed for each of a craft's first thrusters, -1 to 1. Stopped thrusters let a craft
/// with buoyancy surface.
///
/// ```
/// use roverlab::drive::marine::Thrust;
/// assert_eq!(Thrust::new(&[0.5, -0.5])?.commands(), [0.5, -0.5]);
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Thrust {
    commands: [f64; MAX_THRUSTERS],
    thrusters: usize,
}

impl Thrust {
    /// Commands for the thrusters from the first on. Fails with more of them than a craft may have.
    pub fn new(commands: &[f64]) -> Result<Self> {
        if commands.len() > MAX_THRUSTERS {
            return Err(Error::invalid_input("number of thrusters", commands.len(), "at most 8"));
        }
        let mut all = [0.0; MAX_THRUSTERS];
        all[..commands.len()].copy_from_slice(commands);
        Ok(Self { commands: all, thrusters: commands.len() })
    }

    /// The commands.
    pub fn commands(&self) -> &[f64] {
        &self.commands[..self.thrusters]
    }
}

impl<R: Motors + ?Sized> Command<R> for Thrust {
    fn apply(&self, robot: &mut R) -> Result<()> {
        (1..).zip(self.commands()).try_for_each(|(motor, &command)| robot.set_motor(motor, command))
    }

    fn stop(robot: &mut R) -> Result<()> {
        // The first motor that the craft does not have ends the row; RoBIOS gives no reason for its refusal.
        for motor in 1..=MAX_THRUSTERS as u8 {
            match robot.set_motor(motor, 0.0) {
                Err(error)
                    if motor > 1 && matches!(error.kind(), ErrorKind::Unsupported | ErrorKind::Other) =>
                {
                    break;
                }
                stopped => stopped?,
            }
        }
        Ok(())
    }
}

/// Brings a craft to a depth and holds it there, level and on its heading (book, section 8.3).
///
/// The thrusters' forces follow from the craft's own model: damping, buoyancy and inertia with added mass.
/// What the model does not know, such as a load that is not trimmed, is learnt as a force.
///
/// ```
/// use roverlab::drive::marine::{Dive, DiveOutcome, DiveParameters};
/// use roverlab::geometry::{Aabb, Point, Pose};
/// use roverlab::io::control::run;
/// use roverlab::io::sim::{SimOptions, Simulation};
/// use roverlab::kinematics::marine::CraftSpec;
/// use roverlab::world::{RobotSpec, Scene, World};
///
/// let pool = World { water_level: Some(3.0), ..World::empty(20.0, 20.0) };
/// let scene = Scene::with_robot(pool, RobotSpec::mako(), Pose::new(10.0, 10.0, 0.0));
/// let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, 1))?;
/// let parameters = DiveParameters { depth: 1.5, duration: 30.0, ..DiveParameters::default() };
/// let mut dive = Dive::new(&CraftSpec::mako(), parameters)?;
/// assert_eq!(run(&mut simulation.robot(0)?, &mut dive, 60.0, |_, _, _| {})?, DiveOutcome::Over);
/// let keel = simulation.truth().pose_in_space(0)?.position.z;
/// assert!((3.0 - 0.26 - keel - 1.5).abs() < 0.02, "{keel}");
/// # Ok::<(), roverlab::io::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Dive {
    parameters: DiveParameters,
    craft: Craft,
    allocation: Allocation,
    hold: Option<DepthHold>,
    /// Pitch and yaw as turn rates and readings agree.
    pitch: f64,
    yaw: f64,
    begun: Option<f64>,
    before: f64,
}

/// The share of the difference between a reading of the attitude and what turn rates say that a step
/// believes.
const BELIEVED: f64 = 0.1;

impl Dive {
    /// A dive of a craft of this description.
    pub fn new(craft: &CraftSpec, parameters: DiveParameters) -> Result<Self> {
        require_not_negative("depth", parameters.depth)?;
        require_finite("heading", parameters.heading)?;
        require_positive("duration", parameters.duration)?;
        require_positive("turning", parameters.turning)?;
        require_positive("period", parameters.period)?;
        // The model's own step does not matter to what is asked of it.
        let craft = Craft::new(craft, 0.1)?;
        DepthHold::new(&craft, parameters.depth, parameters.hold)?;
        let allocation = Allocation::new(&craft);
        Ok(Self { parameters, craft, allocation, hold: None, pitch: 0.0, yaw: 0.0, begun: None, before: 0.0 })
    }

    /// Changes the depth (m) to which the craft shall come from now on.
    pub fn set_depth(&mut self, depth: f64) -> Result<()> {
        require_not_negative("depth", depth)?;
        self.parameters.depth = depth;
        Ok(())
    }

    /// The commands for the thrusters at a time.
    fn thrust(&mut self, time: f64, seen: &DiveObservation) -> Result<Thrust> {
        let seconds = if self.hold.is_some() { time - self.before } else { self.parameters.period };
        self.before = time;
        if self.hold.is_none() {
            (self.pitch, self.yaw) = (seen.attitude.pitch, seen.attitude.yaw);
            self.hold = Some(DepthHold::new(&self.craft, seen.depth, self.parameters.hold)?);
        }
        self.pitch = believed(self.pitch + seen.rates.y * seconds, seen.attitude.pitch);
        self.yaw = believed(self.yaw + seen.rates.z * seconds, seen.attitude.yaw);
        let (turning, inertia) = (self.parameters.turning, self.craft.inertia());
        let moment = |inertia: f64, off: f64, rate: f64| inertia * turning * (turning * off - 2.0 * rate);
        let level = moment(inertia[4], -self.pitch, seen.rates.y);
        let ahead = moment(inertia[5], angle_difference(self.parameters.heading, self.yaw), seen.rates.z);
        let Some(hold) = &mut self.hold else { return Thrust::new(&[]) };
        let down = hold.step(seen.depth, self.parameters.depth, seconds);
        let upright = Wrench { force: Vector3::z() * -down, moment: Vector3::y() * level };
        let upright = self.allocation.share(&upright);
        hold.told(down * upright.share);
        let turned = self.allocation.share(&Wrench { moment: Vector3::z() * ahead, ..Wrench::NONE });
        let both = upright.commands.iter().zip(&turned.commands);
        let commands: Vec<f64> = both.map(|(a, b)| (a + b).clamp(-1.0, 1.0)).collect();
        Thrust::new(&commands[..self.craft.thrusters().len()])
    }
}

/// An angle between what is expected and what is read.
fn believed(expected: f64, read: f64) -> f64 {
    expected + BELIEVED * angle_difference(read, expected)
}

impl Behaviour for Dive {
    type Observation = DiveObservation;
    type Command = Thrust;
    type Outcome = DiveOutcome;

    fn period(&self) -> f64 {
        self.parameters.period
    }

    fn step(&mut self, time: f64, seen: &DiveObservation) -> Decision<Self> {
        if !(seen.depth.is_finite() && seen.depth >= 0.0) {
            return Err(Error::invalid_input("observed depth", seen.depth, "a finite number of at least 0"));
        }
        let angles = [seen.attitude.pitch, seen.attitude.yaw, seen.rates.y, seen.rates.z];
        if let Some(angle) = angles.iter().find(|angle| !angle.is_finite()) {
            return Err(Error::invalid_input("observed attitude", angle, "finite numbers"));
        }
        let begun = *self.begun.get_or_insert(time);
        if time - begun >= self.parameters.duration {
            return Ok(ControlFlow::Break(DiveOutcome::Over));
        }
        Ok(ControlFlow::Continue(self.thrust(time, seen)?))
    }
}

impl<R: DepthSensor + Inertial + ?Sized> Senses<R> for Dive {
    fn sense(&mut self, robot: &mut R, _time: f64, seen: &mut DiveObservation) -> Result<()> {
        seen.depth = robot.depth()?;
        seen.attitude = robot.attitude()?;
        seen.rates = robot.turn_rates()?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nonsense_is_refused_and_a_broken_sensor_is_named() {
        let with = |change: &dyn Fn(&mut DiveParameters)| {
            let mut parameters = DiveParameters::default();
            change(&mut parameters);
            Dive::new(&CraftSpec::mako(), parameters).map(|_| ()).unwrap_err().to_string()
        };
        assert!(with(&|p| p.depth = -1.0).contains("depth"));
        assert!(with(&|p| p.hold.observer = f64::NAN).contains("observer"));
        assert!(with(&|p| p.period = 0.0).contains("period"));
        let mut dive = Dive::new(&CraftSpec::mako(), DiveParameters::default()).unwrap();
        let broken = DiveObservation { depth: f64::NAN, ..DiveObservation::default() };
        assert!(dive.step(0.0, &broken).unwrap_err().to_string().contains("depth"));
        assert!(Thrust::new(&[0.0; 9]).is_err());
    }
}
