//! Who takes part.

use roverlab::nav::grid::{
    AnyAngle, GridPlanner, GridSearch, JumpPointSearch, PreparedJumps, Quadtree, QuadtreePlanner,
};
use roverlab::world::{BitGrid, GridCell};

use crate::peers::{GridPathfinding, Pathfinding, Petgraph, Polyanya};

/// What a planner answers: the cost, or none.
pub(crate) type Answer = Box<dyn FnMut(GridCell, GridCell) -> Option<f64>>;

/// Which costs a planner has to find.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Truth {
    /// Those of the shortest octile paths.
    Octile,
    /// Those of the shortest octile paths that may cut corners.
    CuttingCorners,
    /// Those of the shortest paths of all.
    AnyAngle,
    /// Not below those.
    AtLeastAnyAngle,
}

/// A planner, and how to get it ready for a map.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Entry {
    pub(crate) name: &'static str,
    pub(crate) truth: Truth,
    pub(crate) is_ours: bool,
    pub(crate) make: fn(&BitGrid) -> Answer,
}

impl Entry {
    const fn peer(name: &'static str, truth: Truth, make: fn(&BitGrid) -> Answer) -> Self {
        Self { name, truth, is_ours: false, make }
    }

    const fn ours(name: &'static str, truth: Truth, make: fn(&BitGrid) -> Answer) -> Self {
        Self { name, truth, is_ours: true, make }
    }
}

pub(crate) const PATHFINDING: &str = "pathfinding astar";
pub(crate) const GRID_PATHFINDING: &str = "grid_pathfinding";
pub(crate) const GRID_PATHFINDING_PLAIN: &str = "grid_pathfinding, plain pruning";
pub(crate) const POLYANYA: &str = "polyanya";
pub(crate) const JPS: &str = "jump points";
pub(crate) const JPS_PLUS: &str = "prepared jumps";
pub(crate) const ANY_ANGLE: &str = "any angle";
pub(crate) const QUADTREE: &str = "quadtree";

pub(crate) const ALL: [Entry; 12] = [
    Entry::peer(PATHFINDING, Truth::Octile, |grid| Pathfinding::new(grid).answer()),
    Entry::peer("petgraph astar", Truth::Octile, |grid| Petgraph::new(grid).answer()),
    Entry::peer(GRID_PATHFINDING, Truth::CuttingCorners, |grid| GridPathfinding::new(grid, true).answer()),
    Entry::peer(GRID_PATHFINDING_PLAIN, Truth::CuttingCorners, |grid| {
        GridPathfinding::new(grid, false).answer()
    }),
    Entry::peer(POLYANYA, Truth::AnyAngle, |grid| Polyanya::new(grid).answer()),
    Entry::ours("Dijkstra", Truth::Octile, |grid| ask(GridSearch::dijkstra(grid))),
    Entry::ours("A*", Truth::Octile, |grid| ask(GridSearch::astar(grid))),
    Entry::ours(JPS, Truth::Octile, |grid| ask(JumpPointSearch::new(grid))),
    Entry::ours(JPS_PLUS, Truth::Octile, |grid| ask(PreparedJumps::new(grid))),
    Entry::ours("any angle, not prepared", Truth::AnyAngle, |grid| ask(AnyAngle::new(grid))),
    Entry::ours(ANY_ANGLE, Truth::AnyAngle, |grid| {
        let mut planner = AnyAngle::new(grid);
        planner.prepare();
        ask(planner)
    }),
    Entry::ours(QUADTREE, Truth::AtLeastAnyAngle, |grid| ask(QuadtreePlanner::new(&Quadtree::new(grid)))),
];

/// The planners of this library.
pub(crate) fn ours() -> Vec<Entry> {
    ALL.into_iter().filter(|entry| entry.is_ours).collect()
}

fn ask(mut planner: impl GridPlanner + 'static) -> Answer {
    Box::new(move |start, goal| planner.plan(start, goal).ok().map(|path| path.cost))
}
