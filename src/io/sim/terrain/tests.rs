use std::f64::consts::TAU;

use proptest::prelude::*;

use super::*;
use crate::geometry::{Aabb, Point, Point3, Pose, Pose3, Vector, Vector3, math, units};
use crate::io::sim::TICK;
use crate::kinematics::{PlanarTwist, advance_planar};
use crate::random::Stream;
use crate::world::{HeightField, RobotSpec};

mod table;

/// A field of 8 m by 8 m; heights are a function of the position from its centre.
fn field(samples: usize, height: impl FnMut(Point) -> f64) -> HeightField {
    let area = Aabb::new(Point::new(-4.0, -4.0), Point::new(4.0, 4.0));
    HeightField::from_fn(samples, samples, area, height).unwrap()
}

/// A plane that rises along x.
fn incline(degrees: f64) -> HeightField {
    let rise = math::tan(units::from_deg(degrees));
    field(33, move |at| rise * at.x)
}

/// Smooth hills.
fn hills(seed: u64, height: f64) -> HeightField {
    let mut stream = Stream::new(seed);
    let waves: Vec<_> = (0..8)
        .map(|_| {
            (Vector::new(stream.between(-3.0, 3.0), stream.between(-3.0, 3.0)), stream.between(0.0, 6.0))
        })
        .collect();
    field(257, |at| {
        waves.iter().map(|(wave, phase)| height / 8.0 * math::sin(wave.dot(&at.coords) + phase)).sum()
    })
}

struct Robot {
    carriage: Undercarriage,
    body: RigidBody,
}

impl Robot {
    /// A robot at rest on the ground.
    fn resting(spec: &RobotSpec, ground: &HeightField, pose: Pose) -> Self {
        Self::with(Undercarriage::of(spec), ground, pose)
    }

    fn with(carriage: Undercarriage, ground: &HeightField, pose: Pose) -> Self {
        let body = RigidBody::resting(ground, &carriage, pose, TICK);
        Self { carriage, body }
    }

    fn step(&mut self, ground: &HeightField, drive: PlanarTwist) {
        self.body.step(ground, &self.carriage, &drive, TICK);
    }

    fn run(&mut self, ground: &HeightField, drive: PlanarTwist, seconds: f64) {
        for _ in 0..(seconds / TICK).round() as u32 {
            self.step(ground, drive);
        }
    }

    fn pose(&self) -> Pose3 {
        self.body.pose(&self.carriage)
    }

    /// Whether all of its feet are above ground.
    fn is_within(&self, ground: &HeightField) -> bool {
        let pose = self.pose();
        let at = |foot: &super::undercarriage::Foot| {
            pose.to_world(Point3::from(foot.place + self.carriage.centre))
        };
        self.carriage.feet.iter().all(|foot| ground.height(at(foot).xy()).is_some())
    }

    /// Depth of the deepest foot in the ground, along the normal.
    fn depth(&self, ground: &HeightField) -> f64 {
        let pose = self.pose();
        let depth = |foot: &super::undercarriage::Foot| {
            let at = pose.to_world(Point3::from(foot.place + self.carriage.centre));
            let upright = ground.normal(at.xy()).map_or(1.0, |normal| normal.z);
            ground.height(at.xy()).map_or(f64::NEG_INFINITY, |level| (level - at.z) * upright)
        };
        // Wheels on springs yield to the ground, and so do belts.
        let stiff = self.carriage.feet.iter().filter(|foot| foot.softness < 1e-3);
        stiff.map(depth).fold(f64::NEG_INFINITY, f64::max)
    }
}

fn robots() -> Vec<RobotSpec> {
    vec![RobotSpec::s4(), RobotSpec::labbot(), RobotSpec::omni(), RobotSpec::car(), RobotSpec::blizzard()]
}

#[test]
fn robots_stand_level_on_level_ground_and_stay() {
    let ground = incline(0.0);
    for spec in robots() {
        let mut robot = Robot::resting(&spec, &ground, Pose::new(0.3, -0.2, 0.7));
        let start = robot.pose();
        assert!(start.position.z.abs() < 5e-4 && start.tilt() < 2e-3, "{}: {start:?}", spec.name);
        robot.run(&ground, PlanarTwist::STOP, 10.0);
        let moved = robot.pose().position - start.position;
        assert!(moved.norm() < 1e-6, "{}: {moved:?}", spec.name);
    }
}

