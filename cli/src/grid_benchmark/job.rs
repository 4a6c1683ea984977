use std::path::Path;

use roverlab::nav::grid::{
    AnyAngle, GridPlanner, GridSearch, JumpPointSearch, PlanError, PreparedJumps, Quadtree, QuadtreePlanner,
};
use roverlab::world::formats::movingai::{self, Query};
use roverlab::world::{BitGrid, GridCell};

use super::{Algorithm, Args, own_map, picture};
use crate::common::{Failure, Outcome, Progress, Report, Stopwatch, rounded};

/// Results of all queries.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Result {
    pub(crate) map: String,
    pub(crate) algorithm: Algorithm,
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) queries: usize,
    /// Number of queries with a blocked end.
    pub(crate) skipped: usize,
    pub(crate) solved: usize,
    pub(crate) optimal: usize,
    /// Path lengths relative to the published ones, for queries with both.
    pub(crate) ratios: Vec<f64>,
    /// Time of each query, ascending (µs).
    pub(crate) times: Vec<f64>,
    pub(crate) preprocess_ms: f64,
    /// Whether everything is computed before the queries that the algorithm prepares.
    pub(crate) prepared: bool,
    pub(crate) expanded: usize,
    /// Description of the first query without a path.
    pub(crate) without_way: Option<String>,
}

impl Result {
    /// Whether all results are correct.
    pub(crate) fn is_good(&self) -> bool {
        let asked = self.queries - self.skipped;
        self.solved == asked && (!self.algorithm.is_octile() || self.optimal == asked)
    }

    /// Quantile of the query times.
    pub(crate) fn time(&self, share: f64) -> Option<f64> {
        let rank = (share * self.times.len() as f64).ceil() as usize;
        self.times.get(rank.saturating_sub(1)).copied()
    }
}

/// Cells of one kind (ground or water), and their planner once there was a query.
struct Domain {
    grid: BitGrid,
    planner: Option<Box<dyn GridPlanner>>,
}

impl Domain {
    fn new(grid: BitGrid) -> Self {
        Self { grid, planner: None }
    }

    fn has_both_ends(&self, query: &Query) -> bool {
        self.grid.is_free(query.start) && self.grid.is_free(query.goal)
    }
}

/// The command's work.
pub(crate) fn work(args: &Args) -> std::result::Result<Report, Failure> {
    args.plain.check_picture()?;
    let (name, grids, queries) = if let (Some(map), Some(scen)) = (&args.map, &args.scen) {
        published(map, scen)?
    } else {
        let (name, grid, queries) = own_map::with_queries(args.plain.seed);
        (name, vec![grid], queries)
    };
    let mut domains: Vec<Domain> = grids.into_iter().map(Domain::new).collect();
    let result = answer(name, &mut domains, &queries, args)?;
    let longest = queries.iter().max_by(|a, b| a.optimal.total_cmp(&b.optimal));
    let report = report(&result);
    let domain_of = |query| domains.iter().find(|domain| domain.has_both_ends(query));
    let Some((query, domain)) = longest.and_then(|query| Some((query, domain_of(query)?))) else {
        return Ok(report);
    };
    Ok(args.plain.draw(report, "grid_benchmark.svg", || picture::of(&result.map, &domain.grid, query)))
}

/// Name, grids (ground, then water) and queries of published files.
fn published(map: &Path, scen: &Path) -> std::result::Result<(String, Vec<BitGrid>, Vec<Query>), Failure> {
    let map_of_all = movingai::load_map(map).map_err(Failure::input)?.value;
    let (grid, water) = (map_of_all.grid(), map_of_all.water());
    let queries = movingai::load_scenarios(scen).map_err(Failure::input)?.value;
    if queries.is_empty() {
        return Err(Failure::input(format!("{}: found no queries; expected at least one", scen.display())));
    }
    if let Some(query) = queries.iter().find(|q| (q.width, q.height) != (grid.width(), grid.height())) {
        return Err(Failure::input(format!(
            "{}: found queries for a map of {} x {} cells; expected {} x {}, as in {}",
            scen.display(),
            query.width,
            query.height,
            grid.width(),
            grid.height(),
            map.display()
        )));
    }
    Ok((map.display().to_string(), vec![grid, water], queries))
}

