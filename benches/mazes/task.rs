//! Mazes in the forms that each way to fill them is fastest on.

use std::fs;
use std::hint::black_box;
use std::path::Path;

use roverlab::maze::generate::competition;
use roverlab::maze::{Cell, Direction, Distances, FloodFill, Maze, Passages, Unknown, files};
use roverlab_bench_c::{CELLS, Openings, SIDE, Walls, queue, sweep};

/// A way to fill a maze from its start.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Method {
    Sweep,
    CQueue,
    OwnQueue,
    Wave,
}

pub(crate) const METHODS: [Method; 4] = [Method::Sweep, Method::CQueue, Method::OwnQueue, Method::Wave];

impl Method {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Sweep => "the book's passes, in C",
            Self::CQueue => "a queue, in C",
            Self::OwnQueue => "our queue",
            Self::Wave => "our wave of bits",
        }
    }
}

/// A maze of 16 x 16 cells for all of them.
#[derive(Debug)]
pub(crate) struct Task {
    pub(crate) maze: Maze,
    walls: Walls,
    openings: Openings,
    listed: Passages,
    boards: Passages,
    start: usize,
    goal: usize,
}

impl Task {
    pub(crate) fn new(maze: Maze) -> Self {
        let steps = fill(&Passages::new(&maze, Unknown::Closed), maze.start());
        // The passes stop at the first cell of the goal that they come to.
        let goal = maze.goals().min_by_key(|&goal| steps.get(goal).unwrap_or(u32::MAX));
        let goal = goal.map_or(CELLS - 1, |goal| maze.index(goal));
        let start = maze.index(maze.start());
        let task = Self {
            walls: walls(&maze),
            openings: openings(&maze),
            listed: Passages::listed(&maze, Unknown::Closed),
            boards: Passages::new(&maze, Unknown::Closed),
            maze,
            start,
            goal,
        };
        task.check();
        task
    }

    /// All ways must find the same numbers of steps; the passes know those up to the goal.
    fn check(&self) {
        let own = fill(&self.boards, self.maze.start());
        assert_eq!(own, fill(&self.listed, self.maze.start()));
        let expected = own.as_slice().iter().map(|&steps| if steps == u32::MAX { -1 } else { steps as i32 });
        let expected: Vec<i32> = expected.collect();
        let mut found = [0; CELLS];
        queue(&self.openings, self.start, &mut found);
        assert_eq!(found[..], expected);
        sweep(&self.walls, self.start, self.goal, &mut found);
        assert_eq!(found[self.goal], expected[self.goal]);
        assert!(found.iter().zip(expected).all(|(&found, expected)| found == -1 || found == expected));
    }
}

fn fill(passages: &Passages, start: Cell) -> Distances {
    let mut flood = FloodFill::default();
    flood.run(passages, [start]);
    flood.into_distances()
}

/// What fills mazes by one of the methods.
pub(crate) fn filler(method: Method) -> Box<dyn FnMut(&Task)> {
    let mut found = [0; CELLS];
    let mut flood = FloodFill::default();
    match method {
        Method::Sweep => Box::new(move |task| {
            sweep(&task.walls, task.start, task.goal, &mut found);
            black_box(&mut found);
        }),
        Method::CQueue => Box::new(move |task| {
            queue(&task.openings, task.start, &mut found);
            black_box(&mut found);
        }),
        Method::OwnQueue => Box::new(move |task| {
            black_box(flood.run(&task.listed, [task.maze.start()]));
        }),
        Method::Wave => Box::new(move |task| {
            black_box(flood.run(&task.boards, [task.maze.start()]));
        }),
    }
}

fn walls(maze: &Maze) -> Walls {
    let mut walls = Walls { below: [[1; SIDE + 1]; SIDE + 1], left: [[1; SIDE + 1]; SIDE + 1] };
    for cell in maze.cells() {
        let (x, y) = (usize::from(cell.x), usize::from(cell.y));
        let stands = |side| i32::from(maze.passage(cell, side, Unknown::Closed).is_none());
        walls.below[y][x] = stands(Direction::South);
        walls.left[y][x] = stands(Direction::West);
    }
    walls
}

fn openings(maze: &Maze) -> Openings {
    let mut open = [0; CELLS];
    for (cell, open) in maze.cells().zip(&mut open) {
        for side in Direction::ALL {
            *open |= u8::from(maze.passage(cell, side, Unknown::Closed).is_some()) << side as u8;
        }
    }
    Openings::new(open)
}

/// Neighbours with a way between them are a step apart at most, and all cells but the start have one that is
/// nearer.
pub(crate) fn assert_steps_differ_by_one(maze: &Maze, steps: &Distances) {
    for cell in maze.cells() {
        let here = steps.get(cell).expect("a cell within reach");
        let around = Direction::ALL.into_iter().filter_map(|side| maze.passage(cell, side, Unknown::Closed));
        let around: Vec<u32> = around.filter_map(|next| steps.get(next)).collect();
        assert!(around.iter().all(|next| next.abs_diff(here) <= 1), "{cell}");
        assert!(
            (here == 0) == (cell == maze.start()) && (here == 0 || around.contains(&(here - 1))),
            "{cell}"
        );
    }
}

/// The published mazes with so many cells to a side and a way to the goal, by the names of their files.
pub(crate) fn mazes(side: usize) -> Vec<Maze> {
    let mut found = Vec::new();
    if let Some(folder) = std::env::var_os("ROVERLAB_DATA") {
        collect(&Path::new(&folder).join("micromouse"), &mut found);
    }
    found.sort();
    let fits = |maze: &Maze| {
        let steps = fill(&Passages::new(maze, Unknown::Closed), maze.start());
        maze.width() == side && maze.height() == side && maze.goals().any(|goal| steps.get(goal).is_some())
    };
    let load = |path| files::load(path).ok().map(|file| file.maze);
    let mazes: Vec<Maze> = found.iter().filter_map(load).filter(fits).collect();
    println!("{} published mazes of {side} x {side}", mazes.len());
    if mazes.is_empty() {
        println!("40 made at random instead");
        return (1..=40).map(|seed| competition(side, seed).expect("a size within limits")).collect();
    }
    mazes
}

/// All files below a folder.
fn collect(folder: &Path, found: &mut Vec<std::path::PathBuf>) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() { collect(&path, found) } else { found.push(path) }
    }
}
