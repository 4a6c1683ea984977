use super::online::Cells;
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
/// On large open floors with many single obstacles there are so many jumps that storing them takes long and
/// gains little. There this planner scans during the search, as [`JumpPointSearch`](super::JumpPointSearch)
/// does ([`is_prepared`](Self::is_prepared)).
///
/// D. Harabor, A. Grastien, *Improving Jump Point Search*, ICAPS 2014 (JPS+). Preparation time is
/// proportional to the number of jump points and the lengths of the diagonals from them, at most 100 million
/// scans; memory is 32 bytes per jump point plus 12 bytes per jump, at most 8 million jumps.
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
    cells: Cells,
    /// Jumps between the jump points; `None` if there are too many.
    graph: Option<Graph>,
    search: Search,
}

/// Maximum number of stored jumps: about 100 MB.
const MOST_JUMPS: usize = 8_000_000;
/// Maximum number of scans to find them: about a second.
const MOST_SCANS: usize = 100_000_000;

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
        let cells = Cells::new(grid);
        let graph = Graph::new(grid, &cells.planes);
        let components = GridComponents::new(grid);
        Self { grid: grid.clone(), components, cells, graph, search: Search::default() }
    }

    /// Whether jumps are stored, rather than scanned for during each search.
    pub fn is_prepared(&self) -> bool {
        self.graph.is_some()
    }

    /// Number of stored jump points.
    pub fn jump_points(&self) -> usize {
        self.graph.as_ref().map_or(0, |graph| graph.nodes.len())
    }

    /// Number of stored jumps between them.
    pub fn jumps(&self) -> usize {
        self.graph.as_ref().map_or(0, |graph| graph.edges.len())
    }
}

impl Graph {
    /// The jumps of a map; `None` if there are too many.
    fn new(grid: &BitGrid, planes: &Planes) -> Option<Self> {
        let stride = (grid.width() + 2).div_ceil(64);
        let mut graph = Self { stride, points: vec![0; stride], ..Self::default() };
        for y in 1..=grid.height() {
            graph.points.extend(planes.jump_points(y));
        }
        let mut count = 0;
        for word in &graph.points {
            graph.before.push(count);
            count += word.count_ones();
        }
        graph.connect(planes)?;
        Some(graph)
    }

    /// Finds the jumps of a map; `None` if there are too many.
    fn connect(&mut self, planes: &Planes) -> Option<()> {
        let mut scans = 0;
        for index in 0..self.points.len() {
            let mut rest = self.points[index];
            while rest != 0 {
                let (x, y) = (index % self.stride * 64 + rest.trailing_zeros() as usize, index / self.stride);
                rest &= rest - 1;
                let node = self.node(planes, x, y, &mut scans)?;
                self.nodes.push(node);
            }
            if self.edges.len() > MOST_JUMPS || scans > MOST_SCANS {
                return None;
            }
        }
        Some(())
    }

    /// The node of a jump point; `None` if it has more jumps than its counters hold.
    fn node(&mut self, planes: &Planes, x: usize, y: usize, scans: &mut usize) -> Option<Node> {
        let before = [(x, y + 1), (x - 1, y), (x, y - 1), (x + 1, y)];
        let onward = [0, 1, 2, 3].map(|way| {
            let arrives = planes.is_free(before[way].0, before[way].1);
            if arrives { planes.onward(Landing { x, y, direction: 2 * way }) } else { 0 }
        });
        // An arrival that only continues straight on makes no jump point.
        let all = onward.iter().filter(|mask| mask.count_ones() > 1).fold(0, |all, mask| all | mask);
        let first = self.edges.len() as u32;
        let mut ends = [0; 8];
        for (direction, end) in ends.iter_mut().enumerate() {
            if all >> direction & 1 != 0 {
                *scans += planes.jumps(x, y, 1 << direction, |at| {
                    let edge = self.edge(at);
                    self.edges.push(edge);
                });
            }
            *end = u16::try_from(self.edges.len() as u32 - first).ok()?;
        }
        Some(Node { first, ends, onward })
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
        let Self { cells, search, .. } = self;
        let (turns, statistics) = match &self.graph {
            Some(graph) => {
                let jumps = Prepared { planes: &cells.planes, graph };
                search.run(&cells.planes, &jumps, start, goal)
            }
            None => search.run(&cells.planes, &*cells, start, goal),
        };
        Ok(GridPath::through(&turns, statistics))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Corridors one cell wide, which cross at every second cell, with some walls.
    fn corridors() -> BitGrid {
        BitGrid::from_fn(41, 41, |x, y| (x % 2 == 1 || y % 2 == 1) && (3 * x + 5 * y) % 7 != 0).unwrap()
    }

    #[test]
    fn what_is_not_stored_is_scanned_for() {
        let grid = corridors();
        let mut prepared = PreparedJumps::new(&grid);
        assert!(prepared.is_prepared());
        let mut unprepared = PreparedJumps { graph: None, ..prepared.clone() };
        assert_eq!((unprepared.is_prepared(), unprepared.jump_points(), unprepared.jumps()), (false, 0, 0));
        let start = GridCell::new(1, 1);
        for goal in grid.free_cells() {
            let cost = |path: Result<GridPath, PlanError>| path.map(|path| path.cost);
            assert_eq!(cost(prepared.plan(start, goal)), cost(unprepared.plan(start, goal)), "{goal}");
        }
    }

    /// A cell beside a corner is a jump point only for those that can arrive past the corner.
    #[test]
    fn corridors_have_jump_points_where_they_meet_and_nowhere_else() {
        let cross = BitGrid::from_text("##.##\n##.##\n.....\n##.##\n##.##").unwrap();
        assert_eq!(PreparedJumps::new(&cross).jump_points(), 1);
        let bend = BitGrid::from_text("###.\n###.\n....").unwrap();
        assert_eq!(PreparedJumps::new(&bend).jump_points(), 1);
    }
}
