use super::portals::Portals;
use super::pull::{distance, funnel, shortcut};
use super::tree::Quadtree;
use crate::geometry::Point;
use crate::nav::grid::any_angle::{Field, HalfPoint};
use crate::nav::grid::components::GridComponents;
use crate::nav::grid::cost::{fixed, limit};
use crate::nav::grid::path::{GridPath, GridPlanner, PlanError, SearchStatistics, check};
use crate::nav::grid::queue::BucketQueue;
use crate::world::{BitGrid, GridCell};

/// Paths through a quadtree's free leaves, pulled straight (book, section 10.5).
///
/// The search is A\* over points on the shared edges of adjacent leaves: their midpoints, and the ends of
/// long ones. It weights the estimate by 1.1 and expands no point twice (I. Pohl, *Heuristic Search Viewed as
/// Path Finding in a Graph*, Artificial Intelligence 1, 1970). The path found is pulled straight within its
/// leaves, then shortcut wherever a later point is in sight. Paths may be slightly longer than the shortest:
/// by 0.1 to 1 % on average on published maps.
///
/// ```
/// use roverlab::nav::grid::{GridPlanner, Quadtree, QuadtreePlanner};
/// use roverlab::world::{BitGrid, GridCell};
/// let grid = BitGrid::from_text("....\n.##.\n....\n....")?;
/// let mut planner = QuadtreePlanner::new(&Quadtree::new(&grid));
/// let path = planner.plan(GridCell::new(0, 1), GridCell::new(3, 1)).unwrap();
/// assert!((path.cost - (2.0 + 2.0 * 0.5f64.sqrt())).abs() < 1e-12);
/// # Ok::<(), roverlab::world::BitGridError>(())
/// ```
#[derive(Debug, Clone)]
pub struct QuadtreePlanner {
    tree: Quadtree,
    grid: BitGrid,
    components: GridComponents,
    field: Field,
    portals: Portals,
    labels: Vec<Label>,
    query: u32,
    queue: BucketQueue,
}

/// Search state of a node.
#[derive(Debug, Clone, Copy, Default)]
struct Label {
    cost: f64,
    parent: u32,
    /// The query it belongs to, and the flags below in the lowest two bits.
    state: u32,
}

impl Label {
    /// The path to the node comes through the second leaf of its portal, not the first.
    const FROM_SECOND: u32 = 1;
    /// The node has left the queue.
    const DONE: u32 = 2;
}

/// The parent of the nodes in the start's leaf.
const START: u32 = u32::MAX;
/// Factor on the heuristic. With many equivalent paths, the search ends much earlier, with a path that is
/// longer by at most this factor.
const HASTE: f64 = 1.1;

struct Query {
    goal: HalfPoint,
    goal_leaf: u32,
    best: f64,
    last: u32,
    statistics: SearchStatistics,
}

impl QuadtreePlanner {
    /// Creates a planner for the free leaves of a quadtree.
    pub fn new(tree: &Quadtree) -> Self {
        let (grid, portals) = (tree.grid(), Portals::new(tree));
        Self {
            components: GridComponents::new(&grid),
            field: Field::new(&grid),
            labels: vec![Label::default(); portals.nodes.len()],
            tree: tree.clone(),
            grid,
            portals,
            query: 0,
            queue: BucketQueue::default(),
        }
    }

    /// Number of free leaves.
    pub fn leaves(&self) -> usize {
        self.portals.leaves.len()
    }

    fn begin(&mut self) {
        if self.query >= u32::MAX - 7 {
            self.labels.fill(Label::default());
            self.query = 0;
        }
        self.query += 4;
    }

    fn leaf_of(&self, cell: GridCell) -> Option<u32> {
        self.tree.leaf_at(cell).map(|leaf| self.portals.number_of(leaf))
    }

    fn search(&mut self, start: HalfPoint, start_leaf: u32, query: &mut Query) {
        self.begin();
        self.queue.start(fixed(distance(start, query.goal)));
        self.spread(query, start, start_leaf, 0.0, START);
        while let Some((number, bits)) = self.queue.pop_below(limit(query.best)) {
            let (label, node) = (&mut self.labels[number as usize], self.portals.nodes[number as usize]);
            let cost = label.cost;
            let rest = distance(node.at, query.goal);
            if cost.to_bits() != bits || label.state & Label::DONE != 0 || cost + rest >= query.best {
                continue;
            }
            label.state |= Label::DONE;
            query.statistics.expanded += 1;
            let leaf = node.leaves[usize::from(label.state & Label::FROM_SECOND == 0)];
            if leaf == query.goal_leaf {
                (query.best, query.last) = (cost + rest, number);
                continue;
            }
            self.spread(query, node.at, leaf, cost, number);
        }
    }

    /// Relaxes all nodes around a leaf from a point.
    fn spread(&mut self, query: &mut Query, from: HalfPoint, leaf: u32, cost: f64, parent: u32) {
        let Self { portals, labels, queue, .. } = self;
        let portal = if parent == START { None } else { Some(portals.nodes[parent as usize].portal) };
        for &number in portals.around(leaf) {
            let (label, node) = (&mut labels[number as usize], portals.nodes[number as usize]);
            let total = cost + distance(from, node.at);
            let is_known = label.state & !3 == self.query;
            let is_done = is_known && (label.state & Label::DONE != 0 || label.cost <= total);
            let rest = distance(node.at, query.goal);
            if is_done || Some(node.portal) == portal || total + rest >= query.best {
                continue;
            }
            let side = if node.leaves[0] == leaf { 0 } else { Label::FROM_SECOND };
            *label = Label { cost: total, parent, state: self.query | side };
            query.statistics.generated += 1;
            queue.push(fixed(total + HASTE * rest), number, total.to_bits());
        }
    }

    /// The portals on the path, each by its left and its right end.
    fn openings(&self, last: u32) -> Vec<(HalfPoint, HalfPoint)> {
        let mut openings = Vec::new();
        let mut number = last;
        while number != START {
            let label = self.labels[number as usize];
            let portal = self.portals.all[self.portals.nodes[number as usize].portal as usize];
            let [a, b] = portal.ends.map(|(x, y)| HalfPoint::corner(x, y));
            // Passing a vertical portal to the right, its upper end is on the left; passing a horizontal one
            // downwards, its right end is.
            let (upright, forward) = (a.x == b.x, label.state & Label::FROM_SECOND == 0);
            openings.push(if upright == forward { (a, b) } else { (b, a) });
            number = label.parent;
        }
        openings.reverse();
        openings
    }
}

impl GridPlanner for QuadtreePlanner {
    fn plan(&mut self, start: GridCell, goal: GridCell) -> Result<GridPath, PlanError> {
        check(&self.grid, &self.components, start, goal)?;
        let unreachable = PlanError::Unreachable { start, goal };
        let (from, to) = (HalfPoint::centre(start), HalfPoint::centre(goal));
        let start_leaf = self.leaf_of(start).ok_or(unreachable)?;
        let goal_leaf = self.leaf_of(goal).ok_or(unreachable)?;
        let statistics = SearchStatistics { expanded: 1, generated: 1 };
        let mut query = Query { goal: to, goal_leaf, best: f64::INFINITY, last: START, statistics };
        if start_leaf != goal_leaf {
            self.search(from, start_leaf, &mut query);
        }
        let pulled = funnel(from, &self.openings(query.last), to);
        let points = shortcut(&self.field, &pulled);
        let cells = |point: HalfPoint| Point::new(0.5 * f64::from(point.x), 0.5 * f64::from(point.y));
        Ok(GridPath::along(points.into_iter().map(cells).collect(), query.statistics))
    }
}
