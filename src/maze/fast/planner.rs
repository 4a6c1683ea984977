use super::bound::Bounds;
use super::builder::Builder;
use super::limits::{Repertoire, RunLimits};
use super::plan::FastPlan;
use super::search::{Grid, Node, Tables};
use super::turn::TurnKind;
use crate::ParameterError;
use crate::maze::{Cell, Direction, FloodFill, Maze, Passages, Scale, Unknown};

/// Plans time-optimal runs.
///
/// A run consists of straights along rows, columns and diagonals, of smooth turns between them
/// ([`TurnKind`]), each with a fixed shape and speed, and of turns on the spot in cell centres. It starts and
/// ends at rest in a cell centre. The planner finds the fastest such run by A* over the ends of turns; every
/// straight is driven with full acceleration, top speed and full braking. The heuristic is the minimum time,
/// without walls, for the steps that flood fill counts to the goal.
///
/// # Complexity
///
/// For n cells there are at most 60 n ends of turns, each with as many successors as its straight passes
/// cells.
///
/// Times are in microseconds up to 4294 s; longer runs are not found.
///
/// ```
/// use roverlab::maze::{FastPlanner, Maze, RunLimits, Scale, Unknown};
///
/// let mut planner = FastPlanner::new(Scale::MICROMOUSE, RunLimits::MICROMOUSE)?;
/// let maze = Maze::open(16, 16).expect("a size within limits");
/// let plan = planner.plan(&maze, Unknown::Closed).expect("a way to the goal");
/// assert!(plan.time < 2.5 && plan.route.steps() >= 14);
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
#[derive(Debug, Clone)]
pub struct FastPlanner {
    repertoire: Repertoire,
    scale: Scale,
    tables: Tables,
    memory: Memory,
}

/// Buffers kept between searches.
#[derive(Debug, Clone)]
struct Memory {
    bounds: Bounds,
    grid: Grid,
    /// Steps from each cell to the goal.
    flood: FloodFill,
    /// Cost of each node (µs).
    costs: Vec<u32>,
    parents: Vec<Parent>,
    /// Costs and nodes, bucketed by the minimum time of a run through the node, in multiples of `width`.
    buckets: Vec<Vec<(u32, u32)>>,
    width: u32,
    /// Index of the bucket being processed.
    bucket: usize,
    touched: Vec<u32>,
}

/// Predecessor of a node, and number of cells or edges that the straight between passes.
#[derive(Debug, Clone, Copy, Default)]
struct Parent {
    node: u32,
    count: u16,
}

/// Predecessor of the start.
const NO_PARENT: u32 = u32::MAX;
/// Number of buckets for the duration of the shortest turn.
const BUCKETS_PER_TURN: u32 = 8;

/// Best arrival at a goal so far.
#[derive(Debug, Clone, Copy)]
struct Arrival {
    cost: u32,
    node: u32,
    count: u16,
}

impl FastPlanner {
    /// A planner for one robot in mazes of one scale.
    ///
    /// # Errors
    ///
    /// If a limit or the cell size is out of range.
    pub fn new(scale: Scale, limits: RunLimits) -> Result<Self, ParameterError> {
        let repertoire = Repertoire::new(scale, limits)?;
        let tables = Tables::new(&repertoire);
        let memory = Memory::new(&tables);
        Ok(Self { repertoire, scale, tables, memory })
    }

    /// The same planner without heuristic.
    #[cfg(test)]
    pub(super) fn unled(mut self) -> Self {
        self.memory.bounds = Bounds::none();
        self
    }

    /// The fastest run from the start to the goal, with `unknown` for unknown walls; `None` if the goal is
    /// unreachable.
    pub fn plan(&mut self, maze: &Maze, unknown: Unknown) -> Option<FastPlan> {
        self.plan_from(maze, unknown, (maze.start(), maze.heading()), |cell| maze.is_goal(cell))
    }

