use std::sync::Arc;

use image::GrayImage;
use proptest::prelude::*;

use super::*;
use crate::geometry::{Pose, Twist, units};
use crate::io::sim::{SimOptions, SimRobot, Simulation};
use crate::io::{Camera, Clock, Drive, Resolution};
use crate::random::Stream;
use crate::vision::{Error, GrayView};
use crate::world::{Object, ObjectKind, RobotPlacement, RobotSpec, Scene, World};

fn view(image: &GrayImage) -> GrayView<'_> {
    image.try_into().unwrap()
}

fn detector() -> MotionDetector {
    MotionDetector::new(MotionParameters::default()).unwrap()
}

/// A picture of smooth hills with the noise of a camera, as bright as asked for.
fn hills(light: f64, seed: u64) -> GrayImage {
    let mut stream = Stream::new(seed);
    GrayImage::from_fn(160, 120, |x, y| {
        let shade = 90.0 + f64::from((x / 20 + y / 15) % 4) * 25.0;
        let noise = 2.0 * (shade / 255.0).sqrt() * stream.normal();
        image::Luma([(light * shade + noise).round().clamp(0.0, 255.0) as u8])
    })
}

proptest! {
    #![proptest_config(crate::testing::cases(40))]

    #[test]
    fn noise_and_exposure_are_no_motion(seed in 0..1_000_000_u64, light in 0.9..1.1f64) {
        let motion = detector().compare(view(&hills(1.0, seed)), view(&hills(light, seed + 1))).unwrap();
        prop_assert!(!motion.is_moving(), "{:?}", motion);
    }

    #[test]
    fn a_thing_that_appears_is_motion_in_its_sector(x in 0_u32..148, y in 0_u32..108, seed in 0..1_000_000_u64) {
        let (before, mut after) = (hills(1.0, seed), hills(1.0, seed + 1));
        for dy in 0..12 {
            for dx in 0..12 {
                after.put_pixel(x + dx, y + dy, image::Luma([250]));
            }
        }
        let motion = detector().compare(view(&before), view(&after)).unwrap();
        // Where the thing lies across two sectors, either is right.
        let sector = |x: u32| (3 * x / 160) as usize;
        let strongest = motion.strongest.unwrap();
        prop_assert!((sector(x.saturating_sub(8))..=sector((x + 19).min(159))).contains(&strongest));
        let expected = crate::vision::mean_difference(view(&before), view(&after)).unwrap();
        prop_assert_eq!(motion.mean_difference, expected);
    }

    #[test]
    fn any_size_has_an_answer(width in 1_u32..40, height in 1_u32..30, block in 2_usize..12) {
        let image = GrayImage::from_fn(width, height, |x, y| image::Luma([(7 * x + 13 * y) as u8]));
        let parameters = MotionParameters { block, ..MotionParameters::default() };
        let motion = MotionDetector::new(parameters).unwrap().compare(view(&image), view(&image)).unwrap();
        prop_assert_eq!(motion.sectors, [0.0; 3]);
        prop_assert!(!motion.is_moving());
    }
}

/// A room with things, an observer in it, and another robot before it.
fn scene() -> Scene {
    let mut world = World::walled(3.0, 3.0);
    for (name, x, y) in [("can", 2.0, 1.1), ("crate", 2.5, 2.0), ("soccer", 1.8, 1.9)] {
        let kind = Arc::new(ObjectKind::predefined(name).unwrap());
        world.objects.push(Object::new(kind, Pose::new(x, y, 0.4)));
    }
    let mut scene = Scene::with_robot(world, RobotSpec::s4(), Pose::new(0.6, 1.5, 0.0));
    scene.robots.push(RobotPlacement::new(Arc::new(RobotSpec::s4()), Pose::new(1.5, 1.75, 0.0)));
    scene
}

#[test]
fn a_turn_is_taken_out_of_the_image() {
    let field_of_view = RobotSpec::s4().camera.unwrap().field_of_view;
    let simulation = Simulation::new(&scene(), SimOptions::ideal()).unwrap();
    let mut robot = simulation.robot(0).unwrap();
    let first = robot.gray_image().unwrap();
    robot.turn(units::from_deg(3.0), 0.5).unwrap();
    robot.wait_done().unwrap();
    let second = robot.gray_image().unwrap();
    let mut compensator = TurnCompensator::new(field_of_view).unwrap();
    let angle = robot.pose().unwrap().heading;
    let Turned { image: moved, from, to, .. } = compensator.turn(view(&first), view(&second), angle).unwrap();
    assert!(from == 0 || to == 160, "{from} {to}");
    assert!(to - from > 140);
    let difference = |a: &GrayImage| {
        let part = |image| view(image).region((from, 0), to - from, 120).unwrap();
        crate::vision::mean_difference(part(a), part(&second)).unwrap()
    };
    let (without, with) = (difference(&first), difference(moved));
    assert!(with < 0.4 * without, "{with} {without}");
}

/// The robot that watches a room, in which another one drives or stands.
fn watcher(options: SimOptions, other: Twist) -> SimRobot {
    let simulation = Simulation::new(&scene(), options).unwrap();
    // Whose program has ended keeps its speed.
    simulation.robot(1).unwrap().set_speed(other).unwrap();
    let mut robot = simulation.robot(0).unwrap();
    robot.set_resolution(Resolution::Qqvga).unwrap();
    robot
}

