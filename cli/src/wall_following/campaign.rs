use std::fmt::Write as _;

use roverlab::drive::WallOutcome;
use roverlab::geometry::units::to_mm;
use serde_json::{Value, json};

use super::job::{run, scene, time_limit};
use super::{Args, Controller, Errors};
use crate::common::{Failure, Outcome, Report, millimetres, portable};
use crate::driving::Conditions;

/// Results of many rooms for one controller.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Row {
    pub(crate) controller: Controller,
    pub(crate) rooms: u64,
    /// Number of rooms in which the robot went all the way round.
    pub(crate) followed: u64,
    pub(crate) contacts: u64,
    /// Number of rooms with contacts.
    pub(crate) touched: u64,
    pub(crate) away_from_corners: Errors,
    pub(crate) everywhere: Errors,
    pub(crate) sim_time: f64,
    /// Seeds of the first rooms with a problem.
    pub(crate) amiss: Vec<u64>,
}

/// Maximum acceptable errors away from corners (mm).
const RMS: f64 = 10.0;
const WORST: f64 = 40.0;
/// Maximum number of listed seeds.
const LISTED: usize = 10;

impl Row {
    /// Whether all rooms were followed without contact and with small errors.
    pub(crate) fn is_good(&self) -> bool {
        self.followed == self.rooms
            && self.contacts == 0
            && self.away_from_corners.rms().is_some_and(|rms| to_mm(rms) <= RMS)
            && to_mm(self.away_from_corners.worst) <= WORST
    }
}

/// Runs the campaign. The controller of the options is judged; the others are listed for comparison.
pub(crate) fn campaign(args: &Args) -> Result<Report, Failure> {
    let rows = rows(args)?;
    let good = rows.iter().any(|row| row.controller == args.controller && row.is_good());
    args.common.tell(text(&rows));
    let outcome = if good { Outcome::verdict("passed") } else { Outcome::failure("wrong") };
    Ok(Report { sim_time: Some(rows.iter().map(|row| row.sim_time).sum()), ..Report::new(outcome) }
        .table("rows", json(&rows)))
}

/// A row for the requested controller, and one for each other.
pub(crate) fn rows(args: &Args) -> Result<Vec<Row>, Failure> {
    let others = Controller::ALL.into_iter().filter(|&other| other != args.controller);
    let mut rows: Vec<Row> = std::iter::once(args.controller).chain(others).map(|c| row(args, c)).collect();
    let runs = args.rooms * rows.len() as u64;
    let trials = args.parts.share_out(&args.common.origin, "rooms", runs, None, |index| {
        let controller = rows[(index / args.rooms) as usize].controller;
        trial(&Args { controller, ..args.clone() }, args.common.seed.wrapping_add(index % args.rooms))
    })?;
    for (row, trials) in rows.iter_mut().zip(trials.chunks(args.rooms as usize)) {
        for trial in trials {
            row.add(trial);
        }
    }
    Ok(rows)
}

fn row(args: &Args, controller: Controller) -> Row {
    Row {
        controller,
        rooms: args.rooms,
        followed: 0,
        contacts: 0,
        touched: 0,
        away_from_corners: Errors::default(),
        everywhere: Errors::default(),
        sim_time: 0.0,
        amiss: Vec::new(),
    }
}

/// Result of a room.
#[derive(Debug, Clone)]
struct Trial {
    seed: u64,
    followed: bool,
    contacts: u32,
    away_from_corners: Errors,
    everywhere: Errors,
    sim_time: f64,
}

portable!(struct Trial { seed, followed, contacts, away_from_corners, everywhere, sim_time });

fn trial(args: &Args, seed: u64) -> Result<Trial, Failure> {
    let scene = scene(seed);
    let limit = time_limit(args, &scene);
    let conditions = Conditions { seed, common: None, ..Conditions::new(&args.common, limit)? };
    let (run, watch) = run(args, &scene, &conditions, |_| {})?;
    Ok(Trial {
        seed,
        followed: run.ending.as_ref().is_ok_and(|walk| walk.outcome == WallOutcome::Stopped),
        contacts: run.truth.contacts,
        away_from_corners: watch.away_from_corners,
        everywhere: watch.everywhere,
        sim_time: run.sim_time,
    })
}

impl Row {
    fn add(&mut self, trial: &Trial) {
        self.followed += u64::from(trial.followed);
        self.contacts += u64::from(trial.contacts);
        self.touched += u64::from(trial.contacts > 0);
        self.away_from_corners.merge(&trial.away_from_corners);
        self.everywhere.merge(&trial.everywhere);
        self.sim_time += trial.sim_time;
        let is_near = to_mm(trial.away_from_corners.worst) <= WORST;
        if !(trial.followed && trial.contacts == 0 && is_near) && self.amiss.len() < LISTED {
            self.amiss.push(trial.seed);
        }
    }
}

/// The table, without anything that differs between machines.
pub(crate) fn text(rows: &[Row]) -> String {
    let mut text = String::from(
        "controller  rooms  all round  touched  contacts  rms mm  worst mm  rms everywhere  good\n",
    );
    let mm = |length: Option<f64>| length.map_or("-".into(), |length| format!("{:.2}", to_mm(length)));
    for row in rows {
        writeln!(
            text,
            "{:<10}  {:>5}  {:>9}  {:>7}  {:>8}  {:>6}  {:>8}  {:>14}  {}",
            row.controller.name(),
            row.rooms,
            row.followed,
            row.touched,
            row.contacts,
            mm(row.away_from_corners.rms()),
            mm(Some(row.away_from_corners.worst)),
            mm(row.everywhere.rms()),
            if row.is_good() { "yes" } else { "no" },
        )
        .expect("writing to a string does not fail");
        if !row.amiss.is_empty() && row.controller != Controller::Book {
            writeln!(text, "  amiss with seeds {:?}", row.amiss).expect("writing to a string does not fail");
        }
    }
    write!(text, "good: all round, no contact, {RMS} mm rms and {WORST} mm at worst away from corners")
        .expect("writing to a string does not fail");
    text
}

fn json(rows: &[Row]) -> Vec<Value> {
    let one = |row: &Row| {
        json!({
            "controller": row.controller.name(),
            "rooms": row.rooms,
            "all_round": row.followed,
            "touched": row.touched,
            "contacts": row.contacts,
            "rms_error_mm": row.away_from_corners.rms().map(millimetres),
            "max_error_mm": millimetres(row.away_from_corners.worst),
            "rms_error_everywhere_mm": row.everywhere.rms().map(millimetres),
            "amiss": row.amiss,
            "good": row.is_good(),
        })
    };
    rows.iter().map(one).collect()
}
