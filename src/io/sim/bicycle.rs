use super::{NoiseModel, TICK};
use crate::geometry::units::NEGLIGIBLE;
use crate::geometry::{Twist, math, units};
use crate::kinematics::{PlanarMotion, PlanarTwist};
use crate::random::Stream;
use crate::world::{CarDynamics, MotorSpec};

/// A fast car by the dynamic bicycle model: tyres slip, and their forces stay within the friction circle.
///
/// Odometry takes the speed from the wheels and the heading from a gyroscope; it cannot measure sideslip.
#[derive(Debug, Clone)]
pub(super) struct Bicycle {
    spec: CarDynamics,
    motor: MotorSpec,
    wheelbase: f64,
    speeds: Speeds,
    /// Motion of the present tick without obstacles.
    wish: PlanarMotion,
    senses: Senses,
}

/// Speeds of the centre of mass forwards and to the left, and the yaw rate.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Speeds {
    along: f64,
    across: f64,
    yaw_rate: f64,
}

/// Errors of a tachometer and a rate gyroscope.
#[derive(Debug, Clone)]
struct Senses {
    scale: f64,
    slip: f64,
    bias: f64,
    noise: f64,
    stream: Stream,
}

/// Integration steps of the tyre forces per tick.
const SUBSTEPS: u32 = 5;
/// The rate in rad/s that a gyroscope reads standing, for noise 1.
const GYRO_BIAS: f64 = 0.001;
/// Standard deviation of a gyroscope reading at noise 1 (rad/s).
const GYRO_NOISE: f64 = 0.003;

impl Senses {
    fn new(noise: &NoiseModel, mut stream: Stream) -> Self {
        // Noise level relative to the real robot, for the gyroscope.
        let size = noise.wheel_mismatch / NoiseModel::real().wheel_mismatch;
        Self {
            scale: 1.0 + noise.wheel_scale * stream.normal(),
            slip: noise.slip,
            bias: GYRO_BIAS * size * stream.normal(),
            noise: GYRO_NOISE * size,
            stream,
        }
    }

    fn measure(&mut self, speeds: &Speeds) -> Twist {
        let slip = self.slip * (speeds.along.abs() / TICK).sqrt() * self.stream.normal();
        let rate = speeds.yaw_rate + self.bias + self.noise * self.stream.normal();
        Twist::new(speeds.along * self.scale + slip, rate)
    }
}

impl Bicycle {
    pub(super) fn new(
        spec: CarDynamics,
        motor: MotorSpec,
        wheelbase: f64,
        noise: &NoiseModel,
        stream: Stream,
    ) -> Self {
        let senses = Senses::new(noise, stream);
        Self { spec, motor, wheelbase, speeds: Speeds::default(), wish: PlanarMotion::default(), senses }
    }

    /// Rate at which the steering turns (rad/s).
    pub(super) fn steering_rate(&self) -> f64 {
        self.spec.steering_rate
    }

    /// Applies a speed command while the steering angle changes from one value to another. Returns the motion
    /// of the middle of the rear axle in one tick without obstacles.
    pub(super) fn step(&mut self, speed: f64, steering: [f64; 2]) -> PlanarMotion {
        let dt = TICK / f64::from(SUBSTEPS);
        let mut wish = PlanarMotion::default();
        for k in 1..=SUBSTEPS {
            let share = f64::from(k) / f64::from(SUBSTEPS);
            self.substep(speed, steering[0] + share * (steering[1] - steering[0]), dt);
            wish.forward += dt * self.speeds.along;
            wish.left += dt * self.slip();
            wish.angle += dt * self.speeds.yaw_rate;
        }
        self.wish = wish;
        wish
    }

    /// Takes over the speeds that follow from the car's true motion in this tick; returns their measurement.
    pub(super) fn settle(&mut self, moved: PlanarMotion) -> Twist {
        if moved != self.wish {
            self.collide(moved);
        }
        if self.speeds == Speeds::default() { Twist::STOP } else { self.senses.measure(&self.speeds) }
    }

    /// Forward speed at the wheels.
    pub(super) fn speed(&self) -> f64 {
        self.speeds.along
    }

    /// Lateral speed at the rear axle, to the left (m/s).
    fn slip(&self) -> f64 {
        self.speeds.across - self.spec.mass_centre * self.speeds.yaw_rate
    }

    /// Collisions are inelastic: speeds shrink like the motion. Being pushed out of a wall does not increase
    /// them.
    fn collide(&mut self, moved: PlanarMotion) {
        let (length, most) = (moved.length(), self.wish.length());
        let share = if length > most { most / length } else { 1.0 };
        let turn = self.wish.angle.abs();
        let PlanarTwist { forward, left, angular } = PlanarTwist::new(
            share * moved.forward / TICK,
            share * moved.left / TICK,
            moved.angle.clamp(-turn, turn) / TICK,
        );
        let across = left + self.spec.mass_centre * angular;
        self.speeds = Speeds { along: forward, across, yaw_rate: angular };
    }

