use std::ops::ControlFlow;

use super::helm::{Helm, Push};
use super::{DepthHoldParameters, DiveObservation, Thrust};
use crate::io::control::{Behaviour, Decision, Senses, halts};
use crate::io::{DepthSensor, Inertial, Result};
use crate::kinematics::marine::CraftSpec;
use crate::parameter::{require_finite, require_not_negative, require_positive};

/// Parameters of [`Dive`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DiveParameters {
    /// Desired depth of the pressure sensor (m).
    pub depth: f64,
    /// Heading to hold (rad).
    pub heading: f64,
    /// Duration of the dive (s).
    pub duration: f64,
    /// Bandwidth of the heading and pitch controllers (rad/s).
    pub turning: f64,
    /// Control period (s).
    pub period: f64,
    /// Parameters of the depth controller.
    pub hold: DepthHoldParameters,
}

impl Default for DiveParameters {
    /// One metre deep, for 80 s.
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

/// Outcome of a [`Dive`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum DiveOutcome {
    /// The craft held its depth until the dive was over.
    Over,
    /// The time limit came first.
    TimedOut,
    /// The observer stopped the run.
    Stopped,
}

halts!(DiveOutcome { Over: "the dive is over" });

/// Brings a craft to a depth and holds it there, level and on its heading (book, section 8.3).
///
/// The thrust follows from the model of the craft: damping, buoyancy, and inertia with added mass. What the
/// model lacks, such as an untrimmed load, is estimated as an unknown force.
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
    helm: Helm,
    begun: Option<f64>,
}

impl Dive {
    /// Creates a dive of a craft. Fails for parameters out of range.
    pub fn new(craft: &CraftSpec, parameters: DiveParameters) -> Result<Self> {
        require_not_negative("depth", parameters.depth)?;
        require_finite("heading", parameters.heading)?;
        require_positive("duration", parameters.duration)?;
        require_positive("turning", parameters.turning)?;
        require_positive("period", parameters.period)?;
        let helm = Helm::new(craft, parameters.turning, parameters.period, parameters.hold)?;
        Ok(Self { parameters, helm, begun: None })
    }

    /// Changes the desired depth (m).
    ///
    /// # Errors
    ///
    /// If the depth is negative or not finite.
    pub fn set_depth(&mut self, depth: f64) -> Result<()> {
        require_not_negative("depth", depth)?;
        self.parameters.depth = depth;
        Ok(())
    }
}

impl Behaviour for Dive {
    type Observation = DiveObservation;
    type Command = Thrust;
    type Outcome = DiveOutcome;

    fn period(&self) -> f64 {
        self.parameters.period
    }

    fn step(&mut self, time: f64, seen: &DiveObservation) -> Decision<Self> {
        seen.check()?;
        let begun = *self.begun.get_or_insert(time);
        if time - begun >= self.parameters.duration {
            return Ok(ControlFlow::Break(DiveOutcome::Over));
        }
        let DiveParameters { depth, heading, .. } = self.parameters;
        self.helm.observe(time, seen)?;
        let push = Push { ahead: 0.0, turn: self.helm.turn_to(heading) };
        Ok(ControlFlow::Continue(self.helm.thrust(depth, push)?))
    }
}

impl<R: DepthSensor + Inertial + ?Sized> Senses<R> for Dive {
    fn sense(&mut self, robot: &mut R, _time: f64, seen: &mut DiveObservation) -> Result<()> {
        seen.read(robot)
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
