use std::fmt::Write as _;

use roverlab::geometry::units;
use roverlab::nav::BugOutcome;
use serde_json::{Value, json};

use super::Args;
use super::trial::{Judgement, Run, Trial};
use crate::common::rounded;

/// Runs at one noise level.
struct Row<'a> {
    noise: f64,
    runs: Vec<&'a Run>,
}

impl<'a> Row<'a> {
    fn of(trials: &'a [Trial], index: usize, noise: f64) -> Self {
        Self { noise, runs: trials.iter().map(|trial| &trial.runs[index]).collect() }
    }

    fn count(&self, pick: impl Fn(&Run) -> bool) -> usize {
        self.runs.iter().filter(|run| pick(run)).count()
    }

    fn judged(&self, judgement: Judgement) -> usize {
        self.count(|run| run.judgement == judgement)
    }

    fn ended(&self, outcome: BugOutcome) -> usize {
        self.count(|run| run.ending == Ok(outcome))
    }

    fn contacts(&self) -> usize {
        self.count(|run| run.contacts > 0)
    }

    /// Percentage of correct verdicts, rounded down: 100 % only if all are correct.
    fn percent(&self) -> f64 {
        (1000.0 * self.judged(Judgement::Correct) as f64 / self.runs.len() as f64).floor() / 10.0
    }

    /// Mean path length relative to the shortest path; `None` without any.
    fn path_ratio(&self) -> Option<f64> {
        let ratios: Vec<f64> = self.runs.iter().filter_map(|run| run.path_ratio).collect();
        (!ratios.is_empty()).then(|| ratios.iter().sum::<f64>() / ratios.len() as f64)
    }

    /// Largest distance from the goal among the runs that reported arrival (m).
    fn worst_distance(&self) -> Option<f64> {
        let reached = Ok(BugOutcome::Reached);
        let arrived = self.runs.iter().filter(|run| run.ending == reached);
        arrived.map(|run| run.goal_distance).reduce(f64::max)
    }

    fn sim_time(&self) -> f64 {
        self.runs.iter().map(|run| run.sim_time).sum()
    }
}

fn rows<'a>(noises: &'a [f64], trials: &'a [Trial]) -> impl Iterator<Item = Row<'a>> {
    noises.iter().enumerate().map(|(index, &noise)| Row::of(trials, index, noise))
}

/// The table, and the seeds of failed courses, without anything that differs between machines.
pub(crate) fn text(noises: &[f64], trials: &[Trial]) -> String {
    let mut text = String::from("noise  runs  correct  reached  unreachable  timed out");
    for (_, name) in Judgement::WRONG {
        write!(text, "  {name:>8}").expect("writing to a string does not fail");
    }
    text.push_str("  contact  path ratio  worst mm   sim s\n");
    for row in rows(noises, trials) {
        text.push_str(&line(&row));
    }
    for (index, noise) in noises.iter().enumerate() {
        text.push_str(&wrong_seeds(*noise, index, trials));
    }
    text.trim_end().to_owned()
}

fn line(row: &Row<'_>) -> String {
    let optional = |value: Option<f64>, digits: usize| value.map_or("-".into(), |v| format!("{v:.digits$}"));
    let mut line = format!(
        "{:>5}  {:>4}  {:>6.1}%  {:>7}  {:>11}  {:>9}",
        row.noise,
        row.runs.len(),
        row.percent(),
        row.ended(BugOutcome::Reached),
        row.ended(BugOutcome::Unreachable) + row.ended(BugOutcome::NoRoom),
        row.ended(BugOutcome::TimedOut),
    );
    for (judgement, _) in Judgement::WRONG {
        write!(line, "  {:>8}", row.judged(judgement)).expect("writing to a string does not fail");
    }
    let (ratio, worst) = (optional(row.path_ratio(), 2), optional(row.worst_distance().map(units::to_mm), 1));
    format!("{line}  {:>7}  {ratio:>10}  {worst:>8}  {:>6.0}\n", row.contacts(), row.sim_time())
}

/// Seeds and kinds of failures at one noise level; empty without any.
fn wrong_seeds(noise: f64, index: usize, trials: &[Trial]) -> String {
    let wrong: Vec<String> = trials
        .iter()
        .map(|trial| (trial.seed, &trial.runs[index]))
        .filter(|(_, run)| !run.is_clean())
        .map(|(seed, run)| format!("{seed} ({})", why(run)))
        .collect();
    if wrong.is_empty() { String::new() } else { format!("wrong at noise {noise}: {}\n", wrong.join(", ")) }
}

fn why(run: &Run) -> String {
    let name =
        Judgement::WRONG.iter().find(|(judgement, _)| *judgement == run.judgement).map(|(_, name)| *name);
    match (name, run.contacts) {
        (Some(name), 0) => name.into(),
        (Some(name), _) => format!("{name}, contact"),
        (None, _) => "contact".into(),
    }
}

/// The table, its abbreviations, and the folder of saved courses.
pub(super) fn explained(args: &Args, trials: &[Trial]) -> String {
    let mut text = text(&args.levels, trials);
    text.push_str(
        "\n\noff: reached, too far from the goal; false r.: reached without a way; false u.: unreachable in spite of \
         a way; late: no verdict in the time; failed: the robot failed",
    );
    if let Some(folder) = &args.save {
        let folder = folder.display();
        write!(
            text,
            "\nwrong courses are in {folder}: roverlab distbug --world {folder}/course-SEED.sim --seed SEED --noise F"
        )
        .expect("writing to a string does not fail");
    }
    text
}

/// The table as JSON: one object per noise level.
pub(super) fn json(noises: &[f64], trials: &[Trial]) -> Vec<Value> {
    rows(noises, trials).enumerate().map(|(index, row)| level(&row, index, trials)).collect()
}

fn level(row: &Row<'_>, index: usize, trials: &[Trial]) -> Value {
    let seeds = |pick: &dyn Fn(&Run) -> bool| {
        trials.iter().filter(|trial| pick(&trial.runs[index])).map(|trial| trial.seed).collect::<Vec<_>>()
    };
    let wrong = |judgement: Judgement| seeds(&|run: &Run| run.judgement == judgement);
    json!({
        "noise": row.noise,
        "runs": row.runs.len(),
        "correct": row.judged(Judgement::Correct),
        "correct_percent": row.percent(),
        "reached": row.ended(BugOutcome::Reached),
        "unreachable": row.ended(BugOutcome::Unreachable),
        "no_room": row.ended(BugOutcome::NoRoom),
        "timed_out": row.ended(BugOutcome::TimedOut),
        "runs_with_contact": row.contacts(),
        "mean_path_ratio": row.path_ratio().map(rounded),
        "worst_goal_distance_mm": row.worst_distance().map(|distance| rounded(units::to_mm(distance))),
        "sim_time_s": rounded(row.sim_time()),
        "wrong_seeds": {
            "too_far_from_goal": wrong(Judgement::FarFromGoal),
            "reached_without_a_way": wrong(Judgement::NotReached),
            "unreachable_in_spite_of_a_way": wrong(Judgement::NotUnreachable),
            "timed_out": wrong(Judgement::TimedOut),
            "failed": wrong(Judgement::Failed),
            "contact": seeds(&|run: &Run| run.contacts > 0),
        },
    })
}