/// Without slip, a drive moves as on the floor.
#[test]
fn on_level_ground_robots_move_as_their_wheels_turn() {
    let ground = incline(0.0);
    for spec in robots() {
        for drive in [
            PlanarTwist::new(0.3, 0.0, 0.0),
            PlanarTwist::new(0.3, 0.0, 0.5),
            PlanarTwist::new(-0.2, 0.0, 0.3),
        ] {
            let start = Pose::new(-1.0, 0.0, 0.4);
            let mut robot = Robot::resting(&spec, &ground, start);
            let mut expected = robot.pose().pose();
            for tick in 0..500 {
                let part = (f64::from(tick) / 50.0).min(1.0);
                robot.step(&ground, drive.scaled(part));
                expected = advance_planar(expected, drive.scaled(part).during(TICK));
            }
            let found = robot.pose().pose();
            let apart = (found.position() - expected.position()).norm();
            let turned = crate::geometry::angle_difference(found.heading, expected.heading);
            // Belts skid in turns, and are calibrated for turns on the spot only.
            let skids = spec.name == "Blizzard" && drive.angular != 0.0;
            let slack = if skids { 0.3 * drive.angular.abs() * 5.0 } else { 1e-3 };
            assert!(apart < slack && turned.abs() < slack, "{} {drive:?}: {apart} {turned}", spec.name);
        }
    }
}

/// In turns on the spot, a tracked robot moves as its odometry measures.
#[test]
fn belts_are_calibrated_for_turns_on_the_spot() {
    let ground = incline(0.0);
    let mut robot = Robot::resting(&RobotSpec::blizzard(), &ground, Pose::new(0.0, 0.0, 0.0));
    let drive = PlanarTwist::new(0.0, 0.0, 0.5);
    let (mut turned, mut before) = (0.0, 0.0);
    for _ in 0..1000 {
        robot.step(&ground, drive);
        let heading = robot.pose().pose().heading;
        turned += crate::geometry::angle_difference(heading, before);
        before = heading;
    }
    assert!((turned - 5.0).abs() < 0.1, "{turned}");
    assert!(robot.pose().position.xy().coords.norm() < 0.01, "{:?}", robot.pose());
}

#[test]
fn a_robot_on_a_plane_has_its_attitude() {
    for (spec, degrees, heading) in
        [(RobotSpec::s4(), 10.0, 0.0), (RobotSpec::labbot(), 15.0, 1.0), (RobotSpec::car(), 20.0, 2.5)]
    {
        let ground = incline(degrees);
        let robot = Robot::resting(&spec, &ground, Pose::new(0.0, 0.0, heading));
        let normal = ground.normal(Point::origin()).unwrap();
        let apart = math::acos(robot.pose().up().dot(&normal).min(1.0));
        assert!(units::to_deg(apart) < 0.3, "{}: {}", spec.name, units::to_deg(apart));
        let height = ground.height(robot.pose().position.xy()).unwrap();
        assert!((robot.pose().position.z - height).abs() < 1e-3);
    }
}

/// Smallest slope on which something is the case (degrees).
fn threshold(is_over: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (0.0, 60.0);
    while high - low > 0.02 {
        let middle = 0.5 * (low + high);
        if is_over(middle) { high = middle } else { low = middle }
    }
    0.5 * (low + high)
}

/// Smallest slope (degrees) on which a robot with blocked wheels moves.
fn slips_at(carriage: &Undercarriage, heading: f64) -> f64 {
    threshold(|degrees| {
        let ground = incline(degrees);
        let mut robot = Robot::with(carriage.clone(), &ground, Pose::new(0.0, 0.0, heading));
        let start = robot.pose().position;
        robot.run(&ground, PlanarTwist::STOP, 1.0);
        (robot.pose().position - start).norm() > 1e-4
    })
}

#[test]
fn a_car_with_four_braked_wheels_slips_at_the_angle_of_friction() {
    let mut carriage = Undercarriage::of(&RobotSpec::car());
    for foot in &mut carriage.feet {
        if let super::undercarriage::Grip::Rolling(axle) = foot.grip {
            foot.grip = super::undercarriage::Grip::Driven(axle);
        }
    }
    for friction in [0.3, 0.6] {
        carriage.friction = friction;
        for eighth in 0..8 {
            let found = slips_at(&carriage, TAU / 8.0 * f64::from(eighth) + 0.1);
            let expected = units::to_deg(math::atan(friction));
            assert!((found - expected).abs() < 0.2, "{friction}, {eighth}: {found} {expected}");
        }
    }
}

