use std::path::PathBuf;

use roverlab::evolve::{Gait, OnePoint, Recipe, Selection, Uniform};

use super::evolution::Trials;
use super::figure::Figure;
use crate::common::{CommonArgs, Failure, check_writable, parse_seconds};

/// Maximum duration of a trial (s).
const LONGEST: f64 = 3600.0;

/// Command line of `starman`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "A round robot with five limbs learns to walk by a genetic algorithm",
    after_help = "\
Fitness is 1 plus the distance along the floor of a gait in millimetres. The best gait is drawn to
target/pictures/starman.svg, except with --json.

The distance counts from the robot's rest position at the first control point of its gait. --statistics saves a row of
numbers or a chart of each generation.

JSON fields:
  generations, evaluations       number in this run, including a checkpoint's
  timing                         with --timing: evaluations_per_s by this process, real_time_factor
  best_first, best_last, ratio   highest fitness of the first and of all generations
  population_hash                hash of the final population
  best_gait                      its bytes, one for each servo and control point; with --body, two for each limb follow
  way_mm                         final position of the best gait along the floor, which --record records
  threads, picture               file of the strip, if there is one
With --compare, `rows`: seed, best_first, best_last, ratio, random (the best of as many random gaits), together (with --body:
body and gait evolved with as many evaluations), and the number of seeds in which either is better. With --steps, `rows`: time step, and of the gaits that move more than 5 mm their number and the
median change of the distance when the step is halved.
Outcomes: evolved; better (with --compare: from either beginning, the evolved gait is better than the best random one in more
than half of the seeds), no_better; compared (with --steps), failed."
)]
pub(crate) struct Args {
    /// Number of individuals in a generation.
    #[arg(long, value_name = "P", default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) population: u32,

    /// Number of generations.
    #[arg(long, value_name = "G", default_value_t = 100, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) generations: u32,

    /// Simulated seconds of a trial; the first two are for coming to rest.
    #[arg(long, value_name = "S", default_value = "10", value_parser = parse_seconds, allow_hyphen_values = true)]
    pub(crate) seconds: f64,

    /// Number of evaluation threads; 0 for one per processor.
    #[arg(long, value_name = "T", default_value_t = 0, value_parser = clap::value_parser!(u16).range(..=512))]
    pub(crate) threads: u16,

    /// Evaluate in this many processes instead.
    #[arg(long, value_name = "N", conflicts_with = "threads", value_parser = clap::value_parser!(u16).range(1..=512))]
    pub(crate) processes: Option<u16>,

    /// Command that starts each of the processes, such as `ssh node roverlab`; the words of a worker follow it.
    /// It is split at spaces; quotation marks keep words together.
    #[arg(long, value_name = "CMD", requires = "processes", value_parser = Words::parse)]
    pub(crate) worker_command: Option<Words>,

    /// Number of individuals that a process is sent at once [default: 1].
    #[arg(long, value_name = "N", requires = "processes", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) worker_piece: Option<u32>,

    /// The robot: the book's, the planar figure it is based on, or a body of limbs: biped, hexapod, star,
    /// worm, or a file like those in cli/figures.
    #[arg(long, value_name = "NAME|FILE.toml", default_value = "book")]
    pub(crate) figure: String,

    /// Evolve the body with the gait: lengths of the limbs, up to four times as long or short, and their
    /// directions, by up to 30 degrees.
    #[arg(long)]
    pub(crate) body: bool,

    /// The first generation: near the servos' middle as in the book, or uniformly random bytes.
    #[arg(long, value_enum, default_value = "neutral")]
    pub(crate) init: Init,

    /// Selection of parents; the book uses the roulette wheel.
    #[arg(long, value_enum, default_value = "tournament")]
    pub(crate) selection: Choice,

    /// Crossover of two parents; the book cuts at one point.
    #[arg(long, value_enum, default_value = "uniform")]
    pub(crate) crossover: Cross,

    /// Number of bits flipped in a generation [default: three times the population].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(..=10_000_000))]
    pub(crate) mutations: Option<u32>,

    /// Number of control points of the sequence that leads into the cycle of ten.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u8).range(0..=100))]
    pub(crate) leading: u8,

    /// Save the run to a file after every generation, and continue from an existing one.
    #[arg(long, value_name = "FILE")]
    pub(crate) checkpoint: Option<PathBuf>,

    /// Write the statistics of all generations, as a table (.csv) or a drawing (.svg or .png).
    #[arg(long, value_name = "FILE")]
    pub(crate) statistics: Option<PathBuf>,

    /// Compare with random search, for this many seeds and both kinds of initialisation.
    #[arg(
        long,
        value_name = "SEEDS",
        conflicts_with_all = ["steps", "init", "checkpoint", "animation", "statistics", "picture", "processes", "worker_command", "worker_piece", "record", "replay"],
        value_parser = clap::value_parser!(u32).range(1..=10_000)
    )]
    pub(crate) compare: Option<u32>,

    /// Print how much the distance of --population gaits changes when the time step is halved.
    #[arg(
        long,
        conflicts_with_all = ["leading", "checkpoint", "animation", "statistics", "picture", "processes", "worker_command", "worker_piece", "record", "replay"]
    )]
    pub(crate) steps: bool,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

