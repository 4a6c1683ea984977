use std::f64::consts::FRAC_PI_2;

use crate::ParameterError;
use crate::geometry::math;
use crate::parameter::{require, require_positive};

/// Tyre model: a steady-state bicycle model, whose axles share the load by the lever rule and drive in
/// proportion.
///
/// The lateral force of an axle is proportional to small slip angles and saturates at the friction circle,
/// which is reduced by driving and braking: force = stiffness · slip / √(1 + (stiffness · slip / limit)²).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tyres {
    /// Radius of the friction circle (m/s²).
    pub grip: f64,
    /// Lateral acceleration per small slip angle (m/s² per rad).
    pub stiffness: f64,
    /// Grip and stiffness of the front tyres, relative to the rear ones.
    pub front: f64,
    /// Distance between the axles (m).
    pub wheelbase: f64,
    /// Maximum steering angle (rad).
    pub lock: f64,
}

impl Default for Tyres {
    fn default() -> Self {
        Self { grip: 12.0, stiffness: 216.0, front: 0.9, wheelbase: 1.55, lock: 0.6 }
    }
}

impl Tyres {
    /// Checks the parameters; the stiffness may be infinite.
    ///
    /// # Errors
    ///
    /// If one is out of range.
    pub fn validate(&self) -> Result<(), ParameterError> {
        require_positive("grip", self.grip)?;
        require("stiffness", self.stiffness, self.stiffness > 0.0, "a positive number")?;
        require_positive("grip of the front tyres", self.front)?;
        require_positive("wheelbase", self.wheelbase)?;
        let good = self.lock > 0.0 && self.lock < FRAC_PI_2;
        require("lock", self.lock, good, "more than 0 and less than a right angle")
    }

    /// Tyres that roll and do not slip, as those of slow cars as good as do.
    pub const ROLLING: Self =
        Self { grip: 12.0, stiffness: f64::INFINITY, front: 1.0, wheelbase: 1.55, lock: 0.6 };
}

/// Fraction of an axle's grip that is used at most.
const MOST: f64 = 0.97;

impl Tyres {
    /// Slip angles of the front and the rear axle (rad) for a lateral acceleration, while the car accelerates
    /// at `along` (both m/s²). They grow towards the limit of the tyres, and are bounded slightly below it.
    ///
    /// ```
    /// use roverlab::race::Tyres;
    /// let [front, rear] = Tyres::default().slips(8.0, 0.0);
    /// // The front slides first: it needs more steering.
    /// assert!(front > rear && rear > 8.0 / 216.0);
    /// ```
    pub fn slips(&self, across: f64, along: f64) -> [f64; 2] {
        [self.slip(self.front, across, along), self.slip(1.0, across, along)]
    }

    /// Slip angle of an axle with a fraction of grip and stiffness.
    fn slip(&self, share: f64, across: f64, along: f64) -> f64 {
        let circle = self.circle(along);
        // The axle that saturates first bounds both.
        let most = MOST * self.front.min(1.0) / share;
        let strained = (across / (share * circle)).max(-most).min(most);
        strained * circle / (self.stiffness * (1.0 - strained * strained).sqrt())
    }

    /// Lateral grip left by a longitudinal acceleration (m/s²); at least 1, so that divisions by it stay
    /// finite.
    fn circle(&self, along: f64) -> f64 {
        (self.grip * self.grip - along * along).max(1.0).sqrt()
    }

    /// Maximum push of the motors at a curvature and a lateral acceleration (m/s²); at least a tenth of the
    /// grip, so that a sliding car keeps some power.
    pub fn left_along(&self, curvature: f64, across: f64) -> f64 {
        let most = self.most(curvature.abs(), across.abs(), Push::On);
        most.unwrap_or(0.0).max(0.1 * self.grip)
    }

    /// Curvature at which a car without slip would have the steering angle that this one needs.
    pub fn steering(&self, curvature: f64, across: f64, along: f64) -> f64 {
        math::tan(self.steered(curvature, across, along).clamp(-1.2, 1.2)) / self.wheelbase
    }

    /// Steering angle for a curvature and accelerations (rad).
    fn steered(&self, curvature: f64, across: f64, along: f64) -> f64 {
        let rolling = self.rolling(curvature, across, along);
        let mut steering = rolling;
        for _ in 0..TURNS {
            // The push of turned wheels is not fully lateral.
            steering = rolling + self.slip(self.front, across / math::cos(steering), along);
        }
        steering
    }

    /// Steering angle for front wheels without slip (rad).
    fn rolling(&self, curvature: f64, across: f64, along: f64) -> f64 {
        math::atan(self.wheelbase * curvature - math::tan(self.slip(1.0, across, along)))
    }
}

