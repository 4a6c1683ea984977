use super::portals::Portals;
use super::pull::{distance, funnel, shortcut};
use super::tree::Quadtree;
use crate::geometry::Point;
use crate::nav::grid::any_angle::{Field, HalfPoint};
use crate::nav::grid::components::Components;
use crate::nav::grid::cost::{fixed, limit};
use crate::nav::grid::path::{GridPath, GridPlanner, PlanError, SearchStatistics, check};
use crate::nav::grid::queue::BucketQueue;
use crate::world::{BitGrid, GridCell};

/// Paths through a quadtree's free leaves, pulled straight (book, section 10.5).
///
/// The search is A\* over points on the parts of edges that neighbouring leaves share: their middles, and the ends of
/// long ones. What it finds is then pulled straight within the leaves that it goes through, and cut short wherever a later
/// point is in sight. Paths may be a little longer than the shortest: on published maps by 0.1 to 0.6 % in the mean.
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
    components: Components,
    field: Field,
    portals: Portals,
    labels: Vec<Label>,
    query: u32,
    queue: BucketQueue,
}

/// What is known about a point of a portal.
#[derive(Debug, Clone, Copy, Default)]
struct Label {
    cost: f64,
    parent: u32,
    /// The leaf that the way to it goes through last.
    leaf: u32,
    query: u32,
}

/// The points of a portal: its ends, if it is longer than so many cells, and its middle.
const POINTS: u32 = 3;
const MIDDLE: u32 = 2;
const LONG: i32 = 8;
const START: u32 = u32::MAX;

struct Query {
    goal: HalfPoint,
    goal_leaf: u32,
    best: f64,
    last: u32,
    statistics: SearchStatistics,
}

impl QuadtreePlanner {
    /// Plans in the free leaves of a quadtree.
    pub fn new(tree: &Quadtree) -> Self {
        let (grid, portals) = (tree.grid(), Portals::new(tree));
        Self {
            components: Components::new(&grid),
            field: Field::new(&grid),
            labels: vec![Label::default(); portals.all.len() * POINTS as usize],
            tree: tree.clone(),
            grid,
            portals,
            query: 0,
            queue: BucketQueue::default(),
        }
    }

    /// How many free leaves there are.
    pub fn leaves(&self) -> usize {
        self.portals.leaves.len()
    }

    fn begin(&mut self) {
        if self.query == u32::MAX {
            self.labels.fill(Label::default());
            self.query = 0;
        }
        self.query += 1;
    }

    fn point(&self, node: u32) -> HalfPoint {
        let [a, b] = self.portals.all[(node / POINTS) as usize].ends;
        match node % POINTS {
            0 => HalfPoint::corner(a.0, a.1),
            1 => HalfPoint::corner(b.0, b.1),
            _ => HalfPoint { x: a.0 + b.0, y: a.1 + b.1 },
        }
    }

    fn leaf_of(&self, cell: GridCell) -> Option<u32> {
        self.tree.leaf_at(cell).map(|leaf| self.portals.number_of(leaf))
    }

    fn search(&mut self, start: HalfPoint, start_leaf: u32, query: &mut Query) {
        self.begin();
        self.queue.start(fixed(distance(start, query.goal)));
        self.spread(query, start, start_leaf, 0.0, START);
        while let Some((node, bits)) = self.queue.pop_below(limit(query.best)) {
            let label = self.labels[node as usize];
            let point = self.point(node);
            if label.cost.to_bits() != bits || label.cost + distance(point, query.goal) >= query.best {
                continue;
            }
            query.statistics.expanded += 1;
            let [a, b] = self.portals.all[(node / POINTS) as usize].leaves;
            let leaf = if label.leaf == a { b } else { a };
            if leaf == query.goal_leaf {
                (query.best, query.last) = (label.cost + distance(point, query.goal), node);
                continue;
            }
            self.spread(query, point, leaf, label.cost, node);
        }
    }

    /// Goes from a point to all portals of a leaf.
    fn spread(&mut self, query: &mut Query, from: HalfPoint, leaf: u32, cost: f64, parent: u32) {
        for index in 0..self.portals.of(leaf).len() {
            let number = self.portals.of(leaf)[index];
            if parent != START && number == parent / POINTS {
                continue;
            }
            let [a, b] = self.portals.all[number as usize].ends;
            let is_long = (b.0 - a.0) + (b.1 - a.1) > LONG;
            for point in if is_long { 0..POINTS } else { MIDDLE..POINTS } {
                let node = number * POINTS + point;
                let at = self.point(node);
                let label = &mut self.labels[node as usize];
                let total = cost + distance(from, at);
                if label.query == self.query && label.cost <= total {
                    continue;
                }
                let sum = total + distance(at, query.goal);
                if sum >= query.best {
                    continue;
                }
                *label = Label { cost: total, parent, leaf, query: self.query };
                query.statistics.generated += 1;
                self.queue.push(fixed(sum), node, total.to_bits());
            }
        }
    }

    /// The portals that the way goes through, each by its left end and its right end.
    fn openings(&self, last: u32) -> Vec<(HalfPoint, HalfPoint)> {
        let mut openings = Vec::new();
        let mut node = last;
        while node != START {
            let label = self.labels[node as usize];
            let portal = self.portals.all[(node / POINTS) as usize];
            let [a, b] = portal.ends.map(|(x, y)| HalfPoint::corner(x, y));
            // To the right through an upright opening its upper end is on the left; downwards through a level one
            // its right end is.
            let upright = a.x == b.x;
            let forward = label.leaf == portal.leaves[0];
            openings.push(if upright == forward { (a, b) } else { (b, a) });
            node = label.parent;
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
