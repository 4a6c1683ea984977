use std::f64::consts::TAU;

use super::*;
use crate::geometry::math;

#[test]
fn a_car_that_measures_its_speed_too_high_stops_all_the_same() {
    const RADIUS: f64 = 60.0;
    let at = |way: f64| {
        let turned = way / RADIUS;
        Pose::new(RADIUS * math::sin(turned), RADIUS * (1.0 - math::cos(turned)), turned)
    };
    let parameters = RacerParameters::default();
    // A loop, so that the car neither searches a lane nor gets lost for lack of cones.
    let points: Vec<Point> = (0..200).map(|k| at(TAU * RADIUS * f64::from(k) / 200.0).position()).collect();
    let profile = SpeedProfile::closed(&points, &parameters.limits).unwrap();
    let mut racer = Racer::new(parameters).unwrap();
    racer.tracker = Some(LineTracker::new(points, profile, true, parameters.tracker).unwrap());
    (racer.phase, racer.looks) = (RacePhase::Finished, 0);
    let (mut place, mut speed) = (0.0, 20.0);
    for _ in 0..200 {
        let measured = Twist::new(1.02 * speed, 1.02 * speed / RADIUS);
        speed = racer.decide(at(place), measured, &[]).linear;
        place += parameters.period * speed;
    }
    assert!(speed < 0.05 && place < 100.0, "{speed} m/s after {place} m");
}
