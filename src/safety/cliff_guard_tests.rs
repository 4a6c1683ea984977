use proptest::prelude::*;

use super::{CliffGuard, CliffGuardParameters, SpeedError, StoppingModel};
use crate::geometry::{Aabb, Point, Pose, Twist, Vector, direction};
use crate::io::sim::{SimOptions, Simulation};
use crate::io::{Call, Clock, Drive, ErrorKind, Manoeuvres, MockRobot, Odometry, Psd};
use crate::random::Stream;
use crate::world::{Footprint, HeightField, RobotSpec, Scene, Terrain, World};

/// A mock whose corners find ground, or none.
fn mock(missing: [bool; 4]) -> CliffGuard<MockRobot> {
    let robot = (0..4).fold(MockRobot::new().with_ideal_drive(), |robot, number| {
        let range = if missing[number] { 0.5 } else { 0.14 };
        robot.with_distance(Psd(21 + number as u8), range)
    });
    CliffGuard::new(robot, &RobotSpec::blizzard(), CliffGuardParameters::default()).unwrap()
}

fn box_corners() -> [(Vector, Vector); 4] {
    let Footprint::Rectangle(outline) = RobotSpec::blizzard().footprint else { unreachable!() };
    [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)].map(|(x, y)| {
        let outwards = Vector::new(x, y);
        (outwards.component_mul(&outline.max.coords), outwards)
    })
}

proptest! {
    #![proptest_config(crate::testing::cases(256))]
    /// What is passed on brings a corner without ground no nearer to an edge in any direction beyond it, and
    /// moves no place too fast; away from all edges everything is passed on, on the same circle.
    #[test]
    fn only_what_leads_away_is_passed_on(
        (linear, angular) in (-0.6..0.6f64, -2.0..2.0f64), missing in any::<[bool; 4]>(), share in 0.0..1.0f64,
    ) {
        let mut robot = mock(missing);
        robot.set_speed(Twist::new(linear, angular)).unwrap();
        let told = robot.speed().unwrap();
        for ((place, outwards), missing) in box_corners().into_iter().zip(missing) {
            let velocity = Vector::new(told.linear - told.angular * place.y, told.angular * place.x);
            prop_assert!(velocity.norm() <= 0.3 + 1e-9, "{velocity}");
            let normal = Vector::new(share, 1.0 - share).component_mul(&outwards);
            prop_assert!(!missing || velocity.dot(&normal) <= 1e-9, "{told:?} {place}");
        }
        if missing == [false; 4] {
            let apart = told.linear * angular - told.angular * linear;
            prop_assert!(apart.abs() < 1e-9 && told.linear * linear > 0.0, "{told:?}");
        }
    }
}

#[test]
fn manoeuvres_and_waits_are_guarded() {
    let ahead = [true, true, false, false];
    let mut robot = mock(ahead);
    robot.straight(0.5, 0.2).unwrap();
    robot.turn(1.0, 0.5).unwrap();
    robot.curve(0.5, 0.2, 0.2).unwrap();
    let started = |call: &Call| matches!(call, Call::Straight(..) | Call::Turn(..) | Call::Curve(..));
    assert!(!robot.inner().calls().iter().any(started), "{:?}", robot.inner().calls());
    robot.straight(-0.5, 0.2).unwrap();
    assert!(robot.inner().calls().iter().any(started));
    assert!(robot.is_at_edge());
}

#[test]
fn a_failed_sensor_stops_the_robot() {
    let robot = MockRobot::new().with_ideal_drive().with_distance(Psd(21), vec![0.14, 0.14]);
    let mut robot = CliffGuard::new(robot, &RobotSpec::blizzard(), CliffGuardParameters::default()).unwrap();
    let failed = robot.set_speed(Twist::new(0.2, 0.0));
    assert!(failed.is_err());
    assert_eq!(robot.speed().unwrap(), Twist::STOP);
    assert_ne!(failed.unwrap_err().kind(), ErrorKind::InvalidInput);
}

