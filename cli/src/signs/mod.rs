//! The command `signs`.

mod drawing;
mod evaluation;
mod faces;
mod folder;
mod frames;
#[cfg(feature = "learn")]
mod network;

use std::num::NonZero;
use std::path::{Path, PathBuf};

use roverlab::files::write_whole;
use roverlab::vision::RgbView;
use roverlab::vision::signs::{Area, SignFinder, SignModel, SignTrainer};

use crate::common::{Failure, Outcome, PlainArgs, Report, Stopwatch, check_writable, regular_bytes};
use evaluation::Evaluation;
use faces::Faces;

/// Command line of `signs`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Learns to find traffic signs and to tell their classes, from pictures with known boxes, and tries it on others",
    after_help = "\
A folder has a file boxes.csv and the pictures that it names. Its first line names the columns: `file`, `class`, and either
`left`, `top`, `width`, `height` or `x1`, `y1`, `x2`, `y2`, in pixels. Where the pictures show little else than a sign, in the mean
at least a quarter of the picture, only its class is learned and told, and its box is given; otherwise signs are searched for, and
one is right if it has the class and at least half of what box and find cover together is in both. If boxes do not fit into
their pictures, all pictures have been scaled since; boxes are then taken to have equal margins left and right, above and below.

With --network, a network learns the classes too: from signs that are shown turned, slanted, darker, coarser and partly covered. What
it has learned is kept in the folder FILE.training, from which the same command goes on after an interruption.

Without a folder it learns from, and is tried on, pictures that it draws: faces at 0.4 to 1.5 m, turned by up to 35 degrees, in
30 to 150 % of the light, blurred by motion. Signs of less than 20 pixels may be found, but need not be. There are six faces of the
book's model road, or with `--faces caudri` 25 faces of 19 classes that the rules of the CAuDri-Challenge name, in their sizes. A
speed zone has any number there, and a board of three chevrons counts as three signs.

JSON fields:
  pictures                    number of pictures that it was tried on, or that it learned from
  finds                       whether signs are searched for
  classes                     rows: class, right, false, missed, precision, recall, f1
  mean_precision, mean_recall, mean_f1
  accuracy                    share of the signs whose class is right
  weights, weights_hash       file that was written, and its hash
  picture                     precision and recall of each class
  timing                      with --timing: median_ms of a picture, or seconds of learning
Outcomes: learned, evaluated."
)]
pub(crate) struct Args {
    /// Folder to learn from.
    #[arg(long, value_name = "FOLDER", conflicts_with = "evaluate", requires = "out")]
    pub(crate) train: Option<PathBuf>,

    /// File for what has been learned.
    #[arg(long, value_name = "FILE.safetensors", requires = "train")]
    pub(crate) out: Option<PathBuf>,

    /// Let a network learn the classes too, which tells them better: minutes instead of seconds.
    #[arg(long, requires = "train")]
    pub(crate) network: bool,

    /// How often the network sees as many signs as there are.
    #[arg(long, value_name = "N", default_value_t = 60, value_parser = clap::value_parser!(u64).range(1..=1000), allow_hyphen_values = true)]
    pub(crate) epochs: u64,

    /// Number of threads that train it [default: one per core].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub(crate) threads: Option<NonZero<usize>>,

    /// Folder to be tried on.
    #[arg(long, value_name = "FOLDER", requires = "weights")]
    pub(crate) evaluate: Option<PathBuf>,

    /// File that --train wrote.
    #[arg(long, value_name = "FILE.safetensors", requires = "evaluate")]
    pub(crate) weights: Option<PathBuf>,

    /// Faces that are drawn.
    #[arg(long, value_enum, default_value = "book")]
    pub(crate) faces: Faces,

    /// Pictures that are drawn to learn from [default: 12 of each face, and 12 without a sign].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(7..=10_000), allow_hyphen_values = true)]
    pub(crate) learn: Option<u32>,

    /// Pictures that are drawn to be tried on [default: 4 of each face, and 4 without a sign].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000), allow_hyphen_values = true)]
    pub(crate) frames: Option<u32>,

    #[command(flatten)]
    pub(crate) plain: PlainArgs,
}

crate::common::shares_options!(Args, plain: PlainArgs, unheeded: [
    ("always", &["animation"]),
    ("train", &["faces", "frames", "learn", "picture"]),
    ("evaluate", &["faces", "frames", "learn", "seed"]),
    ("!network", &["epochs", "threads"]),
]);

/// A picture and its signs: their classes, by index, and boxes.
#[derive(Debug, Clone)]
struct Marked {
    /// Where it comes from.
    name: String,
    pixels: Vec<u8>,
    size: (usize, usize),
    signs: Vec<(usize, Area)>,
}

