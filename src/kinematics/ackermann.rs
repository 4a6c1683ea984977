use std::f64::consts::FRAC_PI_2;

use super::{Differential, Displacement, WheelSpeeds};
use crate::ParameterError;
use crate::geometry::{Twist, math};
use crate::parameter::{require, require_positive};

/// The geometry of a car: driven rear wheels on a differential gear, steered front wheels (book, section 7.1).
///
/// The robot's origin is the middle of the rear axle. The *steering angle* is that of the bicycle model, a wheel in the
/// middle of the front axle, positive to the left; [`wheel_angles`](Ackermann::wheel_angles) has those of the two front
/// wheels, which all point to the same centre of the turn.
///
/// ```
/// use roverlab::geometry::Twist;
/// use roverlab::kinematics::Ackermann;
/// let car = Ackermann::new(0.3, 0.2, 0.5)?;
/// let state = car.inverse(Twist::new(1.0, 1.0)).expect("a bend of a metre's radius");
/// assert!((state.steering.tan() - 0.3).abs() < 1e-12, "wheelbase over radius");
/// assert!(car.inverse(Twist::new(0.5, 1.0)).is_none(), "half a metre is tighter than it can");
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ackermann {
    wheelbase: f64,
    track: f64,
    max_steering: f64,
}

/// What a car's motor and steering are set to.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CarState {
    /// Metres per second of the middle of the rear axle.
    pub speed: f64,
    /// The steering angle in radians, positive to the left.
    pub steering: f64,
}

/// Rim speeds of a car's four wheels, in metres per second.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CarWheels {
    /// The driven wheels.
    pub rear: WheelSpeeds,
    /// The steered wheels.
    pub front: WheelSpeeds,
}

impl Ackermann {
    /// A car from the metres between its axles, the metres between the wheels of an axle, and the largest steering
    /// angle, which is less than a right angle.
    ///
    /// Fails if a length is not positive, or if the turn would be so tight that its centre lies between the wheels.
    pub fn new(wheelbase: f64, track: f64, max_steering: f64) -> Result<Self, ParameterError> {
        require_positive("wheelbase", wheelbase)?;
        require_positive("track", track)?;
        let good = max_steering > 0.0 && max_steering < FRAC_PI_2;
        require("maximal steering", max_steering, good, "more than 0 and less than a right angle")?;
        let car = Self { wheelbase, track, max_steering };
        let good = car.turning_radius() > 0.5 * track;
        require("maximal steering", max_steering, good, "a turn whose centre lies beside the car")?;
        Ok(car)
    }

    /// Metres between the axles.
    pub fn wheelbase(&self) -> f64 {
        self.wheelbase
    }

    /// The largest steering angle in radians.
    pub fn max_steering(&self) -> f64 {
        self.max_steering
    }

    /// Metres from the middle of the rear axle to the centre of the tightest turn.
    pub fn turning_radius(&self) -> f64 {
        self.wheelbase / math::tan(self.max_steering)
    }

    /// The largest curvature that the car drives, the inverse of its turning radius.
    pub fn max_curvature(&self) -> f64 {
        math::tan(self.max_steering) / self.wheelbase
    }

    /// The curvature of the path under a steering angle, in 1/m.
    pub fn curvature(&self, steering: f64) -> f64 {
        math::tan(steering) / self.wheelbase
    }

    /// The steering angle for a curvature, as far as the steering goes.
    pub fn steering_for(&self, curvature: f64) -> f64 {
        math::atan(curvature * self.wheelbase).clamp(-self.max_steering, self.max_steering)
    }

    /// What the car does with its motor and steering set so.
    pub fn forward(&self, state: CarState) -> Twist {
        Twist::new(state.speed, state.speed * self.curvature(state.steering))
    }

    /// Speed and steering that give a twist; `None` if the car cannot turn so tightly, as on the spot.
    pub fn inverse(&self, twist: Twist) -> Option<CarState> {
        if twist.angular == 0.0 {
            return Some(CarState { speed: twist.linear, steering: 0.0 });
        }
        let curvature = twist.angular / twist.linear;
        let possible = curvature.abs() <= self.max_curvature() * (1.0 + 1e-12);
        possible.then(|| CarState { speed: twist.linear, steering: self.steering_for(curvature) })
    }

    /// Speed and steering nearest to a twist: a turn that is too tight becomes the tightest one to that side, and the
    /// speed is scaled down where the outer rear wheel would exceed `limit`, which keeps the curvature.
    ///
    /// A car that shall turn on the spot turns its steering and stands.
    pub fn inverse_limited(&self, twist: Twist, limit: f64) -> CarState {
        let steering = if twist.linear == 0.0 {
            if twist.angular == 0.0 { 0.0 } else { self.max_steering.copysign(twist.angular) }
        } else {
            self.steering_for(twist.angular / twist.linear)
        };
        let outer = 1.0 + 0.5 * self.track * self.curvature(steering).abs();
        let fastest = limit / outer;
        CarState { speed: twist.linear.clamp(-fastest, fastest), steering }
    }

