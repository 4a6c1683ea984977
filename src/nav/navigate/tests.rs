use std::ops::ControlFlow;

use super::*;
use crate::geometry::{Aabb, Point, Pose, Vector, direction};
use crate::io::control::{Behaviour, LidarObservation};
use crate::world::{Wall, World};

/// Two rooms of 1 m with a door of `door` metres in the wall between them.
fn rooms(door: f64) -> World {
    let mut world = World::walled(2.0, 1.0);
    world.walls.push(Wall::new(Point::new(1.0, 0.0), Point::new(1.0, 0.5 - 0.5 * door)));
    world.walls.push(Wall::new(Point::new(1.0, 0.5 + 0.5 * door), Point::new(1.0, 1.0)));
    world
}

fn navigator(door: f64) -> Navigator {
    let (start, goal) = (Pose::new(0.3, 0.3, 0.0), Point::new(1.7, 0.7));
    Navigator::new(&rooms(door), start, goal, NavigatorParameters::default()).unwrap()
}

fn clearance_of(navigator: &mut Navigator) -> f64 {
    let planned = navigator.take_events().into_iter().find_map(|event| match event {
        NavigatorEvent::Planned { clearance, .. } => Some(clearance),
        _ => None,
    });
    planned.unwrap()
}

#[test]
fn narrow_doors_are_passed_with_less_clearance_and_closed_ones_told_at_once() {
    assert!((clearance_of(&mut navigator(0.5)) - 0.039).abs() < 1e-9);
    assert!((clearance_of(&mut navigator(0.18)) - 0.012).abs() < 1e-9);
    let mut closed = navigator(0.1);
    assert_eq!(closed.phase(), NavigatorPhase::Ended(NavigatorOutcome::Unreachable));
    assert_eq!(closed.take_events(), [NavigatorEvent::End(NavigatorOutcome::Unreachable)]);
    let decision = closed.step(0.0, &LidarObservation::default()).unwrap();
    assert_eq!(decision, ControlFlow::Break(NavigatorOutcome::Unreachable));
}

/// Cells of 10 mm close a corridor that lies aslant to them and leaves 8 mm on either side.
#[test]
fn a_narrow_corridor_aslant_to_the_cells_is_a_way() {
    for (width, outcome) in [(0.170, None), (0.146, Some(NavigatorOutcome::Unreachable))] {
        let (mut world, along) = (World::walled(3.0, 2.0), direction(-0.35));
        let across = Vector::new(-along.y, along.x);
        let middle = Point::new(1.5, 1.0);
        let corner = |x: f64, y: f64| middle + along * x + across * y;
        let half = 0.5 * width;
        // A cell of 0.6 m, and the corridor into it.
        let around = [(-0.3, half), (-0.3, 0.3), (0.3, 0.3), (0.3, -0.3), (-0.3, -0.3), (-0.3, -half)];
        let around = [&[(-0.6, half)][..], &around, &[(-0.6, -half)]].concat();
        let ends = around.windows(2).map(|pair| (corner(pair[0].0, pair[0].1), corner(pair[1].0, pair[1].1)));
        world.walls.extend(ends.map(|(from, to)| Wall::new(from, to)));
        let start = Pose::new(0.3, 0.3, 0.0);
        let navigator = Navigator::new(&world, start, middle, NavigatorParameters::default()).unwrap();
        assert_eq!(navigator.phase(), outcome.map_or(NavigatorPhase::Looking, NavigatorPhase::Ended));
    }
}

/// The robot's centre fits no nearer to a wall than 72 mm; 25 mm off the goal are near enough.
#[test]
fn a_goal_too_near_to_a_wall_counts_within_its_tolerance() {
    for (away, ends) in [(0.070, false), (0.055, false), (0.048, false), (0.046, true), (0.010, true)] {
        let (start, goal) = (Pose::new(0.3, 0.5, 0.0), Point::new(0.5, 1.0 - 0.005 - away));
        let navigator = Navigator::new(&rooms(0.5), start, goal, NavigatorParameters::default()).unwrap();
        let ended = navigator.phase() == NavigatorPhase::Ended(NavigatorOutcome::NoRoom);
        assert_eq!(ended, ends, "{away}");
        let place = navigator.path().last();
        assert!(ends || place.is_some_and(|place| (place - goal).norm() <= 0.025 && place.y <= 0.9231));
    }
}

