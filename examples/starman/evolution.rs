use std::ffi::OsString;
use std::process::Command;

use roverlab::evolve::{
    Evaluator, Evolution, Gait, Genetic, Parallel, Population, Processes, StopRules, Trial, checkpoint,
};
use roverlab::io::sim::starman::{LIMBS, Starman, StarmanSpec};
use roverlab::io::{Drive, Result};
use roverlab::random::Stream;
use roverlab::world::{Scene, World};

use super::WORKER;
use super::options::{Args, Init};
use crate::common::{Failure, Progress, Stopwatch};

/// Control points of the cycle.
const CYCLE: usize = 10;
/// The largest step between control points of the first generation near the middle, in bytes.
const STEP: u8 = 5;

/// The floor that a recording shows: width and depth in metres.
const FLOOR: (f64, f64) = (4.0, 0.5);

/// How a gait is tried.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Trials {
    pub(crate) spec: StarmanSpec,
    pub(crate) seconds: f64,
    pub(crate) leading: usize,
}

impl Default for Trials {
    fn default() -> Self {
        Self { spec: StarmanSpec::book(), seconds: 10.0, leading: 0 }
    }
}

impl Trials {
    /// 1 plus the way along the floor in millimetres.
    pub(crate) fn fitness(&self, bytes: &[u8]) -> Result<f64> {
        Ok(1.0 + 1000.0 * self.way(bytes)?.abs())
    }

    /// Metres along the floor, from where the robot has come to rest on its feet.
    pub(crate) fn way(&self, bytes: &[u8]) -> Result<f64> {
        let mut starman = Starman::new(&self.spec)?;
        Gait::from_bytes(bytes, LIMBS, self.leading)?.run(&mut starman, self.seconds)?;
        Ok(starman.truth().posture.body.0)
    }

    /// A random gait to begin with.
    pub(crate) fn beginning(&self, init: Init, random: &mut Stream) -> Vec<u8> {
        let points = self.leading + CYCLE;
        match init {
            Init::Neutral => Gait::near_middle(LIMBS, points, STEP, random),
            Init::Uniform => (0..LIMBS * points).map(|_| random.below(256) as u8).collect(),
        }
    }
}

/// What a run came to.
#[derive(Debug, Clone)]
pub(crate) struct Evolved {
    pub(crate) generations: u64,
    pub(crate) evaluations: u64,
    /// Evaluations in a second of the wall clock.
    pub(crate) rate: f64,
    pub(crate) best_first: f64,
    pub(crate) best_last: f64,
    pub(crate) best: Vec<u8>,
    pub(crate) hash: u64,
    pub(crate) threads: usize,
}

/// Evolves a gait as the command line says.
pub(crate) fn evolve(args: &Args) -> std::result::Result<Evolved, Failure> {
    let (mut evaluator, threads) = evaluator(args)?;
    run(args, args.common.seed, args.init, evaluator.as_mut(), threads)
}

/// Walks a gait on the robot that can be recorded and replayed. Returns metres along the floor, by the robot itself.
pub(crate) fn walk(args: &Args, bytes: &[u8]) -> std::result::Result<f64, Failure> {
    let trials = args.trials();
    let room = Scene::new(World::empty(FLOOR.0, FLOOR.1));
    let mut robot = args.common.staged_robot(&room, Starman::new(&trials.spec)?)?;
    Gait::from_bytes(bytes, LIMBS, trials.leading)?.run(&mut *robot, trials.seconds)?;
    Ok(robot.pose()?.x)
}

/// Threads or processes that try gaits, and how many.
type Workers = (Box<dyn Evaluator<Vec<u8>>>, usize);

fn evaluator(args: &Args) -> std::result::Result<Workers, Failure> {
    let trials = args.trials();
    let Some(processes) = args.processes else {
        let threads = Parallel::new(args.threads, move |bytes: &Vec<u8>, _: Trial| trials.fitness(bytes))?;
        let count = threads.threads();
        return Ok((Box::new(threads), count));
    };
    let program =
        std::env::current_exe().map_err(|error| Failure::run(format!("this program's file: {error}")))?;
    let words =
        [WORKER.to_owned(), trials.seconds.to_string(), trials.leading.to_string()].map(OsString::from);
    let start = || {
        let mut command = Command::new(&program);
        command.args(&words);
        command
    };
    Ok((Box::new(Processes::start(processes, start).map_err(Failure::input)?), processes))
}

/// Evolves a gait from a seed.
pub(crate) fn run(
    args: &Args,
    seed: u64,
    init: Init,
    evaluator: &mut dyn Evaluator<Vec<u8>>,
    threads: usize,
) -> std::result::Result<Evolved, Failure> {
    let settings = args.settings();
    let kept = args.checkpoint.as_ref().map(|file| checkpoint::load(file, &settings)).transpose();
    let kept: Option<Population<Vec<u8>>> = kept.map_err(Failure::input)?.flatten();
    let population = match kept {
        Some(population) => population,
        None => first(args, seed, init)?,
    };
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
        threads,
    })
}

fn first(args: &Args, seed: u64, init: Init) -> Result<Population<Vec<u8>>> {
    let trials = args.trials();
    let mut random = Stream::new(seed).child("first generation", 0);
    Population::new((0..args.population).map(|_| trials.beginning(init, &mut random)).collect(), seed)
}
