//! Training in rounds.

use std::num::NonZero;
use std::path::Path;

use roverlab::drive::end_to_end::SteeringExamples;
use roverlab::files::write_whole;
use roverlab::learn::{Loss, Trainer, TrainerOptions};
use roverlab::vision::network::Network;
use serde_json::{Value, json};

use super::lesson::lesson;
use super::{Args, MOST_ROUNDS};
use crate::common::{
    Failure, Outcome, Progress, Report, Stopwatch, TrainingStore, check_writable, rounded, share_out, threads,
};
use crate::signs::hash;

/// Rate of the first epoch of a round; it falls evenly to a tenth.
const RATE: f64 = 1e-3;
/// Seeds of lessons begin far from those that people choose.
const LESSONS: u64 = 1 << 40;

/// Trains a network and writes it.
pub(super) fn train(args: &Args, out: &Path) -> Result<Report, Failure> {
    let watch = Stopwatch::start();
    check_writable("--out", out)?;
    let store = TrainingStore::open(out, &facts(args))?;
    let crew = threads(args.threads);
    let results = args.architecture.outputs();
    let options = TrainerOptions {
        loss: if results == 1 { Loss::Squares } else { Loss::Classes },
        seed: args.common.seed,
        threads: NonZero::new(crew).unwrap_or(NonZero::<usize>::MIN),
        ..TrainerOptions::default()
    };
    let mut trainer = match store.state()? {
        Some(bytes) => {
            Trainer::from_checkpoint(&bytes, args.architecture.clone(), options).map_err(Failure::input)?
        }
        None => Trainer::new(args.architecture.clone(), options)?,
    };
    let mut examples = SteeringExamples::new(args.architecture.input()).for_results(results);
    let (mut seed, mut pupil, mut rows) = (args.common.seed.wrapping_add(LESSONS), None, Vec::new());
    let mut bytes = Vec::new();
    for round in 0..args.rounds {
        let count = if round == 0 { args.lessons } else { args.lessons.div_ceil(2) };
        let lessons = share_out("lessons", count, crew, |index| {
            lesson(args, seed.wrapping_add(index), pupil.as_ref())
        })?;
        seed = seed.wrapping_add(count);
        for (more, _) in &lessons {
            examples.extend(more)?;
        }
        let (mut loss, mut progress) = (None, Progress::start());
        while trainer.epochs() < (round + 1) * args.epochs {
            progress.show(|| format!("{} of {} epochs", trainer.epochs(), args.rounds * args.epochs));
            let part = (trainer.epochs() % args.epochs) as f64 / args.epochs as f64;
            loss = Some(trainer.epoch(&examples, RATE * (1.0 - 0.9 * part)).map_err(Failure::run)?);
            store.keep(&trainer.to_checkpoint().map_err(Failure::run)?)?;
        }
        // Other rounds meet the network as a file of weights of 16 bits has it.
        bytes = store.once(&file_of(round), || trainer.network().to_safetensors().map_err(Failure::run))?;
        let network =
            Network::from_safetensors(&bytes).ok().filter(|found| *found.architecture() == args.architecture);
        let error =
            || Failure::input(format!("{}: found a round of another network", store.folder().display()));
        pupil = Some(network.ok_or_else(error)?);
        let astray = lessons.iter().filter(|(_, astray)| *astray).count();
        let row = Row { examples: examples.len(), loss, interventions: astray };
        args.common.tell(row.text(round));
        rows.push(row.json());
    }
    write_whole(out, &bytes).map_err(|error| Failure::run(format!("--out {}: {error}", out.display())))?;
    store.close((0..MOST_ROUNDS).map(file_of))?;
    Ok(Report::new(Outcome::verdict("learned"))
        .field("architecture", args.architecture.to_string())
        .field("examples", examples.len())
        .table("rounds", rows)
        .field("weights", out.display().to_string())
        .field("weights_hash", format!("{:016x}", hash(&bytes)))
        .timing("seconds", watch.seconds()))
}

/// The options on which what is learned depends.
fn facts(args: &Args) -> String {
    let Args { architecture, lessons, rounds: _, epochs, disturbance, common, .. } = args;
    let (seed, noise) = (common.seed, common.noise);
    format!(
        "{architecture}; lessons {lessons}, epochs {epochs}, disturbance {disturbance}, seed {seed}, noise {noise}"
    )
}

/// Where the network after a round is kept.
fn file_of(round: u64) -> String {
    format!("round-{}.safetensors", round + 1)
}

/// A round.
struct Row {
    examples: usize,
    /// `None` if it was learned before an interruption.
    loss: Option<f64>,
    interventions: usize,
}

impl Row {
    fn text(&self, round: u64) -> String {
        let loss = self.loss.map_or_else(|| "as before".into(), |loss| format!("loss {loss:.5}"));
        let Self { examples, interventions, .. } = self;
        format!("round {}: {examples} images, {interventions} lessons ended astray, {loss}", round + 1)
    }

    fn json(&self) -> Value {
        json!({ "examples": self.examples, "loss": self.loss.map(rounded), "interventions": self.interventions })
    }
}
