use petgraph::graph::{NodeIndex, UnGraph};
use petgraph::visit::{EdgeRef, IntoEdges, NodeIndexable};

use super::search::{GraphError, GraphPath, GraphStep, shortest_path};
use crate::world::{BitGrid, GridCell};

/// A grid as a `petgraph` graph: a node for each free cell, row by row, and an edge for each step that grid
/// planners take, with its cost in cells: 1 along rows and columns, √2 along a diagonal that cuts no corner.
///
/// ```
/// use roverlab::nav::graph::petgraph_of_grid;
/// use roverlab::world::BitGrid;
/// let graph = petgraph_of_grid(&BitGrid::from_text("..#\n...")?);
/// assert_eq!((graph.node_count(), graph.edge_count()), (5, 7));
/// # Ok::<(), roverlab::world::BitGridError>(())
/// ```
pub fn petgraph_of_grid(grid: &BitGrid) -> UnGraph<GridCell, f64> {
    let mut graph = UnGraph::default();
    let (width, height) = (grid.width(), grid.height());
    let mut nodes: Vec<Option<NodeIndex>> = vec![None; width * height];
    for cell in (0..height).flat_map(|row| (0..width).map(move |column| GridCell::new(column, row))) {
        if !grid.is_free(cell) {
            continue;
        }
        let node = graph.add_node(cell);
        nodes[cell.row * width + cell.column] = Some(node);
        let at = |column: usize, row: usize| nodes.get(row * width + column).copied().flatten();
        let left = cell.column.checked_sub(1).and_then(|column| at(column, cell.row));
        if let Some(left) = left {
            graph.add_edge(left, node, 1.0);
        }
        let Some(row) = cell.row.checked_sub(1) else { continue };
        let above = at(cell.column, row);
        if let Some(above) = above {
            graph.add_edge(above, node, 1.0);
        }
        let corner = cell.column.checked_sub(1).and_then(|column| at(column, row));
        if let (Some(_), Some(_), Some(corner)) = (left, above, corner) {
            graph.add_edge(corner, node, std::f64::consts::SQRT_2);
        }
        // The other diagonal of the same four cells.
        if let (Some(left), Some(above), Some(_)) = (left, above, corner) {
            graph.add_edge(left, above, std::f64::consts::SQRT_2);
        }
    }
    graph
}

/// The cheapest path between two nodes of a `petgraph` graph, by A\*; see [`shortest_path`].
///
/// `cost` returns the cost of an edge, `estimate` a lower bound of the cost from a node to the goal: 0 gives
/// Dijkstra's algorithm.
///
/// # Errors
///
/// As [`shortest_path`].
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
