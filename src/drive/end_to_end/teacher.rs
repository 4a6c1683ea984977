use std::ops::ControlFlow;

use super::driver::NetworkDriver;
use super::examples::SteeringExamples;
use super::sight::{check_sight, see_road_into};
use crate::ParameterError;
use crate::drive::lane_keeping::{LaneKeeper, LaneObservation, LaneOutcome};
use crate::geometry::Twist;
use crate::io::control::{Behaviour, Decision, Senses};
use crate::io::{self, Camera, Odometry, Resolution};
use crate::parameter::{require_not_negative, require_positive};
use crate::random::Stream;
use crate::vision::network::MapSize;

/// Parameters of a [`SteeringTeacher`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TeacherParameters {
    /// Speed (m/s).
    pub speed: f64,
    /// Mean time between disturbances (s).
    pub pause: f64,
    /// Duration of a disturbance (s).
    pub duration: f64,
    /// Largest curvature that a disturbance adds to the steering (1/m).
    pub disturbance: f64,
    /// Seed of the disturbances.
    pub seed: u64,
}

impl Default for TeacherParameters {
    /// At 1 m/s, every 1.5 s a disturbance of 0.4 s by up to 1.5/m.
    fn default() -> Self {
        Self { speed: 1.0, pause: 1.5, duration: 0.4, disturbance: 1.5, seed: 1 }
    }
}

impl TeacherParameters {
    fn validate(&self) -> Result<(), ParameterError> {
        require_positive("speed", self.speed)?;
        require_positive("pause", self.pause)?;
        require_not_negative("duration", self.duration)?;
        require_not_negative("disturbance", self.disturbance)
    }
}

/// Collects examples of steering: the lane keeper's curvature for each image. It drives itself, disturbed now
/// and then, or has a network drive. Images in which the lane keeper knows no lane are left out.
#[derive(Debug, Clone)]
pub struct SteeringTeacher {
    keeper: LaneKeeper,
    pupil: Option<NetworkDriver>,
    parameters: TeacherParameters,
    examples: SteeringExamples,
    size: MapSize,
    input: Vec<f32>,
    random: Stream,
    /// Curvature of the present disturbance (1/m), and when it begins and ends (s).
    push: f64,
    when: [f64; 2],
}

impl SteeringTeacher {
    /// Creates a teacher that drives itself, for a network that sees images of a size.
    ///
    /// # Errors
    ///
    /// If a parameter is out of range.
    pub fn new(
        keeper: LaneKeeper,
        size: MapSize,
        parameters: TeacherParameters,
    ) -> Result<Self, ParameterError> {
        parameters.validate()?;
        check_sight(size)?;
        let random = Stream::new(parameters.seed).child("disturbances", 0);
        Ok(Self {
            keeper,
            pupil: None,
            parameters,
            examples: SteeringExamples::new(size),
            size,
            input: vec![0.0; size.len()],
            random,
            push: 0.0,
            when: [0.0; 2],
        })
    }

    /// Has a network drive.
    #[must_use]
    pub fn with_pupil(self, pupil: NetworkDriver) -> Self {
        Self { pupil: Some(pupil), ..self }
    }

    /// The lane keeper.
    pub fn keeper(&self) -> &LaneKeeper {
        &self.keeper
    }

    /// What has been collected.
    pub fn into_examples(self) -> SteeringExamples {
        self.examples
    }

    /// Curvature that the present disturbance adds (1/m).
    fn disturbance(&mut self, time: f64) -> f64 {
        let p = &self.parameters;
        if time >= self.when[1] {
            let begin = time + p.pause * self.random.between(0.5, 1.5);
            self.when = [begin, begin + p.duration];
            self.push = p.disturbance * self.random.between(-1.0, 1.0);
        }
        if time >= self.when[0] { self.push } else { 0.0 }
    }
}

impl Behaviour for SteeringTeacher {
    type Observation = LaneObservation;
    type Command = Twist;
    type Outcome = LaneOutcome;

    fn period(&self) -> f64 {
        self.keeper.period()
    }

    fn step(&mut self, time: f64, seen: &LaneObservation) -> Decision<Self> {
        let shown = match self.keeper.step(time, seen)? {
            ControlFlow::Continue(shown) => shown,
            ControlFlow::Break(outcome) => return Ok(ControlFlow::Break(outcome)),
        };
        let curvature = (shown.linear > 0.0).then(|| shown.angular / shown.linear);
        if let Some(curvature) = curvature {
            see_road_into(&seen.image, self.size, &mut self.input).map_err(io::Error::caused_by)?;
            self.examples.push(&self.input, curvature);
        }
        let disturbance = self.disturbance(time);
        let driven = match &mut self.pupil {
            Some(pupil) => pupil.steer(&seen.image).map_err(io::Error::caused_by)?,
            None => curvature.unwrap_or(0.0),
        };
        let speed = self.parameters.speed;
        Ok(ControlFlow::Continue(Twist::new(speed, speed * (driven + disturbance))))
    }
}

impl<R: Camera + Odometry + ?Sized> Senses<R> for SteeringTeacher {
    fn prepare(&mut self, robot: &mut R) -> io::Result<()> {
        robot.set_resolution(Resolution::Qvga)
    }

    fn sense(&mut self, robot: &mut R, _time: f64, seen: &mut LaneObservation) -> io::Result<()> {
        seen.read(robot)
    }
}