/// The nearest place with room may be where the robot cannot get; another one within the tolerance is as
/// good.
#[test]
fn of_places_on_both_sides_of_a_wall_one_is_in_reach() {
    let mut world = World::walled(2.0, 1.0);
    world.walls.push(Wall::new(Point::new(1.0, 0.0), Point::new(1.0, 1.0)));
    let parameters = NavigatorParameters { goal_tolerance: 0.15, ..NavigatorParameters::default() };
    for x in [0.3, 1.7] {
        let (start, goal) = (Pose::new(x, 0.3, 0.0), Point::new(1.02, 0.5));
        let navigator = Navigator::new(&world, start, goal, parameters).unwrap();
        assert_eq!(navigator.phase(), NavigatorPhase::Looking);
        assert!(navigator.path().last().is_some_and(|place| (place.x - 1.0) * (x - 1.0) > 0.0), "{x}");
    }
}

#[test]
fn goals_in_walls_or_outside_are_unreachable() {
    for goal in [Point::new(1.0, 0.1), Point::new(5.0, 5.0), Point::new(-3.0, 0.5)] {
        let start = Pose::new(0.3, 0.3, 0.0);
        let navigator = Navigator::new(&rooms(0.5), start, goal, NavigatorParameters::default()).unwrap();
        assert_eq!(navigator.phase(), NavigatorPhase::Ended(NavigatorOutcome::Unreachable), "{goal:?}");
    }
}

#[test]
fn starts_in_walls_or_outside_lead_nowhere() {
    for start in [Pose::new(1.0, 0.1, 0.0), Pose::new(5.0, 5.0, 0.0), Pose::new(-3.0, 0.5, 0.0)] {
        let goal = Point::new(1.7, 0.7);
        let navigator = Navigator::new(&rooms(0.5), start, goal, NavigatorParameters::default()).unwrap();
        assert_eq!(navigator.phase(), NavigatorPhase::Ended(NavigatorOutcome::Unreachable), "{start:?}");
    }
}

/// A wall far from the rooms makes the world 100 times as large, but not what the robot can reach.
#[test]
fn a_way_is_found_whatever_lies_far_off() {
    for far in [Point::new(-30.0, 50.0), Point::new(80.0, 60.0)] {
        let mut world = rooms(0.165);
        world.walls.push(Wall::new(far, far + Vector::new(0.0, 1.0)));
        let (start, goal) = (Pose::new(0.3, 0.3, 0.0), Point::new(1.7, 0.7));
        let mut navigator = Navigator::new(&world, start, goal, NavigatorParameters::default()).unwrap();
        assert_eq!(navigator.phase(), NavigatorPhase::Looking, "{far}");
        assert!((clearance_of(&mut navigator) - 0.012).abs() < 1e-9);
    }
}

/// Or where most walls are: a room with more of them, 150 m away, is the world's site.
#[test]
fn a_way_is_found_in_the_room_with_fewer_walls() {
    let mut world = rooms(0.165);
    let there = World::walled(3.0, 3.0).walls.into_iter().cycle().take(4 * world.walls.len());
    world.walls.extend(there.map(|wall| {
        let [a, b] = [wall.line.a, wall.line.b].map(|end| end + Vector::new(150.0, 0.0));
        Wall::new(a, b)
    }));
    let (start, goal) = (Pose::new(0.3, 0.3, 0.0), Point::new(1.7, 0.7));
    assert!(!world.site().contains(start.position()), "{:?}", world.site());
    let mut navigator = Navigator::new(&world, start, goal, NavigatorParameters::default()).unwrap();
    assert_eq!(navigator.phase(), NavigatorPhase::Looking);
    assert!((clearance_of(&mut navigator) - 0.012).abs() < 1e-9);
}

/// Also a floor of 1000 km, over which cells are larger than the rooms.
#[test]
fn a_way_is_found_on_any_floor() {
    let (start, goal) = (Pose::new(0.3, 0.3, 0.0), Point::new(1.7, 0.7));
    for (x, y) in [(1e3, 1e3), (1e6, 2.0)] {
        let mut world = rooms(0.165);
        world.floor = Aabb::new(Point::origin(), Point::new(x, y));
        let mut navigator = Navigator::new(&world, start, goal, NavigatorParameters::default()).unwrap();
        assert_eq!(navigator.phase(), NavigatorPhase::Looking, "{x} {y}");
        assert!((clearance_of(&mut navigator) - 0.012).abs() < 1e-9);
        // Without walls around the robot, a part of the floor is planned in.
        world.walls = vec![Wall::new(Point::new(0.5, 0.0), Point::new(0.5, 1.0))];
        let mut navigator = Navigator::new(&world, start, goal, NavigatorParameters::default()).unwrap();
        assert_eq!(navigator.phase(), NavigatorPhase::Looking, "{x} {y}");
        assert!((clearance_of(&mut navigator) - 0.039).abs() < 1e-9);
        assert!(navigator.path_length().is_some_and(|length| length < 2.5));
    }
}