/// It tips sideways when its centre of mass is above the lower wheels.
/// At rest it hardly moves, so what holds it is not told by its speed.
#[test]
fn a_tracked_robot_at_rest_slides_from_the_angle_of_friction_on() {
    let spec = RobotSpec::blizzard();
    let limit = math::atan(Undercarriage::of(&spec).friction).to_degrees();
    for heading in 0..8 {
        let slid = |degrees: f64| {
            let ground = incline(degrees);
            let pose = Pose::new(0.0, 0.0, f64::from(heading) * std::f64::consts::FRAC_PI_4);
            let mut robot = Robot::resting(&spec, &ground, pose);
            let start = robot.pose().position;
            robot.run(&ground, PlanarTwist::STOP, 1.0);
            (robot.pose().position - start).norm()
        };
        let (below, above) = (slid(limit - 0.3), slid(limit + 0.3));
        assert!(below < 2e-3 && above > 0.02, "{heading}: {below} {above}");
    }
}

#[test]
fn a_car_tips_where_its_middle_leaves_its_wheels() {
    let spec = RobotSpec::car();
    let crate::world::DriveSpec::Ackermann { track, .. } = spec.drive else { unreachable!() };
    let mut carriage = Undercarriage::of(&spec);
    carriage.friction = 5.0;
    let high = 0.5 * track / math::tan(units::from_deg(30.0));
    let up = high - carriage.centre.z;
    carriage.centre.z = high;
    for foot in &mut carriage.feet {
        foot.place.z -= up;
        if let super::undercarriage::Grip::Rolling(axle) = foot.grip {
            foot.grip = super::undercarriage::Grip::Driven(axle);
        }
    }
    for (degrees, tips) in [(29.5, false), (30.5, true)] {
        for heading in [TAU / 4.0, -TAU / 4.0] {
            let ground = incline(degrees);
            let mut robot = Robot::with(carriage.clone(), &ground, Pose::new(0.0, 0.0, heading));
            robot.run(&ground, PlanarTwist::STOP, 3.0);
            let normal = ground.normal(Point::origin()).unwrap();
            let leaning = units::to_deg(math::acos(robot.pose().up().dot(&normal).min(1.0)));
            assert_eq!(leaning > 20.0, tips, "{degrees} {heading}: {leaning}");
        }
    }
}

#[test]
fn a_drop_ends_on_the_ground() {
    let ground = incline(0.0);
    let carriage = Undercarriage::of(&RobotSpec::s4());
    let pose = Pose3::from_angles(Point3::new(0.0, 0.0, 0.5), 0.2, -0.1, 0.3);
    let body = RigidBody::new(&carriage, &pose);
    let mut robot = Robot { carriage, body };
    robot.run(&ground, PlanarTwist::STOP, 0.2);
    assert!(!robot.body.is_carried() && (robot.body.velocity().z + 1.962).abs() < 1e-6);
    robot.run(&ground, PlanarTwist::STOP, 2.0);
    assert!(robot.pose().tilt() < 0.01 && robot.pose().position.z.abs() < 1e-3, "{:?}", robot.pose());
}

/// A wall of one cell's width stops a robot instead of being climbed.
#[test]
fn a_robot_placed_into_a_slope_starts_above_it_and_comes_to_rest_on_it() {
    let ground = incline(12.0);
    for spec in robots() {
        let carriage = Undercarriage::of(&spec);
        let level = Pose3::level(Pose::new(0.0, 0.0, 0.3), 0.0);
        let mut robot = Robot { body: RigidBody::above(&ground, &carriage, &level), carriage };
        let (up, depth) = (robot.pose().position.z, robot.depth(&ground));
        assert!(up > 2e-3 && depth < 1e-9, "{}: {up} {depth}", spec.name);
        robot.run(&ground, PlanarTwist::STOP, 3.0);
        let tilt = units::to_deg(robot.pose().tilt());
        assert!((tilt - 12.0).abs() < 1.0 && robot.body.velocity().norm() < 1e-3, "{}: {tilt}", spec.name);
    }
}

