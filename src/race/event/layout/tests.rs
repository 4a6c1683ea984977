use super::*;
use crate::geometry::direction;
use proptest::prelude::*;
use std::f64::consts::TAU;

/// Step size of the numerical derivative.
const STEP: f64 = 1e-6;

fn eight(apart: f64, inner: f64, outer: f64) -> Vec<Cone> {
    let mut cones = Vec::new();
    for side in [1.0, -1.0] {
        for k in 0..16 {
            let arm = direction(TAU * f64::from(k) / 16.0);
            let centre = Point::new(0.0, side * apart);
            cones.push(Cone::unknown(centre + arm * inner));
            let place = centre + arm * outer;
            if place.y * side > 1.0 {
                cones.push(Cone::unknown(place));
            }
        }
        for k in 0..3 {
            cones.push(Cone::unknown(Point::new(-9.0 - 2.0 * f64::from(k), side * (apart - inner))));
        }
    }
    cones
}

proptest! {
    #![proptest_config(crate::testing::cases(32))]
    #[test]
    fn a_skidpad_is_found_from_its_start(
        apart in 9.0..9.3f64, thin in 1.5..1.65f64, wide in 1.4..1.65f64,
        back in 14.0..20.0f64, aside in -0.4..0.4f64, turn in -0.1..0.1f64,
    ) {
        let cones = eight(apart, apart - thin, apart + wide);
        let car = Pose::new(-back, aside, turn);
        let seen: Vec<Cone> = cones.into_iter().filter(|cone| car.distance_to(cone.position) < 24.0).collect();
        let found = EventLayout::find(&seen, car, EventShape::EIGHT).unwrap();
        prop_assert!(found.pose.position().coords.norm() < 0.1 && found.pose.heading.abs() < 0.02, "{:?}", found);
        let numbers = [apart, apart - thin, apart + wide];
        for (number, truth) in found.shape.numbers().iter().zip(numbers) {
            prop_assert!((number - truth).abs() < 0.1, "{:?} {:?}", found, numbers);
        }
    }

    #[test]
    fn gradients_are_those_of_the_distance(x in -15.0..15.0f64, y in -19.0..19.0f64) {
        prop_assume!(y.abs() > 0.01);
        let place = Point::new(x, y);
        let numbers = EventShape::EIGHT.numbers();
        let edge = EventShape::EIGHT.edge(place);
        for axis in 0..3 {
            let mut other = numbers;
            other[axis] += STEP;
            let moved = EventShape::EIGHT.with(other).edge(place).off;
            // Not where another edge becomes the nearest.
            if (moved - edge.off).abs() < 2.0 * STEP {
                prop_assert!(((moved - edge.off) / STEP - edge.by_shape[axis]).abs() < 1e-3);
            }
        }
        for (axis, step) in [Vector::new(STEP, 0.0), Vector::new(0.0, STEP)].into_iter().enumerate() {
            let moved = EventShape::EIGHT.edge(place + step).off;
            if (moved - edge.off).abs() < 2.0 * STEP {
                prop_assert!(((moved - edge.off) / STEP - edge.by_place[axis]).abs() < 1e-3);
            }
        }
    }
}

#[test]
fn what_is_no_layout() {
    assert_eq!(EventLayout::find(&[], Pose::default(), EventShape::STRIP), None);
    let heap: Vec<Cone> = (0..30)
        .map(|k| Cone::unknown(Point::new(f64::from(7 * k % 20), f64::from(11 * k % 17) - 8.0)))
        .collect();
    for shape in [EventShape::STRIP, EventShape::EIGHT] {
        assert_eq!(EventLayout::find(&heap, Pose::default(), shape), None);
    }
}
