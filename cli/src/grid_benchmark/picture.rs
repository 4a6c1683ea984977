//! Pictures of grids and of planners at work. Lengths are in cells; the first row is at the top.

use roverlab::geometry::Point;
use roverlab::nav::grid::{AnyAngle, GridPath, GridPlanner, GridSearch, JumpPointSearch};
use roverlab::picture::{Mark, Picture, SERIES, Style, ramp};
use roverlab::world::formats::movingai::Query;
use roverlab::world::{BitGrid, GridCell, Wall, World};

/// Number of colours for the order of expansion, and time between them in a film (s).
const SHADES: usize = 10;
const SHADE: f64 = 0.6;
/// Approximate width of a panel (pixels).
const PANEL: f64 = 240.0;

/// Dijkstra's algorithm, A*, jump point search and any-angle planning for one query.
pub(crate) fn of(map: &str, grid: &BitGrid, query: &Query) -> Picture {
    let end = SHADE * SHADES as f64;
    let mut panels = Vec::new();
    for (name, mut search) in [("Dijkstra", GridSearch::dijkstra(grid)), ("A*", GridSearch::astar(grid))] {
        let mut cells = Vec::new();
        let path = search.plan_traced(query.start, query.goal, |step| cells.push(step.cell));
        let mut panel = of_grid(grid);
        panel.title(format!("{name}: {} cells expanded", cells.len()));
        let width = (PANEL / grid.width() as f64).clamp(1.0, 12.0);
        for (index, batch) in cells.chunks(cells.len().div_ceil(SHADES).max(1)).enumerate() {
            let style = Style::new(ramp(index as f64 / SHADES as f64)).width(width).opacity(0.8);
            panel.during(index as f64 * SHADE..);
            panel.points(batch.iter().map(|cell| place(grid, cell.centre())), style);
        }
        panels.push(with_path(panel, grid, query, path.ok().as_ref(), end));
    }
    let mut jumps = JumpPointSearch::new(grid);
    let path = jumps.plan(query.start, query.goal).ok();
    let (landings, mut panel) = (jumps.landings(), of_grid(grid));
    panel.title(format!("jump points: {} reached", landings.len()));
    for (index, batch) in landings.chunks(landings.len().div_ceil(SHADES).max(1)).enumerate() {
        let style = Style::new(SERIES[8]).width(3.0).labelled("jump point");
        panel.during(index as f64 * SHADE..);
        panel.points(batch.iter().map(|cell| place(grid, cell.centre())), style);
    }
    panels.push(with_path(panel, grid, query, path.as_ref(), end));
    let path = AnyAngle::new(grid).plan(query.start, query.goal).ok();
    let mut panel = of_grid(grid);
    panel
        .title(path.as_ref().map_or("any angle".into(), |path| format!("any angle: {:.1} cells", path.cost)));
    panels.push(with_path(panel, grid, query, path.as_ref(), end));
    let mut picture = Picture::panels(&panels, 2);
    picture.title("Four planners, one query").caption(format!(
        "{map}, {} x {} cells; blue was expanded first, red last; shortest path by 8 neighbours {:.1} cells",
        grid.width(),
        grid.height(),
        query.optimal
    ));
    picture
}

/// Adds start, goal and a path, which a film shows at the end.
fn with_path(
    mut picture: Picture,
    grid: &BitGrid,
    query: &Query,
    path: Option<&GridPath>,
    end: f64,
) -> Picture {
    picture.during(..);
    picture
        .mark(Mark::Start, place(grid, query.start.centre()))
        .mark(Mark::Goal, place(grid, query.goal.centre()));
    if let Some(path) = path {
        draw_path(&mut picture, grid, path, end);
    }
    picture
}

/// Adds a path that a film shows from a time on.
pub(crate) fn draw_path(picture: &mut Picture, grid: &BitGrid, path: &GridPath, from: f64) {
    let points = path.points.iter().map(|&point| place(grid, point));
    let style = Style::new(SERIES[4]).width(2.2).labelled("path");
    picture.during(from..).line(points, style).during(..);
}

/// Position of a point, given in cells, in the picture.
pub(crate) fn place(grid: &BitGrid, point: Point) -> Point {
    Point::new(point.x, grid.height() as f64 - point.y)
}

/// The blocked cells as rectangles, maximal in width first, then in height.
pub(crate) fn of_grid(grid: &BitGrid) -> Picture {
    let (width, height) = (grid.width(), grid.height());
    let mut world = World::empty(width as f64, height as f64);
    let mut open: Vec<(usize, usize, usize)> = Vec::new();
    for row in 0..=height {
        let runs = if row < height { blocked(grid, row) } else { Vec::new() };
        let (kept, done): (Vec<_>, Vec<_>) =
            open.drain(..).partition(|(from, to, _)| runs.contains(&(*from, *to)));
        for (from, to, top) in done {
            world
                .walls
                .push(rectangle([from, to].map(|x| x as f64), [top, row].map(|y| (height - y) as f64)));
        }
        let known: Vec<_> = kept.iter().map(|(from, to, _)| (*from, *to)).collect();
        open = kept;
        open.extend(runs.iter().filter(|run| !known.contains(run)).map(|(from, to)| (*from, *to, row)));
    }
    // Walls of equal thickness are drawn as one.
    world.walls.sort_by(|a, b| a.thickness.total_cmp(&b.thickness));
    let mut picture = Picture::new(&world);
    picture.without_scale();
    picture
}

/// A rectangle as a wall along its longer side, slightly too wide, to hide seams.
fn rectangle([left, right]: [f64; 2], [top, bottom]: [f64; 2]) -> Wall {
    const SEAM: f64 = 0.1;
    let (x, y) = (0.5 * (left + right), 0.5 * (top + bottom));
    let (across, up) = (right - left, top - bottom);
    let mut wall = if across >= up {
        Wall::new(Point::new(left, y), Point::new(right, y))
    } else {
        Wall::new(Point::new(x, bottom), Point::new(x, top))
    };
    wall.thickness = across.min(up) + SEAM;
    wall
}

/// The runs of blocked cells in a row: the first cell, and the one after the last.
fn blocked(grid: &BitGrid, row: usize) -> Vec<(usize, usize)> {
    let mut runs: Vec<(usize, usize)> = Vec::new();
    for column in (0..grid.width()).filter(|&column| !grid.is_free(GridCell::new(column, row))) {
        match runs.last_mut() {
            Some((_, end)) if *end == column => *end += 1,
            _ => runs.push((column, column + 1)),
        }
    }
    runs
}
