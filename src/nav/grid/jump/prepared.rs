use super::planes::{Direction, Landing, Planes};
use super::search::{Arrival, Jumps, Search};
use crate::nav::grid::components::GridComponents;
use crate::nav::grid::path::{GridPath, GridPlanner, PlanError, check};
use crate::world::{BitGrid, GridCell};

/// Jump point search with precomputed jumps: the shortest octile paths on a static map.
///
/// The map's jump points are the nodes of a graph, and the useful jumps from them its edges, stored
/// contiguously. A query scans from its start and follows edges after that; each node checks whether it sees
/// the goal.
///
/// D. Harabor, A. Grastien, *Improving Jump Point Search*, ICAPS 2014 (JPS+). Preparation time is
/// proportional to the number of jump points and the lengths of the diagonals from them; memory is 32 bytes
/// per jump point plus 12 bytes per jump.
///
/// ```
/// use roverlab::nav::grid::{GridPlanner, PreparedJumps};
/// use roverlab::world::{BitGrid, GridCell};
/// let grid = BitGrid::from_text("....\n.##.\n....")?;
/// let mut planner = PreparedJumps::new(&grid);
/// let path = planner.plan(GridCell::new(0, 1), GridCell::new(3, 1)).unwrap();
/// assert_eq!(path.cost, 5.0);
/// # Ok::<(), roverlab::world::BitGridError>(())
/// ```
#[derive(Debug, Clone)]
pub struct PreparedJumps {
    grid: BitGrid,
    components: GridComponents,
    planes: Planes,
    graph: Graph,
    search: Search,
}

#[derive(Debug, Clone, Default)]
struct Graph {
    /// Jump points as bits, row by row including the border, and the number of them before each word.
    points: Vec<u64>,
    before: Vec<u32>,
    stride: usize,
    nodes: Vec<Node>,
    edges: Vec<Edge>,
}

#[derive(Debug, Clone, Copy, Default)]
struct Node {
    /// First edge, and the ends of the edges in each direction relative to it.
    first: u32,
    ends: [u16; 8],
    /// Directions to continue in after an arrival from south, west, north and east.
    onward: [u8; 4],
}

/// End of a jump; the direction of arrival is in the lowest two bits of the node.
#[derive(Debug, Clone, Copy)]
struct Edge {
    node: u32,
    x: u32,
    y: u32,
}

impl PreparedJumps {
    /// Prepares a map.
    pub fn new(grid: &BitGrid) -> Self {
        let planes = Planes::new(grid);
        let graph = Graph::new(grid, &planes);
        let components = GridComponents::new(grid);
        Self { grid: grid.clone(), components, planes, graph, search: Search::default() }
    }

    /// Number of jump points of the map.
    pub fn jump_points(&self) -> usize {
        self.graph.nodes.len()
    }

    /// Number of jumps between them.
    pub fn jumps(&self) -> usize {
        self.graph.edges.len()
    }
}

impl Graph {
    fn new(grid: &BitGrid, planes: &Planes) -> Self {
        let stride = (grid.width() + 2).div_ceil(64);
        let mut graph = Self { stride, points: vec![0; stride], ..Self::default() };
        for y in 1..=grid.height() {
            graph.points.extend(planes.jump_points(y, grid.height()));
        }
        let mut count = 0;
        for word in &graph.points {
            graph.before.push(count);
            count += word.count_ones();
        }
        graph.connect(planes);
        graph
    }

    fn connect(&mut self, planes: &Planes) {
        for index in 0..self.points.len() {
            let mut rest = self.points[index];
            while rest != 0 {
                let (x, y) = (index % self.stride * 64 + rest.trailing_zeros() as usize, index / self.stride);
                rest &= rest - 1;
                let node = self.node(planes, x, y);
                self.nodes.push(node);
            }
        }
    }

    fn node(&mut self, planes: &Planes, x: usize, y: usize) -> Node {
        let onward = [0, 2, 4, 6].map(|direction| planes.onward(Landing { x, y, direction }));
        // An arrival that only continues straight on makes no jump point.
        let all = onward.iter().filter(|mask| mask.count_ones() > 1).fold(0, |all, mask| all | mask);
        let first = self.edges.len() as u32;
        let mut ends = [0; 8];
        for (direction, end) in ends.iter_mut().enumerate() {
            if all >> direction & 1 != 0 {
                planes.jumps(x, y, 1 << direction, |at| {
                    let edge = self.edge(at);
                    self.edges.push(edge);
                });
            }
            *end = (self.edges.len() as u32 - first) as u16;
        }
        Node { first, ends, onward }
    }

    fn edge(&self, at: Landing) -> Edge {
        Edge { node: self.number(at) << 2 | (at.direction / 2) as u32, x: at.x as u32, y: at.y as u32 }
    }

    /// Number of the jump point at a landing.
    fn number(&self, at: Landing) -> u32 {
        let index = at.y * self.stride + at.x / 64;
        let below = self.points[index] & ((1 << (at.x % 64)) - 1);
        self.before[index] + below.count_ones()
    }
}

/// Jumps, scanned from the start and looked up after that.
struct Prepared<'a> {
    planes: &'a Planes,
    graph: &'a Graph,
}

impl Jumps for Prepared<'_> {
    fn count(&self) -> usize {
        self.graph.nodes.len()
    }

    fn leave_start(&self, x: usize, y: usize, mut land: impl FnMut(Arrival)) {
        self.planes.jumps(x, y, u8::MAX, |at| land(Arrival { node: self.graph.number(at), at }));
    }

    #[inline]
    fn leave_node(&self, node: u32, at: Landing, mut land: impl FnMut(Arrival)) {
        let node = &self.graph.nodes[node as usize];
        let mut directions = node.onward[at.direction / 2];
        while directions != 0 {
            // Edges of adjacent directions are contiguous.
            let low = directions.trailing_zeros() as usize;
            let high = low + (directions >> low).trailing_ones() as usize;
            directions = (u16::from(directions) >> high << high) as u8;
            let begin = if low == 0 { 0 } else { node.ends[low - 1] };
            let edges = node.first as usize + usize::from(begin)
                ..node.first as usize + usize::from(node.ends[high - 1]);
            for edge in &self.graph.edges[edges] {
                let direction: Direction = (edge.node as usize & 3) * 2;
                let at = Landing { x: edge.x as usize, y: edge.y as usize, direction };
                land(Arrival { node: edge.node >> 2, at });
            }
        }
    }
}

impl GridPlanner for PreparedJumps {
    fn plan(&mut self, start: GridCell, goal: GridCell) -> Result<GridPath, PlanError> {
        check(&self.grid, &self.components, start, goal)?;
        let jumps = Prepared { planes: &self.planes, graph: &self.graph };
        let (turns, statistics) = self.search.run(&self.planes, &jumps, start, goal);
        Ok(GridPath::through(&turns, statistics))
    }
}
