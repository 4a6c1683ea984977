use std::ffi::OsString;
use std::process::Command;
use std::sync::Arc;

use roverlab::evolve::{
    Evaluator, Evolution, Gait, GenerationStatistics, Genetic, Parallel, Population, Processes, StopRules,
    Trial, checkpoint,
};
use roverlab::io::sim::starman::{Starman, StarmanSpec};
use roverlab::io::{Clock, Odometry, Result, Servos};
use roverlab::random::Stream;
use roverlab::world::{Scene, World};

use super::WORKER;
use super::figure::Figure;
use super::options::{Args, Init};
use crate::common::{Failure, Progress, Stopwatch, own_program};

/// Number of control points of the cycle.
const CYCLE: usize = 10;
/// Maximum step between control points in a neutral first generation (bytes).
const STEP: u8 = 5;

/// Floor shown in a recording: width and depth (m).
const FLOOR: (f64, f64) = (4.0, 0.5);

/// Trial of a gait.
#[derive(Debug, Clone)]
pub(crate) struct Trials {
    pub(crate) figure: Arc<Figure>,
    /// Whether the body evolves too.
    pub(crate) evolves: bool,
    pub(crate) time_step: f64,
    pub(crate) seconds: f64,
    pub(crate) leading: usize,
}

impl Default for Trials {
    fn default() -> Self {
        let book = StarmanSpec::book();
        let figure = Arc::new(Figure::Star(book));
        Self { figure, evolves: false, time_step: book.time_step, seconds: 10.0, leading: 0 }
    }
}

impl Trials {
    /// 1 plus the distance walked in millimetres.
    pub(crate) fn fitness(&self, bytes: &[u8]) -> Result<f64> {
        Ok(1.0 + 1000.0 * self.way(bytes)?.abs())
    }

    /// Distance walked along the floor, from the resting position on its feet (m).
    pub(crate) fn way(&self, bytes: &[u8]) -> Result<f64> {
        self.walk(bytes, &mut self.robot(bytes)?, |starman| Ok(starman.pose()?.x))
    }

    /// Walks a gait. Returns the distance along the floor by `place`, from the resting position (m).
    pub(crate) fn walk<R: Clock + Servos + ?Sized>(
        &self,
        bytes: &[u8],
        robot: &mut R,
        place: impl Fn(&mut R) -> Result<f64>,
    ) -> Result<f64> {
        let (gait, _) = self.parts(bytes);
        let gait = Gait::from_bytes(gait, self.figure.servos(), self.leading)?;
        gait.settle(robot)?;
        let start = place(robot)?;
        gait.walk(robot, self.seconds - Gait::SETTLING)?;
        Ok(place(robot)? - start)
    }

    /// The robot under trial, with the body of a genome.
    pub(crate) fn robot(&self, bytes: &[u8]) -> Result<Starman> {
        self.figure.robot(self.time_step, self.parts(bytes).1)
    }

    /// The bytes of a genome for the gait, and those for the body.
    fn parts<'g>(&self, bytes: &'g [u8]) -> (&'g [u8], &'g [u8]) {
        bytes.split_at(bytes.len().saturating_sub(self.body_genes()))
    }

    /// Number of bytes by which the body evolves.
    fn body_genes(&self) -> usize {
        if self.evolves { self.figure.genes() } else { 0 }
    }

    /// A random initial gait.
    pub(crate) fn beginning(&self, init: Init, random: &mut Stream) -> Result<Vec<u8>> {
        let (servos, points) = (self.figure.servos(), self.leading + CYCLE);
        let uniform = |count: usize, random: &mut Stream| -> Vec<u8> {
            (0..count).map(|_| random.below(256) as u8).collect()
        };
        let gait = match init {
            Init::Neutral => Gait::near_middle(servos, points, STEP, random)?,
            Init::Uniform => uniform(servos * points, random),
        };
        let body = uniform(self.body_genes(), random);
        Ok([gait, body].concat())
    }
}

/// Result of a run.
#[derive(Debug, Clone)]
pub(crate) struct Evolved {
    pub(crate) generations: u64,
    pub(crate) evaluations: u64,
    /// Evaluations per second of wall-clock time.
    pub(crate) rate: f64,
    pub(crate) best_first: f64,
    pub(crate) best_last: f64,
    pub(crate) best: Vec<u8>,
    pub(crate) hash: u64,
    pub(crate) history: Vec<GenerationStatistics>,
    pub(crate) threads: usize,
}

/// Evolves a gait with the options of the command line.
pub(crate) fn evolve(args: &Args, trials: &Trials) -> std::result::Result<Evolved, Failure> {
    let (mut evaluator, threads) = evaluator(args, trials)?;
    run(args, trials, (args.common.seed, args.init), evaluator.as_mut(), threads)
}