/// Direction of a longitudinal force.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Push {
    Back,
    On,
}

impl Tyres {
    /// Maximum longitudinal acceleration at a curvature and a lateral acceleration, limited by the motors;
    /// negative if the front tyres need more than that to be pulled around the bend. `None` if no push lets
    /// the car turn so.
    pub(super) fn forwards(&self, curvature: f64, across: f64, drive: f64) -> Option<f64> {
        let push = self.most(curvature, across, Push::On)?.min(drive);
        Some(self.along(curvature, across, push))
    }

    /// Whether the front wheels turn far enough for a lateral acceleration at a steady speed.
    pub(super) fn turns(&self, curvature: f64, across: f64) -> bool {
        self.steered(curvature.abs(), across, 0.0) <= self.lock
    }

    /// Maximum deceleration, limited by the brakes.
    pub(super) fn backwards(&self, curvature: f64, across: f64, brake: f64) -> Option<f64> {
        let push = self.most(curvature, across, Push::Back)?.max(-brake);
        Some(-self.along(curvature, across, push))
    }

    /// Deceleration of a car that rolls around a bend, because the lateral tyre forces are slanted.
    pub(super) fn drag(&self, curvature: f64, across: f64) -> f64 {
        -self.along(curvature.abs(), across.abs(), 0.0)
    }

    /// Maximum push of brakes or motors at which both axles still provide a lateral acceleration (m/s²).
    ///
    /// Turned front wheels also push sideways, so their required lateral force is (across - push · sin) / cos
    /// of the steering angle, and share · √(grip² - push²) is available: a quadratic equation for the push,
    /// given that angle.
    fn most(&self, curvature: f64, across: f64, push: Push) -> Option<f64> {
        let sign = if push == Push::On { 1.0 } else { -1.0 };
        let rear = self.grip * self.grip - (across / MOST) * (across / MOST);
        if rear < 0.0 {
            return None;
        }
        let mut found = 0.0;
        for _ in 0..TURNS {
            let circle = self.circle(found);
            let slip = circle * MOST / (self.stiffness * (1.0 - MOST * MOST).sqrt());
            let (sin, cos) = math::sin_cos(self.rolling(curvature, across, found) + slip);
            let share = cos * MOST * self.front;
            let (square, half) = (sin * sin + share * share, across * sin);
            let free = half * half - square * (across * across - share * share * self.grip * self.grip);
            if free < 0.0 {
                return None;
            }
            found = (half + sign * free.sqrt()) / square;
        }
        Some(found.max(-rear.sqrt()).min(rear.sqrt()))
    }

    /// Longitudinal acceleration left of a push, because the lateral tyre forces are slanted.
    fn along(&self, curvature: f64, across: f64, push: f64) -> f64 {
        let steering = self.steered(curvature, across, push);
        let (sin, cos) = math::sin_cos(steering);
        let aside = (across - push * sin) / cos;
        // Along the car, each axle with half its weight; the centre moves at a sideslip angle.
        let along = 0.5 * (push * (1.0 + cos) - aside * sin);
        let aslant = math::atan(0.5 * self.wheelbase * curvature - math::tan(self.slip(1.0, across, push)));
        along + across * math::sin(aslant)
    }
}