#[test]
fn a_steep_face_stops_a_robot() {
    let ground = field(801, |at| if at.x > 0.505 { 0.2 } else { 0.0 });
    for spec in robots() {
        let mut robot = Robot::resting(&spec, &ground, Pose::new(0.0, 0.0, 0.0));
        for _ in 0..500 {
            robot.step(&ground, PlanarTwist::new(0.3, 0.0, 0.0));
            assert!(robot.depth(&ground) < 0.004, "{}: {}", spec.name, robot.depth(&ground));
        }
        let end = robot.pose();
        assert!(end.position.x < 0.6 && end.position.z < 0.1, "{}: {end:?}", spec.name);
    }
}

#[test]
fn a_robot_drives_up_a_ramp_and_falls_off_a_ledge() {
    let ground = field(401, |at| {
        if at.x < 0.0 {
            0.0
        } else if at.x < 1.0 {
            0.2 * at.x
        } else if at.x < 2.0 {
            0.2
        } else {
            0.0
        }
    });
    let mut robot = Robot::resting(&RobotSpec::labbot(), &ground, Pose::new(-1.0, 0.0, 0.0));
    robot.run(&ground, PlanarTwist::new(0.25, 0.0, 0.0), 10.0);
    let on_top = robot.pose();
    assert!((on_top.position.z - 0.2).abs() < 2e-3 && on_top.position.y.abs() < 1e-3, "{on_top:?}");
    let mut flew = false;
    for _ in 0..1000 {
        robot.step(&ground, PlanarTwist::new(0.25, 0.0, 0.0));
        flew |= !robot.body.is_carried();
    }
    let down = robot.body.middle();
    assert!(flew && down.x > 1.9 && down.z < 0.15, "{down:?}");
}

/// Poses of a robot after some seconds, with ticks of full, half and quarter length; the drive reaches its
/// speed within a second.
fn ends(spec: &RobotSpec, ground: &HeightField, start: Pose, drive: PlanarTwist, seconds: u32) -> [Pose3; 3] {
    [1, 2, 4].map(|parts| {
        let mut robot = Robot::resting(spec, ground, start);
        let tick = TICK / f64::from(parts);
        for number in 0..100 * seconds * parts {
            let speed = drive.scaled(((f64::from(number) + 0.5) * tick).min(1.0));
            robot.body.step(ground, &robot.carriage, &speed, tick);
        }
        robot.pose()
    })
}

/// Maximum distance (m) and angle (degrees) between the ends of pairs.
fn apart(ends: &[Pose3; 3]) -> (f64, f64) {
    ends.windows(2).fold((0.0, 0.0), |(far, turned), pair| {
        let turn = crate::geometry::angle_difference(pair[1].pose().heading, pair[0].pose().heading);
        let way = (pair[1].position - pair[0].position).norm();
        (way.max(far), units::to_deg(turn).abs().max(turned))
    })
}

/// Halving the tick moves the end of a drive of 10 m by at most 1 mm and 0.1 degrees, also on belts, which
/// skid all the way.
#[test]
fn the_tick_matters_little() {
    for seed in 3..6 {
        let ground = hills(seed, 0.2);
        for spec in robots() {
            let drive = PlanarTwist::new(0.25, 0.0, 0.15);
            let found = apart(&ends(&spec, &ground, Pose::new(0.0, -1.7, 0.0), drive, 40));
            assert!(found.0 < 1e-3 && found.1 < 0.1, "{}, {seed}: {found:?}", spec.name);
        }
    }
}

