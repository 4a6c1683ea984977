use proptest::prelude::*;

use super::{GraphError, shortest_path};

type Edge = (usize, usize, f64);

fn search(
    count: usize,
    edges: &[Edge],
    (start, goal): (usize, usize),
    estimate: impl FnMut(usize) -> f64,
) -> Result<(Vec<usize>, f64), GraphError<usize>> {
    let neighbours = |node: usize, visit: &mut dyn FnMut(usize, f64)| {
        for edge in edges.iter().filter(|edge| edge.0 == node) {
            visit(edge.1, edge.2);
        }
    };
    shortest_path(count, start, goal, neighbours, estimate, |_| {}).map(|path| (path.nodes, path.cost))
}

/// The example of section 10.6: start, a, b, c and d, with the goal at b. Scores as in Figures 10.13 to
/// 10.15.
#[test]
fn the_books_example_step_by_step() {
    let [s, a, b, c, d] = [0, 1, 2, 3, 4];
    let edges = [(s, a, 10.0), (s, c, 5.0), (s, d, 9.0), (c, a, 3.0), (c, b, 9.0), (c, d, 2.0), (a, b, 1.0)];
    let bounds = [7.0, 1.0, 0.0, 3.0, 5.0];
    let mut steps = Vec::new();
    let neighbours = |node: usize, visit: &mut dyn FnMut(usize, f64)| {
        for edge in edges.iter().filter(|edge| edge.0 == node) {
            visit(edge.1, edge.2);
        }
    };
    let path = shortest_path(5, s, b, neighbours, |node| bounds[node], |step| steps.push(step)).unwrap();
    assert_eq!((path.nodes, path.cost), (vec![s, c, a, b], 9.0));
    let scores: Vec<Vec<(usize, f64)>> = steps
        .iter()
        .map(|step| step.reached.iter().map(|&(node, cost, rest)| (node, cost + rest)).collect())
        .collect();
    assert_eq!(scores[0], [(a, 11.0), (c, 8.0), (d, 14.0)]);
    assert_eq!(scores[1], [(a, 9.0), (b, 14.0), (d, 12.0)]);
    assert_eq!(scores[2], [(b, 9.0)]);
    assert_eq!(steps.iter().map(|step| step.node).collect::<Vec<_>>(), [s, c, a, b]);
    assert_eq!(steps[2].before, Some(c));
}

#[test]
fn costs_that_are_none_are_named() {
    let error = |cost: f64| search(2, &[(0, 1, cost)], (0, 1), |_| 0.0).unwrap_err();
    assert!(matches!(error(f64::NAN), GraphError::NanCost { from: 0, to: 1 }));
    assert_eq!(error(-1.0).to_string(), "the cost from 0 to 1 is -1; expected 0 or more");
    assert_eq!(error(f64::INFINITY), GraphError::Unreachable { start: 0, goal: 1 });
    assert_eq!(search(2, &[(0, 1, -0.0)], (0, 1), |_| 0.0), Ok((vec![0, 1], 0.0)));
    assert_eq!(search(2, &[], (0, 2), |_| 0.0), Err(GraphError::NoSuchNode(2)));
    assert_eq!(search(2, &[(0, 5, 1.0)], (0, 1), |_| 0.0), Err(GraphError::NoSuchNode(5)));
    assert_eq!(search(2, &[(0, 1, 1.0)], (0, 1), |_| f64::NAN), Err(GraphError::NanEstimate(0)));
    assert_eq!(search(1, &[], (0, 0), |_| 0.0), Ok((vec![0], 0.0)));
}

/// Costs from all nodes to one, by relaxing every edge until nothing changes.
fn truth(count: usize, edges: &[Edge], goal: usize) -> Vec<f64> {
    let mut costs = vec![f64::INFINITY; count];
    costs[goal] = 0.0;
    for _ in 0..count {
        for &(from, to, cost) in edges {
            costs[from] = costs[from].min(cost + costs[to]);
        }
    }
    costs
}

proptest! {
    #![proptest_config(crate::testing::cases(256))]
    /// Without an estimate, with the exact one, and with an admissible but inconsistent one.
    #[test]
    fn the_cheapest_way_is_found(
        count in 1..12usize,
        edges in proptest::collection::vec((0..12usize, 0..12usize, 0..20u32), 0..60),
        share in proptest::collection::vec(0.0..1.0f64, 12),
    ) {
        let edges: Vec<Edge> =
            edges.into_iter().map(|(a, b, cost)| (a % count, b % count, f64::from(cost))).collect();
        let costs = truth(count, &edges, 0);
        for start in 0..count {
            let estimates: [&dyn Fn(usize) -> f64; 3] =
                [&|_| 0.0, &|node| costs[node], &|node| if costs[node].is_finite() { costs[node] * share[node] } else { 0.0 }];
            for estimate in estimates {
                match search(count, &edges, (start, 0), estimate) {
                    Ok((nodes, cost)) => {
                        prop_assert!((cost - costs[start]).abs() < 1e-9);
                        prop_assert!((nodes[0], nodes[nodes.len() - 1]) == (start, 0));
                        let steps = nodes.windows(2).map(|pair| {
                            let joins = edges.iter().filter(|edge| (edge.0, edge.1) == (pair[0], pair[1]));
                            joins.map(|edge| edge.2).fold(f64::INFINITY, f64::min)
                        });
                        prop_assert!((steps.sum::<f64>() - cost).abs() < 1e-9);
                    }
                    Err(error) => {
                        prop_assert_eq!(error, GraphError::Unreachable { start, goal: 0 });
                        prop_assert!(costs[start].is_infinite());
                    }
                }
            }
        }
    }
}
