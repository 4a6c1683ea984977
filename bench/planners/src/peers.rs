//! The peers, each at its best settings that we know of.

use glam::Vec2;
use grid_pathfinding::PathingGrid;
use grid_util::grid::ValueGrid;
use grid_util::point::Point;
use petgraph::graph::{NodeIndex, UnGraph};
use roverlab::world::{BitGrid, GridCell};

use crate::Answer;
use crate::mesh;

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

/// Steps from a cell, into an array on the stack.
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

/// `pathfinding::prelude::astar` over pairs of small numbers.
pub struct Pathfinding(BitGrid);

impl Pathfinding {
    pub fn new(grid: &BitGrid) -> Self {
        Self(grid.clone())
    }
}

impl From<Pathfinding> for Answer<'static> {
    fn from(Pathfinding(grid): Pathfinding) -> Self {
        Box::new(move |start, goal| {
            let (start, goal) = (small(start), small(goal));
            let path = pathfinding::prelude::astar(
                &start,
                |&cell| steps(&grid, cell).collect::<Vec<_>>(),
                |&cell| octile(cell, goal),
                |&cell| cell == goal,
            );
            path.map_or(f64::NAN, |path| cells(path.1))
        })
    }
}

/// `petgraph::algo::astar` over a graph that is built beforehand.
pub struct Petgraph {
    graph: UnGraph<(u16, u16), u32, u32>,
    width: usize,
    nodes: Vec<NodeIndex<u32>>,
}

impl Petgraph {
    pub fn new(grid: &BitGrid) -> Self {
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
}

impl From<Petgraph> for Answer<'static> {
    fn from(this: Petgraph) -> Self {
        Box::new(move |start, goal| {
            let node = |cell: GridCell| this.nodes[cell.row * this.width + cell.column];
            let last = node(goal);
            let path = petgraph::algo::astar(
                &this.graph,
                node(start),
                |node| node == last,
                |edge| *edge.weight(),
                |node| octile(this.graph[node], small(goal)),
            );
            path.map_or(f64::NAN, |path| cells(path.0))
        })
    }
}

/// `grid_pathfinding`: turning points alone. It cuts corners.
pub struct GridPathfinding(PathingGrid);

impl GridPathfinding {
    pub fn new(grid: &BitGrid) -> Self {
        let mut peer = PathingGrid::new(grid.width(), grid.height(), true);
        for cell in grid.free_cells() {
            peer.set(cell.column as i32, cell.row as i32, false);
        }
        peer.generate_components();
        Self(peer)
    }
}

impl From<GridPathfinding> for Answer<'static> {
    fn from(GridPathfinding(grid): GridPathfinding) -> Self {
        Box::new(move |start, goal| {
            let point = |cell: GridCell| Point::new(cell.column as i32, cell.row as i32);
            let turns = grid.get_waypoints_single_goal(point(start), point(goal), false).unwrap_or_default();
            let length = |pair: &[Point]| {
                let (dx, dy) = (f64::from((pair[0].x - pair[1].x).abs()), f64::from((pair[0].y - pair[1].y).abs()));
                (dx - dy).abs() + dx.min(dy) * std::f64::consts::SQRT_2
            };
            turns.windows(2).map(length).sum()
        })
    }
}

/// `polyanya` over a mesh of rectangles.
pub struct Polyanya {
    mesh: polyanya::Mesh,
    height: usize,
}

impl Polyanya {
    pub fn new(grid: &BitGrid) -> Self {
        Self { mesh: mesh::of_rectangles(grid), height: grid.height() }
    }
}

impl From<Polyanya> for Answer<'static> {
    fn from(this: Polyanya) -> Self {
        Box::new(move |start, goal| {
            let point = |cell: GridCell| {
                Vec2::new(cell.column as f32 + 0.5, (this.height - cell.row) as f32 - 0.5)
            };
            this.mesh.path(point(start), point(goal)).map_or(f64::NAN, |path| f64::from(path.length))
        })
    }
}
