use roverlab::evolve::{Evaluator, Parallel, Round, Trial};
use roverlab::random::Stream;
use serde::Serialize;

use super::evolution;
use super::options::{Args, Init};
use crate::common::{Failure, Outcome, Report, rounded};

/// Evolution and random search from one seed.
#[derive(Debug, Clone, Copy, Serialize)]
struct Row {
    init: &'static str,
    seed: u64,
    best_first: f64,
    best_last: f64,
    ratio: f64,
    random: f64,
}

/// Compares evolution with the same number of random gaits of the same kind.
pub(crate) fn work(args: &Args, seeds: u32) -> Result<Report, Failure> {
    let mut rows = Vec::new();
    for (init, name) in [(Init::Neutral, "neutral"), (Init::Uniform, "uniform")] {
        for seed in (args.common.seed..).take(seeds as usize) {
            let row = compare(args, seed, init, name)?;
            args.common.tell(format_args!(
                "{name} seed {seed}: first {:.0}, last {:.0}, ratio {:.2}, random search {:.0}",
                row.best_first, row.best_last, row.ratio, row.random
            ));
            rows.push(row);
        }
    }
    let better =
        |name: &str| rows.iter().filter(|row| row.init == name && row.best_last > row.random).count();
    Ok(Report::new(Outcome::verdict("compared"))
        .field("seeds", seeds)
        .field("better_neutral", better("neutral"))
        .field("better_uniform", better("uniform"))
        .table("rows", &rows))
}

fn compare(args: &Args, seed: u64, init: Init, name: &'static str) -> Result<Row, Failure> {
    let trials = args.trials();
    let mut threads =
        Parallel::new(args.threads.into(), move |bytes: &Vec<u8>, _: Trial| trials.fitness(bytes))?;
    let evolved = evolution::run(args, seed, init, &mut threads, 0)?;
    let mut random = Stream::new(seed).child("random search", 0);
    let gaits = (0..evolved.evaluations).map(|_| trials.beginning(init, &mut random));
    let gaits = gaits.collect::<Result<Vec<_>, _>>()?;
    let found = threads.evaluate(&gaits, Round { seed, generation: 0 })?;
    Ok(Row {
        init: name,
        seed,
        best_first: rounded(evolved.best_first),
        best_last: rounded(evolved.best_last),
        ratio: rounded(evolved.best_last / evolved.best_first),
        random: rounded(found.into_iter().fold(0.0, f64::max)),
    })
}
