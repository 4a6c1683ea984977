use roverlab::evolve::{Evaluator, Parallel, Round, Trial};
use roverlab::random::Stream;
use serde::Serialize;

use super::evolution::{self, Trials};
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
    /// Body and gait evolved together, with as many evaluations.
    together: Option<f64>,
}

/// Compares evolution with the same number of random gaits of the same kind.
pub(crate) fn work(args: &Args, seeds: u32) -> Result<Report, Failure> {
    let (mut rows, trials) = (Vec::new(), args.trials()?);
    for (init, name) in [(Init::Neutral, "neutral"), (Init::Uniform, "uniform")] {
        for seed in (args.common.seed..).take(seeds as usize) {
            let row = compare(args, &trials, seed, (init, name))?;
            args.common.tell(format_args!(
                "{name} seed {seed}: first {:.0}, last {:.0}, ratio {:.2}, random search {:.0}{}",
                row.best_first,
                row.best_last,
                row.ratio,
                row.random,
                row.together.map_or(String::new(), |together| format!(", with the body {together:.0}"))
            ));
            rows.push(row);
        }
    }
    let better =
        |name: &str| rows.iter().filter(|row| row.init == name && row.best_last > row.random).count();
    let together = |name: &str| {
        let wins = rows.iter().filter(|row| row.init == name && row.together > Some(row.best_last));
        args.body.then_some(wins.count())
    };
    let is_better = ["neutral", "uniform"].iter().all(|name| 2 * better(name) > seeds as usize);
    let outcome = if is_better { Outcome::verdict("better") } else { Outcome::failure("no_better") };
    Ok(Report::new(outcome)
        .field("seeds", seeds)
        .field("better_neutral", better("neutral"))
        .field("better_uniform", better("uniform"))
        .field("together_neutral", together("neutral"))
        .field("together_uniform", together("uniform"))
        .table("rows", &rows))
}

fn compare(
    args: &Args,
    trials: &Trials,
    seed: u64,
    (init, name): (Init, &'static str),
) -> Result<Row, Failure> {
    let together = if args.body { Some(evolved(args, trials, (seed, init))?.0.best_last) } else { None };
    let alone = Trials { evolves: false, ..trials.clone() };
    let (evolved, mut threads) = evolved(args, &alone, (seed, init))?;
    let mut random = Stream::new(seed).child("random search", 0);
    let gaits = (0..evolved.evaluations).map(|_| alone.beginning(init, &mut random));
    let gaits = gaits.collect::<Result<Vec<_>, _>>()?;
    let found = threads.evaluate(&gaits, Round { seed, generation: 0 })?;
    Ok(Row {
        init: name,
        seed,
        best_first: rounded(evolved.best_first),
        best_last: rounded(evolved.best_last),
        ratio: rounded(evolved.best_last / evolved.best_first),
        random: rounded(found.into_iter().fold(0.0, f64::max)),
        together: together.map(rounded),
    })
}

/// Evaluates genomes in threads.
type Threads = Box<dyn Evaluator<Vec<u8>>>;

/// An evolution, and the threads that evaluated it.
fn evolved(
    args: &Args,
    trials: &Trials,
    start: (u64, Init),
) -> Result<(evolution::Evolved, Threads), Failure> {
    let own = trials.clone();
    let fitness = move |bytes: &Vec<u8>, _: Trial| own.fitness(bytes);
    let mut threads = Parallel::new(args.threads.into(), fitness)?;
    let evolved = evolution::run(args, trials, start, &mut threads, 0)?;
    Ok((evolved, Box::new(threads)))
}