/// Cells that cover start and goal may be too large for the robot.
#[test]
fn a_goal_too_far_off_for_the_cells_is_refused() {
    let mut world = World::walled(1e3, 1e3);
    world.floor = Aabb::new(Point::origin(), Point::new(1e3, 1e3));
    let to = |x: f64| {
        Navigator::new(&world, Pose::new(5.0, 5.0, 0.0), Point::new(x, 5.0), NavigatorParameters::default())
    };
    assert_eq!(to(100.0).unwrap().phase(), NavigatorPhase::Looking);
    let error = to(900.0).unwrap_err().to_string();
    assert!(error.contains("may close a way to the goal; expected one for cells of 10 mm"), "{error}");
}

/// On a floor of 2 km, cells are 1 m.
#[test]
fn a_goal_shut_in_by_walls_is_unreachable_on_any_floor() {
    let navigator = |door: f64, start: Point| {
        let mut world = rooms(door);
        world.walls.extend(World::walled(2.0, 1.0).walls);
        world.floor = Aabb::new(Point::new(-10.0, -10.0), Point::new(2e3, 2e3));
        let start = Pose::new(start.x, start.y, 0.0);
        Navigator::new(&world, start, Point::new(1.7, 0.7), NavigatorParameters::default()).unwrap()
    };
    let unreachable = NavigatorPhase::Ended(NavigatorOutcome::Unreachable);
    for outside in [Point::new(-0.5, 0.5), Point::new(1900.0, 5.0), Point::new(5.0, 1900.0)] {
        assert_eq!(navigator(0.5, outside).phase(), unreachable, "{outside}");
    }
    assert_eq!(navigator(0.0, Point::new(0.3, 0.3)).phase(), unreachable);
    assert_eq!(navigator(0.5, Point::new(0.3, 0.3)).phase(), NavigatorPhase::Looking);
}

/// Cells of 50 mm may close a door of 165 mm: nobody can say that no way exists.
#[test]
fn what_is_too_large_for_its_doors_is_refused() {
    let hall = |door: f64| {
        let mut world = World::walled(100.0, 100.0);
        world.walls.push(Wall::new(Point::new(1.0, 0.0), Point::new(1.0, 50.0 - 0.5 * door)));
        world.walls.push(Wall::new(Point::new(1.0, 50.0 + 0.5 * door), Point::new(1.0, 100.0)));
        let (start, goal) = (Pose::new(0.5, 0.5, 0.0), Point::new(9.0, 9.0));
        Navigator::new(&world, start, goal, NavigatorParameters::default())
    };
    let error = hall(0.165).unwrap_err().to_string();
    assert!(error.contains("cells of 50 mm may close a way"), "{error}");
    assert_eq!(hall(0.5).unwrap().phase(), NavigatorPhase::Looking);
    assert_eq!(hall(0.0).unwrap().phase(), NavigatorPhase::Ended(NavigatorOutcome::Unreachable));
}

#[test]
fn nonsense_is_refused() {
    let good = NavigatorParameters::default();
    let new =
        |goal: Point, parameters| Navigator::new(&rooms(0.5), Pose::new(0.3, 0.3, 0.0), goal, parameters);
    assert!(new(Point::new(f64::NAN, 0.0), good).is_err());
    for bad in [
        NavigatorParameters { clearance: 0.001, ..good },
        NavigatorParameters { clearance: f64::NAN, ..good },
        NavigatorParameters { resolution: 0.0, ..good },
        NavigatorParameters { period: f64::INFINITY, ..good },
    ] {
        assert!(new(Point::new(1.0, 0.5), bad).is_err());
    }
}

/// The path keeps its clearance everywhere, not only at its points.
#[test]
fn what_the_path_sweeps_is_free() {
    let mut navigator = navigator(0.5);
    let clearance = clearance_of(&mut navigator);
    let world = rooms(0.5);
    for pair in navigator.path().windows(2) {
        for step in 0..20 {
            let point = pair[0] + (pair[1] - pair[0]) * (f64::from(step) / 20.0);
            for wall in &world.walls {
                let gap = wall.line.distance_to(point) - 0.5 * wall.thickness;
                assert!(gap >= 0.060 + clearance - 1e-9, "{gap} at {point:?}");
            }
        }
    }
}
