//! Maps of cells and queries on them, for the planners.

use std::fs;
use std::path::{Path, PathBuf};

use roverlab::nav::grid::GridComponents;
use roverlab::random::Stream;
use roverlab::world::formats::movingai;
use roverlab::world::{BitGrid, GridCell};

/// A map with queries that have answers.
#[derive(Debug)]
pub struct Map {
    /// Its file, or kind and size.
    pub name: String,
    /// Its cells.
    pub grid: BitGrid,
    /// Start and goal of each query.
    pub queries: Vec<(GridCell, GridCell)>,
}

/// The published maps of 200 cells and more, if there are any.
pub fn published(queries: usize) -> Vec<Map> {
    let Some(folder) = std::env::var_os("ROVERLAB_DATA") else { return Vec::new() };
    let folder = Path::new(&folder).join("movingai");
    let scenarios: Vec<PathBuf> = files(&folder.join("scen")).iter().flat_map(|kind| files(kind)).collect();
    scenarios.iter().filter_map(|scen| with_scenarios(&folder, scen, queries)).collect()
}

/// Queries of a scenario file, spread evenly over it.
fn with_scenarios(folder: &Path, scen: &Path, count: usize) -> Option<Map> {
    let all = movingai::load_scenarios(scen).ok()?.value;
    let kind = scen.parent()?.file_name()?;
    let file = Path::new(&all.first()?.map).file_name()?.to_owned();
    let grid = movingai::load_map(folder.join("map").join(kind).join(&file)).ok()?.value.grid();
    if grid.width().max(grid.height()) < 200 {
        return None;
    }
    let count = count.min(all.len());
    let queries = (0..count).map(|i| &all[i * all.len() / count]).map(|query| (query.start, query.goal));
    Some(Map { name: file.to_string_lossy().into_owned(), grid, queries: queries.collect() })
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    files.sort();
    files
}

/// Maps of a size that are made here: rooms, scattered cells, a cave.
pub fn own(size: usize, queries: usize) -> Vec<Map> {
    let stream = Stream::new(1);
    let mut scattered = stream.child("scattered", size as u64);
    let grids = [
        ("rooms", rooms(size, &mut stream.child("rooms", size as u64))),
        ("20 % scattered", filled(size, |_, _| scattered.chance(0.8))),
        ("cave", cave(size, &mut stream.child("cave", size as u64))),
    ];
    grids.map(|(name, grid)| with_queries(format!("{name}, {size} x {size}"), grid, queries)).into()
}

fn with_queries(name: String, grid: BitGrid, count: usize) -> Map {
    let mut stream = Stream::new(3);
    let components = GridComponents::new(&grid);
    let mut queries = Vec::new();
    while queries.len() < count {
        let mut cell = || GridCell::new(stream.below(grid.width()), stream.below(grid.height()));
        let (start, goal) = (cell(), cell());
        if components.connected(start, goal) {
            queries.push((start, goal));
        }
    }
    Map { name, grid, queries }
}

fn filled(size: usize, is_free: impl FnMut(usize, usize) -> bool) -> BitGrid {
    BitGrid::from_fn(size, size, is_free).expect("a map that fits")
}

/// Cells across a room with one of its walls.
const ROOM: usize = 16;

fn rooms(size: usize, stream: &mut Stream) -> BitGrid {
    let mut grid = filled(size, |x, y| x % ROOM != 0 && y % ROOM != 0);
    for (x, y) in (0..size).step_by(ROOM).flat_map(|y| (0..size).step_by(ROOM).map(move |x| (x, y))) {
        let door = |stream: &mut Stream| 1 + stream.below(ROOM - 1);
        if stream.chance(0.9) {
            grid.set_free(GridCell::new(x, y + door(stream)), true);
        }
        if stream.chance(0.9) {
            grid.set_free(GridCell::new(x + door(stream), y), true);
        }
    }
    grid
}

/// Noise that becomes what most of its surroundings are, five times.
fn cave(size: usize, stream: &mut Stream) -> BitGrid {
    let mut grid = filled(size, |_, _| stream.chance(0.57));
    for _ in 0..5 {
        let before = grid;
        let at = |x: usize, y: usize| before.is_free(GridCell::new(x.wrapping_sub(1), y.wrapping_sub(1)));
        grid = filled(size, |x, y| (0..9).filter(|i| at(x + i % 3, y + i / 3)).count() >= 5);
    }
    grid
}
