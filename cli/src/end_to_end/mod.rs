//! The command `end-to-end`.

#[cfg(feature = "learn")]
mod lesson;
#[cfg(feature = "learn")]
mod train;

use std::num::NonZero;
use std::path::{Path, PathBuf};

use roverlab::vision::network::{Architecture, Network};

use crate::common::{CommonArgs, Failure, OF_ONE_RUN, PartArgs, Report, check_writable, parse_png};
use crate::lane_keeping::{Pilot, Plan, Setting, one, scores};

/// The command line of `end-to-end`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Trains a network to steer a model car by its camera image, and drives by it before the referee of Free Drive",
    after_help = "\
The network sees the road part of the image, unless told otherwise in grey and of 32 x 80 pixels, and says the curvature to steer;
several results are classes of curvature, ten as in the book with an --architecture that ends in dense10. It drives at one speed,
without odometry.

--train drives courses of its own, other ones than those of a campaign, by the lane keeper of `lane-keeping`, which is disturbed now
and then, and learns its steering. Half of the courses have bends as tight as those of the book's loop, and beside half of the roads
another floor begins. In further rounds the network drives half as many courses itself, and learns what the lane keeper would have
steered there (DAgger). Equal options give equal weights on one machine, whatever the number of threads. What is learned so far is
kept in the folder FILE.training, from which the same command goes on after an interruption.

JSON fields:
  architecture, examples            --train: the network; number of images
  weights, weights_hash             --train: file that was written, and its hash
  rounds                            --train: rows: examples, interventions, loss (mean of the last epoch; none if an
                                    interruption came after it)
  attention                         --attention: the picture
  and those of lane-keeping otherwise
Outcomes: learned; kept, departed (of lanes), timed_out (in its lane, before --minutes were over), failed; with --campaign: passed
(autonomy of at least 99 %), wrong."
)]
pub(crate) struct Args {
    /// Train a network.
    #[arg(long, requires = "out", conflicts_with_all = ["drive", "campaign"])]
    pub(crate) train: bool,

    /// File for the trained network.
    #[arg(long, value_name = "FILE.safetensors", requires = "train")]
    pub(crate) out: Option<PathBuf>,

    /// Layers of the network to train, after rows, columns and channels of what it sees.
    #[arg(long, value_name = "LAYERS", default_value = SMALL)]
    pub(crate) architecture: Architecture,

    /// Courses of 20 s to learn from, in the first round.
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u64).range(1..=1000), allow_hyphen_values = true)]
    pub(crate) lessons: u64,

    /// Rounds; from the second one on, the network drives.
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u64).range(1..=MOST_ROUNDS), allow_hyphen_values = true)]
    pub(crate) rounds: u64,

    /// How often each round looks at all examples.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u64).range(1..=1000), allow_hyphen_values = true)]
    pub(crate) epochs: u64,

    /// Largest curvature by which the lane keeper is disturbed, in 1/m.
    #[arg(long, value_name = "F", default_value_t = 1.5, value_parser = crate::lane_keeping::disturbance, allow_hyphen_values = true)]
    pub(crate) disturbance: f64,

    /// Weights to drive by, a file that --train wrote [default: built in].
    #[arg(long, value_name = "FILE.safetensors")]
    pub(crate) drive: Option<PathBuf>,

    /// Picture of what the network looks at: the camera's last image, redder where that contributes to what its filters see.
    #[arg(long, value_name = "FILE.png", value_parser = parse_png)]
    pub(crate) attention: Option<PathBuf>,

    /// Course to drive: a seed, or a file in the format of docs/courses.md.
    #[arg(long, value_name = "SEED|FILE", default_value = "1")]
    pub(crate) course: String,

    /// Minutes to drive.
    #[arg(long, value_name = "N", default_value_t = 2.0, value_parser = crate::lane_keeping::minutes, allow_hyphen_values = true)]
    pub(crate) minutes: f64,

    /// Speed in m/s [default: 1].
    #[arg(long, value_name = "M/S", value_parser = crate::lane_keeping::speed, allow_hyphen_values = true)]
    pub(crate) speed: Option<f64>,

    /// Brightness of the light; 1 is a well lit room.
    #[arg(long, value_name = "F", default_value_t = 1.0, value_parser = crate::lane_keeping::light, allow_hyphen_values = true)]
    pub(crate) light: f64,

    /// Drive on many courses, from --seed on, each in its own light.
    #[arg(long)]
    pub(crate) campaign: bool,

    /// Number of courses in a campaign.
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u64).range(1..=100_000), allow_hyphen_values = true)]
    pub(crate) courses: u64,

    /// Number of threads in a campaign, or of training [default: one per core].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub(crate) threads: Option<NonZero<usize>>,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("always", &["world", "robot", "start", "goal", "quantised", "robios", "supervised"]),
    ("campaign", OF_ONE_RUN),
    ("campaign", &["attention", "course", "light"]),
    ("!campaign", &["courses"]),
    ("!campaign&!train", &["threads"]),
    ("!train", &["architecture", "lessons", "rounds", "epochs", "disturbance"]),
    ("train", OF_ONE_RUN),
    ("train", &["attention", "course", "minutes", "speed", "light", "time_limit"]),
]);

/// Most rounds of a training.
const MOST_ROUNDS: u64 = 20;
/// The built-in network.
const SMALL: &str = "32x80x1 conv12/5/2 conv24/5/2 conv32/3/1 dense64 dense1";
/// Its weights: `roverlab end-to-end --train --out cli/nets/steering.safetensors`.
const WEIGHTS: &[u8] = include_bytes!("../../nets/steering.safetensors");
/// Autonomy of a good network (percent).
const ENOUGH: f64 = 99.0;

/// Runs the command.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    if let (true, Some(out)) = (args.train, &args.out) {
        return learned(args, out);
    }
    let network = Box::new(steering(&args.common, "drive", args.drive.as_deref())?);
    let pilot = Pilot::Network(network);
    let attention = args.attention.as_deref();
    if let Some(file) = attention {
        check_writable("--attention", file)?;
    }
    let plan = Plan { pilot, speed: args.speed, minutes: args.minutes, attention, common: &args.common };
    if args.campaign {
        let scores = scores(&plan, args.courses, args.threads, &PartArgs::default())?;
        return Ok(scores.report("net", scores.autonomy() >= ENOUGH));
    }
    one(&plan, &Setting::of(&args.common, &args.course, args.light)?)
}

#[cfg(feature = "learn")]
fn learned(args: &Args, out: &Path) -> Result<Report, Failure> {
    train::train(args, out)
}

#[cfg(not(feature = "learn"))]
fn learned(_: &Args, _: &Path) -> Result<Report, Failure> {
    Err(Failure::input("--train: this program was built without the feature `learn`"))
}

/// The network of a file that an option names, or the built-in one.
pub(crate) fn steering(common: &CommonArgs, option: &str, file: Option<&Path>) -> Result<Network, Failure> {
    let Some(file) = file else {
        return Network::from_safetensors(WEIGHTS).map_err(Failure::run);
    };
    let bytes = common.read(option, file).map_err(Failure::input)?;
    let fail = |error| Failure::input(format!("--{option} {}: {error}", file.display()));
    Network::from_safetensors(&bytes).map_err(fail)
}