/// How many of the images of one run are alarms while the robot turns, and how many there are. The watched room is still
/// or has another robot that drives across; odometry jumps in the midst of a turn.
fn alarms_while_turning(moves: bool, noise: f64, light: f64, seed: u64) -> (usize, usize) {
    let options = SimOptions { light, ..SimOptions::with_noise(noise, seed) };
    let mut robot = watcher(options, if moves { Twist::new(0.25, 2.0) } else { Twist::STOP });
    let parameters = WatchParameters::new(RobotSpec::s4().camera.unwrap().field_of_view);
    let mut watch = MotionWatch::new(parameters).unwrap();
    let (mut alarms, mut images) = (0, 0);
    // To and fro with pauses, in radians per second, each for half a second.
    for (part, speed) in [0.0, 0.4, 0.0, -0.4, -0.4, 0.0, 0.4, -0.2].into_iter().enumerate() {
        for i in 0..5 {
            let image = robot.gray_image().unwrap();
            let mut pose = robot.pose().unwrap();
            if (part, i) >= (3, 3) {
                pose.heading += units::from_deg(15.0);
            }
            watch.step(robot.now().unwrap(), &image, pose).unwrap();
            if let Some(motion) = watch.motion() {
                images += 1;
                alarms += usize::from(motion.is_moving());
            }
            robot.set_speed(Twist::new(0.0, speed)).unwrap();
            robot.wait(0.1).unwrap();
        }
    }
    (alarms, images)
}

#[test]
fn a_still_world_is_no_motion_while_the_robot_turns() {
    for (noise, light) in [(0.0, 1.0), (1.0, 1.0), (1.0, 1.5), (1.5, 1.0)] {
        for seed in 1..=3 {
            assert_eq!(alarms_while_turning(false, noise, light, seed), (0, 39), "{noise} {light} {seed}");
        }
    }
}

#[test]
fn what_moves_is_seen_while_the_robot_turns() {
    for noise in [0.0, 1.0] {
        let (alarms, images) = alarms_while_turning(true, noise, 1.0, 1);
        assert!(3 * alarms > images, "{noise}: {alarms} of {images}");
    }
}

/// Pairs of images with an alarm, of twenty of a room by a standing robot, under some light and noise.
fn alarms_standing(moves: bool, light: f64, noise: f64) -> usize {
    let options = SimOptions { light, ..SimOptions::with_noise(noise, 5) };
    let mut robot = watcher(options, if moves { Twist::new(0.15, 2.2) } else { Twist::STOP });
    robot.wait(0.5).unwrap();
    let mut before = robot.gray_image().unwrap();
    let mut detector = detector();
    let pairs = (0..20).filter(|_| {
        robot.wait(0.1).unwrap();
        let image = robot.gray_image().unwrap();
        let motion = detector.compare(view(&before), view(&image)).unwrap();
        before = image;
        motion.is_moving()
    });
    pairs.count()
}

#[test]
fn motion_and_stillness_are_told_apart_in_any_light_and_noise() {
    for (light, noise) in [(0.3, 1.0), (0.6, 1.0), (1.0, 0.0), (1.0, 1.0), (1.0, 2.0), (1.5, 1.0), (3.0, 1.0)]
    {
        assert_eq!(alarms_standing(false, light, noise), 0, "{light} {noise}");
        let moving = alarms_standing(true, light, noise);
        assert!(moving >= 19, "{light} {noise}: {moving}");
    }
}

#[test]
fn the_robot_turns_to_what_moves_and_stands_when_nothing_does() {
    let turned = |moves: bool| {
        let simulation = Simulation::new(&scene(), SimOptions::with_noise(1.0, 3)).unwrap();
        let mut other = simulation.robot(1).unwrap();
        let mut robot = simulation.robot(0).unwrap();
        std::thread::scope(|scope| {
            scope.spawn(move || {
                if moves {
                    // To the observer's left, and across its view.
                    other.set_speed(Twist::new(0.15, 2.2)).unwrap();
                }
                other.wait(3.0).unwrap();
            });
            let parameters = WatchParameters::new(RobotSpec::s4().camera.unwrap().field_of_view);
            let mut watch = MotionWatch::new(parameters).unwrap();
            watch.run(&mut robot, 3.0, |_, _, _| Ok(())).unwrap();
        });
        simulation.truth().pose(0).unwrap().heading
    };
    assert_eq!(turned(false), 0.0);
    assert!(turned(true) > 0.1, "{}", turned(true));
}

#[test]
fn parameters_out_of_range() {
    for (block, threshold, least_noise) in
        [(1, 6.0, 1.0), (8, f64::NAN, 1.0), (8, -1.0, 1.0), (8, 6.0, 0.0), (999, 6.0, 1.0)]
    {
        assert!(MotionDetector::new(MotionParameters { block, threshold, least_noise }).is_err());
    }
    assert!(TurnCompensator::new(0.0).is_err());
    let (a, b) = (GrayImage::new(4, 4), GrayImage::new(4, 5));
    assert!(matches!(detector().compare(view(&a), view(&b)), Err(Error::Size { .. })));
}
