//! Training of a network that tells the classes of signs.

use std::num::NonZero;
use std::path::Path;

use roverlab::learn::{Loss, Trainer, TrainerOptions};
use roverlab::vision::network::Network;
use roverlab::vision::signs::SignTrainer;

use super::{Args, hash};
use crate::common::{Failure, Progress, TrainingStore, threads};

/// Its layers before the one for the classes.
const LAYERS: &str = "32x32x3 conv24/5/1 pool2 conv48/3/1 pool2 conv96/3/1 dense150";
/// Signs between two steps.
const BATCH: usize = 64;
/// Part of the weights, times the rate, that each step takes off.
const DECAY: f64 = 0.05;
/// Part of what the last layer sees that is hidden from it.
const HIDDEN: f64 = 0.5;
/// Rate of the first epoch; it falls evenly to almost nothing.
const RATE: f64 = 1e-3;

/// Learns the classes of a trainer's signs, and has the network written. What is learned so far is kept
/// beside the file until then.
pub(super) fn learned<T>(
    args: &Args,
    out: &Path,
    (signs, names): (&SignTrainer, &[String]),
    write: impl FnOnce(Network) -> Result<T, Failure>,
) -> Result<T, Failure> {
    let patches = signs.patches()?;
    let labels = patches.classes().iter().map(|&class| names[class].as_str()).collect::<Vec<_>>().join("\n");
    let facts = format!(
        "{} signs of hash {:016x}, classes of hash {:016x}, {} epochs, seed {}",
        patches.len(),
        hash(patches.bytes()),
        hash(labels.as_bytes()),
        args.epochs,
        args.plain.seed
    );
    let store = TrainingStore::open(out, &facts)?;
    let architecture = format!("{LAYERS} dense{}", names.len()).parse()?;
    let options = TrainerOptions {
        loss: Loss::Classes,
        batch: BATCH,
        decay: DECAY,
        hidden: HIDDEN,
        seed: args.plain.seed,
        threads: NonZero::new(threads(args.threads)).unwrap_or(NonZero::<usize>::MIN),
    };
    let mut trainer = match store.state()? {
        Some(bytes) => Trainer::from_checkpoint(&bytes, architecture, options).map_err(Failure::input)?,
        None => Trainer::new(architecture, options)?,
    };
    let (mut progress, mut loss) = (Progress::start(), None);
    while trainer.epochs() < args.epochs {
        let told = loss.map_or(String::new(), |loss: f64| format!(", loss {loss:.3}"));
        progress.show(|| format!("{} of {} epochs{told}", trainer.epochs(), args.epochs));
        let part = trainer.epochs() as f64 / args.epochs as f64;
        loss = Some(trainer.epoch(&patches, RATE * (1.0 - part)).map_err(Failure::run)?);
        store.keep(&trainer.to_checkpoint().map_err(Failure::run)?)?;
    }
    let written = write(trainer.network())?;
    store.close(std::iter::empty())?;
    Ok(written)
}
