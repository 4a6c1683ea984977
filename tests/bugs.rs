//! The bug family in the simulator: every algorithm on small worlds that are hard in one way each.

#[allow(unreachable_pub, reason = "the library's own, which is public there with the feature `testing`")]
#[path = "../src/testing/cases.rs"]
mod cases;
#[path = "bugs/worlds.rs"]
mod worlds;

use proptest::prelude::*;
use roverlab::geometry::{Point, Pose};
use roverlab::io::control;
use roverlab::io::sim::{SimOptions, Simulation};
use roverlab::nav::{BugEvent, BugKind, BugOutcome, BugParameters, PathBound, Reachability, WallSide};
use roverlab::random::Stream;
use roverlab::world::generate::{CourseOptions, obstacle_course};
use roverlab::world::{RobotSpec, Scene, World};

/// What came of a run.
#[derive(Debug)]
struct Run {
    outcome: BugOutcome,
    events: Vec<BugEvent>,
    contacts: u32,
    length: f64,
    goal_distance: f64,
}

impl Run {
    fn hits(&self) -> Vec<Point> {
        let hit =
            |event: &BugEvent| if let BugEvent::Hit { point, .. } = event { Some(*point) } else { None };
        self.events.iter().filter_map(hit).collect()
    }

    fn leaves(&self) -> Vec<Point> {
        let leave =
            |event: &BugEvent| if let BugEvent::Leave { point, .. } = event { Some(*point) } else { None };
        self.events.iter().filter_map(leave).collect()
    }
}

fn parameters(noise: f64) -> BugParameters {
    BugParameters { match_scans: noise > 0.0, ..BugParameters::default() }
}

fn run_with(kind: BugKind, world: &World, ends: (Pose, Point), noise: f64, parameters: BugParameters) -> Run {
    let (start, goal) = ends;
    let scene = Scene::with_robot(world.clone(), RobotSpec::s4(), start);
    let simulation = Simulation::new(&scene, SimOptions::with_noise(noise, 5)).unwrap();
    let (truth, mut robot) = (simulation.truth(), simulation.robot(0).unwrap());
    let mut bug = kind.with(start.to_local(goal), parameters).unwrap();
    let mut events = Vec::new();
    let outcome =
        control::run(&mut robot, bug.as_mut(), 1500.0, |_, bug, _| events.extend(bug.take_events())).unwrap();
    let truth = truth.robot(0).unwrap();
    let goal_distance = truth.pose.distance_to(goal);
    Run { outcome, events, contacts: truth.contacts, length: truth.path_length, goal_distance }
}

fn run(kind: BugKind, (world, start, goal): &(World, Pose, Point), noise: f64) -> Run {
    run_with(kind, world, (*start, *goal), noise, parameters(noise))
}

/// Every algorithm reaches the goal of a world, at some level of noise.
fn assert_reached(scene: &(World, Pose, Point), noise: f64) {
    let tolerance = if noise == 0.0 { 0.05 } else { 0.15 };
    for kind in BugKind::ALL {
        let run = run(kind, scene, noise);
        assert_eq!((run.outcome, run.contacts), (BugOutcome::Reached, 0), "{kind}: {run:?}");
        assert!(run.goal_distance < tolerance, "{kind}: {run:?}");
        assert_eq!(run.hits().len(), run.leaves().len(), "{kind}: {run:?}");
    }
}

/// Every algorithm finds that there is no way.
fn assert_unreachable(scene: &(World, Pose, Point), noise: f64) {
    for kind in BugKind::ALL {
        let run = run(kind, scene, noise);
        assert_eq!((run.outcome, run.contacts), (BugOutcome::Unreachable, 0), "{kind}: {run:?}");
    }
}

#[test]
fn a_goal_in_sight_is_reached_straight() {
    for kind in BugKind::ALL {
        let run = run(kind, &worlds::empty(), 0.0);
        assert_eq!((run.outcome, run.contacts, run.hits().len()), (BugOutcome::Reached, 0, 0), "{kind}");
        assert!(run.length < 2.45, "{kind}: {}", run.length);
    }
}

#[test]
fn a_block_is_passed() {
    assert_reached(&worlds::block(), 0.0);
}

#[test]
fn a_dead_end_is_left_under_noise() {
    assert_reached(&worlds::dead_end(), 1.0);
}

#[test]
fn a_thin_wall_has_two_sides() {
    assert_reached(&worlds::thin_wall(), 0.0);
}

#[test]
fn a_spiral_is_left() {
    assert_reached(&worlds::spiral(), 0.0);
}

#[test]
fn a_goal_in_a_ring_is_unreachable_under_noise() {
    assert_unreachable(&worlds::ring(), 1.0);
}