#[test]
fn a_guard_that_could_not_stop_in_time_is_refused() {
    let good = CliffGuardParameters::default();
    let stopping = |reaction, deceleration| CliffGuardParameters {
        stopping: StoppingModel { reaction, lag: 0.0, deceleration, error: SpeedError::NONE },
        ..good
    };
    for bad in [
        CliffGuardParameters { speed: 0.5, ..good },
        CliffGuardParameters { speed: 0.0, ..good },
        CliffGuardParameters { drop: f64::NAN, ..good },
        CliffGuardParameters { period: 0.1, ..good },
        stopping(0.3, 3.0),
        stopping(0.03, 0.5),
    ] {
        assert!(CliffGuard::new(MockRobot::new(), &RobotSpec::s4(), bad).is_err(), "{bad:?}");
    }
}

/// A plateau whose ground ends at x = 2 m.
const EDGE: f64 = 2.0;

fn plateau() -> World {
    let area = Aabb::new(Point::origin(), Point::new(3.0, 3.0));
    let ground = HeightField::from_fn(601, 601, area, |at| if at.x > EDGE { 0.0 } else { 0.2 }).unwrap();
    World { terrain: Some(Terrain::new("plateau.png", ground)), ..World::empty(3.0, 3.0) }
}

/// Metres from the outline to the edge at the end of an approach; `None` if the robot does not arrive.
fn approach(world: &World, stream: &mut Stream, seed: u64) -> Option<f64> {
    let specs = [RobotSpec::blizzard(), RobotSpec::labbot(), RobotSpec::s4()];
    let spec = CliffGuard::equip(specs[stream.below(3)].clone());
    let backwards = stream.chance(0.5);
    let (towards, speed) = (stream.between(-1.4, 1.4), stream.between(0.05, 0.35));
    let bend = stream.between(-0.3, 0.3);
    let heading = if backwards { towards + std::f64::consts::PI } else { towards };
    let start = Point::new(1.4, 1.5) - direction(towards) * stream.between(0.0, 0.2);
    let options = SimOptions::with_noise(1.0, seed);
    let scene = Scene::with_robot(world.clone(), spec.clone(), Pose::new(start.x, start.y, heading));
    let simulation = Simulation::new(&scene, options).unwrap();
    let robot = simulation.robot(0).unwrap();
    let mut robot = CliffGuard::new(robot, &spec, CliffGuardParameters::default()).unwrap();
    let linear = if backwards { -speed } else { speed };
    for _ in 0..200 {
        robot.set_speed(Twist::new(linear, bend * speed)).unwrap();
        robot.wait(0.1).unwrap();
        if robot.is_at_edge() {
            break;
        }
    }
    robot.wait(1.0).unwrap();
    let arrived = robot.is_at_edge();
    let pose = simulation.truth().pose(0).unwrap();
    assert_eq!(simulation.truth().mishap(0).unwrap(), None, "seed {seed}");
    let left = match spec.footprint {
        Footprint::Disc { radius } => EDGE - pose.x - radius,
        Footprint::Rectangle(b) => {
            [(b.min.x, b.min.y), (b.min.x, b.max.y), (b.max.x, b.min.y), (b.max.x, b.max.y)]
                .map(|(x, y)| EDGE - pose.to_world(Point::new(x, y)).x)
                .into_iter()
                .fold(f64::INFINITY, f64::min)
        }
    };
    arrived.then_some(left)
}

/// None falls, and all that arrive stand within 100 mm of the edge.
fn approaches(count: u64) {
    let (world, mut stream) = (plateau(), Stream::new(1));
    let mut arrived = 0;
    for seed in 0..count {
        let Some(left) = approach(&world, &mut stream, seed) else { continue };
        assert!((0.0..=0.1).contains(&left), "seed {seed}: {left}");
        arrived += 1;
    }
    assert!(2 * arrived > count, "{arrived} of {count}");
}

#[test]
fn nobody_falls_off_an_edge() {
    approaches(60);
}

mod campaigns {
    #[test]
    #[ignore = "takes minutes"]
    fn ten_thousand_approaches() {
        super::approaches(10_000);
    }
}
