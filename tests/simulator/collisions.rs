//! Robots among walls, objects and each other.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
use std::ops::ControlFlow;
use std::sync::Arc;

use roverlab::geometry::{Point, Pose, Segment, Twist, math};
use roverlab::io::sim::{Fleet, SimOptions, Simulation};
use roverlab::io::{Clock, Drive, Manoeuvres, Motors, Odometry, StallDetector};
use roverlab::world::{Object, ObjectKind, RobotSpec, Scene, Shape, Wall, World};

use crate::common::{degrees_between, robots, start};
use crate::scenes::{brick, with_robots};

/// An S4 that looks along x at a wall whose face is at x = 1.
fn before_a_wall(distance: f64) -> Scene {
    let mut world = World::empty(3.0, 3.0);
    world.walls.push(Wall::new(Point::new(1.005, 0.0), Point::new(1.005, 3.0)));
    Scene::with_robot(world, RobotSpec::s4(), Pose::new(1.0 - 0.06 - distance, 1.5, 0.0))
}

#[test]
fn a_wall_stops_the_robot_but_not_its_wheels() {
    let (mut robot, truth) = start(&before_a_wall(0.2), SimOptions::ideal());
    robot.set_speed(Twist::new(0.2, 0.0)).unwrap();
    robot.wait(5.0).unwrap();
    let pose = truth.pose(0).unwrap();
    assert!((pose.x - 0.94).abs() <= 1e-5 && (pose.y - 1.5).abs() < 1e-12, "{pose:?}");
    // The lag of 0.2 s costs 0.04 m of the 1 m that the wheels would have driven.
    let odometry = robot.pose().unwrap();
    assert!((odometry.x - 0.96).abs() < 0.005, "{odometry:?}");
    let told = truth.robot(0).unwrap();
    assert_eq!((told.contacts, told.contact_places.len()), (1, 1));
    assert!((told.contact_places[0] - Point::new(1.0, 1.5)).norm() < 0.005, "{told:?}");
    assert!((told.path_length - 0.2).abs() < 1e-5);
}

#[test]
fn a_held_robot_stalls_after_half_a_second_and_backs_off() {
    let (mut robot, truth) = start(&before_a_wall(0.0), SimOptions::ideal());
    robot.set_speed(Twist::new(0.2, 0.0)).unwrap();
    robot.wait(0.48).unwrap();
    assert!(!robot.is_stalled().unwrap());
    robot.wait(0.06).unwrap();
    assert!(robot.is_stalled().unwrap());
    robot.straight(-0.1, 0.2).unwrap();
    robot.wait_done().unwrap();
    assert!(!robot.is_stalled().unwrap());
    // Its wheels still rolled forward a little, in vain, and gave that back too.
    let backed = 0.94 - truth.pose(0).unwrap().x;
    assert!((0.1..0.115).contains(&backed), "{backed}");
}

#[test]
fn a_stalled_manoeuvre_ends_the_wait() {
    let (mut robot, truth) = start(&before_a_wall(0.1), SimOptions::ideal());
    robot.straight(2.0, 0.2).unwrap();
    robot.wait_done().unwrap();
    assert!(robot.is_stalled().unwrap() && !robot.is_done().unwrap());
    assert!((1.0..2.0).contains(&truth.time()), "{}", truth.time());
}

#[test]
fn a_speed_that_is_commanded_again_and_again_still_stalls() {
    let (mut robot, _) = start(&before_a_wall(0.0), SimOptions::ideal());
    for _ in 0..7 {
        robot.set_speed(Twist::new(0.2, 0.0)).unwrap();
        robot.wait(0.1).unwrap();
    }
    assert!(robot.is_stalled().unwrap());
    robot.set_speed(Twist::STOP).unwrap();
    robot.wait(0.1).unwrap();
    assert!(!robot.is_stalled().unwrap(), "nothing drives the wheels any more");
}

#[test]
fn a_disc_at_a_wall_still_turns_and_does_not_stall() {
    let (mut robot, truth) = start(&before_a_wall(0.001), SimOptions::ideal());
    robot.turn(FRAC_PI_2, 1.0).unwrap();
    robot.wait_done().unwrap();
    assert!(!robot.is_stalled().unwrap());
    assert!(degrees_between(truth.pose(0).unwrap().heading, FRAC_PI_2) < 0.3);
    assert_eq!(truth.robot(0).unwrap().contacts, 0);
}

#[test]
fn a_rectangle_that_cannot_turn_stalls() {
    // A slot 0.11 m wide around a robot 0.10 m wide and 0.16 m long.
    let mut world = World::empty(3.0, 3.0);
    for y in [1.44, 1.56] {
        world.walls.push(Wall::new(Point::new(0.5, y), Point::new(2.5, y)));
    }
    let (mut robot, truth) =
        start(&Scene::with_robot(world, brick(), Pose::new(1.5, 1.5, 0.0)), SimOptions::ideal());
    robot.turn(FRAC_PI_2, 1.0).unwrap();
    robot.wait_done().unwrap();
    assert!(robot.is_stalled().unwrap());
    let pose = truth.pose(0).unwrap();
    assert!(degrees_between(pose.heading, 0.0) < 15.0, "{pose:?}");
    // Its wheels go on, so odometry believes in the turn.
    robot.wait(3.0).unwrap();
    assert!(degrees_between(robot.pose().unwrap().heading, FRAC_PI_2) < 0.3);
}

