//! The peers, each at its best settings that we know of.

use glam::Vec2;
use grid_pathfinding::PathingGrid;
use grid_util::grid::ValueGrid;
use grid_util::point::Point;
use petgraph::graph::{NodeIndex, UnGraph};
use roverlab::world::{BitGrid, GridCell};

use crate::mesh;
use crate::table::Answer;

/// Steps as whole numbers, in the ratio of 1 to the square root of 2 to eight digits.
const STRAIGHT: u32 = 5741;
const DIAGONAL: u32 = 8119;

fn octile(a: (u16, u16), b: (u16, u16)) -> u32 {
    let (dx, dy) = (u32::from(a.0.abs_diff(b.0)), u32::from(a.1.abs_diff(b.1)));
    STRAIGHT * (dx.max(dy) - dx.min(dy)) + DIAGONAL * dx.min(dy)
}

fn cells(cost: u32) -> f64 {
    f64::from(cost) / f64::from(STRAIGHT)
}

/// Steps from a cell, without memory from the heap.
fn steps(grid: &BitGrid, (x, y): (u16, u16)) -> impl Iterator<Item = ((u16, u16), u32)> {
    let free = |dx: i32, dy: i32| {
        let (x, y) = (i32::from(x) + dx, i32::from(y) + dy);
        x >= 0 && y >= 0 && grid.is_free(GridCell::new(x as usize, y as usize))
    };
    let [east, south, west, north] = [free(1, 0), free(0, 1), free(-1, 0), free(0, -1)];
    let at = |dx: i32, dy: i32| ((i32::from(x) + dx) as u16, (i32::from(y) + dy) as u16);
    let step = |open: bool, dx, dy, cost| open.then(|| (at(dx, dy), cost));
    [
        step(east, 1, 0, STRAIGHT),
        step(south, 0, 1, STRAIGHT),
        step(west, -1, 0, STRAIGHT),
        step(north, 0, -1, STRAIGHT),
        step(east && south && free(1, 1), 1, 1, DIAGONAL),
        step(west && south && free(-1, 1), -1, 1, DIAGONAL),
        step(west && north && free(-1, -1), -1, -1, DIAGONAL),
        step(east && north && free(1, -1), 1, -1, DIAGONAL),
    ]
    .into_iter()
    .flatten()
}

fn small(cell: GridCell) -> (u16, u16) {
    (cell.column as u16, cell.row as u16)
}

/// `pathfinding::prelude::astar`. Its table of nodes is hashed, so that a node is one small number.
#[derive(Debug)]
pub(crate) struct Pathfinding(BitGrid);

impl Pathfinding {
    pub(crate) fn new(grid: &BitGrid) -> Self {
        Self(grid.clone())
    }

    pub(crate) fn answer(self) -> Answer {
        let pack = |(x, y): (u16, u16)| u32::from(y) << 16 | u32::from(x);
        let unpack = |node: u32| (node as u16, (node >> 16) as u16);
        Box::new(move |start, goal| {
            let last = small(goal);
            let path = pathfinding::prelude::astar(
                &pack(small(start)),
                |&node| steps(&self.0, unpack(node)).map(|(next, cost)| (pack(next), cost)),
                |&node| octile(unpack(node), last),
                |&node| node == pack(last),
            );
            path.map(|path| cells(path.1))
        })
    }
}

/// `petgraph::algo::astar` over a graph that is built beforehand.
#[derive(Debug)]
pub(crate) struct Petgraph {
    graph: UnGraph<(u16, u16), u32, u32>,
    width: usize,
    nodes: Vec<NodeIndex<u32>>,
}

impl Petgraph {
    pub(crate) fn new(grid: &BitGrid) -> Self {
        let mut graph = UnGraph::default();
        let mut nodes = vec![NodeIndex::end(); grid.width() * grid.height()];
        for cell in grid.free_cells() {
            nodes[cell.row * grid.width() + cell.column] = graph.add_node(small(cell));
        }
        for cell in grid.free_cells() {
            let from = nodes[cell.row * grid.width() + cell.column];
            for ((x, y), cost) in steps(grid, small(cell)) {
                let to = nodes[usize::from(y) * grid.width() + usize::from(x)];
                if from < to {
                    graph.add_edge(from, to, cost);
                }
            }
        }
        Self { graph, width: grid.width(), nodes }
    }

    pub(crate) fn answer(self) -> Answer {
        Box::new(move |start, goal| {
            let node = |cell: GridCell| self.nodes[cell.row * self.width + cell.column];
            let last = node(goal);
            let path = petgraph::algo::astar(
                &self.graph,
                node(start),
                |node| node == last,
                |edge| *edge.weight(),
                |node| octile(self.graph[node], small(goal)),
            );
            path.map(|path| cells(path.0))
        })
    }
}

/// `grid_pathfinding`, its turning points alone. It cuts corners, which is an easier rule, and offers two
/// ways of pruning.
#[derive(Debug)]
pub(crate) struct GridPathfinding(PathingGrid);

impl GridPathfinding {
    pub(crate) fn new(grid: &BitGrid, improved_pruning: bool) -> Self {
        let mut peer = PathingGrid::new(grid.width(), grid.height(), true);
        for cell in grid.free_cells() {
            peer.grid.set(cell.column as i32, cell.row as i32, false);
        }
        peer.improved_pruning = improved_pruning;
        peer.initialize();
        peer.generate_components();
        Self(peer)
    }

    pub(crate) fn answer(self) -> Answer {
        Box::new(move |start, goal| {
            let point = |cell: GridCell| Point::new(cell.column as i32, cell.row as i32);
            let turns = self.0.get_waypoints_single_goal(point(start), point(goal), false)?;
            let length = |pair: &[Point]| {
                let (dx, dy) =
                    (f64::from(pair[0].x - pair[1].x).abs(), f64::from(pair[0].y - pair[1].y).abs());
                (dx - dy).abs() + dx.min(dy) * std::f64::consts::SQRT_2
            };
            Some(turns.windows(2).map(length).sum())
        })
    }
}

/// `polyanya` over a mesh of rectangles.
#[derive(Debug)]
pub(crate) struct Polyanya {
    mesh: polyanya::Mesh,
    height: usize,
}

impl Polyanya {
    pub(crate) fn new(grid: &BitGrid) -> Self {
        Self { mesh: mesh::of_rectangles(grid), height: grid.height() }
    }

    pub(crate) fn answer(self) -> Answer {
        Box::new(move |start, goal| {
            let point =
                |cell: GridCell| Vec2::new(cell.column as f32 + 0.5, (self.height - cell.row) as f32 - 0.5);
            self.mesh.path(point(start), point(goal)).map(|path| f64::from(path.length))
        })
    }
}