/// Number of fixed-point iterations for the steering angle.
const TURNS: usize = 3;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Pose, Twist};
    use crate::io::sim::{SimOptions, Simulation, TICK};
    use crate::io::{Clock, Drive, Odometry};
    use crate::kinematics::PlanarMotion;
    use crate::race::ConeTrack;
    use proptest::prelude::*;

    /// Steers a car for a circle at a speed for some seconds. Returns its speed and yaw rate, and the lateral
    /// velocity of its rear axle.
    fn driven(curvature: f64, speed: f64, tyres: Option<Tyres>) -> (Twist, f64) {
        let scene = ConeTrack::default().scene(&[Pose::default()]);
        let race = Simulation::new(&scene, SimOptions::ideal()).unwrap();
        let mut car = race.robot(0).unwrap();
        let bend = tyres.map_or(curvature, |t| t.steering(curvature, speed * speed * curvature, 0.0));
        car.set_speed(Twist::new(speed, speed * bend)).unwrap();
        car.wait(8.0).unwrap();
        let before = race.truth().pose(0).unwrap();
        car.wait(TICK).unwrap();
        let motion = PlanarMotion::between(before, race.truth().pose(0).unwrap());
        (car.speed().unwrap(), motion.left / TICK)
    }

    proptest! {
        #![proptest_config(crate::testing::cases(24))]
        #[test]
        fn a_car_in_balance_drives_the_circle_that_is_wanted(
            radius in 6.0..40.0f64, share in 0.2..0.9f64, left in any::<bool>(),
        ) {
            let curvature = if left { 1.0 / radius } else { -1.0 / radius };
            let tyres = Tyres::default();
            let speed = (10.4 * (1.0 - 0.5 / radius) * share * radius).sqrt();
            let (twist, slides) = driven(curvature, speed, Some(tyres));
            let found = twist.angular / twist.linear;
            prop_assert!((found / curvature - 1.0).abs() < 0.04, "{found} {curvature}");
            let rear = tyres.slips(twist.linear * twist.angular, 0.0)[1];
            prop_assert!((-slides / twist.linear - math::tan(rear)).abs() < 0.01, "{slides} {rear}");
        }

        #[test]
        fn slip_grows_with_every_force_below_the_limit(across in 0.0..8.4f64, along in 0.0..6.0f64) {
            let tyres = Tyres::default();
            let (less, more) = (tyres.slips(across, along), tyres.slips(across + 0.3, along));
            let pushed = tyres.slips(across, along + 0.5);
            for axle in 0..2 {
                prop_assert!(less[axle] <= more[axle] && less[axle] <= pushed[axle]);
            }
            prop_assert!(less[0] >= less[1]);
            prop_assert_eq!(tyres.slips(-across, -along), less.map(|slip| -slip));
        }
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        // With less lateral force, turned wheels push more than needed.
        #[test]
        fn no_more_is_left_than_the_friction_circle(across in 6.0..14.0f64, curvature in -0.3..0.3f64) {
            let tyres = Tyres::default();
            let left = tyres.left_along(curvature, across);
            prop_assert!(left <= tyres.left_along(curvature, 0.9 * across) + 1e-9 && left >= 1.19);
            prop_assert!(left < 1.21 || across * across + left * left <= 144.0);
            prop_assert_eq!(left, tyres.left_along(-curvature, -across));
        }
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn the_steering_is_that_of_axles_that_slip(
            curvature in -0.25..0.25f64, across in 0.0..9.0f64, along in -5.0..5.0f64,
        ) {
            let (tyres, across) = (Tyres::default(), across.copysign(curvature));
            let steered = tyres.steered(curvature, across, along);
            // Beyond the limit of the front tyres, no steering is right.
            let most = MOST * tyres.front * tyres.circle(along);
            prop_assume!(across.abs() / math::cos(steered) < 0.95 * most);
            // Back from the angle to the curvature, by the slip of both axles.
            let front = tyres.slip(tyres.front, across / math::cos(steered), along);
            let rear = math::tan(tyres.slip(1.0, across, along));
            let back = (math::tan(steered - front) + rear) / tyres.wheelbase;
            prop_assert!((back - curvature).abs() < 5e-3, "{back} {curvature}");
            prop_assert!((tyres.steered(-curvature, -across, along) + steered).abs() < 1e-12);
        }

        #[test]
        fn what_is_pushed_at_most_both_axles_give(curvature in 0.0..0.25f64, across in 0.0..9.0f64) {
            both_axles_give(curvature, across)?;
        }
    }

    /// Pushes and brakes as much as possible at a lateral acceleration.
    fn both_axles_give(curvature: f64, across: f64) -> Result<(), TestCaseError> {
        let tyres = Tyres::default();
        for push in [Push::On, Push::Back] {
            let Some(most) = tyres.most(curvature, across, push) else { continue };
            let (sin, cos) = math::sin_cos(tyres.steered(curvature, across, most));
            prop_assert!(across <= MOST * (tyres.grip * tyres.grip - most * most).sqrt() + 1e-9);
            let (front, circle) = ((across - most * sin) / cos, tyres.circle(most));
            // The steering angle is iterated only a few times, and off by some per mille.
            prop_assert!(front <= 1.02 * MOST * tyres.front * circle + 1e-9, "{front} of {circle}");
        }
        Ok(())
    }

    #[test]
    fn nearly_all_grip_is_pushed_along_a_straight() {
        // The friction circle alone leaves less lateral grip than the minimum of the model.
        for across in [0.724_529_029_955_289_8, 0.766_706_480_633_079_4] {
            both_axles_give(0.0, across).unwrap();
        }
    }

    #[test]
    fn tyres_that_do_not_slip_need_no_more_steering() {
        let rolling = Tyres::ROLLING;
        assert_eq!(rolling.slips(8.0, 3.0), [0.0, 0.0]);
        assert!((rolling.steering(0.2, 8.0, 3.0) - 0.2).abs() < 1e-12);
    }

    #[test]
    fn wheels_that_only_roll_are_steered_too_little() {
        let (curvature, speed) = (0.08, 10.5);
        let without = driven(curvature, speed, None).0;
        assert!(without.angular / without.linear < 0.93 * curvature, "{without:?}");
    }
}
