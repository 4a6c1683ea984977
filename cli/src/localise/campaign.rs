use std::fmt::Write as _;

use roverlab::geometry::units::{to_deg, to_mm};
use roverlab::scan::Localisation;
use roverlab::world::{RobotSpec, Scene};
use serde_json::{Value, json};

use super::Args;
use super::job::{errors, run};
use super::worlds::{Place, start, worlds};
use crate::common::{Failure, Outcome, Progress, Report, millimetres, rounded};
use crate::driving::Conditions;

/// What came of many starts in one world.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Row {
    pub(crate) world: &'static str,
    /// From how many places the world looks the same.
    pub(crate) symmetry: usize,
    pub(crate) starts: u64,
    /// One place, and the right one; or as many as look the same, the right one among them.
    pub(crate) right: u64,
    /// Several places where there is one.
    pub(crate) several: u64,
    pub(crate) contacts: u64,
    /// Metres and radians, of those that are right.
    pub(crate) worst_position: f64,
    pub(crate) worst_heading: f64,
    pub(crate) sim_time: f64,
    /// Seeds of the others: the first ones.
    pub(crate) amiss: Vec<u64>,
}

/// A place is right within so many millimetres and degrees.
const NEAR: (f64, f64) = (50.0, 3.0);
/// The share that has to be right, in percent.
const SHARE: u64 = 98;
const LISTED: usize = 10;

impl Row {
    fn new(place: &Place, starts: u64) -> Self {
        Self {
            world: place.name,
            symmetry: place.symmetry,
            starts,
            right: 0,
            several: 0,
            contacts: 0,
            worst_position: 0.0,
            worst_heading: 0.0,
            sim_time: 0.0,
            amiss: Vec::new(),
        }
    }

    /// Whether enough places are right and nothing was touched.
    pub(crate) fn is_good(&self) -> bool {
        100 * self.right >= SHARE * self.starts && self.contacts == 0
    }
}

/// The campaign's work.
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

/// A row for each world.
pub(crate) fn rows(args: &Args) -> Result<Vec<Row>, Failure> {
    let mut progress = Progress::start();
    let mut rows = Vec::new();
    for place in worlds() {
        let starts = if place.symmetry > 1 { args.starts.div_ceil(5) } else { args.starts };
        let mut row = Row::new(&place, starts);
        for index in 0..starts {
            progress.show(|| format!("{}: {index} of {starts} starts", place.name));
            add_start(&mut row, args, &place, args.common.seed.wrapping_add(index))?;
        }
        rows.push(row);
    }
    Ok(rows)
}

fn add_start(row: &mut Row, args: &Args, place: &Place, seed: u64) -> Result<(), Failure> {
    let spec = RobotSpec::s4();
    let pose = start(&place.world, spec.footprint.bounding_radius(), seed);
    let pose = pose.ok_or_else(|| Failure::run(format!("no free floor in the world {}", place.name)))?;
    let scene = Scene::with_robot(place.world.clone(), spec, pose);
    let conditions =
        Conditions { seed, common: None, ..Conditions::new(&args.common, args.patience + 30.0)? };
    let run = run(args, &scene, &conditions, |_| {})?;
    row.sim_time += run.sim_time;
    row.contacts += u64::from(run.truth.contacts);
    let found = run.ending.as_ref().map_or(Localisation::Lost, |finding| finding.localisation);
    let (position, heading) = if place.symmetry == 1 {
        errors(&run).unwrap_or((f64::INFINITY, f64::INFINITY))
    } else {
        nearest_of_all(&run)
    };
    let near = to_mm(position) <= NEAR.0 && to_deg(heading) <= NEAR.1;
    if near && found.count() == place.symmetry {
        row.right += 1;
        row.worst_position = row.worst_position.max(position);
        row.worst_heading = row.worst_heading.max(heading);
        return Ok(());
    }
    row.several += u64::from(found.count() > place.symmetry);
    if row.amiss.len() < LISTED {
        row.amiss.push(seed);
    }
    Ok(())
}

/// The errors of that of several places that is the right one.
fn nearest_of_all(run: &crate::driving::Run<super::Finding>) -> (f64, f64) {
    let Ok(finding) = &run.ending else { return (f64::INFINITY, f64::INFINITY) };
    let truth = run.truth.pose;
    finding
        .hypotheses
        .iter()
        .map(|hypothesis| {
            let turn = roverlab::geometry::angle_difference(hypothesis.pose.heading, truth.heading);
            (hypothesis.pose.distance_to(truth.position()), turn.abs())
        })
        .min_by(|a, b| (a.0 + a.1).total_cmp(&(b.0 + b.1)))
        .unwrap_or((f64::INFINITY, f64::INFINITY))
}

/// The table. Holds nothing that differs between machines.
pub(crate) fn text(rows: &[Row]) -> String {
    let mut text = String::from(
        "world      looks alike  starts  right  too many  contacts  worst mm  worst deg  mean s  good\n",
    );
    for row in rows {
        writeln!(
            text,
            "{:<10} {:>11}  {:>6}  {:>5}  {:>8}  {:>8}  {:>8.2}  {:>9.2}  {:>6.1}  {}",
            row.world,
            row.symmetry,
            row.starts,
            row.right,
            row.several,
            row.contacts,
            to_mm(row.worst_position),
            to_deg(row.worst_heading),
            row.sim_time / row.starts as f64,
            if row.is_good() { "yes" } else { "NO" },
        )
        .expect("writing to a string does not fail");
        if !row.amiss.is_empty() {
            writeln!(text, "  amiss with seeds {:?}", row.amiss).expect("writing to a string does not fail");
        }
    }
    write!(text, "right: within {} mm and {} degrees, and as many places as look alike", NEAR.0, NEAR.1)
        .expect("writing to a string does not fail");
    text
}

fn json(rows: &[Row]) -> Vec<Value> {
    let one = |row: &Row| {
        json!({
            "world": row.world,
            "looks_alike": row.symmetry,
            "starts": row.starts,
            "right": row.right,
            "too_many": row.several,
            "contacts": row.contacts,
            "worst_position_error_mm": millimetres(row.worst_position),
            "worst_heading_error_deg": rounded(to_deg(row.worst_heading)),
            "amiss": row.amiss,
            "good": row.is_good(),
        })
    };
    rows.iter().map(one).collect()
}
