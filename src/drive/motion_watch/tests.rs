use std::sync::Arc;

use image::GrayImage;

use super::*;
use crate::geometry::{Pose, Twist, units};
use crate::io::control::run;
use crate::io::sim::{SimOptions, SimRobot, Simulation};
use crate::io::{Camera, Clock, Drive, Manoeuvres, Odometry, Resolution};
use crate::vision::GrayView;
use crate::vision::motion::{MotionDetector, MotionParameters, TurnCompensator, Turned};
use crate::world::{Object, ObjectKind, RobotPlacement, RobotSpec, Scene, World};

fn view(image: &GrayImage) -> GrayView<'_> {
    image.try_into().unwrap()
}

/// A room with objects, an observer, and another robot in front of it.
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
    let difference = |a: GrayView<'_>| {
        let (corner, width) = ((from, 0), to - from);
        let (a, b) = (a.region(corner, width, 120), view(&second).region(corner, width, 120));
        crate::vision::mean_difference(a.unwrap(), b.unwrap()).unwrap()
    };
    let (without, with) = (difference(view(&first)), difference(moved));
    assert!(with < 0.4 * without, "{with} {without}");
}

/// A robot that watches a room in which another one drives or stands.
fn watcher(options: SimOptions, other: Twist) -> SimRobot {
    let simulation = Simulation::new(&scene(), options).unwrap();
    // A robot whose program has ended keeps its speed.
    simulation.robot(1).unwrap().set_speed(other).unwrap();
    let mut robot = simulation.robot(0).unwrap();
    robot.set_resolution(Resolution::Qqvga).unwrap();
    robot
}

/// Number of alarms, and of images, while the robot turns. The room is still or another robot drives across;
/// odometry jumps in the middle of a turn.
fn alarms_while_turning(moves: bool, noise: f64, light: f64, seed: u64) -> (usize, usize) {
    let options = SimOptions { light, ..SimOptions::with_noise(noise, seed) };
    let mut robot = watcher(options, if moves { Twist::new(0.25, 2.0) } else { Twist::STOP });
    let parameters = MotionWatchParameters::new(RobotSpec::s4().camera.unwrap().field_of_view);
    let mut watch = MotionWatch::new(parameters).unwrap();
    let (mut alarms, mut images) = (0, 0);
    // Turn rates to and fro with pauses (rad/s), half a second each.
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

/// Number of alarms among twenty image pairs from a standing robot.
fn alarms_standing(moves: bool, light: f64, noise: f64) -> usize {
    let options = SimOptions { light, ..SimOptions::with_noise(noise, 5) };
    let mut robot = watcher(options, if moves { Twist::new(0.15, 2.2) } else { Twist::STOP });
    robot.wait(0.5).unwrap();
    let mut before = robot.gray_image().unwrap();
    let mut detector = MotionDetector::new(MotionParameters::default()).unwrap();
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
            let parameters = MotionWatchParameters::new(RobotSpec::s4().camera.unwrap().field_of_view);
            let mut watch = MotionWatch::new(parameters).unwrap();
            run(&mut robot, &mut watch, 3.0, |_, _, _| {}).unwrap();
        });
        simulation.truth().pose(0).unwrap().heading
    };
    assert_eq!(turned(false), 0.0);
    assert!(turned(true) > 0.1, "{}", turned(true));
}
