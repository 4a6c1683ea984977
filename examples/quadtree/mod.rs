//! What the example `quadtree` is made of.

use std::path::{Path, PathBuf};

use roverlab::nav::grid::{GridPath, GridPlanner, Leaf, Quadtree, QuadtreePlanner};
use roverlab::random::Stream;
use roverlab::world::formats::{bitmap, movingai, ros_map};
use roverlab::world::{BitGrid, GridCell};
use serde_json::{Value, json};

use crate::common::{Failure, Printed, Stopwatch, rounded};

/// The command line of the example `quadtree`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    name = "quadtree",
    about = "Divides a map into free and blocked squares, and plans a path through the free ones",
    after_help = "\
Pictures have their first row at the top and obstacles in black; the rows of a ROS map count from the bottom. Without --map,
the map has some discs in it; --seed says where. A map whose size is no power of two is divided as if it were part of a larger
one; squares lie within the map.

JSON fields:
  map, width, height
  free_leaves, blocked_leaves how many squares
  smallest, largest           sides of the free ones, in cells; null without any
  links                       pairs of free squares that share a part of an edge
  decompose_us                time to divide the map, microseconds
  list_us                     time to list its free squares, microseconds
  list                        with --list: the free squares, as the book's program prints them
  path                        with --from and --to: cost in cells, and points [x, y] in cells
Outcomes: decomposed, and with --from and --to found or unreachable."
)]
pub(crate) struct Args {
    /// Picture (.png, .pgm, .bmp), MovingAI map (.map) or ROS map (.yaml).
    #[arg(long, value_name = "IMAGE")]
    pub(crate) map: Option<PathBuf>,

    /// List the free squares in the book's order and form: `free COLUMN ROW (SIDE)`.
    #[arg(long)]
    pub(crate) list: bool,

    /// Do not divide squares of this side, a power of two; they count as blocked if a cell of theirs is.
    #[arg(long, value_name = "CELLS", default_value_t = 1, allow_hyphen_values = true)]
    pub(crate) minimum: usize,

    /// Cell to plan a path from.
    #[arg(long, value_name = "COLUMN,ROW", value_parser = cell, requires = "to", allow_hyphen_values = true)]
    pub(crate) from: Option<GridCell>,

    /// Cell to plan a path to.
    #[arg(long, value_name = "COLUMN,ROW", value_parser = cell, requires = "from", allow_hyphen_values = true)]
    pub(crate) to: Option<GridCell>,

    /// Seed of the example's own map.
    #[arg(long, value_name = "N", default_value_t = 1, allow_hyphen_values = true)]
    pub(crate) seed: u64,

    /// Print exactly one JSON object on standard output, and nothing else there.
    #[arg(long)]
    pub(crate) json: bool,
}

fn cell(text: &str) -> Result<GridCell, String> {
    let numbers: Option<Vec<usize>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[column, row]) => Ok(GridCell::new(column, row)),
        _ => Err("expected COLUMN,ROW: two whole numbers from 0".into()),
    }
}

/// The work of the example.
pub(crate) fn work(args: &Args) -> Result<Printed, Failure> {
    let wall_clock = Stopwatch::start();
    let (name, grid) = match &args.map {
        Some(map) => (map.display().to_string(), load(map)?),
        None => (format!("discs of seed {}", args.seed), own_map(args.seed)),
    };
    let stopwatch = Stopwatch::start();
    let tree = Quadtree::with_minimum_leaf(&grid, args.minimum)
        .map_err(|error| Failure::input(format!("--minimum: {error}")))?;
    let decomposed = 1e6 * stopwatch.seconds();
    let free = tree.free_leaves();
    let listed = 1e6 * stopwatch.seconds() - decomposed;
    let blocked = tree.blocked_leaves().len();
    let path = match (args.from, args.to) {
        (Some(from), Some(to)) => Some(plan(&tree, from, to)?),
        _ => None,
    };
    let links = tree.neighbour_graph().links.len();
    let outcome = match &path {
        None => "decomposed",
        Some(None) => "unreachable",
        Some(Some(_)) => "found",
    };
    let list: Vec<String> = free.iter().map(line).collect();
    let text = if args.json {
        let mut fields = vec![
            ("example", json!("quadtree")),
            ("outcome", json!(outcome)),
            ("seed", json!(args.seed)),
            ("noise", Value::Null),
            ("sim_time_s", Value::Null),
            ("wall_time_s", json!(rounded(wall_clock.seconds()))),
            ("collisions", Value::Null),
            ("path_length_mm", Value::Null),
            ("pose", Value::Null),
            ("odometry", Value::Null),
            ("map", json!(name)),
            ("width", json!(grid.width())),
            ("height", json!(grid.height())),
            ("free_leaves", json!(free.len())),
            ("blocked_leaves", json!(blocked)),
            ("smallest", json!(free.iter().map(|leaf| leaf.size).min())),
            ("largest", json!(free.iter().map(|leaf| leaf.size).max())),
            ("links", json!(links)),
            ("decompose_us", json!(rounded(decomposed))),
            ("list_us", json!(rounded(listed))),
        ];
        fields.extend(args.list.then(|| ("list", json!(list))));
        fields.extend(path.flatten().map(|path| ("path", path_json(&path))));
        let fields: Vec<String> = fields.iter().map(|(name, value)| format!("\"{name}\":{value}")).collect();
        format!("{{{}}}", fields.join(","))
    } else if args.list {
        list.join("\n")
    } else {
        let mut lines = vec![
            format!("{name}: {} x {} cells", grid.width(), grid.height()),
            format!(
                "{} free squares, {blocked} blocked ones, {links} pairs of free ones side by side",
                free.len()
            ),
            format!("divided in {decomposed:.0} us, free squares listed in {listed:.0} us"),
        ];
        lines.extend(
            path.flatten()
                .map(|path| format!("a path of {:.2} cells over {} points", path.cost, path.points.len())),
        );
        lines.join("\n")
    };
    Ok(Printed { text, message: None, status: 0 })
}

/// A path, or none if there is no way.
fn plan(tree: &Quadtree, from: GridCell, to: GridCell) -> Result<Option<GridPath>, Failure> {
    use roverlab::nav::grid::PlanError;
    match QuadtreePlanner::new(tree).plan(from, to) {
        Ok(path) => Ok(Some(path)),
        Err(PlanError::Unreachable { .. }) => Ok(None),
        Err(error) => Err(Failure::input(format!("--from, --to: {error}"))),
    }
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

/// Some discs on a square.
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
