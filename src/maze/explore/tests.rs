use proptest::prelude::*;

use super::*;
use crate::maze::generate::{competition, mazes};
use crate::maze::{
    FastPlanner, Preference, RunLimits, Scale, Unknown, WallState, distances_from_start, shortest_route,
};

/// The initial knowledge of a robot.
fn knowledge(truth: &Maze) -> Maze {
    let mut maze = Maze::unexplored(truth.width(), truth.height()).unwrap();
    maze.set_start(truth.start(), truth.heading());
    maze.set_goals(truth.goals());
    maze
}

/// Result of an exploration by a robot that sees the walls of its cell.
struct Walk {
    known: Maze,
    verdict: ExplorationOutcome,
    looks: usize,
    steps: u32,
}

fn walk(truth: &Maze, explorer: &mut dyn Explorer) -> Walk {
    let mut known = knowledge(truth);
    let (mut cell, mut heading) = (truth.start(), truth.heading());
    let (mut looks, mut steps) = (0, 0);
    loop {
        for side in Direction::ALL {
            known.set_wall(cell, side, truth.wall(cell, side));
        }
        looks += 1;
        assert!(looks <= 4 * truth.cell_count() + 4, "the exploration does not end");
        match explorer.next(&known, (cell, heading)) {
            ExplorationStep::Finished(verdict) => return Walk { known, verdict, looks, steps },
            ExplorationStep::Go(next) => {
                let from_here = {
                    let mut flood = crate::maze::FloodFill::default();
                    flood.run(&crate::maze::Passages::new(&known, Unknown::Closed), [cell]);
                    flood.into_distances()
                };
                steps += from_here.get(next).expect("a cell that is reachable on known passages");
                let side = Direction::ALL.into_iter().find(|&side| known.neighbour(cell, side) == Some(next));
                heading = side.unwrap_or(heading);
                cell = next;
            }
        }
    }
}

fn planner() -> FastPlanner {
    FastPlanner::new(Scale::MICROMOUSE, RunLimits::MICROMOUSE).unwrap()
}

proptest! {
    #![proptest_config(crate::testing::cases(256))]
    #[test]
    fn recursion_sees_every_wall_that_can_be_seen(truth in mazes(9), early in any::<bool>()) {
        let mut explorer =
            if early { RecursiveExplorer::new() } else { RecursiveExplorer::without_early_marking() };
        let Walk { known, verdict, .. } = walk(&truth, &mut explorer);
        prop_assert_eq!(verdict, ExplorationOutcome::Explored);
        let reached = distances_from_start(&truth, Unknown::Closed);
        for cell in truth.cells().filter(|&cell| reached.get(cell).is_some()) {
            for side in Direction::ALL {
                prop_assert_eq!(known.wall(cell, side), truth.wall(cell, side));
            }
        }
    }

    #[test]
    fn early_marking_saves_looks(truth in mazes(9)) {
        let early = walk(&truth, &mut RecursiveExplorer::new());
        let late = walk(&truth, &mut RecursiveExplorer::without_early_marking());
        prop_assert!(early.steps <= late.steps && early.looks <= late.looks);
    }

    #[test]
    fn the_proof_holds_in_the_true_maze(truth in mazes(9), timed in any::<bool>()) {
        let goals = if timed { Goals::StepsAndTime(Box::new(planner())) } else { Goals::Steps };
        let Walk { known, verdict, .. } = walk(&truth, &mut TwoPhaseExplorer::new(goals));
        let best = |maze: &Maze| shortest_route(maze, Unknown::Closed, Preference::Steps).map(|r| r.steps());
        prop_assert_eq!(best(&known), best(&truth));
        let expected = if best(&truth).is_some() { ExplorationOutcome::Optimal } else { ExplorationOutcome::Unreachable };
        prop_assert_eq!(verdict, expected);
        if timed {
            let time = |maze: &Maze| planner().plan(maze, Unknown::Closed).map(|plan| plan.time);
            match (time(&known), time(&truth)) {
                (Some(known), Some(truth)) => prop_assert!((known - truth).abs() < 1e-3),
                (known, truth) => prop_assert_eq!(known.is_some(), truth.is_some()),
            }
        }
    }
}

#[test]
fn the_proof_needs_no_complete_maze() {
    let (mut looks, mut all) = (0, 0);
    for seed in 0..20 {
        let truth = competition(16, seed).unwrap();
        let walk = walk(&truth, &mut TwoPhaseExplorer::new(Goals::Steps));
        assert_eq!(walk.verdict, ExplorationOutcome::Optimal);
        looks += walk.looks;
        all += 256;
        assert!(
            walk.known
                .cells()
                .any(|c| Direction::ALL.iter().any(|&s| walk.known.wall(c, s) == WallState::Unknown))
        );
    }
    assert!(looks < all, "{looks} looks");
}