    /// The fastest run from a cell and heading to any cell that satisfies `goal`.
    pub fn plan_from(
        &mut self,
        maze: &Maze,
        unknown: Unknown,
        start: (Cell, Direction),
        goal: impl Fn(Cell) -> bool,
    ) -> Option<FastPlan> {
        if !maze.contains(start.0) {
            return None;
        }
        self.memory.prepare(maze, unknown, &goal);
        let arrival = self.search(start, &goal)?;
        Some(self.trace(start, arrival))
    }

    fn search(
        &mut self,
        (cell, heading): (Cell, Direction),
        goal: &impl Fn(Cell) -> bool,
    ) -> Option<Arrival> {
        let (tables, memory) = (&self.tables, &mut self.memory);
        let first = memory.grid.index(cell);
        memory.flood.distances().get(cell)?;
        for direction in Direction::ALL {
            let cost = tables.pivots[heading.quarters_to(direction)];
            memory.reach(cost, Node::row(first, direction, None), NO_PARENT, 0);
        }
        let mut best: Option<Arrival> = None;
        while memory.bucket < memory.buckets.len() {
            // No remaining run is faster than the lower end of its bucket.
            if best.is_some_and(|best| best.cost / memory.width < memory.bucket as u32) {
                break;
            }
            // The bucket may grow while it is processed.
            let mut open = std::mem::take(&mut memory.buckets[memory.bucket]);
            for &(cost, id) in &open {
                if memory.costs[id as usize] != cost {
                    continue;
                }
                let node = Node::from_id(id);
                if node.is_diagonal() {
                    memory.expand_diagonal(tables, cost, node);
                } else {
                    memory.expand_row(tables, cost, node, goal, &mut best);
                }
            }
            open.clear();
            let refilled = &mut memory.buckets[memory.bucket];
            if refilled.is_empty() {
                *refilled = open;
                memory.bucket += 1;
            }
        }
        memory.clear_buckets();
        best
    }

    fn trace(&self, start: (Cell, Direction), arrival: Arrival) -> FastPlan {
        let mut hops = vec![(arrival.node, arrival.count, None)];
        let mut id = arrival.node;
        loop {
            let parent = self.memory.parents[id as usize];
            if parent.node == NO_PARENT {
                break;
            }
            hops.push((parent.node, parent.count, Some(Node::from_id(id))));
            id = parent.node;
        }
        hops.reverse();
        let mut builder = Builder::new(&self.repertoire, self.scale, start);
        builder.face(Node::from_id(id).heading().0);
        for (from, count, to) in hops {
            let to = to.map(|to| (to, self.memory.grid.cell(to.cell())));
            builder.hop(Node::from_id(from), count, to);
        }
        builder.finish()
    }
}

impl Memory {
    fn new(tables: &Tables) -> Self {
        Self {
            bounds: Bounds::new(tables),
            grid: Grid::default(),
            flood: FloodFill::default(),
            costs: Vec::new(),
            parents: Vec::new(),
            buckets: Vec::new(),
            width: (tables.shortest / BUCKETS_PER_TURN).max(1),
            bucket: 0,
            touched: Vec::new(),
        }
    }

    fn prepare(&mut self, maze: &Maze, unknown: Unknown, goal: &impl Fn(Cell) -> bool) {
        self.grid.read(maze, unknown);
        self.flood.run(&Passages::new(maze, unknown), maze.cells().filter(|&cell| goal(cell)));
        let nodes = Node::count(maze.cell_count());
        if self.costs.len() == nodes {
            for id in self.touched.drain(..) {
                self.costs[id as usize] = u32::MAX;
            }
        } else {
            self.costs.clear();
            self.costs.resize(nodes, u32::MAX);
            self.parents.resize(nodes, Parent::default());
            self.touched.clear();
        }
    }

    fn clear_buckets(&mut self) {
        self.buckets.iter_mut().for_each(Vec::clear);
        self.bucket = 0;
    }