#[test]
fn a_start_in_a_room_without_a_door_is_too() {
    assert_unreachable(&worlds::locked_in(), 0.0);
}

/// The corner that points at the goal is acute, so that the robot keeps farther from it than from a wall.
#[test]
fn an_acute_corner_is_not_a_way() {
    assert_unreachable(&worlds::star(), 0.0);
}

#[test]
fn bug1_goes_once_round_and_back_the_shorter_way() {
    let scene = worlds::block();
    for side in [WallSide::Left, WallSide::Right] {
        let parameters = BugParameters { side: Some(side), ..parameters(0.0) };
        let run = run_with(BugKind::Bug1, &scene.0, (scene.1, scene.2), 0.0, parameters);
        assert_eq!(run.outcome, BugOutcome::Reached);
        // The block is 0.6 m by 1 m, and its boundary is followed at 0.1 m.
        let round = 3.2 + std::f64::consts::TAU * 0.099;
        let straight = (scene.2 - scene.1.position()).norm();
        assert!(run.length > round + 0.5, "{side:?}: {}", run.length);
        assert!(run.length < straight + 1.5 * round, "{side:?}: {}", run.length);
        assert_eq!(run.hits().len(), 1);
    }
}

#[test]
fn bug2_leaves_on_the_line() {
    let (world, start, goal) = worlds::block();
    let run = run(BugKind::Bug2, &(world, start, goal), 0.0);
    let line = start.to_local(goal).coords.normalize();
    for point in run.leaves() {
        let offset = roverlab::geometry::cross(line, point.coords);
        assert!(offset.abs() < 0.015, "{offset} in {run:?}");
    }
    assert!(run.length < 1.02 * ((goal - start.position()).norm() + 3.2 + 0.63), "{run:?}");
}

#[test]
fn leaves_of_class1_are_nearer_than_all_hits_before() {
    let (_, start, goal) = worlds::dead_end();
    let run = run(BugKind::Class1, &worlds::dead_end(), 0.0);
    let goal = start.to_local(goal);
    for (hit, leave) in run.hits().iter().zip(run.leaves()) {
        assert!((leave - goal).norm() < (hit - goal).norm(), "{run:?}");
    }
}

#[test]
fn names_are_read_and_others_refused() {
    for kind in BugKind::ALL {
        assert_eq!(kind.name().to_lowercase().parse(), Ok(kind));
        let bug = kind.with(Point::new(1.0, 0.0), BugParameters::default()).unwrap();
        assert_eq!(bug.name(), kind.to_string());
    }
    let error = "bug3".parse::<BugKind>().unwrap_err().to_string();
    assert!(error.starts_with("unknown bug `bug3`; expected one of Bug1, Bug2"), "{error}");
}

#[test]
fn bad_goals_and_parameters_are_named() {
    for kind in BugKind::ALL {
        let error = kind.with(Point::new(f64::NAN, 0.0), BugParameters::default()).unwrap_err();
        assert!(error.to_string().starts_with("goal is"), "{error}");
        let parameters = BugParameters { step: 0.0, ..BugParameters::default() };
        assert!(
            kind.with(Point::new(1.0, 0.0), parameters).unwrap_err().to_string().starts_with("STEP is 0")
        );
    }
}

#[test]
fn bounds_are_those_of_the_papers() {
    let guarantee =
        |kind: BugKind| kind.with(Point::new(1.0, 0.0), BugParameters::default()).unwrap().guarantee();
    assert_eq!(guarantee(BugKind::Bug1).path_bound, PathBound::Perimeters);
    assert_eq!(guarantee(BugKind::LeaveBug).path_bound, PathBound::TwicePerimeters);
    assert_eq!(guarantee(BugKind::Bug2).path_bound, PathBound::Crossings);
    assert!(BugKind::ALL.into_iter().all(|kind| guarantee(kind).complete));
}

proptest! {
    #![proptest_config(cases::cases(3))]

    #[test]
    fn verdicts_are_the_truth(seed in 0u64..1_000_000) {
        let options = CourseOptions { size: (2.8, 3.5), obstacles: (2, 4), ..CourseOptions::default() };
        let course = obstacle_course(&mut Stream::new(seed), &options).unwrap();
        let truth = Reachability::new(&course.world, 0.06, 0.01).unwrap();
        let way = truth.connected(course.start.position(), course.goal);
        let expected = if way { BugOutcome::Reached } else { BugOutcome::Unreachable };
        for kind in BugKind::ALL {
            let run = run(kind, &(course.world.clone(), course.start, course.goal), 0.0);
            prop_assert_eq!((run.outcome, run.contacts), (expected, 0), "{}, seed {}", kind, seed);
        }
    }
}
