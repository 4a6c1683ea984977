use roverlab::geometry::units;
use roverlab::nav::NavigatorOutcome;

use super::Args;
use super::course;
use super::drive::{Arrival, drive};
use super::job::AT_GOAL;
use crate::common::{Failure, Outcome, Report, portable, rounded};
use crate::driving::{Conditions, RESERVE};

/// A generated world and its result.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Trial {
    pub(crate) seed: u64,
    /// The verdict; `None` if the robot failed.
    pub(crate) outcome: Option<NavigatorOutcome>,
    pub(crate) contacts: u32,
    /// True distance from the goal (m).
    pub(crate) goal_distance: f64,
    pub(crate) unmapped: u32,
    pub(crate) replans: usize,
    pub(crate) recoveries: usize,
    pub(crate) sim_time: f64,
    pub(crate) path_length: f64,
}

portable!(struct Trial {
    seed, outcome, contacts, goal_distance, unmapped, replans, recoveries, sim_time, path_length,
});

/// Required fraction of reached goals.
const SHARE: f64 = 0.99;

impl Trial {
    /// Whether the robot is truly at the goal.
    pub(crate) fn is_reached(&self) -> bool {
        self.outcome == Some(NavigatorOutcome::Reached) && self.goal_distance <= AT_GOAL
    }
}

/// Runs the campaign.
pub(crate) fn campaign(args: &Args) -> Result<Report, Failure> {
    let trials = trials(args)?;
    let count = |is: &dyn Fn(&Trial) -> bool| trials.iter().filter(|trial| is(trial)).count();
    let reached = count(&Trial::is_reached);
    let contacts: u64 = trials.iter().map(|trial| u64::from(trial.contacts)).sum();
    let wrong: Vec<u64> = trials
        .iter()
        .filter(|trial| !trial.is_reached() || trial.contacts > 0)
        .map(|trial| trial.seed)
        .collect();
    let mean = |of: &dyn Fn(&Trial) -> f64| trials.iter().map(of).sum::<f64>() / trials.len() as f64;
    for trial in trials.iter().filter(|trial| wrong.contains(&trial.seed)) {
        let off = units::to_mm(trial.goal_distance);
        args.common.tell(format_args!(
            "seed {}: {:?}, {off:.0} mm from the goal, {} contacts, {} recoveries",
            trial.seed, trial.outcome, trial.contacts, trial.recoveries
        ));
    }
    args.common.tell(format_args!("{reached} of {} goals reached, {contacts} contacts", trials.len()));
    let good = reached as f64 >= SHARE * trials.len() as f64 && contacts == 0;
    let outcome = if good { Outcome::verdict("passed") } else { Outcome::failure("wrong") };
    Ok(Report {
        sim_time: Some(trials.iter().map(|trial| trial.sim_time).sum()),
        collisions: Some(contacts),
        ..Report::new(outcome)
    }
    .field("runs", trials.len())
    .field("reached", reached)
    .field("contacts", contacts)
    .field("mean_unmapped", rounded(mean(&|trial| f64::from(trial.unmapped))))
    .field("mean_replans", rounded(mean(&|trial| trial.replans as f64)))
    .field("mean_recoveries", rounded(mean(&|trial| trial.recoveries as f64)))
    .field("mean_time_s", rounded(mean(&|trial| trial.sim_time)))
    .field("mean_path_mm", rounded(units::to_mm(mean(&|trial| trial.path_length))))
    .field("wrong_seeds", wrong))
}

/// All trials in the order of their seeds, whatever the number of threads.
pub(crate) fn trials(args: &Args) -> Result<Vec<Trial>, Failure> {
    args.parts.share_out(&args.common.origin, "worlds", args.runs, args.threads, |index| {
        trial(args, args.common.seed.wrapping_add(index))
    })
}

fn trial(args: &Args, seed: u64) -> Result<Trial, Failure> {
    let course = course::generated(seed)?;
    let trip = &course.trip;
    let parameters = args.parameters(trip.spec().footprint)?;
    let conditions = Conditions {
        seed,
        noise: args.common.noise,
        light: 1.0,
        keys: Vec::new(),
        pushing: false,
        others: Vec::new(),
        ideal_encoders: false,
        time_limit: args.common.time_limit.unwrap_or(600.0),
        reserve: RESERVE,
        common: None,
    };
    let places = (&course.known, trip.start(), trip.goal);
    let run = conditions.run(
        &trip.scene,
        |_| {},
        |robot, step| drive(robot, places, parameters, conditions.time_limit, |_| step()),
    )?;
    let arrival = run.ending.as_ref().ok();
    Ok(Trial {
        seed,
        outcome: arrival.map(|arrival| arrival.outcome),
        contacts: run.truth.contacts,
        goal_distance: run.truth.pose.distance_to(trip.goal),
        unmapped: course.unmapped,
        replans: arrival.map_or(0, Arrival::replans),
        recoveries: arrival.map_or(0, Arrival::recoveries),
        sim_time: run.sim_time,
        path_length: run.truth.path_length,
    })
}