fn report(result: &Result) -> Report {
    let time = |share| result.time(share).unwrap_or(f64::NAN);
    let word = if result.is_good() { Outcome::verdict("solved") } else { Outcome::failure("wrong") };
    Report { error: result.without_way.clone(), ..Report::new(word) }
        .field("map", &result.map)
        .field("algorithm", result.algorithm.name())
        .field("width", result.width)
        .field("height", result.height)
        .field("queries", result.queries)
        .field("skipped", result.skipped)
        .field("prepared", result.prepared)
        .field("solved", result.solved)
        .field("optimal", result.optimal)
        .field("mean_ratio", mean(&result.ratios))
        .field("worst_ratio", result.ratios.iter().copied().reduce(f64::max))
        .field(
            "mean_expanded",
            (result.solved > 0).then(|| rounded(result.expanded as f64 / result.solved as f64)),
        )
        .timing("median_us", time(0.5))
        .timing("p95_us", time(0.95))
        .timing("preprocess_ms", result.preprocess_ms)
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// A planner, and whether all that it can prepare is prepared.
fn planner(algorithm: Algorithm, grid: &BitGrid) -> (Box<dyn GridPlanner>, bool) {
    let planner: Box<dyn GridPlanner> = match algorithm {
        Algorithm::Dijkstra => Box::new(GridSearch::dijkstra(grid)),
        Algorithm::Astar => Box::new(GridSearch::astar(grid)),
        Algorithm::Jps => Box::new(JumpPointSearch::new(grid)),
        Algorithm::JpsPlus => {
            let planner = PreparedJumps::new(grid);
            let prepared = planner.is_prepared();
            return (Box::new(planner), prepared);
        }
        Algorithm::AnyAngle => {
            let mut planner = AnyAngle::new(grid);
            let prepared = planner.prepare();
            return (Box::new(planner), prepared);
        }
        Algorithm::Quadtree => Box::new(QuadtreePlanner::new(&Quadtree::new(grid))),
    };
    (planner, true)
}

fn answer(
    map: String,
    domains: &mut [Domain],
    queries: &[Query],
    args: &Args,
) -> std::result::Result<Result, Failure> {
    let (width, height) = domains.first().map_or((0, 0), |land| (land.grid.width(), land.grid.height()));
    let mut result = Result {
        map,
        algorithm: args.algorithm,
        width,
        height,
        queries: queries.len(),
        skipped: 0,
        solved: 0,
        optimal: 0,
        ratios: Vec::new(),
        times: Vec::new(),
        preprocess_ms: 0.0,
        prepared: true,
        expanded: 0,
        without_way: None,
    };
    let mut progress = Progress::start();
    for (index, query) in queries.iter().enumerate() {
        progress.show(|| format!("{index} of {} queries", queries.len()));
        let Some(domain) = domains.iter_mut().find(|domain| domain.has_both_ends(query)) else {
            result.skipped += 1;
            continue;
        };
        let planner = domain.planner.get_or_insert_with(|| {
            let stopwatch = Stopwatch::start();
            let (planner, prepared) = planner(args.algorithm, &domain.grid);
            result.prepared &= prepared;
            result.preprocess_ms += 1e3 * stopwatch.seconds();
            planner
        });
        if let Err(error) = ask(&mut **planner, query, args.repeat.get(), &mut result) {
            let file = args.scen.as_ref().map_or(String::new(), |scen| format!("{}: ", scen.display()));
            let wrong = format!("{file}query {}: {error}", index + 1);
            if !matches!(error, PlanError::Unreachable { .. }) {
                return Err(Failure::input(wrong));
            }
            result.without_way.get_or_insert(wrong);
        }
    }
    if result.skipped == result.queries {
        return Err(Failure::input(no_query(&queries[0], domains, args)));
    }
    result.times.sort_by(f64::total_cmp);
    Ok(result)
}

/// Explains that all queries begin or end in blocked cells.
fn no_query(query: &Query, domains: &[Domain], args: &Args) -> String {
    let is_free = |cell: GridCell| domains.iter().any(|domain| domain.grid.is_free(cell));
    let (start, goal) = (query.start, query.goal);
    let what = match (is_free(start), is_free(goal)) {
        (false, _) => format!("the start {start} is blocked"),
        (_, false) => format!("the goal {goal} is blocked"),
        _ => format!("no way leads from {start} to {goal}, of which one is in water"),
    };
    let file = args.scen.as_ref().map_or(String::new(), |scen| format!("{}: ", scen.display()));
    format!("{file}no query begins and ends in free cells; in query 1 {what}")
}

fn ask(
    planner: &mut dyn GridPlanner,
    query: &Query,
    repeat: u32,
    result: &mut Result,
) -> std::result::Result<(), PlanError> {
    let mut time = f64::INFINITY;
    let mut once = || {
        let stopwatch = Stopwatch::start();
        let answer = planner.plan(query.start, query.goal);
        time = time.min(1e6 * stopwatch.seconds());
        answer
    };
    let mut answer = once();
    for _ in 1..repeat {
        answer = once();
    }
    result.times.push(time);
    let path = answer?;
    result.solved += 1;
    result.expanded += path.statistics.expanded;
    let tolerance = (2e-5 * query.optimal).max(0.006);
    result.optimal += usize::from((path.cost - query.optimal).abs() <= tolerance);
    if query.optimal > 0.0 {
        result.ratios.push(path.cost / query.optimal);
    }
    Ok(())
}
