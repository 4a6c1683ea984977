use super::*;
use crate::geometry::Pose;
use crate::kinematics::advance_planar;
use crate::world::{DriveSpec, RobotSpec};

/// Time step (s).
const DT: f64 = 0.002;

fn bicycle() -> Bicycle {
    let spec = RobotSpec::race_car();
    let DriveSpec::Ackermann { wheelbase, dynamics: Some(dynamics), .. } = spec.drive else {
        panic!("a racing car has tyres")
    };
    Bicycle::new(dynamics, spec.motor, wheelbase, &NoiseModel::ideal(), Stream::new(1))
}

fn settled(speed: f64, steering: f64, seconds: f64) -> Bicycle {
    let mut car = bicycle();
    for _ in 0..(seconds / DT) as u32 {
        car.substep(speed, steering, DT);
    }
    car
}

/// The acceleration of the centre of mass between two steps, in the frame of the world.
fn acceleration(before: &Speeds, after: &Speeds) -> f64 {
    let (sin, cos) = math::sin_cos(DT * after.yaw_rate);
    let (x, y) = (cos * after.along - sin * after.across, sin * after.along + cos * after.across);
    math::hypot(x - before.along, y - before.across) / DT
}

#[test]
fn slow_cars_roll_in_circles() {
    let car = settled(1.5, 0.3, 5.0);
    let curvature = car.speeds.yaw_rate / car.speeds.along;
    assert!((curvature - math::tan(0.3) / car.wheelbase).abs() < 1e-6);
    assert!(car.slip().abs() < 1e-9);
}

#[test]
fn no_force_leaves_the_friction_circle() {
    for (speed, steering) in [(8.0, 0.1), (12.0, 0.2), (20.0, 0.4), (25.0, 0.05), (-25.0, 0.2), (-6.0, 0.6)] {
        let mut car = bicycle();
        for _ in 0..4000 {
            let before = car.speeds;
            car.substep(speed, steering, DT);
            let acceleration = acceleration(&before, &car.speeds);
            assert!(acceleration < 1.02 * car.spec.grip, "{acceleration} at {before:?}");
        }
    }
}

/// However it moves and whatever it is told, sliding sideways and backwards included, and the sliding
/// comes to an end.
#[test]
fn nor_does_any_from_random_driving() {
    let mut random = Stream::new(11);
    for _ in 0..300 {
        let mut car = bicycle();
        car.speeds = Speeds {
            along: random.between(-25.0, 25.0),
            across: random.between(-12.0, 12.0),
            yaw_rate: random.between(-5.0, 5.0),
        };
        for k in 0..3000 {
            let wish = if k < 1000 { random.between(-30.0, 30.0) } else { 0.0 };
            let before = car.speeds;
            car.substep(wish, random.between(-0.6, 0.6), DT);
            let acceleration = acceleration(&before, &car.speeds);
            assert!(acceleration < 1.02 * car.spec.grip, "{acceleration} at {before:?}");
        }
        assert_eq!(car.speeds, Speeds::default(), "it stands");
    }
}

/// Whether tyres hold an acceleration across, on bends that are wide for the car.
fn balances(spec: &CarDynamics, across: f64) -> bool {
    let (stiffness, strained) = (spec.stiffness * units::GRAVITY, across / spec.grip);
    if strained >= 1.0 {
        return false;
    }
    let rear = across / (stiffness * (1.0 - strained * strained).sqrt());
    // The front axle gives more the more it slips, and less the more it is turned.
    (0..400).any(|k| {
        let slip = 1.2 * f64::from(k) / 400.0;
        let steering = slip - rear;
        let linear = stiffness * slip / spec.grip;
        let force = spec.balance * spec.grip * linear / (1.0 + linear * linear).sqrt();
        steering <= 0.6 && force * math::cos(steering) >= across
    })
}

#[test]
fn no_steering_gives_more_across_than_the_balance() {
    let spec = CarDynamics::default();
    let bound = (0..1200).map(|k| 0.01 * f64::from(k)).take_while(|&a| balances(&spec, a)).last().unwrap();
    for curvature in [0.03, 0.08, 0.15, 0.25] {
        // Of all circles that the car comes to drive at some speeds, those of about that curvature.
        let mut best = 0.0_f64;
        for steering in 1..30 {
            for speed in 1..20 {
                let speed = (0.06 * f64::from(speed) * bound / curvature).sqrt();
                let car = settled(speed, 0.02 * f64::from(steering), 6.0);
                let Speeds { along, across, yaw_rate } = car.speeds;
                let velocity = math::hypot(along, across);
                if (yaw_rate / velocity / curvature - 1.0).abs() < 0.03 && along > CarDynamics::SLIPS {
                    best = best.max(yaw_rate * velocity);
                }
            }
        }
        assert!(best < 1.02 * bound && best > 0.85 * bound, "{curvature}: {best} of {bound}");
    }
}

#[test]
fn brakes_bring_it_to_stand_within_the_distance() {
    let mut car = settled(20.0, 0.0, 6.0);
    assert!((car.speed() - 20.0).abs() < 0.01);
    let way: f64 = (0..600).map(|_| car.step(0.0, [0.0; 2]).forward).sum();
    // v²/2a, and v/gain for the end that it brakes softly.
    let bound = 20.0 * 20.0 / (2.0 * car.spec.brake) + 20.0 * car.motor.time_constant;
    assert!(car.speed() == 0.0 && way < bound && way > 15.0, "{way} of {bound}");
}

#[test]
fn it_drives_backwards_as_well() {
    let car = settled(-1.0, 0.2, 3.0);
    assert!((car.speed() + 1.0).abs() < 1e-6 && car.speeds.yaw_rate < 0.0);
}

#[test]
fn ticks_add_up_to_the_circle_of_the_rear_axle() {
    let mut car = settled(10.0, 0.1, 6.0);
    let twist = PlanarTwist::new(car.speed(), car.slip(), car.speeds.yaw_rate);
    let mut pose = Pose::default();
    for _ in 0..100 {
        pose = advance_planar(pose, car.step(10.0, [0.1; 2]));
    }
    let end = advance_planar(Pose::default(), twist.during(1.0));
    assert!(pose.distance_to(end.position()) < 1e-6, "{pose:?} {end:?}");
}

#[test]
fn a_wall_takes_the_speed_into_it_and_leaves_that_along_it() {
    let mut car = settled(10.0, 0.0, 6.0);
    let wish = car.step(10.0, [0.0; 2]);
    car.settle(PlanarMotion { forward: 0.5 * wish.forward, left: 0.0, angle: 0.0 });
    assert!((car.speed() - 5.0).abs() < 0.01);
    car.settle(PlanarMotion { forward: -3.0, left: 0.0, angle: 2.0 });
    assert!(car.speed().abs() < 10.1 && car.speeds.yaw_rate == 0.0, "out of it, but no faster: {car:?}");
}
