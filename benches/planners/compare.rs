//! All queries of a map, asked of all planners.

use std::time::Instant;

use roverlab::nav::grid::{AnyAngle, GridPlanner, GridSearch};
use roverlab_bench::maps::Map;

use crate::table::{Answer, Entry, Truth};

/// What a planner did on a map.
#[derive(Debug)]
pub(crate) struct Column {
    pub(crate) entry: Entry,
    /// Microseconds of a query.
    pub(crate) median: f64,
    pub(crate) prepare_ms: f64,
    /// Queries with another cost than expected.
    pub(crate) different: usize,
    /// Lengths in terms of the shortest of all: their mean, and what 99 % stay below.
    pub(crate) quality: (f64, f64),
}

/// What all planners did on a map.
#[derive(Debug)]
pub(crate) struct Result {
    pub(crate) map: String,
    /// Whether it is one of 512 cells or more.
    pub(crate) is_large: bool,
    pub(crate) queries: usize,
    pub(crate) columns: Vec<Column>,
}

impl Result {
    /// The median time of a planner by its name.
    pub(crate) fn median(&self, name: &str) -> Option<f64> {
        self.columns.iter().find(|column| column.entry.name == name).map(|column| column.median)
    }
}

impl std::fmt::Display for Result {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        writeln!(f, "{}, {} queries", self.map, self.queries)?;
        for column in &self.columns {
            let name = column.entry.name;
            write!(f, "  {name:<32}{:>10.1} us, ready in {:>8.1} ms", column.median, column.prepare_ms)?;
            if column.different > 0 {
                write!(f, ", {} other costs", column.different)?;
            }
            if column.entry.truth == Truth::AtLeastAnyAngle {
                let (mean, worst) = column.quality;
                write!(f, ", {mean:.4} times the shortest way, 99 % below {worst:.4}")?;
            }
            writeln!(f)?;
        }
        Ok(())
    }
}

/// Asks all queries. What to expect is said by Dijkstra's algorithm, and by shortest paths without
/// preparation.
///
/// # Panics
///
/// If a planner of this library finds another cost than expected.
pub(crate) fn compare(map: &Map, entries: &[Entry], repeat: usize) -> Result {
    let costs = |planner: &mut dyn GridPlanner| -> Vec<f64> {
        let cost = |&(start, goal)| planner.plan(start, goal).map_or(f64::NAN, |path| path.cost);
        map.queries.iter().map(cost).collect()
    };
    let octile = costs(&mut GridSearch::dijkstra(&map.grid));
    let any_angle = costs(&mut AnyAngle::new(&map.grid));
    let columns = entries.iter().map(|&entry| {
        let (mut planner, prepare_ms) = ready(entry, map);
        let found: Vec<f64> =
            map.queries.iter().map(|&(start, goal)| planner(start, goal).unwrap_or(f64::NAN)).collect();
        let close = |a: f64, b: f64| (a - b).abs() <= 2e-5 * b + 1e-6;
        let is_right = |index: usize| match entry.truth {
            Truth::Octile => close(found[index], octile[index]),
            Truth::AnyAngle => close(found[index], any_angle[index]),
            Truth::CuttingCorners => found[index] <= octile[index] * (1.0 + 2e-5) + 1e-6,
            Truth::AtLeastAnyAngle => found[index] >= any_angle[index] - 1e-6,
        };
        let different = (0..found.len()).filter(|&index| !is_right(index)).count();
        // A peer may err, which the table tells; what this library says must be right before it is timed.
        assert!(!entry.is_ours || different == 0, "{}: {different} wrong costs on {}", entry.name, map.name);
        let quality = quality(&found, &any_angle);
        Column { entry, median: median(&mut planner, map, repeat), prepare_ms, different, quality }
    });
    let columns = columns.collect();
    let is_large = map.grid.width().max(map.grid.height()) >= 512;
    Result { map: map.name.clone(), is_large, queries: map.queries.len(), columns }
}

#[allow(clippy::disallowed_methods, reason = "a benchmark measures time")]
fn ready(entry: Entry, map: &Map) -> (Answer, f64) {
    let start = Instant::now();
    let planner = (entry.make)(&map.grid);
    (planner, 1e3 * start.elapsed().as_secs_f64())
}

/// The median over the queries of the fastest time of each, in microseconds.
#[allow(clippy::disallowed_methods, reason = "a benchmark measures time")]
fn median(planner: &mut Answer, map: &Map, repeat: usize) -> f64 {
    let mut times: Vec<f64> = Vec::new();
    for &(from, to) in &map.queries {
        let mut fastest = f64::INFINITY;
        for _ in 0..repeat {
            let start = Instant::now();
            std::hint::black_box(planner(from, to));
            fastest = fastest.min(1e6 * start.elapsed().as_secs_f64());
        }
        times.push(fastest);
    }
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// The mean of the ratios and what 99 % of them stay below.
fn quality(found: &[f64], shortest: &[f64]) -> (f64, f64) {
    let pairs = found.iter().zip(shortest).filter(|(_, shortest)| **shortest > 0.0);
    let mut ratios: Vec<f64> = pairs.map(|(found, shortest)| found / shortest).collect();
    ratios.sort_by(f64::total_cmp);
    let mean = ratios.iter().sum::<f64>() / ratios.len().max(1) as f64;
    let rank = (ratios.len() * 99).div_ceil(100).saturating_sub(1);
    (mean, ratios.get(rank).copied().unwrap_or(f64::NAN))
}