/// The words of a command.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Words {
    pub(super) program: String,
    pub(super) arguments: Vec<String>,
}

impl Words {
    /// Splits a command at its spaces, but for those between quotation marks.
    fn parse(text: &str) -> Result<Self, String> {
        let (mut words, mut word, mut quoted) = (Vec::new(), None::<String>, false);
        for letter in text.chars() {
            match letter {
                '"' => {
                    quoted = !quoted;
                    word.get_or_insert_default();
                }
                ' ' if !quoted => words.extend(word.take()),
                letter => word.get_or_insert_default().push(letter),
            }
        }
        words.extend(word);
        if quoted {
            return Err("expected another quotation mark".into());
        }
        let mut words = words.into_iter();
        let program = words.next().filter(|program| !program.is_empty());
        let program = program.ok_or("expected the name of a program")?;
        Ok(Self { program, arguments: words.collect() })
    }
}

/// Initialisation of the first generation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Init {
    /// Small random steps from the servos' middle.
    Neutral,
    /// Uniformly random bytes.
    Uniform,
}

/// Selection of parents.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Choice {
    /// The fittest of three random individuals.
    Tournament,
    /// In proportion to fitness.
    Wheel,
    /// By rank.
    Rank,
}

/// Crossover of two parents.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Cross {
    /// Each byte from either parent.
    Uniform,
    /// Swaps the parts behind a cut.
    OnePoint,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("always", &["noise", "time_limit", "quantised", "realtime"]),
    ("steps", &["generations", "init", "selection", "crossover", "mutations", "body"]),
]);

impl Args {
    /// The trials of a gait.
    pub(crate) fn trials(&self) -> Result<Trials, Failure> {
        let (seconds, leading) = (self.seconds, self.leading.into());
        let figure = Figure::load(&self.common, &self.figure)?;
        if self.body && figure.genes() == 0 {
            return Err(Failure::input(format!(
                "--body: found the figure {}; expected one of limbs, such as hexapod",
                self.figure
            )));
        }
        let evolves = self.body;
        Ok(Trials { figure: figure.into(), evolves, seconds, leading, ..Trials::default() })
    }

    /// Settings that affect the run, for checkpoints.
    pub(crate) fn settings(&self) -> String {
        let Self { population, seconds, leading, figure, init, selection, crossover, .. } = self;
        let (mutations, seed) = (self.mutation_count(), self.common.seed);
        let figure = match figure.as_str() {
            "book" => "Book",
            "planar" => "Planar",
            other => other,
        };
        let body = if self.body { " with its body" } else { "" };
        format!(
            "population {population}, {seconds} s, {figure} figure{body}, {leading} leading points, {init:?} start, {selection:?} selection, \
             {crossover:?} crossover, {mutations} mutations, seed {seed}"
        )
    }

    /// Operators of the evolution.
    pub(crate) fn recipe(&self) -> Recipe<Vec<u8>> {
        Recipe {
            selection: match self.selection {
                Choice::Tournament => Selection::Tournament { size: 3 },
                Choice::Wheel => Selection::Wheel,
                Choice::Rank => Selection::Rank { pressure: 1.8 },
            },
            crossover: match self.crossover {
                Cross::Uniform => Box::new(Uniform { probability: 0.5 }),
                Cross::OnePoint => Box::new(OnePoint),
            },
            ..Recipe::book(self.mutation_count())
        }
    }

    fn mutation_count(&self) -> usize {
        self.mutations.unwrap_or(3 * self.population) as usize
    }

    /// Fails for an option without meaning here.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        self.common.check_picture()?;
        self.check_seconds()?;
        self.check_files()?;
        let given = [
            ("--world", self.common.world.is_some()),
            ("--robot", self.common.robot.is_some()),
            ("--start", self.common.start.is_some()),
            ("--goal", self.common.goal.is_some()),
            ("--fault", !self.common.fault.is_empty()),
        ];
        match given.iter().find(|(_, given)| *given) {
            Some((option, _)) => Err(Failure::input(format!(
                "{option}: has no meaning for evolution; expected a command line without it"
            ))),
            None => Ok(()),
        }
    }

    fn check_seconds(&self) -> Result<(), Failure> {
        if self.seconds > Gait::SETTLING && self.seconds <= LONGEST {
            return Ok(());
        }
        let found = self.seconds;
        let least = Gait::SETTLING;
        Err(Failure::input(format!(
            "--seconds {found}: expected more than the {least} s to come to rest, at most {LONGEST}"
        )))
    }

    /// Fails before a long run if an output file cannot be written.
    fn check_files(&self) -> Result<(), Failure> {
        let forms = [
            ("--checkpoint", &self.checkpoint, &[][..]),
            ("--statistics", &self.statistics, &["csv", "svg", "png"]),
        ];
        for (option, file, endings) in forms {
            let Some(file) = file else { continue };
            check_writable(option, file)?;
            let ending = file.extension().unwrap_or_default();
            if !endings.is_empty() && endings.iter().all(|known| ending != *known) {
                let (file, expected) = (file.display(), endings.join(", ."));
                return Err(Failure::input(format!("{option} {file}: expected the ending .{expected}")));
            }
        }
        Ok(())
    }
}