/// Walks a gait on a robot that can be recorded and replayed. Returns the robot's own distance along the
/// floor (m).
pub(crate) fn walk(args: &Args, trials: &Trials, bytes: &[u8]) -> std::result::Result<f64, Failure> {
    let room = Scene::new(World::empty(FLOOR.0, FLOOR.1));
    let mut robot = args.common.staged_robot(&room, trials.robot(bytes)?)?;
    Ok(trials.walk(bytes, &mut *robot, |robot| Ok(robot.pose()?.x))?)
}

/// Evaluator with threads or processes, and their number.
type Workers = (Box<dyn Evaluator<Vec<u8>>>, usize);

fn evaluator(args: &Args, trials: &Trials) -> std::result::Result<Workers, Failure> {
    let trials = trials.clone();
    let Some(processes) = args.processes else {
        let threads =
            Parallel::new(args.threads.into(), move |bytes: &Vec<u8>, _: Trial| trials.fitness(bytes))?;
        let count = threads.threads();
        return Ok((Box::new(threads), count));
    };
    let own = || own_program().map_err(|error| Failure::run(format!("this program's file: {error}")));
    let (program, first): (OsString, &[String]) = match &args.worker_command {
        Some(command) => ((&command.program).into(), &command.arguments),
        None => (own()?.into(), &[]),
    };
    let numbers = [trials.seconds.to_string(), trials.leading.to_string(), trials.evolves.to_string()];
    let arguments = [WORKER.to_owned()].into_iter().chain(numbers).chain([args.figure.clone()]);
    let words: Vec<String> = first.iter().cloned().chain(arguments).collect();
    let start = move || {
        let mut command = Command::new(&program);
        command.args(&words);
        command
    };
    let (processes, piece) = (usize::from(processes), args.worker_piece.unwrap_or(1) as usize);
    let started = Processes::start(processes, start).and_then(|started| started.with_piece(piece));
    Ok((Box::new(started.map_err(Failure::input)?), processes))
}

/// Evolves a gait from a seed.
pub(crate) fn run(
    args: &Args,
    trials: &Trials,
    (seed, init): (u64, Init),
    evaluator: &mut dyn Evaluator<Vec<u8>>,
    threads: usize,
) -> std::result::Result<Evolved, Failure> {
    let settings = args.settings();
    let beginning = first(args, trials, seed, init)?;
    let population = kept(args, &settings, &beginning)?.unwrap_or(beginning);
    let before = population.history.last().map_or(0, |row| row.evaluations);
    let mut evolution = Genetic::resume(population, args.recipe())?;
    let (stopwatch, mut progress) = (Stopwatch::start(), Progress::start());
    evolution.run(evaluator, &StopRules::generations(args.generations.into()), |now| {
        let row = now.history()[now.history().len() - 1];
        progress
            .show(|| format!("generation {}: best {:.1}, mean {:.1}", row.generation, row.best, row.mean));
        args.checkpoint.as_ref().map_or(Ok(()), |file| checkpoint::save(file, &settings, now.population()))
    })?;
    let seconds = stopwatch.seconds();
    drop(progress);
    let history = evolution.history();
    let evaluations = history.last().map_or(0, |row| row.evaluations);
    let best = evolution.best().ok_or_else(|| Failure::run("nobody was evaluated"))?;
    Ok(Evolved {
        generations: history.len() as u64,
        evaluations,
        rate: (evaluations - before) as f64 / seconds.max(1e-9),
        best_first: history.first().map_or(0.0, |row| row.best),
        best_last: best.fitness,
        best: best.genome.clone(),
        hash: evolution.population().hash(),
        history: history.to_vec(),
        threads,
    })
}

/// The population of a checkpoint, if there is one: it must belong to this run, judging by its start.
fn kept(
    args: &Args,
    settings: &str,
    beginning: &Population<Vec<u8>>,
) -> std::result::Result<Option<Population<Vec<u8>>>, Failure> {
    let Some(file) = &args.checkpoint else { return Ok(None) };
    let kept: Option<Population<Vec<u8>>> = checkpoint::load(file, settings).map_err(Failure::input)?;
    let Some(kept) = kept else { return Ok(None) };
    let refused = |found: String, expected: String| {
        Failure::input(format!("{}: {found}; expected {expected}", file.display()))
    };
    kept.validate().map_err(|error| Failure::input(format!("{}: {error}", file.display())))?;
    let form = |population: &Population<Vec<u8>>| {
        let (individuals, genes) = (population.genomes.len(), population.genomes[0].len());
        format!("{individuals} individuals of {genes} genes from seed {}", population.seed)
    };
    if form(&kept) == form(beginning) { Ok(Some(kept)) } else { Err(refused(form(&kept), form(beginning))) }
}

fn first(args: &Args, trials: &Trials, seed: u64, init: Init) -> Result<Population<Vec<u8>>> {
    let mut random = Stream::new(seed).child("first generation", 0);
    let gaits = (0..args.population).map(|_| trials.beginning(init, &mut random));
    Population::new(gaits.collect::<Result<_>>()?, seed)
}
