use super::tyres::Tyres;
use crate::ParameterError;
use crate::parameter::{require, require_positive};

/// Grip limit of a car's tyres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum GripLimit {
    /// A friction ellipse, independent of the car.
    Ellipse {
        /// Maximum lateral acceleration on a straight (m/s²).
        across: f64,
        /// Fraction of it lost per 1/m of curvature: turned wheels also push backwards.
        turned: f64,
        /// Maximum longitudinal acceleration (m/s²).
        along: f64,
    },
    /// The bicycle model in steady state.
    Balance(Tyres),
}

impl GripLimit {
    pub(super) fn validate(&self) -> Result<(), ParameterError> {
        match *self {
            Self::Ellipse { across, turned, along } => {
                require_positive("grip across", across)?;
                require_positive("grip along", along)?;
                require("grip lost by turned wheels", turned, (0.0..=1.0).contains(&turned), "0 to 1")
            }
            Self::Balance(tyres) => tyres.validate(),
        }
    }

    /// Maximum lateral acceleration at a curvature (m/s²) at which a car with motors of acceleration `drive`
    /// keeps its speed.
    pub fn across(&self, curvature: f64, drive: f64) -> f64 {
        let curvature = curvature.abs();
        match *self {
            // At least a fifth: no car turns more tightly.
            Self::Ellipse { across, turned, .. } => across * (1.0 - turned * curvature).max(0.2),
            Self::Balance(tyres) => {
                let keeps = |across| {
                    tyres.turns(curvature, across)
                        && tyres.forwards(curvature, across, drive).is_some_and(|along| along >= 0.0)
                };
                let (mut least, mut most) = (0.0, tyres.grip);
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (least + most);
                    if keeps(middle) { least = middle } else { most = middle }
                }
                // Where the wheels do not turn far enough, the car only crawls.
                least.max(CRAWLS * tyres.grip)
            }
        }
    }

    /// Maximum longitudinal acceleration (m/s²) at a curvature and a lateral acceleration, limited by the
    /// motors.
    pub fn forwards(&self, curvature: f64, across: f64, drive: f64) -> f64 {
        match self {
            Self::Ellipse { .. } => self.left_along(curvature, across).min(drive),
            Self::Balance(tyres) => {
                tyres.forwards(curvature.abs(), across.abs(), drive).unwrap_or(0.0).max(0.0)
            }
        }
    }

    /// Maximum deceleration (m/s²), limited by the brakes.
    pub fn backwards(&self, curvature: f64, across: f64, brake: f64) -> f64 {
        match self {
            Self::Ellipse { .. } => self.left_along(curvature, across).min(brake),
            Self::Balance(tyres) => {
                tyres.backwards(curvature.abs(), across.abs(), brake).unwrap_or(0.0).max(0.0)
            }
        }
    }

    fn left_along(&self, curvature: f64, across: f64) -> f64 {
        let Self::Ellipse { along, .. } = self else { return 0.0 };
        let share = across / self.across(curvature, 0.0);
        along * (1.0 - share * share).max(0.0).sqrt()
    }
}

/// The share of the grip that is left for bends that are too tight.
const CRAWLS: f64 = 0.05;
/// Halvings of the range in which an acceleration is looked for.
const HALVINGS: usize = 14;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::math;
    use proptest::prelude::*;

    const DRIVE: f64 = 8.0;

    fn balance() -> GripLimit {
        GripLimit::Balance(Tyres::default())
    }

    proptest! {
        #![proptest_config(crate::testing::cases(256))]
        #[test]
        fn tighter_bends_are_slower(curvature in 0.005..0.38f64, tighter in 1.02..1.5f64) {
            for grip in [balance(), GripLimit::Ellipse { across: 10.0, turned: 0.5, along: 10.0 }] {
                let fast = |bend: f64| (grip.across(bend, DRIVE) / bend).sqrt();
                prop_assert!(fast(curvature * tighter) < fast(curvature), "{grip:?}");
                prop_assert_eq!(grip.across(-curvature, DRIVE), grip.across(curvature, DRIVE));
            }
        }

        #[test]
        fn no_balance_exceeds_the_tyres(curvature in 0.0..0.3f64, share in 0.0..1.0f64) {
            let (grip, circle) = (balance(), Tyres::default().grip);
            let most = grip.across(curvature, DRIVE);
            // The front axle saturates first, but driven, turned wheels also pull the car around.
            prop_assert!(most < if curvature < 0.05 { 0.9 } else { 0.971 } * circle, "{most}");
            let across = share * most;
            for along in [grip.forwards(curvature, across, DRIVE), grip.backwards(curvature, across, 11.0)] {
                prop_assert!(along >= 0.0 && math::hypot(along, across) < circle, "{along} {across}");
            }
            // Turned wheels partly push against the lateral forces.
            prop_assert!(grip.forwards(curvature, across, DRIVE) <= 1.1 * DRIVE);
        }

        #[test]
        fn the_more_is_asked_across_the_less_is_left_along(
            curvature in 0.0..0.25f64, share in 0.5..0.95f64,
        ) {
            let grip = balance();
            let most = grip.across(curvature, DRIVE);
            let [less, more] = [share, share + 0.05].map(|share| grip.forwards(curvature, share * most, DRIVE));
            prop_assert!(more <= less + 1e-6, "{more} {less}");
        }
    }

    #[test]
    fn where_the_wheels_do_not_turn_far_enough_a_car_crawls() {
        // 0.6 rad is a curvature of 0.44 1/m for wheels without slip.
        let speed = |bend: f64| (balance().across(bend, DRIVE) / bend).sqrt();
        assert!((0.5..2.0).contains(&speed(0.5)) && speed(0.4) > 3.0, "{} {}", speed(0.5), speed(0.4));
    }

    #[test]
    fn what_is_no_hold() {
        let told = |grip: GripLimit| grip.validate().unwrap_err().to_string();
        assert_eq!(
            told(GripLimit::Ellipse { across: 9.0, turned: 2.0, along: 9.0 }),
            "grip lost by turned wheels is 2; expected 0 to 1"
        );
        assert_eq!(
            told(GripLimit::Balance(Tyres { grip: -1.0, ..Tyres::default() })),
            "grip is -1; expected a positive, finite number"
        );
    }
}
