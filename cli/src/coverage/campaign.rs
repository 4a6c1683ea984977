use std::fmt::Write as _;

use roverlab::drive::TourOutcome;
use serde_json::{Value, json};

use super::rooms::room;
use super::{Args, ENOUGH, cover};
use crate::common::{Failure, Outcome, Report, portable, rounded};
use crate::driving::Conditions;

/// Results of many rooms.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Row {
    pub(crate) rooms: u64,
    /// Number of rooms whose plan was driven to its end.
    pub(crate) finished: u64,
    pub(crate) contacts: u64,
    /// Covered fractions of the floor.
    pub(crate) least: f64,
    pub(crate) mean: f64,
    /// Path lengths divided by area over width.
    pub(crate) mean_ratio: f64,
    pub(crate) largest_ratio: f64,
    /// Fractions covered by a random drive in the same time.
    pub(crate) random_mean: f64,
    pub(crate) random_most: f64,
    pub(crate) sim_time: f64,
    /// Seeds of the first rooms with a problem.
    pub(crate) amiss: Vec<u64>,
}

/// Maximum length of a good path divided by area over width.
const RATIO: f64 = 1.5;
const LISTED: usize = 10;

impl Row {
    /// Whether each room was covered, without contact and by a short path.
    pub(crate) fn is_good(&self) -> bool {
        self.finished == self.rooms
            && self.contacts == 0
            && self.least >= ENOUGH
            && self.largest_ratio <= RATIO
    }
}

/// Runs the campaign.
pub(crate) fn campaign(args: &Args) -> Result<Report, Failure> {
    let row = row(args)?;
    args.common.tell(text(&row));
    let outcome = if row.is_good() { Outcome::verdict("passed") } else { Outcome::failure("wrong") };
    Ok(Report { sim_time: Some(row.sim_time), collisions: Some(row.contacts), ..Report::new(outcome) }
        .table("rows", json(&row)))
}

/// Results of all rooms.
pub(crate) fn row(args: &Args) -> Result<Row, Failure> {
    let mut row = Row {
        rooms: args.rooms,
        finished: 0,
        contacts: 0,
        least: 1.0,
        mean: 0.0,
        mean_ratio: 0.0,
        largest_ratio: 0.0,
        random_mean: 0.0,
        random_most: 0.0,
        sim_time: 0.0,
        amiss: Vec::new(),
    };
    let part = 1.0 / args.rooms as f64;
    let trials = args.parts.share_out(&args.common.origin, "rooms", args.rooms, None, |index| {
        trial(args, args.common.seed.wrapping_add(index))
    })?;
    for Trial { seed, finished, contacts, share, ratio, random, sim_time } in trials {
        row.finished += u64::from(finished);
        row.contacts += contacts;
        row.least = row.least.min(share);
        row.mean += part * share;
        row.mean_ratio += part * ratio;
        row.largest_ratio = row.largest_ratio.max(ratio);
        row.random_mean += part * random;
        row.random_most = row.random_most.max(random);
        row.sim_time += sim_time;
        let good = finished && contacts == 0 && share >= ENOUGH && ratio <= RATIO;
        if !good && row.amiss.len() < LISTED {
            row.amiss.push(seed);
        }
    }
    Ok(row)
}

/// Result of a room.
#[derive(Debug, Clone)]
struct Trial {
    seed: u64,
    finished: bool,
    contacts: u64,
    /// Covered fraction of the floor; path length divided by area over width; fraction covered at random.
    share: f64,
    ratio: f64,
    random: f64,
    sim_time: f64,
}

portable!(struct Trial { seed, finished, contacts, share, ratio, random, sim_time });

fn trial(args: &Args, seed: u64) -> Result<Trial, Failure> {
    let done = cover(&room(seed), |limit| conditions(args, seed, limit), |_| {})?;
    Ok(Trial {
        seed,
        finished: done.run.ending == Ok(TourOutcome::Finished),
        contacts: done.run.truth.contacts.into(),
        share: done.map.share(),
        ratio: done.ratio,
        random: done.random,
        sim_time: done.run.sim_time,
    })
}

fn conditions(args: &Args, seed: u64, limit: f64) -> Result<Conditions, Failure> {
    Ok(Conditions { seed, common: None, ..Conditions::new(&args.common, limit)? })
}

/// The table, without anything that differs between machines.
pub(crate) fn text(row: &Row) -> String {
    let percent = |share: f64| format!("{:.1} %", 100.0 * share);
    let mut text = String::from("drive    rooms  contacts   least    mean  mean path  longest path  good\n");
    writeln!(
        text,
        "lanes    {:>5}  {:>8}  {:>6}  {:>6}  {:>9.2}  {:>12.2}  {}",
        row.rooms,
        row.contacts,
        percent(row.least),
        percent(row.mean),
        row.mean_ratio,
        row.largest_ratio,
        if row.is_good() { "yes" } else { "no" },
    )
    .expect("writing to a string does not fail");
    let (mean, most) = (percent(row.random_mean), percent(row.random_most));
    writeln!(text, "random   in the same time: {mean} in the mean, {most} at most")
        .expect("writing to a string does not fail");
    if !row.amiss.is_empty() {
        writeln!(text, "  amiss with seeds {:?}", row.amiss).expect("writing to a string does not fail");
    }
    let enough = 100.0 * ENOUGH;
    write!(text, "good: {enough} % at least, no contact, paths of at most {RATIO} times area over width")
        .expect("writing to a string does not fail");
    text
}

fn json(row: &Row) -> Vec<Value> {
    vec![json!({
        "rooms": row.rooms,
        "finished": row.finished,
        "contacts": row.contacts,
        "least_coverage_percent": rounded(100.0 * row.least),
        "mean_coverage_percent": rounded(100.0 * row.mean),
        "mean_path_ratio": rounded(row.mean_ratio),
        "largest_path_ratio": rounded(row.largest_ratio),
        "random_drive_mean_percent": rounded(100.0 * row.random_mean),
        "amiss": row.amiss,
        "good": row.is_good(),
    })]
}
