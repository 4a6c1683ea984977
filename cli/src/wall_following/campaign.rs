use std::fmt::Write as _;

use roverlab::drive::WallOutcome;
use roverlab::geometry::units::to_mm;
use serde_json::{Value, json};

use super::job::{run, scene, time_limit};
use super::{Args, Controller, Errors};
use crate::common::{Failure, Outcome, Progress, Report, millimetres};
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
    let mut progress = Progress::start();
    std::iter::once(args.controller)
        .chain(others)
        .map(|controller| row(&Args { controller, ..args.clone() }, &mut progress))
        .collect()
}

fn row(args: &Args, progress: &mut Progress) -> Result<Row, Failure> {
    let mut row = Row {
        controller: args.controller,
        rooms: args.rooms,
        followed: 0,
        contacts: 0,
        touched: 0,
        away_from_corners: Errors::default(),
        everywhere: Errors::default(),
        sim_time: 0.0,
        amiss: Vec::new(),
    };
    for index in 0..args.rooms {
        progress.show(|| format!("{}: {index} of {} rooms", args.controller.name(), args.rooms));
        add_room(&mut row, args, args.common.seed.wrapping_add(index))?;
    }
    Ok(row)
}

fn add_room(row: &mut Row, args: &Args, seed: u64) -> Result<(), Failure> {
    let scene = scene(seed);
    let limit = time_limit(args, &scene);
    let conditions = Conditions { seed, common: None, ..Conditions::new(&args.common, limit)? };
    let (run, watch) = run(args, &scene, &conditions, |_| {})?;
    let followed = run.ending.as_ref().is_ok_and(|walk| walk.outcome == WallOutcome::Stopped);
    row.followed += u64::from(followed);
    row.contacts += u64::from(run.truth.contacts);
    row.touched += u64::from(run.truth.contacts > 0);
    row.away_from_corners.merge(&watch.away_from_corners);
    row.everywhere.merge(&watch.everywhere);
    row.sim_time += run.sim_time;
    let good = followed && run.truth.contacts == 0 && to_mm(watch.away_from_corners.worst) <= WORST;
    if !good && row.amiss.len() < LISTED {
        row.amiss.push(seed);
    }
    Ok(())
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
