use roverlab::io::Mishap;
use roverlab::nav::RampOutcome;

use super::Args;
use super::cross::{Passage, cross, levels};
use super::job::SECONDS;
use crate::common::{Failure, Outcome, Report, millimetres, portable, wrong_seeds};
use crate::driving::{Conditions, RESERVE};
use crate::terrain::{Ride, median};

/// A crossing of generated levels.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Trial {
    pub(crate) crossed: bool,
    pub(crate) outcome: Option<RampOutcome>,
    pub(crate) mishap: Option<Mishap>,
    pub(crate) edge_distance: f64,
    pub(crate) sim_time: f64,
}

portable!(struct Trial { crossed, outcome, mishap, edge_distance, sim_time });

impl Trial {
    /// Whether the robot fell or tipped.
    pub(crate) fn is_lost(&self) -> bool {
        self.mishap.is_some_and(Mishap::is_final)
    }

    fn is_good(&self) -> bool {
        self.crossed && !self.is_lost()
    }
}

/// Levels of a campaign; each has the next seed.
const LEVELS: u64 = 200;
/// Smallest part of the levels that has to be crossed; no robot may fall.
const CROSSED: f64 = 0.99;

/// The campaign's work.
pub(crate) fn campaign(args: &Args) -> Result<Report, Failure> {
    let trials = trials(args)?;
    let runs = trials.len();
    let crossed = trials.iter().filter(|(_, trial)| trial.crossed).count();
    let falls = trials.iter().filter(|(_, trial)| trial.is_lost()).count();
    for (seed, trial) in trials.iter().filter(|(_, trial)| !trial.is_good()) {
        args.common.tell(format_args!("seed {seed}: {:?}, {:?}", trial.outcome, trial.mishap));
    }
    let good = falls == 0 && crossed as f64 >= CROSSED * runs as f64;
    let outcome = if good { Outcome::verdict("passed") } else { Outcome::failure("wrong") };
    let edge_distance = median(trials.iter().map(|(_, trial)| trial.edge_distance).collect());
    Ok(Report {
        sim_time: Some(trials.iter().map(|(_, trial)| trial.sim_time).sum()),
        ..Report::new(outcome)
    }
    .field("runs", runs)
    .field("passed", crossed)
    .field("falls", falls)
    .field("median_edge_distance_mm", millimetres(edge_distance))
    .field("wrong_seeds", wrong_seeds(&trials, Trial::is_good)))
}

/// All crossings, by seed.
pub(crate) fn trials(args: &Args) -> Result<Vec<(u64, Trial)>, Failure> {
    args.trials.trials(&args.common, "levels", LEVELS, |seed| trial(args, seed))
}

fn trial(args: &Args, seed: u64) -> Result<Trial, Failure> {
    let hike = levels(seed);
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
    let run = cross(&hike, &conditions, |_| {}, |_| {})?;
    let passage = Passage::of(&hike, &run);
    let outcome = run.ending.as_ref().ok().map(|ended| ended.outcome);
    let mishap = Ride::of(&run).and_then(|ride| ride.end.mishap);
    let lost = mishap.is_some_and(Mishap::is_final);
    Ok(Trial {
        crossed: outcome == Some(RampOutcome::Crossed) && passage.crossed && !lost,
        outcome,
        mishap,
        edge_distance: passage.edge_distance,
        sim_time: run.sim_time,
    })
}