#[test]
fn a_slanted_wall_lets_the_robot_slide() {
    let mut world = World::empty(5.0, 5.0);
    let wall = Segment::new(Point::new(1.0, 1.0), Point::new(4.0, 4.0));
    world.walls.push(Wall { thickness: 0.0, ..Wall::new(wall.a, wall.b) });
    let scene = Scene::with_robot(world, RobotSpec::s4(), Pose::new(1.6, 2.0, 0.0));
    let (mut robot, truth) = start(&scene, SimOptions::ideal());
    robot.set_speed(Twist::new(0.2, 0.0)).unwrap();
    robot.wait(5.0).unwrap();
    let told = truth.robot(0).unwrap();
    assert!((wall.distance_to(told.pose.position()) - 0.06).abs() < 1e-5, "{told:?}");
    // Along the wall it makes the cosine of its angle of what its wheels roll.
    let (to_the_wall, rolled) = (0.4 - 0.06 * std::f64::consts::SQRT_2, robot.pose().unwrap().x);
    let slid = (rolled - to_the_wall) * math::cos(FRAC_PI_4);
    let along = told.pose.position() - Point::new(1.6 + to_the_wall, 2.0);
    assert!((along.norm() - slid).abs() < 1e-3, "{} {slid}", along.norm());
    assert_eq!(told.contacts, 1, "one touch, however long it slides");
    assert!(!robot.is_stalled().unwrap());
}

#[test]
fn each_touch_counts_once() {
    let (mut robot, truth) = start(&before_a_wall(0.05), SimOptions::ideal());
    for touch in 1..=3 {
        robot.set_speed(Twist::new(0.2, 0.0)).unwrap();
        robot.wait(1.0).unwrap();
        robot.set_speed(Twist::STOP).unwrap();
        robot.wait(2.0).unwrap();
        // Standing at the wall, it pushes once more: the same touch.
        robot.set_speed(Twist::new(0.1, 0.0)).unwrap();
        robot.wait(1.0).unwrap();
        assert_eq!(truth.robot(0).unwrap().contacts, touch);
        robot.straight(-0.1, 0.2).unwrap();
        robot.wait_done().unwrap();
    }
}

/// Lets robot 0 run into robot 1 three times.
#[test]
fn a_robot_that_is_hit_counts_as_often_as_the_one_that_hits() {
    for spec in [RobotSpec::s4(), brick()] {
        let scene =
            with_robots(World::empty(3.0, 3.0), &spec, &[Pose::new(1.0, 1.0, 0.0), Pose::new(1.4, 1.0, PI)]);
        let (mut robot, truth) = start(&scene, SimOptions::ideal());
        for touch in 1..=3 {
            robot.set_speed(Twist::new(0.3, 0.0)).unwrap();
            robot.wait(2.0).unwrap();
            let apart = truth.pose(1).unwrap().x - truth.pose(0).unwrap().x;
            assert!((apart - 0.12).abs() < 1e-5, "{apart}");
            robot.straight(-0.1, 0.2).unwrap();
            robot.wait_done().unwrap();
            assert_eq!((truth.robot(0).unwrap().contacts, truth.robot(1).unwrap().contacts), (touch, touch));
        }
        assert_eq!(truth.pose(1).unwrap(), Pose::new(1.4, 1.0, PI), "nothing gives way");
    }
}

#[test]
fn objects_stop_robots_of_both_footprints() {
    let boxed = ObjectKind::new(
        "crate",
        Shape::Box { length: 0.1, width: 0.3, height: 0.2 },
        roverlab::world::Colour::RED,
    );
    let round = ObjectKind::new("drum", Shape::Cylinder { radius: 0.05, height: 0.2 }, boxed.colour);
    for kind in [boxed, round] {
        for spec in [RobotSpec::s4(), brick()] {
            let mut world = World::empty(3.0, 3.0);
            world.objects.push(Object::new(Arc::new(kind.clone()), Pose::new(2.0, 1.0, 0.0)));
            let (mut robot, truth) =
                start(&Scene::with_robot(world, spec, Pose::new(1.5, 1.0, 0.0)), SimOptions::ideal());
            robot.set_speed(Twist::new(0.3, 0.0)).unwrap();
            robot.wait(3.0).unwrap();
            // Both robots reach 0.06 m ahead, both objects 0.05 m back.
            let x = truth.pose(0).unwrap().x;
            assert!((x - 1.89).abs() < 1e-5, "{}: {x}", kind.name);
            assert_eq!(truth.robot(0).unwrap().contacts, 1);
        }
    }
}

