use std::f64::consts::FRAC_PI_2;

use super::{Differential, Displacement, WheelSpeeds};
use crate::ParameterError;
use crate::geometry::{Twist, math};
use crate::parameter::{require, require_positive};

/// Kinematics of a car: driven rear wheels with a differential, steered front wheels (book, section 7.1).
///
/// The robot's origin is the centre of the rear axle. The *steering angle* is that of the bicycle model, a
/// virtual wheel in the middle of the front axle, positive to the left.
/// [`wheel_angles`](Ackermann::wheel_angles) returns the angles of the two front wheels, whose axes meet at
/// the turning centre.
///
/// ```
/// use roverlab::geometry::Twist;
/// use roverlab::kinematics::Ackermann;
/// let car = Ackermann::new(0.3, 0.2, 0.5)?;
/// let state = car.inverse(Twist::new(1.0, 1.0)).expect("a radius of 1 m");
/// assert!((state.steering.tan() - 0.3).abs() < 1e-12, "wheelbase over radius");
/// assert!(car.inverse(Twist::new(0.5, 1.0)).is_none(), "a radius of 0.5 m is too tight");
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ackermann {
    wheelbase: f64,
    track: f64,
    max_steering: f64,
}

/// Speed and steering angle of a car.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CarState {
    /// Speed of the centre of the rear axle (m/s).
    pub speed: f64,
    /// Steering angle, positive to the left (rad).
    pub steering: f64,
}

/// Rim speeds of the four wheels (m/s).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CarWheels {
    /// Driven wheels.
    pub rear: WheelSpeeds,
    /// Steered wheels.
    pub front: WheelSpeeds,
}

impl Ackermann {
    /// A car with a wheelbase (m), a track (m) and a maximum steering angle below `pi/2` (rad).
    ///
    /// # Errors
    ///
    /// If a value is out of range, or the turning centre of the tightest turn would lie between the wheels.
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

    /// Distance between the axles (m).
    pub fn wheelbase(&self) -> f64 {
        self.wheelbase
    }

    /// Maximum steering angle (rad).
    pub fn max_steering(&self) -> f64 {
        self.max_steering
    }

    /// Distance from the centre of the rear axle to the centre of the tightest turn (m).
    pub fn turning_radius(&self) -> f64 {
        self.wheelbase / math::tan(self.max_steering)
    }

    /// Maximum curvature: inverse of the turning radius (1/m).
    pub fn max_curvature(&self) -> f64 {
        math::tan(self.max_steering) / self.wheelbase
    }

    /// Path curvature for a steering angle (1/m).
    pub fn curvature(&self, steering: f64) -> f64 {
        math::tan(steering) / self.wheelbase
    }

    /// Steering angle for a curvature, limited to the maximum (rad).
    pub fn steering_for(&self, curvature: f64) -> f64 {
        math::atan(curvature * self.wheelbase).clamp(-self.max_steering, self.max_steering)
    }

    /// Forward kinematics.
    pub fn forward(&self, state: CarState) -> Twist {
        Twist::new(state.speed, state.speed * self.curvature(state.steering))
    }

    /// Inverse kinematics; `None` if the turn is too tight, such as on the spot.
    pub fn inverse(&self, twist: Twist) -> Option<CarState> {
        if twist.angular == 0.0 {
            return Some(CarState { speed: twist.linear, steering: 0.0 });
        }
        let curvature = twist.angular / twist.linear;
        let possible = curvature.abs() <= self.max_curvature() * (1.0 + 1e-12);
        possible.then(|| CarState { speed: twist.linear, steering: self.steering_for(curvature) })
    }

    /// Inverse kinematics within limits. A turn that is too tight becomes the tightest one to that side; the
    /// speed is reduced where the outer rear wheel would exceed `limit` (m/s), which preserves the curvature.
    ///
    /// For a turn on the spot, the car stands and turns its steering to the end.
    pub fn inverse_limited(&self, twist: Twist, limit: f64) -> CarState {
        let steering = if twist.linear == 0.0 {
            if twist.angular == 0.0 { 0.0 } else { self.max_steering.copysign(twist.angular) }
        } else {
            self.steering_for(twist.angular / twist.linear)
        };
        let outer = 1.0 + 0.5 * self.track * self.curvature(steering).abs();
        // A limit that is no number lets the car stand.
        let fastest = (limit / outer).max(0.0);
        CarState { speed: twist.linear.clamp(-fastest, fastest), steering }
    }

    /// Motion while the centre of the rear axle rolls `length` metres at a steering angle.
    pub fn displacement(&self, length: f64, steering: f64) -> Displacement {
        Displacement { length, angle: length * self.curvature(steering) }
    }

    /// Angles of the left and right front wheel that roll without slip at a steering angle (rad); the inner
    /// wheel turns farther.
    pub fn wheel_angles(&self, steering: f64) -> [f64; 2] {
        let curvature = self.curvature(steering);
        [-0.5, 0.5].map(|side| {
            // A point of the front axle moves perpendicular to the line to the turning centre.
            math::atan2(self.wheelbase * curvature, 1.0 + side * self.track * curvature)
        })
    }

    /// Rim speeds of all four wheels.
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
                // Simpson's rule over the heading, which changes at a constant rate.
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