    /// What the car does while the middle of its rear axle rolls so many metres under a steering angle.
    pub fn displacement(&self, length: f64, steering: f64) -> Displacement {
        Displacement { length, angle: length * self.curvature(steering) }
    }

    /// The angles of the left and the right front wheel that roll without slip under a steering angle: the inner wheel
    /// is turned farther.
    pub fn wheel_angles(&self, steering: f64) -> [f64; 2] {
        let curvature = self.curvature(steering);
        [-0.5, 0.5].map(|side| {
            // A point of the front axle moves across the line to the turn's centre.
            math::atan2(self.wheelbase * curvature, 1.0 + side * self.track * curvature)
        })
    }

    /// The rim speeds of all four wheels.
    pub fn wheels(&self, state: CarState) -> CarWheels {
        let twist = self.forward(state);
        let rear = Differential { track: self.track }.inverse(twist);
        // A front wheel also moves sideways with the nose.
        let aside = twist.angular * self.wheelbase;
        let rim = |rear: f64| math::hypot(rear, aside).copysign(rear);
        CarWheels { rear, front: WheelSpeeds { left: rim(rear.left), right: rim(rear.right) } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Pose, Vector, cross, direction};
    use crate::kinematics::advance;
    use proptest::prelude::*;

    fn car() -> Ackermann {
        Ackermann::new(0.25, 0.16, 0.5).unwrap()
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn forward_undoes_inverse(v in -2.0..2.0f64, share in -1.0..=1.0f64) {
            let twist = Twist::new(v, v * share * car().max_curvature());
            let again = car().forward(car().inverse(twist).unwrap());
            prop_assert!((again.linear - v).abs() < 1e-12 && (again.angular - twist.angular).abs() < 1e-12);
        }

        #[test]
        fn limits_keep_the_curvature(v in 0.01..3.0f64, share in -1.0..=1.0f64, limit in 0.05..1.0f64) {
            let curvature = share * car().max_curvature();
            let state = car().inverse_limited(Twist::new(v, v * curvature), limit);
            prop_assert!((car().curvature(state.steering) - curvature).abs() < 1e-12);
            let rear = car().wheels(state).rear;
            prop_assert!(rear.left.abs().max(rear.right.abs()) <= limit + 1e-12);
        }

        #[test]
        fn no_wheel_slips_sideways(speed in 0.05..1.0f64, steering in -0.5..0.5f64) {
            let state = CarState { speed, steering };
            let (twist, wheels) = (car().forward(state), car().wheels(state));
            let angles = car().wheel_angles(steering);
            for (y, angle, rim) in [(0.08, angles[0], wheels.front.left), (-0.08, angles[1], wheels.front.right)] {
                let velocity = Vector::new(twist.linear - twist.angular * y, twist.angular * 0.25);
                prop_assert!(cross(direction(angle), velocity).abs() < 1e-12);
                prop_assert!((velocity.dot(&direction(angle)) - rim).abs() < 1e-12);
            }
        }

        #[test]
        fn fine_integration_of_the_bicycle_agrees(length in -2.0..2.0f64, steering in -0.5..0.5f64) {
            let exact = advance(Pose::default(), car().displacement(length, steering));
            let (steps, mut pose) = (2000, Pose::default());
            let h = length / f64::from(steps);
            let rate = math::tan(steering) / 0.25;
            for _ in 0..steps {
                // Simpson's rule over the heading, which grows evenly.
                let along = |t: f64| direction(pose.heading + t * h * rate);
                let step = (along(0.0) + along(0.5) * 4.0 + along(1.0)) * (h / 6.0);
                pose = Pose::new(pose.x + step.x, pose.y + step.y, pose.heading + h * rate);
            }
            prop_assert!((exact.position() - pose.position()).norm() < 1e-9);
        }
    }

    #[test]
    fn what_no_car_does_is_refused() {
        assert_eq!(car().inverse(Twist::new(0.0, 1.0)), None);
        assert_eq!(car().inverse(Twist::new(0.1, 1.0)), None);
        let on_the_spot = car().inverse_limited(Twist::new(0.0, -1.0), 1.0);
        assert_eq!(on_the_spot, CarState { speed: 0.0, steering: -0.5 });
        assert!(Ackermann::new(0.25, 0.16, 1.6).is_err());
        assert!(Ackermann::new(0.0, 0.16, 0.5).is_err());
        assert_eq!(
            Ackermann::new(0.1, 0.5, 1.0).unwrap_err().to_string(),
            "maximal steering is 1; expected a turn whose centre lies beside the car"
        );
    }
}
