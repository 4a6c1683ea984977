//! What the example `genetic` is made of.

use std::path::PathBuf;

use roverlab::drive::Path;
use roverlab::evolve::{
    Arithmetic, CmaEs, Evolution, Gaussian, Genetic, Population, Recipe, Selection, Serial, SteadyState,
    StopRules, Trial,
};
use roverlab::geometry::{Point, Pose};
use roverlab::io::Result;
use roverlab::picture::{Mark, Picture, Style};
use roverlab::random::Stream;
use roverlab::world::World;

use crate::common::{CommonArgs, Failure, Outcome, Report, millimetres, rounded};

/// The command line of the example `genetic`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    name = "genetic",
    about = "Evolves the scale of a spline's tangents: a short way that does not bend sharply",
    after_help = "\
The spline leads from --start to --goal X,Y,DEG. Its cost is its length plus what its sharpest bend adds; fitness is
minus the cost.

JSON fields:
  method, evaluations, scale, fitness   what was found with how many trials
  length_mm, radius_mm                  of the best spline, and of its sharpest bend
  best, mean                            fitness of each generation
  picture
Outcomes: evolved, failed."
)]
pub(crate) struct Args {
    /// How to evolve.
    #[arg(long, value_enum, default_value = "genetic")]
    pub(crate) method: Method,

    /// Generations.
    #[arg(long, value_name = "G", default_value_t = 40, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) generations: u32,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

impl AsRef<CommonArgs> for Args {
    fn as_ref(&self) -> &CommonArgs {
        &self.common
    }
}

/// A method of evolution.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Method {
    /// Generation after generation.
    Genetic,
    /// Two children at a time.
    SteadyState,
    /// Evolution strategy with covariance matrix adaptation.
    CmaEs,
}

/// Scales that are tried.
const SCALES: (f64, f64) = (0.1, 6.0);
/// What a bend costs, in cubic metres: a bend of radius 0.5 m costs as much as 0.32 m of way.
const BEND: f64 = 0.08;

/// Evolves the scale of a spline: all that evolving something of one's own takes.
fn evolve(
    method: Method,
    start: Pose,
    goal: Pose,
    generations: u32,
    seed: u64,
) -> Result<Population<Vec<f64>>> {
    let cost = |scale: f64| -> Result<f64> {
        let path = Path::hermite(start, goal, scale.clamp(SCALES.0, SCALES.1))?;
        Ok(path.length() + BEND * path.max_curvature() * path.max_curvature())
    };
    let mut evaluator = Serial::new(|genes: &Vec<f64>, _: Trial| Ok(-cost(genes[0])?));
    let mut random = Stream::new(seed);
    let first = (0..20).map(|_| vec![random.between(SCALES.0, SCALES.1)]).collect();
    let recipe = Recipe {
        selection: Selection::Tournament { size: 3 },
        crossover: Box::new(Arithmetic),
        mutation: Box::new(Gaussian { probability: 0.5, sigma: 0.2, low: SCALES.0, high: SCALES.1 }),
        elite: 1,
    };
    let mut evolution: Box<dyn Evolution<Vec<f64>>> = match method {
        Method::Genetic => Box::new(Genetic::new(first, recipe, seed)?),
        Method::SteadyState => Box::new(SteadyState::new(first, recipe, 2, seed)?),
        Method::CmaEs => Box::new(CmaEs::new(vec![3.0], 1.0, 8, seed)?),
    };
    while StopRules::generations(generations.into()).verdict(evolution.history()).is_none() {
        evolution.step(&mut evaluator)?;
    }
    Ok(evolution.population().clone())
}

/// The work of the example.
pub(crate) fn work(args: &Args) -> std::result::Result<Report, Failure> {
    let common = &args.common;
    common.check_picture()?;
    check(common)?;
    let start = common.start.unwrap_or(Pose::new(0.3, 0.4, 0.0));
    let goal = common.goal.map_or(Pose::new(2.4, 1.3, std::f64::consts::FRAC_PI_2), |goal| {
        Pose::new(goal.position.x, goal.position.y, goal.heading.unwrap_or(0.0))
    });
    let population =
        evolve(args.method, start, goal, args.generations, common.seed).map_err(Failure::input)?;
    for row in &population.history {
        common
            .tell(format_args!("generation {}: best {:.4}, mean {:.4}", row.generation, row.best, row.mean));
    }
    let best = population.best.as_ref().ok_or_else(|| Failure::run("nobody was evaluated"))?;
    let scale = best.genome[0].clamp(SCALES.0, SCALES.1);
    let path = Path::hermite(start, goal, scale)?;
    let file = common.picture.clone().or_else(|| (!common.json).then(|| PathBuf::from("genetic.svg")));
    let saved = file.as_ref().map(|file| picture(&population, start, goal, &path).save(file)).transpose();
    let report = Report::new(Outcome::verdict("evolved"))
        .field("method", format!("{:?}", args.method))
        .field("evaluations", population.history.last().map_or(0, |row| row.evaluations))
        .field("scale", rounded(scale))
        .field("fitness", rounded(best.fitness))
        .field("length_mm", millimetres(path.length()))
        .field("radius_mm", millimetres(1.0 / path.max_curvature()))
        .field("best", population.history.iter().map(|row| rounded(row.best)).collect::<Vec<_>>())
        .field("mean", population.history.iter().map(|row| rounded(row.mean)).collect::<Vec<_>>())
        .field("picture", file);
    Ok(Report { trouble: saved.err().map(|error| error.to_string()), ..report })
}

/// Fails when an option has no meaning here.
fn check(common: &CommonArgs) -> std::result::Result<(), Failure> {
    let given = [
        ("--world", common.world.is_some()),
        ("--robot", common.robot.is_some()),
        ("--fault", !common.fault.is_empty()),
        ("--record", common.record.is_some()),
        ("--replay", common.replay.is_some()),
    ];
    let refused = |option: &str| {
        Failure::input(format!(
            "{option}: has no meaning without a robot; expected a command line without it"
        ))
    };
    given.iter().find(|(_, given)| *given).map_or(Ok(()), |(option, _)| Err(refused(option)))
}

/// The splines of the last generation, and the best of all.
fn picture(population: &Population<Vec<f64>>, start: Pose, goal: Pose, best: &Path) -> Picture {
    let corner = |a: f64, b: f64| a.max(b) + 0.5;
    let mut picture = Picture::new(&World::empty(corner(start.x, goal.x), corner(start.y, goal.y)));
    picture
        .title("The scale of a spline, evolved")
        .caption("The splines of the last generation, and the best of all.");
    for genome in &population.genomes {
        if let Ok(path) = Path::hermite(start, goal, genome[0].clamp(SCALES.0, SCALES.1)) {
            picture.line(points(&path), Style::aid().labelled("last generation"));
        }
    }
    picture.line(points(best), Style::true_path().labelled("best of all"));
    picture.mark(Mark::Start, start.position()).mark(Mark::Goal, goal.position());
    picture
}

fn points(path: &Path) -> Vec<Point> {
    path.points().iter().map(|point| point.pose.position()).collect()
}
