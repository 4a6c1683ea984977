use petgraph::visit::{EdgeRef, IntoEdges, NodeIndexable};

use super::search::{GraphError, GraphPath, GraphStep, shortest_path};

/// The cheapest path between two nodes of a `petgraph` graph, by A\*; see [`shortest_path`].
///
/// `cost` returns the cost of an edge, `estimate` a lower bound of the cost from a node to the goal: 0 gives
/// Dijkstra's algorithm.
///
/// ```
/// use petgraph::graph::UnGraph;
/// use roverlab::nav::graph::petgraph_shortest_path;
/// let graph = UnGraph::<(), f64>::from_edges([(0, 1, 1.0), (1, 2, 1.0), (0, 2, 3.0)]);
/// let path = petgraph_shortest_path(&graph, 0.into(), 2.into(), |edge| *edge.weight(), |_| 0.0, |_| {}).unwrap();
/// assert_eq!((path.nodes.len(), path.cost), (3, 2.0));
/// ```
pub fn petgraph_shortest_path<G>(
    graph: G,
    start: G::NodeId,
    goal: G::NodeId,
    mut cost: impl FnMut(G::EdgeRef) -> f64,
    mut estimate: impl FnMut(G::NodeId) -> f64,
    mut trace: impl FnMut(GraphStep<G::NodeId>),
) -> Result<GraphPath<G::NodeId>, GraphError<G::NodeId>>
where
    G: IntoEdges + NodeIndexable,
    G::NodeId: std::fmt::Debug,
{
    let id = |index: usize| graph.from_index(index);
    let neighbours = |node: usize, visit: &mut dyn FnMut(usize, f64)| {
        for edge in graph.edges(id(node)) {
            visit(graph.to_index(edge.target()), cost(edge));
        }
    };
    let step = |step: GraphStep<usize>| {
        trace(GraphStep {
            node: id(step.node),
            before: step.before.map(id),
            cost: step.cost,
            estimate: step.estimate,
            reached: step
                .reached
                .into_iter()
                .map(|(node, cost, estimate)| (id(node), cost, estimate))
                .collect(),
        });
    };
    let bound = graph.node_bound();
    let (first, last) = (graph.to_index(start), graph.to_index(goal));
    if let Some((_, node)) = [(first, start), (last, goal)].into_iter().find(|&(index, _)| index >= bound) {
        return Err(GraphError::NoSuchNode(node));
    }
    match shortest_path(bound, first, last, neighbours, |node| estimate(id(node)), step) {
        Ok(path) => Ok(GraphPath {
            nodes: path.nodes.into_iter().map(id).collect(),
            cost: path.cost,
            statistics: path.statistics,
        }),
        Err(error) => Err(match error {
            GraphError::NoSuchNode(node) => GraphError::NoSuchNode(id(node)),
            GraphError::NanCost { from, to } => GraphError::NanCost { from: id(from), to: id(to) },
            GraphError::NegativeCost { from, to, cost } => {
                GraphError::NegativeCost { from: id(from), to: id(to), cost }
            }
            GraphError::NanEstimate(node) => GraphError::NanEstimate(id(node)),
            GraphError::Unreachable { start, goal } => {
                GraphError::Unreachable { start: id(start), goal: id(goal) }
            }
        }),
    }
}