    #[inline]
    fn reach(&mut self, cost: u32, node: Node, parent: u32, count: u16) {
        let id = node.id();
        let known = &mut self.costs[id as usize];
        if cost >= *known {
            return;
        }
        if *known == u32::MAX {
            self.touched.push(id);
        }
        *known = cost;
        self.parents[id as usize] = Parent { node: parent, count };
        let steps = self.flood.distances().as_slice()[node.cell() as usize];
        let least = cost.saturating_add(self.bounds.get(steps, node.end()));
        // Rounding may reduce the bound by a microsecond.
        let bucket = ((least / self.width) as usize).max(self.bucket);
        if bucket >= self.buckets.len() {
            self.buckets.resize(bucket + 1, Vec::new());
        }
        self.buckets[bucket].push((cost, id));
    }

    /// All continuations from the end of a turn into a row or column.
    fn expand_row(
        &mut self,
        tables: &Tables,
        cost: u32,
        node: Node,
        goal: &impl Fn(Cell) -> bool,
        best: &mut Option<Arrival>,
    ) {
        let (heading, id) = (node.heading().0, node.id());
        let times = tables.row(node.kind());
        let mut index = node.cell();
        for count in 0..tables.reach() as u16 {
            let time = &times[usize::from(count)];
            if goal(self.grid.cell(index)) {
                let cost = cost.saturating_add(time.stop);
                if time.stop != u32::MAX && best.is_none_or(|best| cost < best.cost) {
                    *best = Some(Arrival { cost, node: id, count });
                }
            }
            let ahead = self.grid.next(index, heading);
            for side in [heading.left(), heading.right()] {
                if let Some(beside) = self.grid.next(index, side) {
                    let on = |kind| Node::row(index, side, kind);
                    if count > 0 || node.kind().is_some() {
                        self.extend(cost, time.pivot, on(None), id, count);
                    }
                    self.extend(cost, time.short, on(Some(TurnKind::Short90)), id, count);
                    self.extend(cost, time.wide, on(Some(TurnKind::Wide90)), id, count);
                    let back = heading.opposite();
                    if self.grid.is_open(beside, back) {
                        let turned = Node::row(beside, back, Some(TurnKind::UTurn));
                        self.extend(cost, time.u_turn, turned, id, count);
                        let into = Node::diagonal(index, side, back, TurnKind::In135);
                        self.extend(cost, time.in_135, into, id, count);
                    }
                }
                if let Some(ahead) = ahead
                    && self.grid.is_open(ahead, side)
                {
                    let into = |kind| Node::diagonal(ahead, side, heading, kind);
                    self.extend(cost, time.in_45, into(TurnKind::In45), id, count);
                    self.extend(cost, time.tight_in_45, into(TurnKind::TightIn45), id, count);
                }
            }
            let Some(ahead) = ahead else { return };
            index = ahead;
        }
    }

    /// All continuations from the end of a turn into a diagonal.
    fn expand_diagonal(&mut self, tables: &Tables, cost: u32, node: Node) {
        let (id, (mut via, mut then)) = (node.id(), node.heading());
        let Some(kind) = node.kind() else { return };
        let times = tables.diagonal(kind);
        let mut index = node.cell();
        for count in 1..tables.reach() as u16 {
            // Across the edge to `via`, after one to `then`.
            let Some(beyond) = self.grid.next(index, via) else { return };
            let time = &times[usize::from(count)];
            let straight = |kind| Node::row(beyond, via, Some(kind));
            self.extend(cost, time.out_45, straight(TurnKind::Out45), id, count);
            self.extend(cost, time.tight_out_45, straight(TurnKind::TightOut45), id, count);
            let back = then.opposite();
            if self.grid.is_open(beyond, back) {
                let turned = Node::diagonal(beyond, back, via, TurnKind::Diagonal90);
                self.extend(cost, time.quarter, turned, id, count);
                let out = Node::row(beyond, back, Some(TurnKind::Out135));
                self.extend(cost, time.out_135, out, id, count);
            }
            index = beyond;
            (via, then) = (then, via);
        }
    }

    #[inline]
    fn extend(&mut self, cost: u32, more: u32, node: Node, parent: u32, count: u16) {
        if more != u32::MAX {
            self.reach(cost.saturating_add(more), node, parent, count);
        }
    }
}
