use roverlab::drive::RandomDriveParameters;
use roverlab::geometry::{angle_difference, units};
use roverlab::scan::Localisation;
use roverlab::world::{RobotSpec, Scene};
use serde_json::{Value, json};

use super::drive::{Finding, Options, drive};
use super::{campaign, picture, worlds};
use crate::common::{CommonArgs, Failure, OF_PARTS, Outcome, PartArgs, Report, millimetres, rounded};
use crate::driving::{Conditions, Run, check_level_lidar, localisation_map, paced};

/// Command line of `localise`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Localises a robot in a known world by matching scans while it drives around",
    after_help = "\
Without --world, the robot is at a random place, by the seed, in a built-in office. It knows the world, but neither its
position nor its heading. It drives around at random until a single place explains all its scans, or --patience is over.
Its lidar has to be level.

With --campaign, many starts in worlds and halls, some of which look the same from several places; with --world, many
starts in that world. An answer is wrong if it is a single place more than 100 mm or 5 standard deviations away, or one
of several identical places, or several places that do not include the robot's.

JSON fields:
  position_error_mm, heading_error_deg
                              of the most probable place; null if there is none
  hypotheses                  number of places that explain the scans
  places                      a list of {x_mm, y_mm, heading_deg, probability}, most probable one first
  deviation_mm, deviation_deg standard deviations of the most probable place: the larger one of x and y, and heading
  scans                       number of matched scans
  time_limit_s, picture
  rows                        with --campaign only: the table
Outcomes: localised, several_hypotheses, lost, collided, timed_out, failed; with --campaign: passed, wrong."
)]
pub(crate) struct Args {
    /// Seconds to drive about while there are several places.
    #[arg(long, value_name = "S", default_value_t = 40.0, value_parser = parse_patience, allow_hyphen_values = true)]
    pub(crate) patience: f64,

    /// Start at many places in many worlds and print a table.
    #[arg(long)]
    pub(crate) campaign: bool,

    /// Starts in each world of a campaign; a fifth of it where several places look the same.
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u64).range(1..), allow_hyphen_values = true)]
    pub(crate) starts: u64,

    /// The part to do.
    #[command(flatten)]
    pub(crate) parts: PartArgs,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("campaign", &["robot", "start", "goal", "picture", "animation", "robios", "quantised", "realtime", "fault", "supervised"]),
    ("!campaign", &["starts"]),
    ("!campaign", OF_PARTS),
]);

fn parse_patience(text: &str) -> Result<f64, String> {
    let patience = text.parse().ok().filter(|patience: &f64| (1.0..=1e5).contains(patience));
    patience.ok_or_else(|| "expected 1 to 100000 s".into())
}

/// The command's work.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    if args.campaign {
        return campaign(args);
    }
    let common = &args.common;
    common.check_picture()?;
    let scene = common.placed_without_goal("the robot goes nowhere", || own_scene(common.seed))?;
    check_level_lidar(&scene)?;
    let conditions = Conditions { reserve: 0.0, ..Conditions::new(common, args.patience + 30.0)? };
    let run = run(args, &scene, &conditions, paced(common))?;
    let report = report(&run).field("time_limit_s", conditions.time_limit);
    Ok(common.draw(report, "localise.svg", || picture::of(&scene, &run, conditions.noise, conditions.seed)))
}

/// The office, with a robot at a random pose.
fn own_scene(seed: u64) -> Scene {
    let (world, spec) = (worlds::office(), RobotSpec::s4());
    let starts = worlds::Starts::new(&world, spec.footprint.bounding_radius());
    let start = starts.ok().and_then(|starts| starts.draw(seed)).expect("the office has free floor");
    Scene::with_robot(world, spec, start)
}

/// Lets the robot localise itself.
pub(super) fn run(
    args: &Args,
    scene: &Scene,
    conditions: &Conditions,
    pace: impl FnMut(f64),
) -> Result<Run<Finding>, Failure> {
    let radius = scene.robots[0].spec.footprint.bounding_radius();
    let options = Options {
        map: localisation_map(scene).map_err(Failure::input)?,
        localiser: conditions.localiser(&scene.robots[0].spec),
        random: RandomDriveParameters { radius, ..RandomDriveParameters::default() },
        seed: conditions.seed,
        patience: args.patience.min(conditions.time_limit - 2.0),
    };
    let run = conditions.run(scene, pace, |robot, step| drive(robot, &options, step))?;
    let settled = run.ending.as_ref().is_ok_and(|finding| finding.settled);
    Ok(if settled { run } else { run.lasting(options.patience) })
}

/// Position (m) and heading error (rad) of the most probable place.
pub(super) fn errors(run: &Run<Finding>) -> Option<(f64, f64)> {
    let best = run.ending.as_ref().ok()?.localisation.best()?;
    let truth = run.truth.pose;
    Some((best.pose.distance_to(truth.position()), angle_difference(best.pose.heading, truth.heading).abs()))
}

fn report(run: &Run<Finding>) -> Report {
    let report = run.report(|finding| match finding.localisation {
        Localisation::One(_) => Outcome::verdict("localised"),
        Localisation::Several(..) => Outcome::verdict("several_hypotheses"),
        _ => Outcome::failure("lost"),
    });
    let errors = errors(run);
    let finding = run.ending.as_ref().ok();
    let best = finding.and_then(|finding| finding.localisation.best());
    let count = finding.map(|finding| finding.localisation.count());
    let turn = best.map(|best| best.covariance[(2, 2)].max(0.0).sqrt());
    report
        .field("position_error_mm", errors.map(|(position, _)| millimetres(position)))
        .field("heading_error_deg", errors.map(|(_, heading)| rounded(units::to_deg(heading))))
        .field("hypotheses", count)
        .field("places", finding.map(places))
        .field("deviation_mm", best.map(|best| millimetres(best.deviation())))
        .field("deviation_deg", turn.map(|heading| rounded(units::to_deg(heading))))
        .field("scans", finding.map(|finding| finding.scans))
}

fn places(finding: &Finding) -> Vec<Value> {
    let place = |hypothesis: &roverlab::scan::Hypothesis| {
        json!({
            "x_mm": millimetres(hypothesis.pose.x),
            "y_mm": millimetres(hypothesis.pose.y),
            "heading_deg": rounded(units::to_deg(hypothesis.pose.heading)),
            "probability": rounded(hypothesis.probability),
        })
    };
    finding.hypotheses.iter().take(finding.localisation.count()).map(place).collect()
}
