use std::fmt::Write as _;

use roverlab::geometry::units::to_mm;
use roverlab::io::sim::{Fleet, SimOptions};
use serde_json::{Value, json};

use super::Args;
use super::job::SECONDS;
use super::scene::{Mode, Pattern, hall};
use super::swarm::run;
use crate::common::{Failure, Outcome, Report, millimetres, portable};

/// Results of many seeds for one kind of swarm.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Row {
    pub(crate) mode: Mode,
    pub(crate) pattern: Pattern,
    pub(crate) followers: usize,
    pub(crate) obstacles: usize,
    pub(crate) runs: u64,
    pub(crate) lost: u64,
    pub(crate) contacts: u64,
    /// Gaps between robots (m).
    pub(crate) mean_gap: f64,
    pub(crate) largest_gap: f64,
    pub(crate) sim_time: f64,
    /// First seeds with contacts or lost robots.
    pub(crate) amiss: Vec<u64>,
}

/// The swarms of a campaign: mode, the leader's pattern, number of followers, number of obstacles.
const SWARMS: [(Mode, Pattern, usize, usize); 12] = [
    (Mode::Lidar, Pattern::Round, 1, 0),
    (Mode::Lidar, Pattern::Round, 1, 4),
    (Mode::Raised, Pattern::Round, 5, 0),
    (Mode::Raised, Pattern::Round, 5, 3),
    (Mode::Radio, Pattern::Round, 5, 3),
    (Mode::Chain, Pattern::Round, 20, 0),
    (Mode::Lidar, Pattern::Eight, 1, 0),
    (Mode::Lidar, Pattern::Zigzag, 1, 0),
    (Mode::Lidar, Pattern::StopAndGo, 1, 0),
    (Mode::Raised, Pattern::Eight, 5, 0),
    (Mode::Raised, Pattern::Zigzag, 5, 0),
    (Mode::Raised, Pattern::StopAndGo, 5, 0),
];
const LISTED: usize = 10;

impl Row {
    /// Whether no robot was lost and nothing was touched.
    pub(crate) fn is_good(&self) -> bool {
        self.lost == 0 && self.contacts == 0
    }
}

/// Runs the campaign.
pub(crate) fn campaign(args: &Args) -> Result<Report, Failure> {
    let rows = rows(args)?;
    args.common.tell(text(&rows));
    let good = rows.iter().all(Row::is_good);
    let outcome = if good { Outcome::verdict("passed") } else { Outcome::failure("wrong") };
    Ok(Report {
        sim_time: Some(rows.iter().map(|row| row.sim_time).sum()),
        collisions: Some(rows.iter().map(|row| row.contacts).sum()),
        ..Report::new(outcome)
    }
    .table("rows", json(&rows)))
}

/// A row for each kind of swarm.
pub(crate) fn rows(args: &Args) -> Result<Vec<Row>, Failure> {
    let row = |&(mode, pattern, followers, obstacles)| Row {
        mode,
        pattern,
        followers,
        obstacles,
        runs: args.runs,
        lost: 0,
        contacts: 0,
        mean_gap: 0.0,
        largest_gap: 0.0,
        sim_time: 0.0,
        amiss: Vec::new(),
    };
    let mut rows: Vec<Row> = SWARMS.iter().map(row).collect();
    let runs = args.runs * rows.len() as u64;
    let trials = args.parts.share_out(&args.common.origin, "drives", runs, None, |index| {
        let row = &rows[(index / args.runs) as usize];
        trial(row, args, args.common.seed.wrapping_add(index % args.runs))
    })?;
    for (row, trials) in rows.iter_mut().zip(trials.chunks(args.runs as usize)) {
        for trial in trials {
            row.add(trial);
        }
        row.mean_gap /= args.runs as f64;
    }
    Ok(rows)
}

/// Result of a drive.
#[derive(Debug, Clone)]
struct Trial {
    seed: u64,
    lost: u64,
    contacts: u64,
    mean_gap: f64,
    largest_gap: f64,
    sim_time: f64,
}

portable!(struct Trial { seed, lost, contacts, mean_gap, largest_gap, sim_time });

fn trial(row: &Row, args: &Args, seed: u64) -> Result<Trial, Failure> {
    let (scene, waypoints) = hall((row.mode, row.pattern), row.followers, row.obstacles, seed);
    let options = SimOptions::with_noise(args.common.noise, seed);
    let seconds = args.common.time_limit.unwrap_or(SECONDS);
    let mut fleet = Fleet::new(&scene, options)?;
    let run = run(&mut fleet, &scene, &waypoints, (row.mode, row.pattern), seconds, |_| {})?;
    Ok(Trial {
        seed,
        lost: run.lost.len() as u64,
        contacts: run.contacts,
        mean_gap: run.mean_gap,
        largest_gap: run.largest_gap,
        sim_time: run.sim_time,
    })
}

impl Row {
    fn add(&mut self, trial: &Trial) {
        self.lost += trial.lost;
        self.contacts += trial.contacts;
        self.mean_gap += trial.mean_gap;
        self.largest_gap = self.largest_gap.max(trial.largest_gap);
        self.sim_time += trial.sim_time;
        if trial.lost + trial.contacts > 0 && self.amiss.len() < LISTED {
            self.amiss.push(trial.seed);
        }
    }
}

/// The table, without anything that differs between machines.
pub(crate) fn text(rows: &[Row]) -> String {
    let mut text = String::from(
        "mode    leader       followers  obstacles  runs  lost  contacts  mean gap mm  max gap mm  good\n",
    );
    for row in rows {
        writeln!(
            text,
            "{:<6}  {:<11}  {:>9}  {:>9}  {:>4}  {:>4}  {:>8}  {:>11.0}  {:>10.0}  {}",
            row.mode.name(),
            row.pattern.name(),
            row.followers,
            row.obstacles,
            row.runs,
            row.lost,
            row.contacts,
            to_mm(row.mean_gap),
            to_mm(row.largest_gap),
            if row.is_good() { "yes" } else { "no" },
        )
        .expect("writing to a string does not fail");
        if !row.amiss.is_empty() {
            writeln!(text, "  amiss with seeds {:?}", row.amiss).expect("writing to a string does not fail");
        }
    }
    text.push_str("good: nobody lost, nothing touched");
    text
}

fn json(rows: &[Row]) -> Vec<Value> {
    let one = |row: &Row| {
        json!({
            "mode": row.mode.name(),
            "pattern": row.pattern.name(),
            "followers": row.followers,
            "obstacles": row.obstacles,
            "runs": row.runs,
            "lost": row.lost,
            "contacts": row.contacts,
            "mean_gap_mm": millimetres(row.mean_gap),
            "max_gap_mm": millimetres(row.largest_gap),
            "amiss": row.amiss,
            "good": row.is_good(),
        })
    };
    rows.iter().map(one).collect()
}