impl Marked {
    fn view(&self) -> RgbView<'_> {
        RgbView::new(&self.pixels, self.size.0, self.size.1).expect("the pixels of its size")
    }
}

/// The command's work.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    args.plain.check_picture()?;
    let evaluation = match (&args.train, &args.out, &args.evaluate, &args.weights) {
        (Some(from), Some(out), ..) => return train(args, from, out),
        (.., Some(folder), Some(weights)) => evaluate(folder, weights)?,
        _ => evaluate_drawn(args)?,
    };
    Ok(args.plain.draw(evaluation.report(), "signs.svg", || drawing::picture(&evaluation)))
}

/// Learns from pictures that are drawn, and is tried on others.
fn evaluate_drawn(args: &Args) -> Result<Evaluation, Failure> {
    let (faces, seed) = (args.faces, args.plain.seed);
    // Each face once, and a picture without.
    let round = faces.all().len() as u32 + 1;
    let learn = args.learn.unwrap_or(12 * round);
    if learn < round {
        return Err(Failure::input(format!(
            "--learn: found {learn}; expected at least {round}: each face once, and a picture without"
        )));
    }
    let names: Vec<String> = faces.names().into_iter().map(String::from).collect();
    let model = learned(&trainer(&names, &frames::drawn(faces, learn, seed, "learned"))?, true, seed)?;
    let pictures = frames::drawn(faces, args.frames.unwrap_or(4 * round), seed, "tried");
    Evaluation::by_search(&mut SignFinder::new(model), &pictures, frames::LEAST)
}

fn train(args: &Args, from: &Path, out: &Path) -> Result<Report, Failure> {
    let watch = Stopwatch::start();
    check_writable("--out", out)?;
    let folder = folder::read(from, None)?;
    let trainer = trainer(&folder.names, &folder.pictures)?;
    let model = learned(&trainer, folder.finds(), args.plain.seed)?;
    let finds = model.finds();
    let write = |model: SignModel| {
        let bytes = model.to_safetensors().map_err(Failure::run)?;
        write_whole(out, &bytes)
            .map_err(|error| Failure::run(format!("--out {}: {error}", out.display())))?;
        Ok(bytes)
    };
    let bytes = if args.network {
        network(args, out, (&trainer, &folder.names), |network| write(model.with_network(network)?))?
    } else {
        write(model)?
    };
    Ok(Report::new(Outcome::verdict("learned"))
        .field("pictures", folder.pictures.len())
        .field("finds", finds)
        .field("weights_hash", format!("{:016x}", hash(&bytes)))
        .field("weights", out.display().to_string())
        .timing("seconds", watch.seconds()))
}

/// FNV-1a of 64 bits.
pub(crate) fn hash(bytes: &[u8]) -> u64 {
    bytes
        .iter()
        .fold(0xcbf2_9ce4_8422_2325, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

#[cfg(feature = "learn")]
use network::learned as network;

#[cfg(not(feature = "learn"))]
fn network<T>(
    _: &Args,
    _: &Path,
    _: (&SignTrainer, &[String]),
    _: impl FnOnce(roverlab::vision::network::Network) -> Result<T, Failure>,
) -> Result<T, Failure> {
    Err(Failure::input("--network: this program was built without training; expected the feature `learn`"))
}

/// A trainer of marked pictures.
fn trainer(names: &[String], pictures: &[Marked]) -> Result<SignTrainer, Failure> {
    let mut trainer = SignTrainer::new(names.iter().map(String::as_str))?;
    for picture in pictures {
        trainer
            .add(picture.view(), &picture.signs)
            .map_err(|error| Failure::input(format!("{}: {error}", picture.name)))?;
    }
    Ok(trainer)
}

fn learned(trainer: &SignTrainer, finds: bool, seed: u64) -> Result<SignModel, Failure> {
    let model = if finds { trainer.finder(seed) } else { trainer.classifier(seed) };
    model.map_err(Failure::input)
}

fn evaluate(folder: &Path, weights: &Path) -> Result<Evaluation, Failure> {
    let fail = |error: String| Failure::input(format!("--weights {}: {error}", weights.display()));
    let bytes = regular_bytes(weights).map_err(|error| fail(error.to_string()))?;
    let model = SignModel::from_safetensors(&bytes).map_err(|error| fail(error.to_string()))?;
    let folder = folder::read(folder, Some(model.names()))?;
    if folder.finds() && !model.finds() {
        return Err(fail(
            "they tell classes of signs whose places are known; expected ones that find signs".into(),
        ));
    }
    let mut finder = SignFinder::new(model);
    if folder.finds() {
        Evaluation::by_search(&mut finder, &folder.pictures, 0.0)
    } else {
        Evaluation::by_boxes(&mut finder, &folder.pictures)
    }
}