/// Drops a robot above the ground with random attitude and motion, and observes it for 2 s. Fails if it gains
/// energy or sinks into the ground.
fn let_go(ground: &HeightField, spec: &RobotSpec, stream: &mut Stream) -> Result<(), String> {
    let carriage = Undercarriage::of(spec);
    let mut between = |most: f64| stream.between(-most, most);
    let (x, y) = (between(2.0), between(2.0));
    let (roll, pitch, yaw) = (between(0.5), between(0.5), between(3.0));
    let (drop, vx, vy, w) = (0.225 + between(0.175), between(1.0), between(1.0), between(3.0));
    let low = Pose3::from_angles(Point3::new(x, y, 0.0), roll, pitch, yaw);
    let below = |foot: &super::undercarriage::Foot| {
        let at = low.to_world(Point3::from(foot.place + carriage.centre));
        ground.height(at.xy()).unwrap() - at.z
    };
    let up = carriage.feet.iter().map(below).fold(f64::NEG_INFINITY, f64::max);
    let pose = Pose3::new(low.position + Vector3::z() * (up + drop), low.attitude);
    let mut body = RigidBody::new(&carriage, &pose);
    body.throw(Vector3::new(vx, vy, 0.0), Vector3::z() * w);
    let mut robot = Robot { carriage, body };
    let mut energy = robot.body.energy(&robot.carriage);
    for tick in 0..200 {
        // An impact is noticed at the end of its tick.
        let way = robot.body.velocity().norm() * TICK;
        robot.step(ground, PlanarTwist::STOP);
        let now = robot.body.energy(&robot.carriage);
        let (more, depth) = (now - energy, robot.depth(ground));
        // A robot that leaves the hills falls beside them, and comes to their side from there.
        if !robot.is_within(ground) {
            break;
        }
        if more > 1e-9 || depth > way.max(0.015) {
            let speed = robot.body.velocity().norm();
            return Err(format!("{}, tick {tick}: {more} J/kg more, {depth} m deep, {speed} m/s", spec.name));
        }
        energy = now;
    }
    Ok(())
}

proptest! {
    #![proptest_config(crate::testing::cases(64))]
    #[test]
    fn without_motors_energy_never_rises_and_nothing_sinks_in(
        ground in 0..1000_u64, robot in 0..5_usize, start in any::<u64>(),
    ) {
        let found = let_go(&hills(ground, 1.5), &robots()[robot], &mut Stream::new(start));
        prop_assert_eq!(found, Ok(()));
    }
}

/// These take minutes: `cargo test --release --lib -- --ignored terrain::tests::campaigns`.
mod campaigns {
    use super::*;

    #[test]
    #[ignore = "takes an hour: cargo test --release --lib -- --ignored a_million_starts"]
    fn a_million_starts_without_motors() {
        let robots = robots();
        let mut wrong = Vec::new();
        for seed in 0..1000 {
            let ground = hills(seed, 1.5);
            for start in 0..1000 {
                let spec = &robots[start as usize % robots.len()];
                if let Err(found) = let_go(&ground, spec, &mut Stream::new(1000 * seed + start)) {
                    println!("hills {seed}, start {}: {found}", 1000 * seed + start);
                    wrong.push(found);
                }
            }
        }
        assert!(wrong.is_empty(), "{} of 1000000: {:?}", wrong.len(), &wrong[..wrong.len().min(5)]);
    }

    #[test]
    #[ignore = "takes minutes: cargo test --release --lib -- --ignored ten_million_driven_ticks"]
    fn ten_million_driven_ticks_above_the_ground() {
        let (mut stream, robots) = (Stream::new(2), robots());
        let (mut ticks, mut runs) = (0, 0);
        while ticks < 10_000_000 {
            let ground = hills(runs, 0.6);
            let spec = &robots[runs as usize % robots.len()];
            let heading = stream.between(-3.0, 3.0);
            let mut robot = Robot::resting(spec, &ground, Pose::new(0.0, 0.0, heading));
            let drive = PlanarTwist::new(stream.between(-0.4, 0.4), 0.0, stream.between(-1.0, 1.0));
            for tick in 0..2000 {
                robot.step(&ground, drive);
                let at = robot.pose().position;
                // A robot that leaves the hills falls beside them.
                if at.x.abs().max(at.y.abs()) > 3.5 {
                    break;
                }
                let depth = robot.depth(&ground);
                assert!(depth < 0.01, "{}, run {runs}, tick {tick}: {depth} m deep", spec.name);
                ticks += 1;
            }
            runs += 1;
        }
    }
}

#[test]
fn speeds_are_finite_on_any_ground() {
    let mut stream = Stream::new(9);
    let ground = field(65, |_| stream.between(-1.0, 1.0));
    let mut robot = Robot::resting(&RobotSpec::s4(), &ground, Pose::new(0.0, 0.0, 0.0));
    for tick in 0..2000 {
        let drive = PlanarTwist::new(0.4, 0.0, f64::from(tick % 7) - 3.0);
        robot.step(&ground, drive);
        assert!(robot.pose().is_finite() && robot.body.velocity().norm() < 20.0, "tick {tick}");
    }
}
