use proptest::prelude::*;

use super::lines::{between_walls, entered, squeezed};
use super::{
    Movement, PlanWith, collision_free, complete, grid_queries, mazes, optimal, triangle_inequality,
};
use crate::geometry::Point;
use crate::nav::grid::{
    AnyAngle, GridPath, GridPlanner, GridSearch, JumpPointSearch, PlanError, PreparedJumps, Quadtree,
    QuadtreePlanner, SearchStatistics,
};
use crate::random::Stream;
use crate::world::{BitGrid, GridCell};

proptest! {
    #![proptest_config(crate::testing::cases(100))]

    #[test]
    fn the_librarys_planners_pass((grid, [a, b, c]) in grid_queries(1..40, 1..40)) {
        let octile: [Box<dyn GridPlanner>; 3] =
            [Box::new(GridSearch::astar(&grid)), Box::new(JumpPointSearch::new(&grid)), Box::new(PreparedJumps::new(&grid))];
        for mut planner in octile {
            optimal(&mut planner, &grid, Movement::Octile, a, b)?;
            collision_free(&mut planner, &grid, a, b)?;
            complete(&mut planner, &grid, a, b)?;
            triangle_inequality(&mut planner, a, c, b)?;
        }
        let mut any = AnyAngle::new(&grid);
        collision_free(&mut any, &grid, a, b)?;
        complete(&mut any, &grid, a, b)?;
        triangle_inequality(&mut any, a, c, b)?;
        let mut quadtree = QuadtreePlanner::new(&Quadtree::new(&grid));
        collision_free(&mut quadtree, &grid, a, b)?;
        complete(&mut quadtree, &grid, a, b)?;
    }

    #[test]
    fn mazes_know_their_way(maze in mazes(1..12, 1..12)) {
        let path = GridSearch::astar(&maze.grid).plan(maze.start, maze.goal).unwrap();
        prop_assert_eq!(path.cost, (maze.way.len() - 1) as f64);
        let cells: Vec<GridCell> = path.points.iter().filter_map(|&point| GridCell::at(point)).collect();
        prop_assert_eq!(cells, maze.way);
        // Places, and passages between all of them but one.
        let places = maze.grid.width().div_ceil(2) * maze.grid.height().div_ceil(2);
        prop_assert_eq!(maze.grid.count_free(), 2 * places - 1);
    }
}

/// Worlds take longer to draw, so only a few.
#[test]
fn worlds_are_drawn() {
    use proptest::strategy::ValueTree;
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let course = super::worlds().new_tree(&mut runner).unwrap().current();
    assert!(!course.world.walls.is_empty() && course.goal != course.start.position());
}

/// Compares with the planner's own integer line-of-sight test, for lines between centres and corners of
/// cells.
#[test]
fn lines_are_free_as_the_planners_see_them() {
    let mut stream = Stream::new(7);
    let (mut free, mut squeezes, mut walled) = (0, 0, 0);
    for _ in 0..20_000 {
        let (width, height) = (1 + stream.below(6), 1 + stream.below(6));
        let share = stream.between(0.3, 0.95);
        let grid = BitGrid::from_fn(width, height, |_, _| stream.chance(share)).unwrap();
        let mut point = || {
            if stream.chance(0.5) {
                GridCell::new(stream.below(width), stream.below(height)).centre()
            } else {
                Point::new(stream.below(width + 1) as f64, stream.below(height + 1) as f64)
            }
        };
        let (a, b) = (point(), point());
        if a == b || entered(&grid, a, b).is_some() {
            continue;
        }
        let (walls, squeeze) = (between_walls(&grid, a, b), squeezed(&grid, &[a, b]).is_some());
        assert_eq!(AnyAngle::new(&grid).points_in_sight(a, b), !walls && !squeeze, "{a} to {b} on {grid:?}");
        free += u32::from(!walls && !squeeze);
        squeezes += u32::from(squeeze);
        walled += u32::from(walls);
    }
    assert!(free > 1000 && squeezes > 100 && walled > 100, "{free} {squeezes} {walled}");
}

