//! Searches in graphs of petgraph, beside its own.

use petgraph::graph::DiGraph;
use proptest::prelude::*;
use roverlab::maze::generate::braided;
use roverlab::maze::{Unknown, distances_from_start, petgraph_of_maze};
use roverlab::nav::graph::{GraphError, petgraph_of_grid, petgraph_shortest_path};
use roverlab::nav::grid::{GridPlanner, JumpPointSearch};
use roverlab::world::{BitGrid, GridCell};

#[test]
fn what_makes_no_sense_is_named() {
    let graph = DiGraph::<(), f64>::from_edges([(0, 1, f64::NAN), (1, 2, -1.0), (3, 0, f64::INFINITY)]);
    let error = |start: u32, goal: u32, estimate: f64| {
        let cost = |edge: petgraph::graph::EdgeReference<'_, f64>| *edge.weight();
        let path = petgraph_shortest_path(&graph, start.into(), goal.into(), cost, |_| estimate, |_| {});
        path.unwrap_err()
    };
    assert_eq!(error(0, 2, 0.0), error(0, 1, 0.0));
    assert_eq!(error(0, 2, 0.0).to_string(), "the cost from NodeIndex(0) to NodeIndex(1) is not a number");
    assert_eq!(error(1, 2, 0.0), GraphError::NegativeCost { from: 1.into(), to: 2.into(), cost: -1.0 });
    assert_eq!(error(3, 2, 0.0), GraphError::Unreachable { start: 3.into(), goal: 2.into() });
    assert_eq!(error(0, 7, 0.0), GraphError::NoSuchNode(7.into()));
    assert_eq!(error(9, 0, 0.0), GraphError::NoSuchNode(9.into()));
    assert_eq!(error(1, 2, f64::NAN), GraphError::NanEstimate(1.into()));
}

proptest! {
    #![proptest_config(roverlab::testing::cases(256))]
    /// The same costs as petgraph's own algorithm, on its graphs with removed nodes too.
    #[test]
    fn costs_are_those_of_petgraph(
        edges in proptest::collection::vec((0..20u32, 0..20u32, 0..100u32), 1..80), removed in 0..20u32
    ) {
        let mut graph = petgraph::stable_graph::StableUnGraph::<(), f64>::default();
        let nodes: Vec<_> = (0..20).map(|_| graph.add_node(())).collect();
        for (a, b, cost) in edges {
            graph.add_edge(nodes[a as usize], nodes[b as usize], f64::from(cost));
        }
        graph.remove_node(nodes[removed as usize]);
        let start = nodes[(removed as usize + 1) % 20];
        let costs = petgraph::algo::dijkstra(&graph, start, None, |edge| *edge.weight());
        for &goal in nodes.iter().filter(|&&node| graph.contains_node(node)) {
            let path = petgraph_shortest_path(&graph, start, goal, |edge| *edge.weight(), |_| 0.0, |_| {});
            match path {
                Ok(path) => prop_assert_eq!(Some(&path.cost), costs.get(&goal)),
                Err(error) => {
                    prop_assert_eq!(error, GraphError::Unreachable { start, goal });
                    prop_assert!(!costs.contains_key(&goal));
                }
            }
        }
    }

    /// A grid as a graph has the steps that grid planners take.
    #[test]
    fn grids_as_graphs_have_the_costs_of_grid_planners(
        cells in proptest::collection::vec(prop::bool::weighted(0.7), 9 * 7), from in 0..63usize, to in 0..63usize
    ) {
        let grid = BitGrid::from_fn(9, 7, |column, row| cells[row * 9 + column]).unwrap();
        let cell = |index: usize| GridCell::new(index % 9, index / 9);
        prop_assume!(cells[from] && cells[to]);
        let graph = petgraph_of_grid(&grid);
        let node = |cell: GridCell| graph.node_indices().find(|&node| graph[node] == cell).unwrap();
        let costs = petgraph::algo::dijkstra(&graph, node(cell(from)), None, |edge| *edge.weight());
        match JumpPointSearch::new(&grid).plan(cell(from), cell(to)) {
            Ok(path) => prop_assert!((path.cost - costs[&node(cell(to))]).abs() < 1e-9),
            Err(_) => prop_assert!(!costs.contains_key(&node(cell(to)))),
        }
    }

    /// A maze as a graph has the steps of the flood fill.
    #[test]
    fn mazes_as_graphs_have_the_distances_of_the_flood(width in 1..9usize, height in 1..9usize, seed: u64) {
        let maze = braided(width, height, 0.3, seed).unwrap();
        let graph = petgraph_of_maze(&maze, Unknown::Closed);
        let start = graph.node_indices().find(|&node| graph[node] == maze.start()).unwrap();
        let steps = petgraph::algo::dijkstra(&graph, start, None, |_| 1_u32);
        let distances = distances_from_start(&maze, Unknown::Closed);
        for node in graph.node_indices() {
            prop_assert_eq!(distances.get(graph[node]), steps.get(&node).copied());
        }
    }
}
