//! Planning in grids, quadtrees and graphs, with the statistics of every search.

use roverlab::geometry::{Aabb, Point};
use roverlab::io::Result;
use roverlab::nav::graph::shortest_path;
use roverlab::nav::grid::{
    AnyAngle, DStarLite, DistanceField, Edges, GridComponents, GridPath, GridPlanner, GridSearch,
    JumpPointSearch, LazyThetaStar, PlanError, PreparedJumps, Quadtree, QuadtreePlanner, inflated,
    segment_meets_box,
};
use roverlab::random::Stream;
use roverlab::world::{BitGrid, Footprint, GridCell};

use super::{Scenario, note, other};

pub(super) const SCENARIOS: &[Scenario] = &[
    Scenario::new("grid-planners", planners),
    Scenario::new("grid-repair", repair),
    Scenario::new("quadtree", quadtree),
    Scenario::new("distance-field", distance_field),
    Scenario::new("graph", graph),
    #[cfg(feature = "petgraph")]
    Scenario::new("petgraph", petgraph),
    #[cfg(not(feature = "petgraph"))]
    Scenario::without("petgraph", "built without the feature `petgraph`"),
];

/// A map of rooms with open doors, of things that stand about in them, and of a cell without a door.
fn map() -> Result<BitGrid> {
    let mut random = Stream::new(90);
    let clutter: Vec<bool> = (0..61 * 43).map(|_| random.chance(0.06)).collect();
    let is_door = |x: usize, y: usize| (x + 3 * y) % 17 < 4;
    let is_wall = |x: usize, y: usize| x % 20 == 10 || y % 14 == 7;
    let is_open = |x: usize, y: usize| !clutter[61 * y + x] && (!is_wall(x, y) || is_door(x, y));
    // Around (55, 35) there is a wall without a door.
    let is_cell_wall = |x: usize, y: usize| x.abs_diff(55).max(y.abs_diff(35)) == 2;
    BitGrid::from_fn(61, 43, |x, y| (x, y) == (55, 35) || (is_open(x, y) && !is_cell_wall(x, y)))
        .map_err(other)
}

/// Pairs of cells; to the last ones no way leads.
fn queries(grid: &BitGrid) -> Vec<[GridCell; 2]> {
    let free: Vec<GridCell> = grid.free_cells().collect();
    let mut random = Stream::new(91);
    let mut pick = || free[random.below(free.len())];
    let mut queries: Vec<_> = (0..8).map(|_| [pick(), pick()]).collect();
    queries.extend([(60, 99), (53, 35), (55, 35)].map(|(x, y)| [free[0], GridCell::new(x, y)]));
    queries
}

fn note_plan(log: &mut String, what: &str, plan: &std::result::Result<GridPath, PlanError>) {
    match plan {
        Ok(GridPath { points, cost, statistics }) => {
            note(log, what, &(cost, statistics.expanded, statistics.generated, points));
        }
        Err(error) => note(log, what, error),
    }
}

/// All planners on the same queries.
fn planners() -> Result<String> {
    let grid = map()?;
    let tree = Quadtree::new(&grid);
    let mut planners: [(&str, Box<dyn GridPlanner>); 7] = [
        ("Dijkstra", Box::new(GridSearch::dijkstra(&grid))),
        ("A*", Box::new(GridSearch::astar(&grid))),
        ("jump points", Box::new(JumpPointSearch::new(&grid))),
        ("prepared jumps", Box::new(PreparedJumps::new(&grid))),
        ("any angle", Box::new(AnyAngle::new(&grid))),
        ("lazy theta*", Box::new(LazyThetaStar::new(&grid))),
        ("quadtree", Box::new(QuadtreePlanner::new(&tree))),
    ];
    let mut log = String::new();
    for [start, goal] in queries(&grid) {
        note(&mut log, "query", &(start, goal));
        for (name, planner) in &mut planners {
            note_plan(&mut log, name, &planner.plan(start, goal));
        }
    }
    let [start, goal] = queries(&grid)[0];
    let plan = GridSearch::astar(&grid)
        .plan_traced(start, goal, |step| note(&mut log, "step", &(step.cell, step.cost, step.estimate)));
    note_plan(&mut log, "traced", &plan);
    let jumps = PreparedJumps::new(&grid);
    note(&mut log, "prepared", &(jumps.jump_points(), jumps.jumps(), AnyAngle::new(&grid).corners()));
    Ok(log)
}

