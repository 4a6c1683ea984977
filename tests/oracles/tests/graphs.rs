//! Searches in graphs of petgraph, beside its own.

use petgraph::graph::DiGraph;
use proptest::prelude::*;
use roverlab::nav::graph::{GraphError, petgraph_shortest_path};

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
}
