use roverlab::io::Mishap;
use roverlab::random::Stream;
use roverlab::world::RobotSpec;
use roverlab::world::generate::{ReliefKind, ReliefOptions, relief};
use serde_json::json;

use super::Args;
use super::args::Method;
use super::climb::{Arrival, Summit, climb, equipped};
use super::job::SECONDS;
use crate::common::{Failure, Outcome, Report, portable, rounded, wrong_seeds};
use crate::driving::{Conditions, RESERVE};
use crate::terrain::{Hike, Ride, median};

/// A climb and what came of it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Trial {
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

portable!(struct Trial {
    method, reached, claims_top, mishap, distance, below, path_ratio, sim_time,
});

impl Trial {
    /// Whether the robot tipped, fell or drowned.
    pub(crate) fn is_lost(&self) -> bool {
        self.mishap.is_some_and(Mishap::is_final)
    }

    fn is_good(&self) -> bool {
        self.reached && !self.is_lost()
    }
}

/// Hills of a campaign; each has the next seed.
const HILLS: u64 = 200;
/// The shares of climbs that are to reach the summit, and to be without a mishap; the most that the median
/// path may be longer.
const REACHED: f64 = 0.98;
const UNHARMED: f64 = 0.995;
const LONGEST: f64 = 2.5;

/// The campaign's work.
pub(crate) fn campaign(args: &Args) -> Result<Report, Failure> {
    let trials = trials(args)?;
    let of =
        |method: Method| trials.iter().map(|(_, trial)| trial).filter(move |trial| trial.method == method);
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
    let is_good = |trial: &Trial| trial.method != Method::Search || trial.is_good();
    for (seed, trial) in trials.iter().filter(|(_, trial)| !is_good(trial)) {
        args.common.tell(format_args!(
            "seed {seed}: {:?}, claims the top: {}, {:.0} mm from it, {:.0} mm below",
            trial.mishap,
            trial.claims_top,
            1000.0 * trial.distance,
            1000.0 * trial.below
        ));
    }
    let runs = of(Method::Search).count();
    let reached = of(Method::Search).filter(|trial| trial.reached).count();
    let lost = of(Method::Search).filter(|trial| trial.is_lost()).count();
    let ratio = median(of(Method::Search).map(|trial| trial.path_ratio).collect());
    let enough = reached as f64 >= REACHED * runs as f64 && lost as f64 <= (1.0 - UNHARMED) * runs as f64;
    let good = enough && ratio <= LONGEST;
    let outcome = if good { Outcome::verdict("passed") } else { Outcome::failure("wrong") };
    Ok(Report {
        sim_time: Some(trials.iter().map(|(_, trial)| trial.sim_time).sum()),
        ..Report::new(outcome)
    }
    .field("runs", runs)
    .field("reached", reached)
    .field("mishaps", lost)
    .field("median_path_ratio", rounded(ratio))
    .table("ways", ways)
    .field("wrong_seeds", wrong_seeds(&trials, is_good)))
}

/// All climbs, by seed: each hill by each method.
pub(crate) fn trials(args: &Args) -> Result<Vec<(u64, Trial)>, Failure> {
    let hills = args.trials.trials(&args.common, "hills", HILLS, |seed| {
        Method::ALL.into_iter().map(|method| trial(args, seed, method)).collect::<Result<Vec<_>, _>>()
    })?;
    let climbs =
        hills.into_iter().flat_map(|(seed, climbs)| climbs.into_iter().map(move |climb| (seed, climb)));
    Ok(climbs.collect())
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
