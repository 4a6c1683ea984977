use std::f64::consts::PI;

use proptest::prelude::*;

use super::*;
use crate::geometry::{Aabb, Point, normalize_angle};
use crate::maze::generate::{braided, competition, mazes, partly_known};
use crate::maze::{Cell, Direction, Maze, Preference, Scale, Unknown, WallState, shortest_route};

const SCALE: Scale = Scale::MICROMOUSE;
const LIMITS: RunLimits = RunLimits::MICROMOUSE;

fn planner() -> FastPlanner {
    FastPlanner::new(SCALE, LIMITS).unwrap()
}

fn plan(maze: &Maze) -> Option<FastPlan> {
    planner().plan(maze, Unknown::Closed)
}

/// Walls and posts around a cell, as boxes.
fn solids(maze: &Maze, cell: Cell) -> Vec<Aabb> {
    let mut boxes = Vec::new();
    let half = 0.5 * SCALE.wall;
    for x in cell.x.saturating_sub(1)..=cell.x + 1 {
        for y in cell.y.saturating_sub(1)..=cell.y + 1 {
            let cell = Cell::new(x, y);
            if !maze.contains(cell) {
                continue;
            }
            let (x, y) = (f64::from(x) * SCALE.cell, f64::from(y) * SCALE.cell);
            let far = SCALE.cell;
            for (side, a, b) in [
                (Direction::North, (0.0, far), (far, far)),
                (Direction::East, (far, 0.0), (far, far)),
                (Direction::South, (0.0, 0.0), (far, 0.0)),
                (Direction::West, (0.0, 0.0), (0.0, far)),
            ] {
                if maze.wall(cell, side) == WallState::Present {
                    let wall = Aabb::new(Point::new(x + a.0, y + a.1), Point::new(x + b.0, y + b.1));
                    boxes.push(wall.inflated(half));
                }
            }
            for (dx, dy) in [(0.0, 0.0), (far, 0.0), (0.0, far), (far, far)] {
                let post = Point::new(x + dx, y + dy);
                boxes.push(Aabb::new(post, post).inflated(half));
            }
        }
    }
    boxes
}

fn distance(solid: &Aabb, point: Point) -> f64 {
    let out = |low: f64, high: f64, value: f64| (low - value).max(value - high).max(0.0);
    crate::geometry::math::hypot(
        out(solid.min.x, solid.max.x, point.x),
        out(solid.min.y, solid.max.y, point.y),
    )
}

/// Checks that a run is continuous, clear of the walls, along its route, and as long as planned.
fn assert_drivable(maze: &Maze, plan: &FastPlan) {
    let trajectory = Trajectory::new(plan, SCALE, LIMITS).unwrap();
    assert!((trajectory.duration() - plan.time).abs() < 1e-6, "{} {}", trajectory.duration(), plan.time);
    let end = SCALE.centre(plan.route.end());
    assert!((trajectory.end().position() - end).norm() < 1e-6);
    let step = 2e-3;
    let mut route = plan.route.cells().peekable();
    let mut before = trajectory.at(-1.0);
    assert_eq!(before.twist, crate::geometry::Twist::STOP);
    for i in 0..=(trajectory.duration() / step) as usize + 1 {
        let now = trajectory.at(i as f64 * step);
        let moved = (now.pose.position() - before.pose.position()).norm();
        assert!(moved <= LIMITS.speed * step * 1.001, "a jump of {moved}");
        let turned = normalize_angle(now.pose.heading - before.pose.heading).abs();
        assert!(turned <= 14.0 * step, "a jump of {turned} rad");
        assert!((now.twist.linear - before.twist.linear).abs() <= LIMITS.acceleration * step * 1.01 + 1e-9);
        assert!(
            (now.twist.angular - before.twist.angular).abs()
                <= LIMITS.angular_acceleration * step * 1.01 + 1e-9
        );
        let cell = SCALE.cell_of(maze, now.pose.position()).unwrap();
        while route.peek().is_some_and(|&next| next != cell) {
            route.next();
        }
        assert!(route.peek().is_some(), "cell {cell} is off the route");
        let clearance =
            solids(maze, cell).iter().map(|solid| distance(solid, now.pose.position())).fold(1.0, f64::min);
        assert!(clearance > 0.24 * SCALE.cell, "{clearance} at {:?}", now.pose);
        before = now;
    }
}

/// Time of a route with a stop at every turn (s).
fn time_with_stops(maze: &Maze) -> Option<f64> {
    let repertoire = super::limits::Repertoire::new(SCALE, LIMITS).unwrap();
    let route = shortest_route(maze, Unknown::Closed, Preference::Turns)?;
    let mut time = 0.0;
    let mut heading = route.heading();
    for run in route.moves().chunk_by(|a, b| a == b) {
        time += repertoire.pivot_time(normalize_angle(run[0].heading() - heading.heading()));
        time += repertoire.straight_time(None, None, run.len() as f64 * SCALE.cell, false).unwrap();
        heading = run[0];
    }
    Some(time)
}

/// The maze, mirrored along the diagonal.
fn mirrored(maze: &Maze) -> Maze {
    let mirror = |d: Direction| match d {
        Direction::North => Direction::East,
        Direction::East => Direction::North,
        Direction::South => Direction::West,
        Direction::West => Direction::South,
    };
    let mut other = Maze::open(maze.height(), maze.width()).unwrap();
    let swap = |cell: Cell| Cell::new(cell.y, cell.x);
    for cell in maze.cells() {
        for side in Direction::ALL {
            other.set_wall(swap(cell), mirror(side), maze.wall(cell, side));
        }
    }
    other.set_start(swap(maze.start()), mirror(maze.heading()));
    other.set_goals(maze.goals().map(swap));
    other
}

