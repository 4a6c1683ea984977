use roverlab::io::Mishap;
use roverlab::random::Stream;
use roverlab::world::RobotSpec;
use roverlab::world::generate::{ReliefKind, ReliefOptions, relief};
use serde_json::json;

use super::Args;
use super::args::Method;
use super::climb::{Arrival, Summit, climb, equipped};
use super::job::SECONDS;
use crate::common::{Failure, Outcome, Report, rounded, share_out, threads};
use crate::driving::{Conditions, RESERVE};
use crate::terrain::{Hike, Ride, median};

/// A climb and what came of it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Trial {
    pub(crate) seed: u64,
    pub(crate) method: Method,
    pub(crate) reached: bool,
    pub(crate) claims_top: bool,
    pub(crate) mishap: Option<Mishap>,
    /// Metres from the highest reachable place and below it.
    pub(crate) distance: f64,
    pub(crate) below: f64,
    /// The path as a multiple of the way of who knows the map.
    pub(crate) path_ratio: f64,
    pub(crate) sim_time: f64,
}

impl Trial {
    /// Whether the robot tipped, fell or drowned.
    pub(crate) fn is_lost(&self) -> bool {
        self.mishap.is_some_and(|mishap| mishap != Mishap::Stuck)
    }
}

/// The shares of climbs that are to reach the summit, and to be without a mishap; the most that the median
/// path may be longer.
const REACHED: f64 = 0.98;
const UNHARMED: f64 = 0.995;
const LONGEST: f64 = 2.5;

/// The campaign's work.
pub(crate) fn campaign(args: &Args) -> Result<Report, Failure> {
    let trials = trials(args)?;
    let of = |method: Method| trials.iter().filter(move |trial| trial.method == method);
    let mut ways = Vec::new();
    for method in Method::ALL {
        let runs = of(method).count();
        let reached = of(method).filter(|trial| trial.reached).count();
        let lost = of(method).filter(|trial| trial.is_lost()).count();
        let ratio = median(of(method).filter(|trial| trial.reached).map(|trial| trial.path_ratio).collect());
        args.common.tell(format_args!(
            "{:7} {reached} of {runs} reached, {lost} tipped, fallen or drowned, median path {ratio:.2} of the way",
            method.name()
        ));
        ways.push(json!({
            "method": method.name(), "runs": runs, "reached": reached, "mishaps": lost,
            "median_path_ratio": rounded(ratio),
        }));
    }
    let wrong: Vec<u64> = of(Method::Search)
        .filter(|trial| !trial.reached || trial.is_lost())
        .map(|trial| trial.seed)
        .collect();
    for trial in of(Method::Search).filter(|trial| wrong.contains(&trial.seed)) {
        args.common.tell(format_args!(
            "seed {}: {:?}, claims the top: {}, {:.0} mm from it, {:.0} mm below",
            trial.seed,
            trial.mishap,
            trial.claims_top,
            1000.0 * trial.distance,
            1000.0 * trial.below
        ));
    }
    let runs = args.runs as f64;
    let reached = of(Method::Search).filter(|trial| trial.reached).count();
    let lost = of(Method::Search).filter(|trial| trial.is_lost()).count();
    let ratio = median(of(Method::Search).map(|trial| trial.path_ratio).collect());
    let good = reached as f64 >= REACHED * runs && lost as f64 <= (1.0 - UNHARMED) * runs && ratio <= LONGEST;
    let outcome = if good { Outcome::verdict("passed") } else { Outcome::failure("wrong") };
    Ok(Report { sim_time: Some(trials.iter().map(|trial| trial.sim_time).sum()), ..Report::new(outcome) }
        .field("runs", args.runs)
        .field("reached", reached)
        .field("mishaps", lost)
        .field("median_path_ratio", rounded(ratio))
        .table("ways", ways)
        .field("wrong_seeds", wrong))
}

/// All climbs: each hill by each method, in the order of the seeds.
pub(crate) fn trials(args: &Args) -> Result<Vec<Trial>, Failure> {
    let count = args.runs * Method::ALL.len() as u64;
    share_out("climbs", count, threads(args.threads), |index| {
        let method = Method::ALL[index as usize % Method::ALL.len()];
        trial(args, args.common.seed.wrapping_add(index / Method::ALL.len() as u64), method)
    })
}

fn trial(args: &Args, seed: u64, method: Method) -> Result<Trial, Failure> {
    let made = relief(&mut Stream::new(seed), &ReliefOptions::of(ReliefKind::Range)).map_err(Failure::run)?;
    let hike = Hike::generated(made, equipped(RobotSpec::blizzard(), method));
    let summit = Summit::of(&hike, args)?;
    let conditions = Conditions {
        seed,
        noise: args.common.noise,
        light: 1.0,
        keys: Vec::new(),
        pushing: false,
        others: Vec::new(),
        ideal_encoders: false,
        time_limit: args.common.time_limit.unwrap_or(SECONDS),
        reserve: RESERVE,
        common: None,
    };
    let run = climb(args, method, &hike, &conditions, |_| {}, |_| {})?;
    let ride = Ride::of(&run);
    let (distance, below) = ride.map_or((f64::INFINITY, f64::INFINITY), |ride| {
        (summit.distance(&ride.end), summit.place.z - ride.height())
    });
    let claims_top = run.ending.as_ref().is_ok_and(|ended| ended.arrival == Arrival::Top);
    Ok(Trial {
        seed,
        method,
        reached: claims_top && ride.is_some_and(|ride| summit.is_reached(&ride.end)),
        claims_top,
        mishap: ride.and_then(|ride| ride.end.mishap),
        distance,
        below,
        path_ratio: run.truth.path_length / summit.way.unwrap_or(0.0).max(0.1),
        sim_time: run.sim_time,
    })
}