#[test]
fn two_robots_that_drive_at_each_other_meet_in_the_middle() {
    let poses = [Pose::new(1.0, 1.0, 0.0), Pose::new(2.0, 1.0, PI)];
    let mut fleet = Fleet::new(&robots(World::empty(3.0, 3.0), &poses), SimOptions::ideal()).unwrap();
    for robot in 0..2 {
        fleet
            .control(robot, 0.1, |robot| {
                robot.set_speed(Twist::new(0.2, 0.0)).map(|()| ControlFlow::Continue(()))
            })
            .unwrap();
    }
    fleet.run_for(10.0).unwrap();
    let (a, b) = (fleet.truth(0).unwrap(), fleet.truth(1).unwrap());
    assert!((b.pose.x - a.pose.x - 0.12).abs() < 1e-5 && (a.pose.x - 1.44).abs() < 0.003, "{a:?} {b:?}");
    assert_eq!((a.contacts, b.contacts), (1, 1));
}

#[test]
fn a_fast_robot_does_not_jump_over_a_thin_wall() {
    let DriveOf { spec, top_speed } = racer();
    for angle in [0.0, 0.3, 1.2] {
        let mut world = World::walled(12.0, 12.0);
        let wall = Wall::new(Point::new(6.0, 0.0), Point::new(6.0, 12.0));
        world.walls.push(Wall { thickness: 0.0, ..wall });
        let scene = Scene::with_robot(world, spec.clone(), Pose::new(3.0, 6.0, angle));
        let (mut robot, truth) = start(&scene, SimOptions::ideal());
        robot.set_motor(1, 1.0).unwrap();
        robot.set_motor(2, 1.0).unwrap();
        robot.wait(1.0).unwrap();
        assert!(robot.speed().unwrap().linear > 0.9 * top_speed);
        assert!(truth.pose(0).unwrap().x <= 5.94 + 1e-5, "{angle}: {:?}", truth.pose(0));
    }
}

struct DriveOf {
    spec: RobotSpec,
    top_speed: f64,
}

/// A robot of 0.12 m that drives 0.5 m in a tick.
fn racer() -> DriveOf {
    let mut spec = RobotSpec::s4();
    spec.motor.max_acceleration = 1e4;
    spec.motor.time_constant = 0.0;
    let roverlab::world::DriveSpec::Differential { max_wheel_speed, wheel_diameter, .. } = &mut spec.drive
    else {
        panic!("an S4 has two wheels");
    };
    let top_speed = 50.0;
    *max_wheel_speed = 2.0 * top_speed / *wheel_diameter;
    DriveOf { spec, top_speed }
}

#[test]
fn a_robot_that_is_put_into_a_wall_comes_out_when_it_moves() {
    let simulation = Simulation::new(&before_a_wall(0.3), SimOptions::ideal()).unwrap();
    let (mut robot, truth) = (simulation.robot(0).unwrap(), simulation.truth());
    let odometry = robot.pose().unwrap();
    truth.set_pose(0, Pose::new(0.97, 1.0, FRAC_PI_2)).unwrap();
    assert_eq!(robot.pose().unwrap(), odometry, "a hand moves no wheels");
    robot.straight(0.1, 0.2).unwrap();
    robot.wait_done().unwrap();
    let pose = truth.pose(0).unwrap();
    assert!((pose.x - 0.94).abs() < 1e-5 && (pose.y - 1.1).abs() < 2e-3, "{pose:?}");
}

/// An S4 before a movable box of some mass, 0.5 m of floor, and a wall.
fn before_a_box(mass: f64, fixed: bool) -> Scene {
    let mut scene = before_a_wall(0.8);
    let shape = Shape::Box { length: 0.1, width: 0.3, height: 0.1 };
    let kind = ObjectKind { mass, fixed, ..ObjectKind::new("box", shape, roverlab::world::Colour::RED) };
    scene.world.objects.push(Object::new(Arc::new(kind), Pose::new(0.45, 1.5, 0.0)));
    scene
}

#[test]
fn a_robot_pushes_what_is_light_and_loose_until_a_wall_stops_it() {
    for (mass, fixed, pushing, far) in [
        (0.4, false, true, true),
        (0.4, false, false, false),
        (0.4, true, true, false),
        (0.6, false, true, false),
    ] {
        let options = SimOptions { pushing, ..SimOptions::ideal() };
        let (mut robot, truth) = start(&before_a_box(mass, fixed), options);
        robot.set_speed(Twist::new(0.2, 0.0)).unwrap();
        robot.wait(1.5).unwrap();
        let contacts = truth.robot(0).unwrap().contacts;
        robot.wait(6.0).unwrap();
        let place = truth.object(0).unwrap();
        if far {
            // The box is at the wall, the robot at the box, and only that is a contact.
            assert!((place.x - 0.95).abs() < 1e-3 && (place.y - 1.5).abs() < 1e-9, "{place:?}");
            assert!((truth.pose(0).unwrap().x - 0.84).abs() < 1e-3);
            assert_eq!((contacts, truth.robot(0).unwrap().contacts), (0, 1));
        } else {
            assert_eq!(place, Pose::new(0.45, 1.5, 0.0));
            assert_eq!(contacts, 1);
        }
    }
    let (_, truth) = start(&before_a_box(1.0, false), SimOptions::ideal());
    assert!(truth.object(1).is_err());
}
