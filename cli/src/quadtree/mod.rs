//! The command `quadtree`.

use std::path::{Path, PathBuf};

use roverlab::geometry::Point;
use roverlab::nav::grid::{GridPath, GridPlanner, Leaf, Quadtree, QuadtreePlanner};
use roverlab::picture::{Mark, Picture, SERIES, Style};
use roverlab::random::Stream;
use roverlab::world::formats::{bitmap, movingai, ros_map};
use roverlab::world::{BitGrid, GridCell};
use serde_json::{Value, json};

use crate::common::{Failure, Outcome, PlainArgs, Report, Stopwatch};
use crate::grid_benchmark::picture::{draw_path, of_grid, place};

/// Command line of `quadtree`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Divides a map into free and blocked squares, and plans a path through the free ones",
    after_help = "\
Pictures have their first row at the top and obstacles in black; the rows of a ROS map count from the bottom. Without
--map, the map has some discs, placed by --seed. A map whose size is not a power of two is divided like part of a larger
one; squares are within the map.

JSON fields:
  map, width, height
  free_leaves, blocked_leaves numbers of squares
  smallest, largest           side lengths of the free ones in cells; null without any
  links                       pairs of free squares that share part of an edge
  list                        with --list: the free squares in the format of the book's program
  path                        with --from and --to: cost in cells, and points [x, y] in cells
  timing                      with --timing: decompose_us and list_us, durations of the division and of the list of free squares
Outcomes: decomposed, and with --from and --to found or unreachable."
)]
pub(crate) struct Args {
    /// Picture (.png, .pgm, .bmp), MovingAI map (.map) or ROS map (.yaml).
    #[arg(long, value_name = "IMAGE")]
    pub(crate) map: Option<PathBuf>,

    /// List the free squares in the book's order and form: `free COLUMN ROW (SIDE)`.
    #[arg(long)]
    pub(crate) list: bool,

    /// Minimum side of squares, a power of two; such squares count as blocked if any of their cells is.
    #[arg(long, value_name = "CELLS", default_value_t = 1, allow_hyphen_values = true)]
    pub(crate) minimum: usize,

    /// Start cell of a path.
    #[arg(long, value_name = "COLUMN,ROW", value_parser = cell, requires = "to", allow_hyphen_values = true)]
    pub(crate) from: Option<GridCell>,

    /// Goal cell of a path.
    #[arg(long, value_name = "COLUMN,ROW", value_parser = cell, requires = "from", allow_hyphen_values = true)]
    pub(crate) to: Option<GridCell>,

    #[command(flatten)]
    pub(crate) plain: PlainArgs,
}

crate::common::shares_options!(Args, plain: PlainArgs, unheeded: [("map", &["seed"]), ("always", &["animation"])]);

fn cell(text: &str) -> Result<GridCell, String> {
    let numbers: Option<Vec<usize>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[column, row]) => Ok(GridCell::new(column, row)),
        _ => Err("expected COLUMN,ROW: two whole numbers from 0".into()),
    }
}

/// The command's work.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    args.plain.check_picture()?;
    let (name, grid) = match &args.map {
        Some(map) => (map.display().to_string(), load(map)?),
        None => (format!("discs of seed {}", args.plain.seed), own_map(args.plain.seed)),
    };
    let stopwatch = Stopwatch::start();
    let tree = Quadtree::with_minimum_leaf(&grid, args.minimum)
        .map_err(|error| Failure::input(format!("--minimum: {error}")))?;
    let decomposed = stopwatch.seconds();
    let free = tree.free_leaves();
    let listed = stopwatch.seconds() - decomposed;
    let path = match (args.from, args.to) {
        (Some(from), Some(to)) => Some(plan(&tree, from, to)?),
        _ => None,
    };
    let outcome = match &path {
        None => "decomposed",
        Some(None) => "unreachable",
        Some(Some(_)) => "found",
    };
    let report = Report::new(Outcome::verdict(outcome))
        .field("map", name)
        .field("width", grid.width())
        .field("height", grid.height())
        .field("free_leaves", free.len())
        .field("blocked_leaves", tree.blocked_leaves().len())
        .field("smallest", free.iter().map(|leaf| leaf.size).min())
        .field("largest", free.iter().map(|leaf| leaf.size).max())
        .field("links", tree.neighbour_graph().links.len())
        .timing("decompose_us", 1e6 * decomposed)
        .timing("list_us", 1e6 * listed);
    let report = match path.flatten() {
        Some(path) => report.field("path", path_json(&path)),
        None => report,
    };
    let report = args.plain.draw(report, "quadtree.svg", || picture(args, &grid, &tree));
    if !args.list {
        return Ok(report);
    }
    let list: Vec<String> = free.iter().map(line).collect();
    Ok(Report { words: Some(list.join("\n")), ..report.field("list", list) })
}