/// A robot that finds cells blocked on its way, and one that was thought to be.
fn repair() -> Result<String> {
    let grid = map()?;
    let [start, goal] = queries(&grid)[1];
    let mut planner = DStarLite::new(&grid, start, goal).map_err(other)?;
    let mut jumps = JumpPointSearch::new(&grid);
    let mut log = String::new();
    let mut at = start;
    for round in 0..12 {
        let plan = planner.plan();
        note_plan(&mut log, "D* Lite", &plan);
        note_plan(&mut log, "jump points", &jumps.plan(at, goal));
        let Ok(GridPath { points, .. }) = plan else { break };
        let cells: Vec<GridCell> = points.iter().copied().filter_map(GridCell::at).collect();
        let Some(&[next, _, blocked]) = cells.get(1..4) else { break };
        at = next;
        planner.move_to(at).map_err(other)?;
        let (cell, free) =
            if round % 3 == 2 { (GridCell::new(10, 3 * round), true) } else { (blocked, false) };
        planner.set_free(cell, free);
        jumps.set_free(cell, free);
    }
    Ok(log)
}

fn quadtree() -> Result<String> {
    let grid = map()?;
    let mut log = String::new();
    let mut tree = Quadtree::with_minimum_leaf(&grid, 2).map_err(other)?;
    for change in [None, Some((GridCell::new(30, 20), false)), Some((GridCell::new(10, 7), true))] {
        if let Some((cell, free)) = change {
            tree.set_free(cell, free);
        }
        note(&mut log, "free", &tree.free_leaves());
        note(&mut log, "blocked", &tree.blocked_leaves());
        note(&mut log, "neighbours", &tree.neighbour_graph().links);
    }
    let tree = Quadtree::new(&BitGrid::from_fn(16, 16, |x, y| (x * y) % 7 != 5).map_err(other)?);
    for edges in [Edges::Open, Edges::Closed] {
        note(&mut log, "pairs", &tree.all_pairs_graph(edges).links);
        let met = (0..8).map(|k| segment_meets_box((0, k), (8, 8 - k), (2, 2), (4, 4), edges));
        note(&mut log, "met", &met.collect::<Vec<_>>());
    }
    Ok(log)
}

/// Distances to what is blocked, and the floor that is left for two outlines.
fn distance_field() -> Result<String> {
    let grid = map()?;
    let field = DistanceField::new(&grid);
    let components = GridComponents::new(&grid);
    let mut log = String::new();
    for row in 0..grid.height() {
        let cells = (0..grid.width()).map(|column| GridCell::new(column, row));
        note(&mut log, "row", &cells.clone().map(|cell| field.at(cell)).collect::<Vec<_>>());
        note(&mut log, "regions", &cells.map(|cell| components.region(cell)).collect::<Vec<_>>());
    }
    note(&mut log, "sizes", &components.sizes());
    let oblong = Footprint::Rectangle(Aabb::new(Point::new(-0.15, -0.08), Point::new(0.2, 0.08)));
    for (footprint, heading) in
        [(Footprint::Disc { radius: 0.12 }, None), (oblong, None), (oblong, Some(0.5))]
    {
        let free = inflated(&grid, 0.1, &footprint, heading);
        note(&mut log, "floor", &(0..free.height()).map(|row| free.row(row).to_vec()).collect::<Vec<_>>());
    }
    Ok(log)
}

/// Places at random, each joined to those near it.
fn network() -> (Vec<Point>, Vec<(u32, u32, f64)>) {
    let mut random = Stream::new(92);
    let places: Vec<Point> = (0..40).map(|_| Point::new(random.uniform(), random.uniform())).collect();
    let pairs = (0..40).flat_map(|a| (0..40).map(move |b| (a, b))).filter(|(a, b)| a != b);
    let length = |(a, b): (usize, usize)| (a as u32, b as u32, (places[a] - places[b]).norm());
    let edges = pairs.map(length).filter(|edge| edge.2 < 0.3).collect();
    (places, edges)
}

fn graph() -> Result<String> {
    let (places, edges) = network();
    let mut log = String::new();
    for goal in [7, 23, 39] {
        for scale in [0.0, 1.0] {
            let neighbours = |node: usize, visit: &mut dyn FnMut(usize, f64)| {
                let from_here = edges.iter().filter(|edge| edge.0 as usize == node);
                from_here.for_each(|edge| visit(edge.1 as usize, edge.2));
            };
            let estimate = |node: usize| scale * (places[node] - places[goal]).norm();
            let path = shortest_path(40, 0, goal, neighbours, estimate, |step| {
                note(&mut log, "step", &(step.node, step.before, step.cost, step.estimate, step.reached));
            });
            note(&mut log, "path", &path);
        }
    }
    Ok(log)
}

#[cfg(feature = "petgraph")]
fn petgraph() -> Result<String> {
    use petgraph::graph::UnGraph;
    use roverlab::nav::graph::petgraph_shortest_path;

    let graph = UnGraph::<(), f64>::from_edges(network().1);
    let mut log = String::new();
    for goal in [7, 23, 39] {
        let path =
            petgraph_shortest_path(&graph, 0.into(), goal.into(), |edge| *edge.weight(), |_| 0.0, |_| {});
        note(&mut log, "path", &path);
    }
    Ok(log)
}
