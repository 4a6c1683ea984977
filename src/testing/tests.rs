use proptest::prelude::*;

use super::{
    Movement, PlanWith, collision_free, complete, grid_queries, mazes, optimal, triangle_inequality,
};
use crate::nav::grid::{
    AnyAngle, GridPath, GridPlanner, GridSearch, JumpPointSearch, PlanError, PreparedJumps, Quadtree,
    QuadtreePlanner, SearchStatistics,
};
use crate::world::{BitGrid, GridCell};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

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
        optimal(&mut any, &grid, Movement::AnyAngle, a, b)?;
        collision_free(&mut any, &grid, a, b)?;
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

/// Worlds take longer to draw: a few of them.
#[test]
fn worlds_are_drawn() {
    use proptest::strategy::ValueTree;
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let course = super::worlds().new_tree(&mut runner).unwrap().current();
    assert!(!course.world.walls.is_empty() && course.goal != course.start.position());
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
