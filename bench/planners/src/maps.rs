//! Maps and queries.

use std::fs;
use std::path::{Path, PathBuf};

use roverlab::nav::grid::Components;
use roverlab::random::Stream;
use roverlab::world::formats::movingai;
use roverlab::world::{BitGrid, GridCell};

/// A map with queries that have answers.
pub struct Map {
    pub name: String,
    pub grid: BitGrid,
    pub queries: Vec<(GridCell, GridCell)>,
}

/// Published maps, if there are any, and some of our own.
pub fn all(queries: usize) -> Vec<Map> {
    let mut maps = Vec::new();
    if let Some(folder) = std::env::var_os("ROVERLAB_DATA") {
        let folder = Path::new(&folder).join("movingai");
        for scen in files(&folder.join("scen")).iter().flat_map(|kind| files(kind)) {
            maps.extend(published(&folder, &scen, queries));
        }
    }
    maps.extend(own(512, queries));
    maps
}

/// Queries of a scenario file, spread evenly over it. Maps below 200 cells say little.
fn published(folder: &Path, scen: &Path, count: usize) -> Option<Map> {
    let all = movingai::load_scenarios(scen).ok()?.value;
    let kind = scen.parent()?.file_name()?;
    let file = Path::new(&all.first()?.map).file_name()?.to_owned();
    let grid = movingai::load_map(folder.join("map").join(kind).join(&file)).ok()?.value.grid();
    if grid.width().max(grid.height()) < 200 {
        return None;
    }
    let step = (all.len() / count).max(1);
    let queries = all.iter().step_by(step).take(count).map(|query| (query.start, query.goal)).collect();
    Some(Map { name: file.to_string_lossy().into_owned(), grid, queries })
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    files.sort();
    files
}

/// Maps of some size: rooms, scattered cells, a cave.
pub fn own(size: usize, queries: usize) -> Vec<Map> {
    let mut stream = Stream::new(1).child("maps", size as u64);
    let grids = [
        ("rooms", rooms(size, &mut stream)),
        ("20 % scattered", filled(size, |_, _| stream.chance(0.8))),
        ("cave", cave(size, &mut Stream::new(2).child("cave", size as u64))),
    ];
    grids.map(|(name, grid)| with_queries(format!("{name}, {size} x {size}"), grid, queries)).into()
}

fn with_queries(name: String, grid: BitGrid, count: usize) -> Map {
    let mut stream = Stream::new(3);
    let components = Components::new(&grid);
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

fn rooms(size: usize, stream: &mut Stream) -> BitGrid {
    const ROOM: usize = 16;
    let mut grid = filled(size, |x, y| x % ROOM != 0 && y % ROOM != 0);
    for (x, y) in (0..size).step_by(ROOM).flat_map(|y| (0..size).step_by(ROOM).map(move |x| (x, y))) {
        let mut door = |stream: &mut Stream| 1 + stream.below(ROOM - 1);
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
        grid = filled(size, |x, y| {
            let around = (0..3).flat_map(|dy| (0..3).map(move |dx| GridCell::new((x + dx).wrapping_sub(1), (y + dy).wrapping_sub(1))));
            around.filter(|&cell| before.is_free(cell)).count() >= 5
        });
    }
    grid
}
