use std::cmp::Ordering;
use std::collections::BinaryHeap;

use crate::nav::grid::SearchStatistics;

/// A path through a graph, with statistics of the search.
#[derive(Debug, Clone, PartialEq)]
pub struct GraphPath<N> {
    /// Nodes from the start to the goal.
    pub nodes: Vec<N>,
    /// Sum of the costs along them.
    pub cost: f64,
    /// Statistics of the search.
    pub statistics: SearchStatistics,
}

/// A node taken off the queue: one step of a search.
#[derive(Debug, Clone, PartialEq)]
pub struct GraphStep<N> {
    /// The node.
    pub node: N,
    /// Previous node on the path; `None` at the start.
    pub before: Option<N>,
    /// Cost of the path to it.
    pub cost: f64,
    /// Lower bound of the remaining cost.
    pub estimate: f64,
    /// Nodes reached from here more cheaply than before, with their costs and estimates. The score of a path
    /// is the sum of the two.
    pub reached: Vec<(N, f64, f64)>,
}

/// Reason for the lack of a path.
#[derive(Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GraphError<N: std::fmt::Debug> {
    /// A node is not in the graph.
    #[error("node {0:?} is not in the graph")]
    NoSuchNode(N),
    /// A cost is NaN.
    #[error("the cost from {from:?} to {to:?} is not a number")]
    NanCost {
        /// Start of the edge.
        from: N,
        /// End of the edge.
        to: N,
    },
    /// A cost is negative.
    #[error("the cost from {from:?} to {to:?} is {cost}; expected 0 or more")]
    NegativeCost {
        /// Start of the edge.
        from: N,
        /// End of the edge.
        to: N,
        /// Cost of the edge.
        cost: f64,
    },
    /// An estimate is NaN.
    #[error("the estimate at {0:?} is not a number")]
    NanEstimate(N),
    /// No way leads to the goal.
    #[error("no way leads from {start:?} to {goal:?}")]
    Unreachable {
        /// Start of the query.
        start: N,
        /// Goal of the query.
        goal: N,
    },
}

impl<N: std::fmt::Debug> std::fmt::Debug for GraphError<N> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        std::fmt::Display::fmt(self, f)
    }
}