#[test]
fn squeezing_between_blocked_cells_is_caught() {
    let straight = |points: Vec<Point>| {
        let length = points.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
        PlanWith(move |_, _| {
            Ok(GridPath { points: points.clone(), cost: length, statistics: SearchStatistics::default() })
        })
    };
    let crosswise = BitGrid::from_text("..#\n.#.\n...").unwrap();
    let (a, b) = (GridCell::new(1, 0), GridCell::new(2, 1));
    let through = vec![a.centre(), b.centre()];
    let by_the_corner = vec![a.centre(), Point::new(2.0, 1.0), b.centre()];
    for points in [through, by_the_corner] {
        let caught = collision_free(&mut straight(points), &crosswise, a, b).unwrap_err();
        assert!(caught.what.contains("squeezes"), "{caught}");
    }
    // Touching that corner and returning is allowed.
    let touching = vec![a.centre(), Point::new(2.0, 1.0), a.centre()];
    collision_free(&mut straight(touching), &crosswise, a, a).unwrap();

    let block = BitGrid::from_text("....\n.##.\n.##.\n....").unwrap();
    let (a, b) = (GridCell::new(1, 0), GridCell::new(2, 3));
    let inside = vec![a.centre(), Point::new(2.0, 1.0), Point::new(2.0, 3.0), b.centre()];
    let caught = collision_free(&mut straight(inside), &block, a, b).unwrap_err();
    assert!(caught.what.contains("between blocked cells"), "{caught}");
    // Along one of them is allowed.
    let (a, b) = (GridCell::new(0, 0), GridCell::new(0, 3));
    let beside = vec![a.centre(), Point::new(1.0, 1.0), Point::new(1.0, 3.0), b.centre()];
    collision_free(&mut straight(beside), &block, a, b).unwrap();
}

#[test]
fn a_cost_that_is_no_number_is_caught() {
    let grid = BitGrid::from_text("...").unwrap();
    let [a, b, c] = [0, 1, 2].map(|column| GridCell::new(column, 0));
    let mut planner = PlanWith(|start: GridCell, goal: GridCell| {
        let points = vec![start.centre(), goal.centre()];
        Ok(GridPath { points, cost: f64::NAN, statistics: SearchStatistics::default() })
    });
    assert!(optimal(&mut planner, &grid, Movement::Octile, a, c).is_err());
    assert!(optimal(&mut planner, &grid, Movement::AnyAngle, a, c).is_err());
    assert!(collision_free(&mut planner, &grid, a, c).is_err());
    assert!(triangle_inequality(&mut planner, a, b, c).is_err());
}

#[test]
fn wrong_planners_are_caught() {
    let grid = BitGrid::from_text("....\n.##.\n....").unwrap();
    let (a, b, c) = (GridCell::new(0, 1), GridCell::new(3, 1), GridCell::new(0, 0));
    let path = |points: Vec<crate::geometry::Point>, cost| GridPath {
        points,
        cost,
        statistics: SearchStatistics::default(),
    };
    let mut through = PlanWith(|start: GridCell, goal: GridCell| {
        Ok(path(vec![start.centre(), goal.centre()], (goal.centre() - start.centre()).norm()))
    });
    assert!(
        optimal(&mut through, &grid, Movement::Octile, a, b).unwrap_err().what.contains("the shortest has 5")
    );
    assert!(
        collision_free(&mut through, &grid, a, b)
            .unwrap_err()
            .what
            .contains("enters the blocked cell (1, 1)")
    );
    let mut none = PlanWith(|start, goal| Err(PlanError::Unreachable { start, goal }));
    assert!(complete(&mut none, &grid, a, b).unwrap_err().what.contains("there is one"));
    let wall = BitGrid::from_text(".#.").unwrap();
    assert!(
        complete(&mut through, &wall, c, GridCell::new(2, 0)).unwrap_err().what.contains("there is none")
    );
    let mut liar =
        PlanWith(|start: GridCell, goal: GridCell| Ok(path(vec![start.centre(), goal.centre()], 0.0)));
    assert!(collision_free(&mut liar, &grid, a, c).unwrap_err().what.contains("a cost of 0"));
    let mut astray = PlanWith(|start: GridCell, _: GridCell| Ok(path(vec![start.centre()], 0.0)));
    assert!(collision_free(&mut astray, &grid, a, c).is_err());
    let mut long = PlanWith(|start: GridCell, goal: GridCell| {
        Ok(path(vec![], if (start, goal) == (a, b) { 9.0 } else { 1.0 }))
    });
    assert!(
        triangle_inequality(&mut long, a, c, b).unwrap_err().what.contains("by (0, 0) there is one of 2")
    );
}
