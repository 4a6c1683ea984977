//! The command `genetic`.

mod evolve;
mod spline;
mod wall;

use roverlab::evolve::chart;
use roverlab::picture::Picture;

use crate::common::{CommonArgs, Failure, Outcome, Report, rounded};
use evolve::{evolve, inside};
use spline::Spline;
use wall::Wall;

/// Command line of `genetic`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Evolves the scale of a spline's tangents, or the gains of a wall follower",
    after_help = "\
A spline leads from --start to --goal X,Y,DEG; it should be short without sharp bends. A wall follower should keep its
distance in the simulator, with noise. Fitness is minus the cost. --record requires --task wall and records a drive with
the best gains.

JSON fields:
  task, method, evaluations, fitness          the task; number of trials and the best fitness
  scale, length_mm, radius_mm                 of the best spline; radius of its sharpest bend
  proportional, integral, derivative          the best gains
  best, mean                                  fitness of each generation
  picture
Outcomes: evolved, failed."
)]
pub(crate) struct Args {
    /// What to evolve.
    #[arg(long, value_enum, default_value = "spline")]
    pub(crate) task: Task,

    /// Evolution method.
    #[arg(long, value_enum, default_value = "genetic")]
    pub(crate) method: Method,

    /// Number of generations.
    #[arg(long, value_name = "G", default_value_t = 40, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) generations: u32,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("always", &["time_limit", "quantised", "realtime"]),
    ("task=spline", &["noise"]),
    ("task=wall", &["start", "goal"]),
]);

/// Evolution task.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Task {
    /// The scale of a spline's tangents.
    Spline,
    /// The gains of a PID wall follower.
    Wall,
}

/// Evolution method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Method {
    /// Generational genetic algorithm.
    Genetic,
    /// Steady state: two children at a time.
    SteadyState,
    /// Evolution strategy with covariance matrix adaptation.
    CmaEs,
}

/// The command's work.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    let common = &args.common;
    common.check_picture()?;
    check(args)?;
    let (spline, wall, seed) = (Spline::new(common), Wall::new(common), common.seed);
    let population = match args.task {
        Task::Spline => {
            evolve(args.method, Spline::GENES, args.generations, seed, |genes, _| spline.cost(genes))
        }
        Task::Wall => {
            evolve(args.method, Wall::GENES, args.generations, seed, |genes, trial| wall.cost(genes, trial))
        }
    }
    .map_err(Failure::input)?;
    for row in &population.history {
        common
            .tell(format_args!("generation {}: best {:.4}, mean {:.4}", row.generation, row.best, row.mean));
    }
    let best = population.best.as_ref().ok_or_else(|| Failure::run("nobody was evaluated"))?;
    let genes = inside(&best.genome);
    let (fields, picture) = match args.task {
        Task::Spline => (spline.found(&genes)?, spline.picture(&population, &genes)),
        Task::Wall => (Wall::found(&genes), wall.picture(common, &genes)?),
    };
    let report = Report::new(Outcome::verdict("evolved"))
        .field("task", format!("{:?}", args.task).to_lowercase())
        .field("method", format!("{:?}", args.method))
        .field("evaluations", population.history.last().map_or(0, |row| row.evaluations))
        .field("fitness", rounded(best.fitness));
    let report = fields.into_iter().fold(report, |report, (name, value)| report.field(&name, value));
    let report = report
        .field("best", population.history.iter().map(|row| rounded(row.best)).collect::<Vec<_>>())
        .field("mean", population.history.iter().map(|row| rounded(row.mean)).collect::<Vec<_>>());
    Ok(common.draw(report, "genetic.svg", || {
        let mut curve = chart(&population.history);
        curve.title("fitness and diversity by generation");
        let mut both = Picture::panels(&[picture, curve], 1);
        both.title(match args.task {
            Task::Spline => "The scale of a spline, evolved",
            Task::Wall => "The gains of a wall follower, evolved",
        });
        both
    }))
}

/// Fails for an option without meaning here.
fn check(args: &Args) -> Result<(), Failure> {
    let common = &args.common;
    let drives = args.task == Task::Wall;
    let given = [
        ("--world", common.world.is_some()),
        ("--robot", common.robot.is_some()),
        ("--fault", !common.fault.is_empty()),
        ("--record", common.record.is_some() && !drives),
        ("--replay", common.replay.is_some() && !drives),
    ];
    let refused = |option: &str| {
        Failure::input(format!("{option}: has no meaning for evolution; expected a command line without it"))
    };
    given.iter().find(|(_, given)| *given).map_or(Ok(()), |(option, _)| Err(refused(option)))
}
