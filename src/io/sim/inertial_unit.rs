use super::terrain::GRAVITY;
use super::{NoiseModel, TICK, TICKS_PER_SECOND};
use crate::geometry::{Pose3, Vector3, math, normalize_angle};
use crate::io::{Attitude, Error, Result};
use crate::random::Stream;
use crate::world::InertialSpec;

/// Simulated inertial unit of a robot.
#[derive(Debug)]
pub(super) struct InertialUnit {
    spec: InertialSpec,
    /// Axes in which the attitude's error is a random walk: gravity bounds that of roll and pitch, and a
    /// compass that of the yaw.
    wanders: Vector3,
    pose: Pose3,
    velocity: Vector3,
    turn_rates: Vector3,
    acceleration: Vector3,
    errors: [Errors; 3],
}

/// Time after which the random walk is as large as the bias (s).
const WANDER: f64 = 60.0;
/// Axes of turn rates and accelerations with a random walk.
const ALL: Vector3 = Vector3::new(1.0, 1.0, 1.0);

impl InertialUnit {
    /// Unit of a robot, if it has one.
    pub(super) fn of(spec: InertialSpec, compass: bool, streams: &Stream) -> Option<Box<Self>> {
        let none = spec == InertialSpec::default();
        let errors =
            ["attitude", "turn rates", "acceleration"].map(|name| Errors::new(streams.child(name, 0)));
        (!none).then(|| {
            Box::new(Self {
                spec,
                wanders: if compass { Vector3::zeros() } else { Vector3::z() },
                pose: Pose3::default(),
                velocity: Vector3::zeros(),
                turn_rates: Vector3::zeros(),
                acceleration: Vector3::zeros(),
                errors,
            })
        })
    }

    /// Restarts at rest where the robot has been placed.
    pub(super) fn begin(&mut self, pose: Pose3) {
        (self.pose, self.velocity, self.turn_rates) = (pose, Vector3::zeros(), Vector3::zeros());
        self.acceleration = pose.attitude.inverse() * (Vector3::z() * GRAVITY);
    }

    /// Takes in the robot's motion during a tick.
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
        let found = self.errors[0].add(Vector3::new(roll, pitch, yaw), noise.attitude, self.wanders, tick);
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

/// Errors of three readings in standard deviations: bias and random walk.
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

    /// True values with their errors at a tick.
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
