use proptest::prelude::*;

use super::{CliffGuard, CliffGuardParameters};
use crate::geometry::{Aabb, Point, Pose, Twist, Vector, direction};
use crate::io::sim::{SimOptions, Simulation};
use crate::io::wrappers::{Manoeuvring, ManoeuvringParameters};
use crate::io::{Clock, Drive, ErrorKind, Manoeuvres, MockRobot, Odometry, Psd};
use crate::random::Stream;
use crate::world::{Footprint, HeightField, MotorSpec, RobotSpec, Scene, Terrain, World};

/// A mock whose outer and inner sensors find ground, or none.
fn mock(outer: [bool; 4], inner: [bool; 4]) -> CliffGuard<MockRobot> {
    let spec = RobotSpec::blizzard();
    let missing = outer.into_iter().chain(inner);
    let robot = (21..).zip(missing).fold(MockRobot::new().with_ideal_drive(), |robot, (id, missing)| {
        robot.with_distance(Psd(id), if missing { 1.0 } else { 0.19 })
    });
    CliffGuard::new(robot, &spec, CliffGuardParameters::of(&spec)).unwrap()
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
    /// A corner without ground under its inner sensor gets no nearer to an edge in any direction beyond it;
    /// under the outer one, it creeps. Away from all edges everything is passed on, on the same circle.
    #[test]
    fn only_what_is_safe_is_passed_on(
        (linear, angular) in (-0.6..0.6f64, -2.0..2.0f64), share in 0.0..1.0f64,
        outer in any::<[bool; 4]>(), inner in any::<[bool; 4]>(),
    ) {
        let mut robot = mock(outer, inner);
        robot.set_speed(Twist::new(linear, angular)).unwrap();
        let told = robot.speed().unwrap();
        for (number, (place, outwards)) in box_corners().into_iter().enumerate() {
            let velocity = Vector::new(told.linear - told.angular * place.y, told.angular * place.x);
            prop_assert!(velocity.norm() <= 0.3 + 1e-9, "{velocity}");
            let normal = Vector::new(share, 1.0 - share).component_mul(&outwards);
            let nearer = velocity.dot(&normal);
            prop_assert!(!inner[number] || nearer <= 1e-9, "{told:?} {place}");
            prop_assert!(!outer[number] || nearer <= 0.05 + 1e-9, "{told:?} {place}");
        }
        if outer == [false; 4] && inner == [false; 4] {
            let apart = told.linear * angular - told.angular * linear;
            prop_assert!(apart.abs() < 1e-9 && told.linear * linear > 0.0, "{told:?}");
        }
    }
}

#[test]
fn manoeuvres_end_at_an_edge() {
    let guarded = mock([true, true, false, false], [true, true, false, false]);
    let mut robot = Manoeuvring::new(guarded, ManoeuvringParameters::default()).unwrap();
    robot.straight(0.5, 0.2).unwrap();
    robot.wait_done().unwrap();
    assert_eq!(robot.pose().unwrap(), Pose::default());
    // A held robot stays held until it stops or moves.
    robot.stop().unwrap();
    robot.straight(-0.5, 0.2).unwrap();
    robot.wait_done().unwrap();
    let pose = robot.pose().unwrap();
    assert!((pose.x + 0.5).abs() < 2e-3, "{pose:?}");
    assert!(robot.inner().is_at_edge());
}

#[test]
fn a_failed_sensor_stops_the_robot() {
    let spec = RobotSpec::blizzard();
    let robot = MockRobot::new().with_ideal_drive().with_distance(Psd(21), vec![0.14, 0.14]);
    let mut robot = CliffGuard::new(robot, &spec, CliffGuardParameters::of(&spec)).unwrap();
    let failed = robot.set_speed(Twist::new(0.2, 0.0));
    assert_ne!(failed.unwrap_err().kind(), ErrorKind::InvalidInput);
    assert_eq!(robot.into_inner().speed().unwrap(), Twist::STOP);
}

#[test]
fn nonsense_is_refused() {
    let spec = RobotSpec::s4();
    let good = CliffGuardParameters::of(&spec);
    let mut late = good;
    late.stopping.reaction = 0.03;
    for bad in [
        CliffGuardParameters { speed: 0.0, ..good },
        CliffGuardParameters { creep: 0.4, ..good },
        CliffGuardParameters { drop: f64::NAN, ..good },
        CliffGuardParameters { period: 0.1, ..good },
        late,
    ] {
        assert!(CliffGuard::new(MockRobot::new(), &spec, bad).is_err(), "{bad:?}");
    }
    let mut robot = mock([false; 4], [false; 4]);
    assert!(robot.wait(f64::NAN).is_err() && robot.set_speed(Twist::new(f64::NAN, 0.0)).is_err());
}

