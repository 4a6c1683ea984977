//! The command `starman`.

mod compare;
mod evolution;
mod figure;
mod options;
mod steps;
mod strip;

use std::ffi::OsString;
use std::io;

use roverlab::evolve::{GenerationStatistics, chart, serve, table};
use roverlab::files::{open_regular, write_whole};
use roverlab::geometry::units;

use crate::common::{Failure, Outcome, Report, rounded};
use figure::Figure;
pub(crate) use options::Args;

/// Argument that makes this program evaluate gaits for another process.
const WORKER: &str = "--evaluate-for-another";

/// Evaluates gaits from standard input, if requested. Returns the exit status.
pub(crate) fn work_for_another(words: &[OsString]) -> Option<u8> {
    let words: Vec<&str> = words.iter().skip(1).map(|word| word.to_str()).collect::<Option<_>>()?;
    let [WORKER, seconds, leading, evolves, figure] = words.as_slice() else { return None };
    let (seconds, leading) = seconds.parse().ok().zip(leading.parse().ok())?;
    let read = || Figure::parse(&io::read_to_string(open_regular(figure).ok()?).ok()?, figure).ok();
    let figure = Figure::named(figure).or_else(read)?.into();
    let evolves = *evolves == "true";
    let trials = evolution::Trials { figure, evolves, seconds, leading, ..evolution::Trials::default() };
    let ended = serve(io::stdin().lock(), io::stdout().lock(), |bytes: &Vec<u8>, _| trials.fitness(bytes));
    Some(u8::from(ended.is_err()))
}

/// The command's work.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    args.check()?;
    if args.steps {
        return steps::work(args);
    }
    match args.compare {
        Some(seeds) => compare::work(args, seeds),
        None => walk(args),
    }
}

/// Evolves a gait and shows it.
fn walk(args: &Args) -> Result<Report, Failure> {
    let trials = args.trials()?;
    let evolved = evolution::evolve(args, &trials)?;
    let way = evolution::walk(args, &trials, &evolved.best)?;
    let walk = strip::Walk::of(&trials, &evolved.best)?;
    args.common.tell(format_args!("the best gait goes {:.0} mm", units::to_mm(way)));
    let trouble = keep_statistics(args, &evolved.history).err();
    let report = Report::new(Outcome::verdict("evolved"))
        .field("generations", evolved.generations)
        .field("evaluations", evolved.evaluations)
        .timing("evaluations_per_s", evolved.rate)
        .timing("real_time_factor", evolved.rate * args.seconds)
        .field("best_first", rounded(evolved.best_first))
        .field("best_last", rounded(evolved.best_last))
        .field("ratio", rounded(evolved.best_last / evolved.best_first))
        .field("population_hash", format!("{:016x}", evolved.hash))
        .field("best_gait", &evolved.best)
        .field("way_mm", rounded(units::to_mm(way)))
        .field("threads", evolved.threads);
    let report = Report { sim_time: Some(args.seconds * evolved.evaluations as f64), trouble, ..report };
    Ok(args.common.draw(report, "starman.svg", || strip::picture(args, &walk)))
}

/// Writes the statistics of all generations to the option's file.
fn keep_statistics(args: &Args, history: &[GenerationStatistics]) -> Result<(), String> {
    let Some(file) = &args.statistics else { return Ok(()) };
    let told = |error: &dyn std::fmt::Display| format!("--statistics {}: {error}", file.display());
    if file.extension().is_some_and(|ending| ending == "csv") {
        write_whole(file, table(history).as_bytes()).map_err(|error| told(&error))
    } else {
        chart(history).save(file).map_err(|error| told(&error))
    }
}