    /// Applies a command for `dt` seconds, at most about 2 ms, in one step.
    fn substep(&mut self, speed: f64, steering: f64, dt: f64) {
        let before = self.speeds;
        let wish = (speed - before.along) / self.motor.time_constant.max(dt);
        // It brakes towards standstill and drives away from it.
        let slows = wish * before.along < 0.0;
        let limit = if slows { self.spec.brake } else { self.motor.max_acceleration };
        let push = wish.clamp(-limit, limit).clamp(-self.spec.grip, self.spec.grip);
        let fastest = math::hypot(before.along, self.slip());
        // Slower than half of the speed from which they slip, wheels roll.
        let share = (2.0 * fastest / CarDynamics::SLIPS - 1.0).clamp(0.0, 1.0);
        if share > 0.0 {
            self.slide(push, steering, dt);
        }
        if share < 1.0 {
            let along = before.along + push * dt;
            // It does not brake beyond standing.
            let stops = (slows && along * before.along < 0.0) || (speed == 0.0 && along.abs() < NEGLIGIBLE);
            self.roll(if stops { 0.0 } else { along }, steering, share);
            self.hold(&before, dt);
        }
    }

    /// Blends the slipping-tyre speeds with those of rolling wheels.
    fn roll(&mut self, along: f64, steering: f64, share: f64) {
        let yaw_rate = along * math::tan(steering) / self.wheelbase;
        let mix = |slides: f64, rolls: f64| share * slides + (1.0 - share) * rolls;
        self.speeds = Speeds {
            along: mix(self.speeds.along, along),
            across: mix(self.speeds.across, yaw_rate * self.spec.mass_centre),
            yaw_rate: mix(self.speeds.yaw_rate, yaw_rate),
        };
    }

    /// Limits the change of the speeds since `before` to what the tyres can transmit, also in the transition
    /// to rolling.
    fn hold(&mut self, before: &Speeds, dt: f64) {
        let turned = |rate: f64, along: f64, across: f64| {
            let (sin, cos) = math::sin_cos(dt * rate);
            (cos * along - sin * across, sin * along + cos * across)
        };
        let now = self.speeds;
        let (along, across) = turned(now.yaw_rate, now.along, now.across);
        let change = (along - before.along, across - before.across);
        let excess = math::hypot(change.0, change.1) / (self.spec.grip * dt);
        // Rounding errors need no correction.
        if excess <= 1.001 {
            return;
        }
        let yaw_rate = before.yaw_rate + (now.yaw_rate - before.yaw_rate) / excess;
        let (along, across) = (before.along + change.0 / excess, before.across + change.1 / excess);
        let (along, across) = turned(-yaw_rate, along, across);
        self.speeds = Speeds { along, across, yaw_rate };
    }

    /// Applies the tyre forces to the speeds.
    fn slide(&mut self, push: f64, steering: f64, dt: f64) {
        let (spec, base) = (&self.spec, self.wheelbase);
        let (rear_arm, front_arm) = (spec.mass_centre, base - spec.mass_centre);
        let Speeds { along, across, yaw_rate } = self.speeds;
        let v = along.abs().max(0.5);
        // In reverse, a turned wheel steers to the other side.
        let steered = steering * (along / 0.5).clamp(-1.0, 1.0);
        let slips = [
            math::atan2(across + front_arm * yaw_rate, v) - steered,
            math::atan2(across - rear_arm * yaw_rate, v),
        ];
        // Without load transfer, each axle carries its static share of the weight and drives in proportion.
        let loads = [rear_arm / base, front_arm / base];
        let [front, rear] = [0, 1].map(|axle| {
            let (along, circle) = (push * loads[axle], spec.grip * loads[axle]);
            let share = if axle == 0 { spec.balance } else { 1.0 };
            let across = share * (circle * circle - along * along).max(1e-6).sqrt();
            let linear = -share * spec.stiffness * units::GRAVITY * loads[axle] * slips[axle];
            let ratio = linear / across;
            (along, linear / (1.0 + ratio * ratio).sqrt())
        });
        let (sin, cos) = math::sin_cos(steering);
        let force = (front.0 * cos - front.1 * sin + rear.0, front.0 * sin + front.1 * cos + rear.1);
        let turn = front_arm * (front.0 * sin + front.1 * cos) - rear_arm * rear.1;
        let yaw_rate = yaw_rate + dt * turn / (spec.gyration * spec.gyration);
        // The frame rotates under the velocity.
        let (sin, cos) = math::sin_cos(dt * yaw_rate);
        let (x, y) = (along + dt * force.0, across + dt * force.1);
        self.speeds = Speeds { along: cos * x + sin * y, across: cos * y - sin * x, yaw_rate };
    }
}

#[cfg(test)]
mod tests;