/// A path; `None` without one.
fn plan(tree: &Quadtree, from: GridCell, to: GridCell) -> Result<Option<GridPath>, Failure> {
    use roverlab::nav::grid::PlanError;
    match QuadtreePlanner::new(tree).plan(from, to) {
        Ok(path) => Ok(Some(path)),
        Err(PlanError::Unreachable { .. }) => Ok(None),
        Err(error) => Err(Failure::input(format!("--from, --to: {error}"))),
    }
}

/// The leaves and a path: the requested one, or one between the first and the last free leaf.
fn picture(args: &Args, grid: &BitGrid, tree: &Quadtree) -> Picture {
    let free = tree.free_leaves();
    let mut picture = of_grid(grid);
    picture.title(format!("A quadtree: {} free leaves", free.len()));
    let middle = |leaf: &Leaf| GridCell::new(leaf.column + leaf.size / 2, leaf.row + leaf.size / 2);
    let ends = args.from.zip(args.to).or_else(|| Some((middle(free.first()?), middle(free.last()?))));
    let (width, height) = (grid.width(), grid.height());
    let squares = free.iter().flat_map(|leaf| {
        let (left, top) = (leaf.column, leaf.row);
        let (right, bottom) = ((left + leaf.size).min(width), (top + leaf.size).min(height));
        let corners = [(left, top), (right, top), (right, bottom), (left, bottom), (left, top)];
        let corner = |(x, y): (usize, usize)| place(grid, Point::new(x as f64, y as f64));
        corners.map(corner).into_iter().chain([Point::new(f64::NAN, f64::NAN)])
    });
    picture.line(squares, Style::new(SERIES[1]).width(0.8).labelled("free leaf"));
    let Some((from, to)) = ends else { return picture };
    picture.mark(Mark::Start, place(grid, from.centre())).mark(Mark::Goal, place(grid, to.centre()));
    match plan(tree, from, to) {
        Ok(Some(path)) => {
            picture.caption(format!("a path of {:.1} cells through {width} x {height}", path.cost));
            draw_path(&mut picture, grid, &path, 0.0);
        }
        _ => {
            picture.caption("no path");
        }
    }
    picture
}

fn path_json(path: &GridPath) -> Value {
    let points: Vec<[f64; 2]> = path.points.iter().map(|point| [point.x, point.y]).collect();
    json!({ "cost": path.cost, "points": points })
}

fn line(leaf: &Leaf) -> String {
    format!("free {} {} ({})", leaf.column, leaf.row, leaf.size)
}

fn load(path: &Path) -> Result<BitGrid, Failure> {
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or("").to_ascii_lowercase();
    match ending.as_str() {
        "map" => movingai::load_map(path).map(|map| map.value.grid()),
        "yaml" | "yml" => ros_map::load(path).map(|map| BitGrid::from_occupancy(&map.value.grid)),
        _ => bitmap::load(path).map(|grid| grid.value),
    }
    .map_err(Failure::input)
}

/// Random discs in a square.
fn own_map(seed: u64) -> BitGrid {
    let mut stream = Stream::new(seed).child("discs", 0);
    let size = 128;
    let discs: Vec<[f64; 3]> = (0..6)
        .map(|_| [stream.between(0.0, 128.0), stream.between(0.0, 128.0), stream.between(6.0, 20.0)])
        .collect();
    let free = |column: usize, row: usize| {
        let middle = GridCell::new(column, row).centre();
        discs
            .iter()
            .all(|[x, y, r]| (middle.x - x) * (middle.x - x) + (middle.y - y) * (middle.y - y) > r * r)
    };
    BitGrid::from_fn(size, size, free).expect("a map of moderate size")
}
