use roverlab::evolve::{Evaluator, Parallel, Round, Trial};
use roverlab::geometry::math;
use roverlab::random::Stream;
use serde::Serialize;

use super::evolution::Trials;
use super::options::Args;
use crate::common::{Failure, Outcome, Report, rounded};

/// Effect of halving a time step on the distances of gaits.
#[derive(Debug, Clone, Copy, Serialize)]
struct Row {
    time_step_ms: f64,
    median_way_mm: f64,
    /// Number of gaits that go far enough to count.
    counted: Option<usize>,
    /// Median relative change of a gait's distance when this step is halved.
    median_change: Option<f64>,
}

const STEPS_MS: [f64; 4] = [10.0, 5.0, 2.5, 1.25];
/// Minimum distance of a gait that counts (m); shorter ones are noise.
const LEAST_WAY: f64 = 0.005;

/// Prints the table.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    let trials = args.trials()?;
    let gaits = gaits(args, trials.figure.servos());
    let ways = STEPS_MS.map(|step| ways(args, &trials, &gaits, step));
    let mut rows = Vec::new();
    for (i, step) in STEPS_MS.into_iter().enumerate() {
        let ways_here = ways[i].as_ref().map_err(|error| Failure::run(error.to_string()))?;
        let changes =
            ways.get(i + 1).and_then(|finer| finer.as_ref().ok()).map(|finer| changes(ways_here, finer));
        let row = Row {
            time_step_ms: step,
            counted: changes.as_ref().map(Vec::len),
            median_way_mm: rounded(1000.0 * median(ways_here.iter().map(|way| way.abs()).collect())),
            median_change: changes.filter(|list| !list.is_empty()).map(|list| rounded(median(list))),
        };
        let change = row.median_change.map_or("-".into(), |change| format!("{:.1} %", 100.0 * change));
        args.common.tell(format_args!(
            "{step} ms: median way {} mm, changes by {change} at half of it",
            row.median_way_mm
        ));
        rows.push(row);
    }
    Ok(Report::new(Outcome::verdict("compared")).field("gaits", gaits.len()).table("rows", &rows))
}

/// Waves of random phase through the limbs, which walk like evolved gaits.
fn gaits(args: &Args, servos: usize) -> Vec<Vec<u8>> {
    let mut random = Stream::new(args.common.seed).child("waves", 0);
    let mut wave = || {
        let limbs: Vec<(f64, f64)> = (0..servos)
            .map(|_| (random.between(50.0, 100.0), random.between(0.0, std::f64::consts::TAU)))
            .collect();
        let phase = |point: usize| std::f64::consts::TAU * point as f64 / 10.0;
        (0..10)
            .flat_map(|point| {
                limbs.iter().map(move |(swing, at)| (128.0 + swing * math::sin(phase(point) + at)) as u8)
            })
            .collect()
    };
    (0..args.population).map(|_| wave()).collect()
}

fn ways(args: &Args, trials: &Trials, gaits: &[Vec<u8>], step_ms: f64) -> roverlab::io::Result<Vec<f64>> {
    let trials = Trials { time_step: step_ms / 1000.0, ..trials.clone() };
    let mut threads = Parallel::new(args.threads.into(), move |bytes: &Vec<u8>, _: Trial| trials.way(bytes))?;
    threads.evaluate(gaits, Round { seed: args.common.seed, generation: 0 })
}

fn changes(ways: &[f64], finer: &[f64]) -> Vec<f64> {
    let pairs = ways.iter().zip(finer).filter(|(_, finer)| finer.abs() > LEAST_WAY);
    pairs.map(|(way, finer)| ((way - finer) / finer).abs()).collect()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}
