use roverlab::nav::grid::{
    AnyAngle, GridPlanner, GridSearch, JumpPointSearch, PlanError, PreparedJumps, Quadtree, QuadtreePlanner,
};
use roverlab::world::BitGrid;
use roverlab::world::formats::movingai::{self, Query};

use super::{Algorithm, Args, own_map, picture};
use crate::common::{Failure, Outcome, Progress, Report, Stopwatch, rounded};

/// What came of all queries.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Result {
    pub(crate) map: String,
    pub(crate) algorithm: Algorithm,
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) queries: usize,
    pub(crate) solved: usize,
    pub(crate) optimal: usize,
    /// Lengths in terms of the published ones, of the queries that have got a path and a length.
    pub(crate) ratios: Vec<f64>,
    /// Microseconds of each query, in ascending order.
    pub(crate) times: Vec<f64>,
    pub(crate) preprocess_ms: f64,
    pub(crate) expanded: usize,
    /// The first query that no way answers, in words.
    pub(crate) without_way: Option<String>,
}

impl Result {
    /// Whether all is as it should be.
    pub(crate) fn is_good(&self) -> bool {
        self.solved == self.queries && (!self.algorithm.is_octile() || self.optimal == self.queries)
    }

    /// The time that a share of the queries stays below.
    pub(crate) fn time(&self, share: f64) -> Option<f64> {
        let rank = (share * self.times.len() as f64).ceil() as usize;
        self.times.get(rank.saturating_sub(1)).copied()
    }
}

/// The work of the command.
pub(crate) fn work(args: &Args) -> std::result::Result<Report, Failure> {
    args.plain.check_picture()?;
    let (name, grid, queries) = match (&args.map, &args.scen) {
        (Some(map), Some(scen)) => {
            let grid = movingai::load_map(map).map_err(Failure::input)?.value.grid();
            let queries = movingai::load_scenarios(scen).map_err(Failure::input)?.value;
            if queries.is_empty() {
                return Err(Failure::input(format!(
                    "{}: found no queries; expected at least one",
                    scen.display()
                )));
            }
            if let Some(query) = queries.iter().find(|q| (q.width, q.height) != (grid.width(), grid.height()))
            {
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
            (map.display().to_string(), grid, queries)
        }
        _ => own_map::with_queries(args.plain.seed),
    };
    let result = answer(name, &grid, &queries, args)?;
    let longest = queries.iter().max_by(|a, b| a.optimal.total_cmp(&b.optimal));
    let report = report(&result);
    Ok(match longest {
        Some(query) => {
            args.plain.draw(report, "grid_benchmark.svg", || picture::of(&result.map, &grid, query))
        }
        None => report,
    })
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

fn planner(algorithm: Algorithm, grid: &BitGrid) -> Box<dyn GridPlanner> {
    match algorithm {
        Algorithm::Dijkstra => Box::new(GridSearch::dijkstra(grid)),
        Algorithm::Astar => Box::new(GridSearch::astar(grid)),
        Algorithm::Jps => Box::new(JumpPointSearch::new(grid)),
        Algorithm::JpsPlus => Box::new(PreparedJumps::new(grid)),
        Algorithm::AnyAngle => {
            let mut planner = AnyAngle::new(grid);
            planner.prepare();
            Box::new(planner)
        }
        Algorithm::Quadtree => Box::new(QuadtreePlanner::new(&Quadtree::new(grid))),
    }
}

fn answer(
    map: String,
    grid: &BitGrid,
    queries: &[Query],
    args: &Args,
) -> std::result::Result<Result, Failure> {
    let stopwatch = Stopwatch::start();
    let mut planner = planner(args.algorithm, grid);
    let mut result = Result {
        map,
        algorithm: args.algorithm,
        width: grid.width(),
        height: grid.height(),
        queries: queries.len(),
        solved: 0,
        optimal: 0,
        ratios: Vec::new(),
        times: Vec::new(),
        preprocess_ms: 1e3 * stopwatch.seconds(),
        expanded: 0,
        without_way: None,
    };
    let mut progress = Progress::start();
    for (index, query) in queries.iter().enumerate() {
        progress.show(|| format!("{index} of {} queries", queries.len()));
        if let Err(error) = ask(&mut *planner, query, args.repeat.get(), &mut result) {
            let file = args.scen.as_ref().map_or(String::new(), |scen| format!("{}: ", scen.display()));
            let wrong = format!("{file}query {}: {error}", index + 1);
            if !matches!(error, PlanError::Unreachable { .. }) {
                return Err(Failure::input(wrong));
            }
            result.without_way.get_or_insert(wrong);
        }
    }
    result.times.sort_by(f64::total_cmp);
    Ok(result)
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
