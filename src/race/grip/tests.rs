use super::*;
use crate::geometry::math;
use proptest::prelude::*;

/// Acceleration by the motors (m/s²).
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
