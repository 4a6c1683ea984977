//! The command `parking`.

mod drawing;
mod drive;

use roverlab::drive::parking::{ParkingKind, ParkingLot, ParkingOutcome};
use roverlab::io::sim::SimOptions;
use roverlab::random::Stream;
use roverlab::world::road::Appearance;
use serde_json::json;

use crate::common::{
    CampaignArgs, CommonArgs, Failure, OF_A_CAMPAIGN, OF_ONE_RUN, Outcome, Report, Stage, campaign_report,
    millimetres, wrong_seeds,
};
use drive::Drive;

/// The command line of `parking`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Parks a model car between boxes beside a road, parallel or perpendicular",
    after_help = "\
The seed draws the parking area by the rules of the CAuDri-Challenge: a free spot between boxes, parallel to the road on the
right, 1.4 to 2.1 times as long as the car and behind a gap that is too short, or perpendicular to it on the left. The car keeps
its lane by camera, measures the boxes with a distance sensor on its side, and manoeuvres by odometry.

With --campaign, many areas of both kinds in light of 50 to 150 %.

JSON fields:
  kind                        parallel or perpendicular
  spot_mm                     length of the spot along the road
  legal                       whether all wheels stand in the spot
  touched                     whether the car has touched a box
  lots, rows                  campaign: number of areas; rows by kind: lots, legal, touched
Outcomes: parked, outside (the car stands, but not in the spot), no_path, touched, timed_out, failed; with --campaign: passed (98 %
legal, none touched), wrong."
)]
pub(crate) struct Args {
    /// Kind of the parking area.
    #[arg(long, value_enum, default_value = "parallel")]
    pub(crate) kind: Kind,

    #[command(flatten)]
    pub(crate) trials: CampaignArgs,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("always", &["world", "robot", "start", "goal", "quantised", "robios", "supervised"]),
    ("campaign", OF_ONE_RUN),
    ("campaign", &["kind"]),
    ("!campaign", OF_A_CAMPAIGN),
]);

/// Kind of the parking area.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Kind {
    /// Along the road, on the right.
    Parallel,
    /// Across the road, on the left.
    Perpendicular,
}

impl Kind {
    const ALL: [Self; 2] = [Self::Parallel, Self::Perpendicular];

    fn name(self) -> &'static str {
        match self {
            Self::Parallel => "parallel",
            Self::Perpendicular => "perpendicular",
        }
    }

    fn lot(self, seed: u64) -> Result<ParkingLot, Failure> {
        let kind = match self {
            Self::Parallel => ParkingKind::Parallel,
            Self::Perpendicular => ParkingKind::Perpendicular,
        };
        ParkingLot::drawn(kind, seed).map_err(Failure::input)
    }
}

/// Number of areas in a campaign without `--runs`, and the share of legal ones.
const LOTS: u64 = 500;
const LEGAL: f64 = 0.98;

/// Runs the command.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    if args.trials.campaign {
        return campaign(args);
    }
    let common = &args.common;
    common.check_picture()?;
    let lot = args.kind.lot(common.seed)?;
    let look = Appearance { seed: common.seed, ..Appearance::default() };
    let scene = lot.scene(&look).map_err(Failure::input)?;
    let stage = common.stage(&scene, SimOptions::with_noise(common.noise, common.seed))?;
    let drive = drive::drive(args, &lot, &stage)?;
    let report = report(args, &lot, &drive);
    Ok(common.draw(report, "parking.svg", || drawing::picture(&lot, &drive)))
}

fn report(args: &Args, lot: &ParkingLot, drive: &Drive) -> Report {
    let (word, error) = match &drive.ending {
        Err(error) => (Outcome::failure("failed"), Some(error.clone())),
        Ok(_) if drive.is_touched => (Outcome::failure("touched"), None),
        Ok(ParkingOutcome::Parked) if drive.is_legal => (Outcome::verdict("parked"), None),
        Ok(ParkingOutcome::Parked) => (Outcome::failure("outside"), None),
        Ok(ParkingOutcome::NoPath) => (Outcome::failure("no_path"), None),
        Ok(ParkingOutcome::TimedOut | ParkingOutcome::Stopped) => (Outcome::failure("timed_out"), None),
    };
    let report = Report {
        sim_time: drive.trail.last().map(|(time, _)| *time),
        collisions: Some(drive.truth.contacts.into()),
        path_length: Some(drive.truth.path_length),
        pose: Some(drive.truth.pose),
        odometry: Some(lot.course.start().compose(&drive.truth.odometry)),
        error,
        ..Report::new(word)
    };
    report
        .field("kind", args.kind.name())
        .field("spot_mm", millimetres(lot.spot.1 - lot.spot.0))
        .field("legal", drive.is_legal)
        .field("touched", drive.is_touched)
}

/// Result of a trial: legal, touched.
type Trial = (bool, bool);

fn campaign(args: &Args) -> Result<Report, Failure> {
    let trials = args.trials.trials(&args.common, "lots", LOTS, |seed| trial(args, seed))?;
    let mut rows = Vec::new();
    args.common.tell("kind            lots  legal  touched");
    for kind in Kind::ALL {
        let of = || trials.iter().filter(move |(seed, _)| kind_of(*seed) == kind);
        let (lots, legal) = (of().count(), of().filter(|(_, trial)| trial.0).count());
        let touched = of().filter(|(_, trial)| trial.1).count();
        args.common.tell(format_args!("{:<14}{lots:>6}{legal:>7}{touched:>9}", kind.name()));
        rows.push(json!({ "kind": kind.name(), "lots": lots, "legal": legal, "touched": touched }));
    }
    let legal = trials.iter().filter(|(_, trial)| trial.0).count() as f64;
    let touched = trials.iter().filter(|(_, trial)| trial.1).count();
    let passed = touched == 0 && legal >= LEGAL * trials.len() as f64;
    let wrong = wrong_seeds(&trials, |&(is_legal, is_touched)| is_legal && !is_touched);
    let report = campaign_report(passed, touched as u64, &wrong);
    Ok(report.field("lots", trials.len()).field("legal", legal as u64).table("rows", rows))
}

/// Kind of the area of a seed in a campaign.
fn kind_of(seed: u64) -> Kind {
    Kind::ALL[(seed % 2) as usize]
}

fn trial(args: &Args, seed: u64) -> Result<Trial, Failure> {
    let lot = kind_of(seed).lot(seed)?;
    let mut random = Stream::new(seed).child("parking campaign", 0);
    let light = random.between(0.5, 1.5);
    let look =
        Appearance { wear: random.between(0.0, 0.35), glare: random.below(6), seed, ..Appearance::default() };
    let options = SimOptions { light, ..SimOptions::with_noise(args.common.noise, seed) };
    let stage = Stage::simulated(&lot.scene(&look).map_err(Failure::input)?, options, Vec::new())?;
    let drive = drive::drive(args, &lot, &stage)?;
    drive.ending.map_err(Failure::run)?;
    Ok((drive.is_legal, drive.is_touched))
}
