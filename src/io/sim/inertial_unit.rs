use super::terrain::GRAVITY;
use super::{NoiseModel, TICK, TICKS_PER_SECOND};
use crate::geometry::{Pose3, Vector3, math, normalize_angle};
use crate::io::{Attitude, Error, Result};
use crate::random::Stream;
use crate::world::InertialSpec;

/// Measures a robot's motion in space.
#[derive(Debug)]
pub(super) struct InertialUnit {
    spec: InertialSpec,
    pose: Pose3,
    velocity: Vector3,
    turn_rates: Vector3,
    acceleration: Vector3,
    errors: [Errors; 3],
}

/// Time in which the drift of errors reaches the size of the initial error (s).
const WANDER: f64 = 60.0;
/// Attitude errors do not drift in roll and pitch, which have gravity as a reference; only the yaw drifts.
const YAW: Vector3 = Vector3::new(0.0, 0.0, 1.0);
const ALL: Vector3 = Vector3::new(1.0, 1.0, 1.0);

impl InertialUnit {
    /// The inertial unit of a robot, if it has one.
    pub(super) fn of(spec: InertialSpec, streams: &Stream) -> Option<Box<Self>> {
        let none = spec == InertialSpec::default();
        let errors =
            ["attitude", "turn rates", "acceleration"].map(|name| Errors::new(streams.child(name, 0)));
        (!none).then(|| {
            Box::new(Self {
                spec,
                pose: Pose3::default(),
                velocity: Vector3::zeros(),
                turn_rates: Vector3::zeros(),
                acceleration: Vector3::zeros(),
                errors,
            })
        })
    }

    /// Restarts at the pose where the robot was placed.
    pub(super) fn begin(&mut self, pose: Pose3) {
        (self.pose, self.velocity, self.turn_rates) = (pose, Vector3::zeros(), Vector3::zeros());
        self.acceleration = pose.attitude.inverse() * (Vector3::z() * GRAVITY);
    }

    /// Updates the measurements with the robot's motion in a tick.
    pub(super) fn feel(&mut self, pose: Pose3) {
        let velocity = (pose.position - self.pose.position) / TICK;
        let pull = (velocity - self.velocity) / TICK + Vector3::z() * GRAVITY;
        let turn = (self.pose.attitude.inverse() * pose.attitude).into_inner();
        let (sine, half) = (turn.imag().norm(), turn.imag() * turn.w.signum());
        let per_sine = if sine > 0.0 { 2.0 * math::asin(sine.min(1.0)) / sine } else { 2.0 };
        self.turn_rates = half * (per_sine / TICK);
        self.acceleration = pose.attitude.inverse() * pull;
        (self.pose, self.velocity) = (pose, velocity);
    }

    pub(super) fn attitude(&mut self, tick: u64, noise: &NoiseModel) -> Result<Attitude> {
        self.spec.attitude.ok_or_else(|| Error::unsupported("attitude"))?;
        let Attitude { roll, pitch, yaw } = Attitude::of(&self.pose);
        let found = self.errors[0].add(Vector3::new(roll, pitch, yaw), noise.attitude, YAW, tick);
        let [roll, pitch, yaw] = [found.x, found.y, found.z].map(normalize_angle);
        Ok(Attitude { roll, pitch, yaw })
    }

    pub(super) fn turn_rates(&mut self, tick: u64, noise: &NoiseModel) -> Result<Vector3> {
        self.spec.turn_rates.ok_or_else(|| Error::unsupported("turn rates"))?;
        Ok(self.errors[1].add(self.turn_rates, noise.turn_rate, ALL, tick))
    }

    pub(super) fn acceleration(&mut self, tick: u64, noise: &NoiseModel) -> Result<Vector3> {
        self.spec.acceleration.ok_or_else(|| Error::unsupported("acceleration"))?;
        Ok(self.errors[2].add(self.acceleration, noise.acceleration, ALL, tick))
    }
}

/// Errors of three readings in standard deviations: a constant part and a drifting part.
#[derive(Debug)]
struct Errors {
    offset: Vector3,
    since: u64,
    stream: Stream,
}

impl Errors {
    fn new(mut stream: Stream) -> Self {
        Self { offset: three(&mut stream), since: 0, stream }
    }

    /// Readings with errors at a tick.
    fn add(&mut self, true_ones: Vector3, sigma: f64, wander: Vector3, tick: u64) -> Vector3 {
        if sigma == 0.0 {
            return true_ones;
        }
        let seconds = (tick - self.since) as f64 / TICKS_PER_SECOND;
        self.since = tick;
        self.offset += three(&mut self.stream).component_mul(&wander) * (seconds / WANDER).sqrt();
        true_ones + (self.offset + three(&mut self.stream)) * sigma
    }
}

fn three(stream: &mut Stream) -> Vector3 {
    Vector3::new(stream.normal(), stream.normal(), stream.normal())
}
