use std::f64::consts::FRAC_PI_2;

use crate::ParameterError;
use crate::geometry::math;
use crate::parameter::{require, require_positive};

/// How the tyres of a car slip: the bicycle model in balance, whose axles carry what the levers give them and drive in proportion.
///
/// An axle pushes across in proportion to its slip angle as long as that is small, and near the rim of the friction circle, of
/// which driving and braking take their share, it needs ever more of it:
/// force = stiffness · slip / √(1 + (stiffness · slip / limit)²).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tyres {
    /// The radius of the friction circle, in m/s².
    pub grip: f64,
    /// Acceleration across for a small slip angle, in m/s² for a radian.
    pub stiffness: f64,
    /// Grip and stiffness of the front tyres as a share of that of the rear ones.
    pub front: f64,
    /// Metres between the axles.
    pub wheelbase: f64,
    /// The largest steering angle, in radians.
    pub lock: f64,
}

impl Default for Tyres {
    fn default() -> Self {
        Self { grip: 12.0, stiffness: 216.0, front: 0.9, wheelbase: 1.55, lock: 0.6 }
    }
}

impl Tyres {
    /// Fails with the name of the number that is out of range. Tyres that roll have an infinite stiffness.
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

/// The share of what an axle can give beyond which no more is asked of it.
const MOST: f64 = 0.97;

impl Tyres {
    /// The angles by which the front and the rear axle slip for an acceleration across, while the car gains speed at `along`, both
    /// in m/s². They are the larger the nearer the tyres are to their limit, and no larger than a little below that.
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

    /// That of an axle whose tyres have a share of grip and stiffness.
    fn slip(&self, share: f64, across: f64, along: f64) -> f64 {
        let circle = self.circle(along);
        // The axle that gives up first is the bound of both.
        let most = MOST * self.front.min(1.0) / share;
        let strained = (across / (share * circle)).clamp(-most, most);
        strained * circle / (self.stiffness * (1.0 - strained * strained).sqrt())
    }

    /// What is left across beside an acceleration along the way, in m/s²: never less than 1, so that what is
    /// divided by it stays finite.
    fn circle(&self, along: f64) -> f64 {
        (self.grip * self.grip - along * along).max(1.0).sqrt()
    }

    /// What motors may push at a curvature beside an acceleration across, both in m/s²: at least a tenth of the grip, so that a car
    /// that slides is not left without motors.
    pub fn left_along(&self, curvature: f64, across: f64) -> f64 {
        let most = self.most(curvature.abs(), across.abs(), Push::On);
        most.unwrap_or(0.0).max(0.1 * self.grip)
    }

    /// The curvature for which wheels that only roll would be steered as these are for that one at that acceleration.
    pub fn steering(&self, curvature: f64, across: f64, along: f64) -> f64 {
        math::tan(self.steered(curvature, across, along).clamp(-1.2, 1.2)) / self.wheelbase
    }

    /// The steering angle for that.
    fn steered(&self, curvature: f64, across: f64, along: f64) -> f64 {
        let rolling = self.rolling(curvature, across, along);
        let mut steering = rolling;
        for _ in 0..TURNS {
            // What turned wheels push, they push less across the car.
            steering = rolling + self.slip(self.front, across / math::cos(steering), along);
        }
        steering
    }

    /// The steering angle for front wheels that do not slip.
    fn rolling(&self, curvature: f64, across: f64, along: f64) -> f64 {
        math::atan(self.wheelbase * curvature - math::tan(self.slip(1.0, across, along)))
    }
}

/// Brakes or motors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Push {
    Back,
    On,
}

impl Tyres {
    /// The greatest acceleration along the way at a curvature and an acceleration across, by motors that give so much; negative
    /// where the front tyres need more than that to be pulled around the bend. `None` where no push lets the car turn so.
    pub(super) fn forwards(&self, curvature: f64, across: f64, drive: f64) -> Option<f64> {
        let push = self.most(curvature, across, Push::On)?.min(drive);
        Some(self.along(curvature, across, push))
    }

    /// Whether the front wheels turn far enough for an acceleration across, at a steady speed.
    pub(super) fn turns(&self, curvature: f64, across: f64) -> bool {
        self.steered(curvature.abs(), across, 0.0) <= self.lock
    }

    /// The greatest deceleration, by brakes that give so much.
    pub(super) fn backwards(&self, curvature: f64, across: f64, brake: f64) -> Option<f64> {
        let push = self.most(curvature, across, Push::Back)?.max(-brake);
        Some(-self.along(curvature, across, push))
    }

    /// The deceleration of a car that rolls around a bend: what its tyres push across is not all across the way.
    pub(super) fn drag(&self, curvature: f64, across: f64) -> f64 {
        -self.along(curvature.abs(), across.abs(), 0.0)
    }

    /// The greatest push of brakes or motors beside which both axles give an acceleration across, in m/s².
    ///
    /// Turned front wheels push across as well, so what is asked of them is (across - push · sin) / cos of the steering angle, and
    /// there is share · √(grip² - push²): a quadratic equation for the push, once that angle is known.
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
        Some(found.clamp(-rear.sqrt(), rear.sqrt()))
    }

    /// The acceleration along the way that is left of a push: what is across the wheels is not all across the way.
    fn along(&self, curvature: f64, across: f64, push: f64) -> f64 {
        let steering = self.steered(curvature, across, push);
        let (sin, cos) = math::sin_cos(steering);
        let aside = (across - push * sin) / cos;
        // Along the car, each axle with half its weight; the middle of the car moves aslant to it.
        let along = 0.5 * (push * (1.0 + cos) - aside * sin);
        let aslant = math::atan(0.5 * self.wheelbase * curvature - math::tan(self.slip(1.0, across, push)));
        along + across * math::sin(aslant)
    }
}

/// Times that the steering angle is put in where it is looked for.
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

    /// A car that is steered for a circle at a speed, for some seconds: speed and rate of turn as they are, and how far it slides to
    /// the left at its rear axle.
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
        // With less across, what turned wheels push is more than they need.
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
            // Beyond what the front tyres can give, no steering is right.
            let most = MOST * tyres.front * tyres.circle(along);
            prop_assume!(across.abs() / math::cos(steered) < 0.95 * most);
            // Back from the angle to the curvature: what rolls beside the slip of both axles.
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

    /// Pushes and brakes as much as possible beside an acceleration across.
    fn both_axles_give(curvature: f64, across: f64) -> Result<(), TestCaseError> {
        let tyres = Tyres::default();
        for push in [Push::On, Push::Back] {
            let Some(most) = tyres.most(curvature, across, push) else { continue };
            let (sin, cos) = math::sin_cos(tyres.steered(curvature, across, most));
            prop_assert!(across <= MOST * (tyres.grip * tyres.grip - most * most).sqrt() + 1e-9);
            let (front, circle) = ((across - most * sin) / cos, tyres.circle(most));
            // The steering angle is found in so few turns that it is out by some per mille.
            prop_assert!(front <= 1.02 * MOST * tyres.front * circle + 1e-9, "{front} of {circle}");
        }
        Ok(())
    }

    #[test]
    fn nearly_all_grip_is_pushed_along_a_straight() {
        // Less is left across by the friction circle alone than the model keeps at least.
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