proptest! {
    #![proptest_config(crate::testing::cases(256))]
    #[test]
    fn plans_are_drivable_and_beat_stopping_at_turns(maze in mazes(12)) {
        let plan = plan(&maze);
        let stopping = time_with_stops(&maze);
        prop_assert_eq!(plan.is_some(), stopping.is_some());
        if let (Some(plan), Some(stopping)) = (plan, stopping) {
            prop_assert!(plan.time <= stopping + 1e-3, "{} > {}", plan.time, stopping);
            assert_drivable(&maze, &plan);
        }
    }

    #[test]
    fn bounds_lead_the_search_and_change_no_time(maze in prop_oneof![mazes(14), partly_known(14)]) {
        for mut led in [planner(), FastPlanner::new(Scale::DOUBLED, RunLimits::EYEBOT).unwrap()] {
            let mut unled = led.clone().unled();
            for unknown in [Unknown::Open, Unknown::Closed] {
                // Every hop is rounded to a microsecond.
                match (led.plan(&maze, unknown), unled.plan(&maze, unknown)) {
                    (Some(a), Some(b)) => prop_assert!((a.time - b.time).abs() < 2e-4, "{a:?} {b:?}"),
                    (a, b) => prop_assert_eq!(a.is_some(), b.is_some()),
                }
            }
        }
    }

    #[test]
    fn a_mirrored_maze_takes_the_same_time(maze in mazes(10)) {
        match (plan(&maze), plan(&mirrored(&maze))) {
            (Some(a), Some(b)) => prop_assert!((a.time - b.time).abs() < 1e-4),
            (a, b) => prop_assert_eq!(a.is_some(), b.is_some()),
        }
    }

    #[test]
    fn fewer_walls_never_cost_time(maze in partly_known(10)) {
        let mut planner = planner();
        let (open, closed) = (planner.plan(&maze, Unknown::Open), planner.plan(&maze, Unknown::Closed));
        if let Some(closed) = closed {
            prop_assert!(open.unwrap().time <= closed.time + 1e-4);
        }
    }

    #[test]
    fn a_plan_does_not_depend_on_the_one_before(a in mazes(8), b in mazes(12)) {
        let mut planner = planner();
        for maze in [&a, &b, &a] {
            prop_assert_eq!(planner.plan(maze, Unknown::Closed), plan(maze));
        }
    }
}

#[test]
fn a_staircase_is_driven_diagonally() {
    let mut maze = Maze::filled(10, 10, WallState::Present).unwrap();
    let (mut cell, goal) = (Cell::default(), Cell::new(8, 9));
    maze.set_goals([goal]);
    for i in 0..17 {
        let side = if i % 2 == 0 { Direction::North } else { Direction::East };
        maze.set_wall(cell, side, WallState::Absent);
        cell = maze.neighbour(cell, side).unwrap();
    }
    assert_eq!(cell, goal);
    let plan = plan(&maze).unwrap();
    assert!(plan.pieces.iter().any(|piece| matches!(piece, Piece::Straight { diagonal: true, .. })));
    assert!(plan.pieces.iter().filter(|piece| matches!(piece, Piece::Turn { .. })).count() <= 3, "{plan:?}");
    assert_drivable(&maze, &plan);
}

#[test]
fn the_start_may_face_a_wall() {
    let mut maze = Maze::open(1, 4).unwrap();
    maze.set_start(Cell::new(0, 3), Direction::North);
    maze.set_goals([Cell::new(0, 0)]);
    let plan = plan(&maze).unwrap();
    assert_eq!(plan.pieces.len(), 2);
    assert!(matches!(plan.pieces[0], Piece::Pivot { angle } if (angle.abs() - PI).abs() < 1e-9));
    let mut there = Maze::open(2, 2).unwrap();
    there.set_goals([Cell::default()]);
    let plan = planner().plan(&there, Unknown::Closed).unwrap();
    assert_eq!((plan.time, plan.pieces.len()), (0.0, 0));
}

#[test]
fn limits_are_checked() {
    let wrong = RunLimits { acceleration: -1.0, ..LIMITS };
    let error = FastPlanner::new(SCALE, wrong).unwrap_err();
    assert_eq!(error.to_string(), "acceleration is -1; expected 0.001 to 10000");
    assert!(FastPlanner::new(Scale { cell: f64::NAN, ..SCALE }, LIMITS).is_err());
}

#[test]
fn large_mazes_are_planned() {
    for maze in [competition(32, 1).unwrap(), braided(60, 60, 0.1, 3).unwrap(), Maze::open(48, 40).unwrap()] {
        let plan = plan(&maze).unwrap();
        assert_drivable(&maze, &plan);
        let unled = planner().unled().plan(&maze, Unknown::Closed).unwrap();
        assert!((plan.time - unled.time).abs() < 2e-4, "{} {}", plan.time, unled.time);
    }
    let eyebot = FastPlanner::new(Scale::DOUBLED, RunLimits::EYEBOT)
        .unwrap()
        .plan(&competition(16, 2).unwrap(), Unknown::Closed);
    assert!(eyebot.unwrap().time > 5.0);
}
