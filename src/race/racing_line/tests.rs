use super::*;
use crate::geometry::direction;
use crate::race::ClosedSpline;
use proptest::prelude::*;

/// A wavy ring.
fn ring(waves: f64, height: f64, width: f64) -> Corridor {
    let points: Vec<_> = (0..120)
        .map(|i| {
            let angle = f64::from(i) * std::f64::consts::TAU / 120.0;
            let radius = 30.0 + height * crate::geometry::math::sin(waves * angle);
            (Point::origin() + direction(angle) * radius, width, width)
        })
        .collect();
    Corridor::closed(&points).unwrap()
}

proptest! {
    #![proptest_config(crate::testing::cases(40))]
    #[test]
    fn no_line_nearby_bends_less(
        waves in 2_i32..7, height in 0.5..5.0f64, width in 1.2..4.0f64,
        at in 0_usize..120, lift in prop_oneof![Just(-0.05), Just(0.05)],
    ) {
        let corridor = ring(f64::from(waves), height, width);
        let parameters = RacingLineParameters { tolerance: 1e-5, iterations: 100, margin: 1.0 };
        let line = minimum_curvature(&corridor, &parameters).unwrap();
        let free = corridor.free(1.0).unwrap();
        // A smooth bump of the line, within the bounds, anywhere.
        let mut other = line.offsets.clone();
        for k in 0..21 {
            let i = (at + k) % 120;
            let bump = 0.5 * (1.0 - crate::geometry::math::cos(k as f64 * std::f64::consts::TAU / 20.0));
            other[i] = (other[i] + lift * bump).clamp(free[i][0], free[i][1]);
        }
        prop_assert!(energy(corridor.stations(), &other) >= line.bending_energy * (1.0 - 1e-4));
        for (offset, [low, high]) in line.offsets.iter().zip(&free) {
            prop_assert!(low - 1e-9 <= *offset && *offset <= high + 1e-9);
        }
    }
}

#[test]
fn the_line_bends_less_than_the_middle() {
    let corridor = ring(5.0, 4.0, 3.0);
    let middle: Vec<Point> = corridor.stations().iter().map(|s| s.position).collect();
    let line = minimum_curvature(&corridor, &RacingLineParameters::default()).unwrap();
    let energy = |points: &[Point]| ClosedSpline::through(points).unwrap().bending_energy();
    assert!(energy(&line.points) < 0.5 * energy(&middle), "{} {}", energy(&line.points), energy(&middle));
    // The sum over circles approximates the integral over the spline.
    assert!((line.bending_energy / energy(&line.points) - 1.0).abs() < 0.02);
}

#[test]
fn a_car_that_is_too_wide() {
    let error = minimum_curvature(&ring(3.0, 2.0, 0.9), &RacingLineParameters::default()).unwrap_err();
    assert!(matches!(error, LineError::TooNarrow { needed: 2.0, .. }), "{error}");
}