/// Slower motors look farther ahead.
#[test]
fn sensors_look_as_far_ahead_as_the_robot_stops() {
    let [quick, slow] = [0.02, 0.4].map(|time_constant| {
        let motor = MotorSpec { time_constant, ..MotorSpec::default() };
        CliffGuardParameters::of(&RobotSpec { motor, ..RobotSpec::s4() })
    });
    assert!(quick.near() < slow.near() && quick.far() < slow.far());
    // By hand: 0.05 m/s · 1.056 + 5 mm/s = 57.8 mm/s; 0.44 s of it and 0.0578² / 4.
    assert!((slow.near() - (0.0578 * 0.44 + 0.0578 * 0.0578 / 4.0)).abs() < 1e-9, "{}", slow.near());
}

/// Place along x where a plateau's ground drops by 0.2 m (m).
const EDGE: f64 = 2.0;
/// Place along x where the world ends (m).
const BORDER: f64 = 3.0;

fn plateau(edge: f64) -> World {
    let area = Aabb::new(Point::origin(), Point::new(BORDER, BORDER));
    let ground = HeightField::from_fn(601, 601, area, |at| if at.x > edge { 0.0 } else { 0.2 }).unwrap();
    World { terrain: Some(Terrain::new("plateau.png", ground)), ..World::empty(BORDER, BORDER) }
}

/// Distance between an outline and an edge along y (m).
fn distance(footprint: &Footprint, pose: Pose, edge: f64) -> f64 {
    match footprint {
        Footprint::Disc { radius } => edge - pose.x - radius,
        Footprint::Rectangle(b) => {
            [(b.min.x, b.min.y), (b.min.x, b.max.y), (b.max.x, b.min.y), (b.max.x, b.max.y)]
                .map(|(x, y)| edge - pose.to_world(Point::new(x, y)).x)
                .into_iter()
                .fold(f64::INFINITY, f64::min)
        }
    }
}

/// Distance from the outline to the edge after an approach at up to 85 degrees from its normal (m); `None` if
/// the robot does not arrive.
fn approach(world: &World, edge: f64, stream: &mut Stream, seed: u64) -> Option<f64> {
    let plain = [RobotSpec::blizzard(), RobotSpec::labbot(), RobotSpec::s4()][stream.below(3)].clone();
    let parameters = CliffGuardParameters::of(&plain);
    let spec = CliffGuard::equip(plain, &parameters);
    let backwards = stream.chance(0.5);
    let (towards, speed) = (stream.between(-1.48, 1.48), stream.between(0.05, 0.3));
    let bend = stream.between(-0.3, 0.3);
    let heading = if backwards { towards + std::f64::consts::PI } else { towards };
    let start = Point::new(edge - 0.6, 1.5) - direction(towards) * stream.between(0.0, 0.2);
    let scene = Scene::with_robot(world.clone(), spec.clone(), Pose::new(start.x, start.y, heading));
    let simulation = Simulation::new(&scene, SimOptions::with_noise(1.0, seed)).unwrap();
    let mut robot = CliffGuard::new(simulation.robot(0).unwrap(), &spec, parameters).unwrap();
    let linear = if backwards { -speed } else { speed };
    for _ in 0..300 {
        robot.set_speed(Twist::new(linear, bend * speed)).unwrap();
        robot.wait(0.1).unwrap();
        // Robots that turn away from the edge drive towards another border.
        let inside = (0.5..2.5).contains(&simulation.truth().pose(0).unwrap().y);
        if robot.is_at_edge() || !inside {
            break;
        }
    }
    robot.wait(1.0).unwrap();
    let arrived = robot.is_at_edge();
    assert_eq!(simulation.truth().mishap(0).unwrap(), None, "seed {seed}");
    arrived.then(|| distance(&spec.footprint, simulation.truth().pose(0).unwrap(), edge))
}

/// No robot falls, and all that arrive stand within 100 mm of the edge.
fn approaches(edge: f64, count: u64) {
    let (world, mut stream) = (plateau(edge), Stream::new(1));
    let (mut arrived, mut nearest, mut farthest) = (0, f64::INFINITY, 0.0_f64);
    for seed in 0..count {
        let Some(left) = approach(&world, edge, &mut stream, seed) else { continue };
        assert!((0.0..=0.1).contains(&left), "seed {seed}: {left}");
        arrived += 1;
        (nearest, farthest) = (nearest.min(left), farthest.max(left));
    }
    println!("{arrived} of {count} arrived, and stand {nearest:.4} to {farthest:.4} m from the edge");
    assert!(2 * arrived > count, "{arrived} of {count}");
}

#[test]
fn nobody_drives_over_an_edge() {
    approaches(EDGE, 60);
}

#[test]
fn the_border_of_the_world_is_an_edge() {
    approaches(BORDER, 20);
}

mod campaigns {
    #[test]
    #[ignore = "takes minutes: cargo test --release --all-features --lib -- --ignored ten_thousand_approaches"]
    fn ten_thousand_approaches() {
        super::approaches(super::EDGE, 10_000);
    }
}