/// The cheapest path between two nodes, by A\*.
///
/// Nodes are numbers below `count`. `neighbours(node, visit)` calls `visit(next, cost)` for each edge from a
/// node; an infinite cost counts as no edge. `estimate(node)` must not exceed the remaining cost: 0 gives
/// Dijkstra's algorithm, and an admissible but inconsistent estimate costs time, never the answer. `trace` is
/// called with every step.
///
/// E. W. Dijkstra 1959; P. E. Hart, N. J. Nilsson, B. Raphael 1968, as cited in the book. Time O((n + m) log
/// m) for n nodes and m edges with a consistent estimate; space O(n + m).
///
/// # Errors
///
/// If an end or a neighbour is not in the graph, a cost is NaN or negative, an estimate is NaN, or no path
/// exists.
///
/// ```
/// use roverlab::nav::graph::shortest_path;
/// //  0 --1-- 1 --1-- 2      the direct edge from 0 to 2 costs 3
/// let edges = [(0, 1, 1.0), (1, 2, 1.0), (0, 2, 3.0)];
/// let neighbours = |node, visit: &mut dyn FnMut(usize, f64)| {
///     edges.iter().filter(|edge| edge.0 == node).for_each(|edge| visit(edge.1, edge.2));
/// };
/// let path = shortest_path(3, 0, 2, neighbours, |_| 0.0, |_| {})?;
/// assert_eq!((path.nodes, path.cost), (vec![0, 1, 2], 2.0));
/// # Ok::<(), roverlab::nav::graph::GraphError<usize>>(())
/// ```
pub fn shortest_path(
    count: usize,
    start: usize,
    goal: usize,
    mut neighbours: impl FnMut(usize, &mut dyn FnMut(usize, f64)),
    mut estimate: impl FnMut(usize) -> f64,
    mut trace: impl FnMut(GraphStep<usize>),
) -> Result<GraphPath<usize>, GraphError<usize>> {
    if let Some(&node) = [start, goal].iter().find(|&&node| node >= count) {
        return Err(GraphError::NoSuchNode(node));
    }
    let mut search = Search { labels: vec![None; count], queue: BinaryHeap::new(), pushed: 0 };
    let mut statistics = SearchStatistics::default();
    let first = checked_estimate(start, &mut estimate)?;
    search.push(start, 0.0, first, None);
    while let Some(entry) = search.queue.pop() {
        let node = entry.node;
        let Some(label) = search.labels[node].filter(|label| label.cost == entry.cost) else { continue };
        if node == goal {
            trace(GraphStep {
                node,
                before: label.before,
                cost: label.cost,
                estimate: label.estimate,
                reached: vec![],
            });
            statistics.generated = search.pushed;
            return Ok(GraphPath { nodes: search.back(goal), cost: label.cost, statistics });
        }
        statistics.expanded += 1;
        let mut edges = Vec::new();
        neighbours(node, &mut |next, cost| edges.push((next, cost)));
        let mut reached = Vec::new();
        for (next, cost) in edges {
            check_edge(count, node, next, cost)?;
            let total = label.cost + cost;
            if total.is_infinite() || search.labels[next].is_some_and(|known| known.cost <= total) {
                continue;
            }
            let rest = match search.labels[next] {
                Some(known) => known.estimate,
                None => checked_estimate(next, &mut estimate)?,
            };
            search.push(next, total, rest, Some(node));
            reached.push((next, total, rest));
        }
        trace(GraphStep { node, before: label.before, cost: label.cost, estimate: label.estimate, reached });
    }
    Err(GraphError::Unreachable { start, goal })
}

fn checked_estimate(node: usize, estimate: &mut impl FnMut(usize) -> f64) -> Result<f64, GraphError<usize>> {
    let value = estimate(node);
    if value.is_nan() { Err(GraphError::NanEstimate(node)) } else { Ok(value) }
}

fn check_edge(count: usize, from: usize, to: usize, cost: f64) -> Result<(), GraphError<usize>> {
    if to >= count {
        return Err(GraphError::NoSuchNode(to));
    }
    if cost.is_nan() {
        return Err(GraphError::NanCost { from, to });
    }
    if cost < 0.0 {
        return Err(GraphError::NegativeCost { from, to, cost });
    }
    Ok(())
}

/// Search state of a node.
#[derive(Debug, Clone, Copy)]
struct Label {
    cost: f64,
    estimate: f64,
    before: Option<usize>,
}

struct Search {
    labels: Vec<Option<Label>>,
    queue: BinaryHeap<Entry>,
    pushed: usize,
}

impl Search {
    fn push(&mut self, node: usize, cost: f64, estimate: f64, before: Option<usize>) {
        self.labels[node] = Some(Label { cost, estimate, before });
        self.queue.push(Entry { score: cost + estimate, number: self.pushed, node, cost });
        self.pushed += 1;
    }

    fn back(&self, goal: usize) -> Vec<usize> {
        let before = |&node: &usize| self.labels[node].and_then(|label| label.before);
        let mut nodes: Vec<usize> = std::iter::successors(Some(goal), before).collect();
        nodes.reverse();
        nodes
    }
}

/// A node on the queue. The greatest entry has the lowest score; among equal ones it is the oldest.
#[derive(Debug, Clone, Copy)]
struct Entry {
    score: f64,
    number: usize,
    node: usize,
    cost: f64,
}

impl Ord for Entry {
    fn cmp(&self, other: &Self) -> Ordering {
        other.score.total_cmp(&self.score).then(other.number.cmp(&self.number))
    }
}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Entry {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Entry {}
