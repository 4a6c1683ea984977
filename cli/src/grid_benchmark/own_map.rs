use roverlab::nav::grid::{GridPlanner, GridSearch};
use roverlab::random::Stream;
use roverlab::world::formats::movingai::Query;
use roverlab::world::{BitGrid, GridCell};

/// Rooms per row, cells per room including one wall, and number of queries.
const ROOMS: usize = 16;
const ROOM: usize = 16;
const QUERIES: usize = 200;

/// A map of rooms with a door in most walls, and queries with Dijkstra's answers.
pub(crate) fn with_queries(seed: u64) -> (String, BitGrid, Vec<Query>) {
    let name = format!("rooms of seed {seed}");
    let mut stream = Stream::new(seed).child("rooms", 0);
    let grid = rooms(&mut stream);
    let cells: Vec<GridCell> = grid.free_cells().collect();
    let mut dijkstra = GridSearch::dijkstra(&grid);
    let mut queries = Vec::new();
    while queries.len() < QUERIES {
        let (start, goal) = (cells[stream.below(cells.len())], cells[stream.below(cells.len())]);
        if let Ok(path) = dijkstra.plan(start, goal) {
            let (width, height) = (grid.width(), grid.height());
            queries.push(Query {
                bucket: 0,
                map: name.clone(),
                width,
                height,
                start,
                goal,
                optimal: path.cost,
            });
        }
    }
    (name, grid, queries)
}

fn rooms(stream: &mut Stream) -> BitGrid {
    let size = ROOMS * ROOM + 1;
    let mut grid = BitGrid::blocked(size, size).expect("a map of moderate size");
    for row in 0..size {
        for column in 0..size {
            grid.set_free(GridCell::new(column, row), column % ROOM != 0 && row % ROOM != 0);
        }
    }
    for room in 0..ROOMS * ROOMS {
        let (x, y) = (room % ROOMS * ROOM, room / ROOMS * ROOM);
        let door = |stream: &mut Stream| 1 + stream.below(ROOM - 1);
        if x > 0 && stream.chance(0.8) {
            grid.set_free(GridCell::new(x, y + door(stream)), true);
        }
        if y > 0 && stream.chance(0.8) {
            grid.set_free(GridCell::new(x + door(stream), y), true);
        }
    }
    grid
}
