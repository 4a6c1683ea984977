use petgraph::graph::{NodeIndex, UnGraph};

use super::{Cell, Direction, Maze, Unknown};

/// A maze as a `petgraph` graph: a node for each cell, row by row from the south west, and an edge for each
/// opening between two cells.
///
/// ```
/// use roverlab::maze::{Maze, Unknown, petgraph_of_maze};
/// let graph = petgraph_of_maze(&Maze::open(3, 2)?, Unknown::Closed);
/// assert_eq!((graph.node_count(), graph.edge_count()), (6, 7));
/// # Ok::<(), roverlab::ParameterError>(())
/// ```
pub fn petgraph_of_maze(maze: &Maze, unknown: Unknown) -> UnGraph<Cell, ()> {
    let mut graph = UnGraph::default();
    for cell in maze.cells() {
        graph.add_node(cell);
    }
    let node = |cell: Cell| NodeIndex::new(usize::from(cell.y) * maze.width() + usize::from(cell.x));
    for cell in maze.cells() {
        for direction in [Direction::East, Direction::North] {
            if let Some(beyond) = maze.passage(cell, direction, unknown) {
                graph.add_edge(node(cell), node(beyond), ());
            }
        }
    }
    graph
}
