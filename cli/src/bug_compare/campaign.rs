use std::f64::consts::TAU;
use std::fmt::Write as _;

use roverlab::geometry::{Segment, direction};
use roverlab::nav::{BugKind, PathBound};
use serde_json::{Value, json};

use super::boundaries::Boundaries;
use super::contest::{Setting, campaign_options, of_campaign};
use super::ride::{Ride, parameters, ride};
use super::{Args, job};
use crate::common::{Failure, Outcome, Report, portable, rounded};

/// Checked results of one run in the campaign.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Checked {
    pub(crate) kind: BugKind,
    pub(crate) seed: u64,
    /// Whether the algorithm is proved complete.
    pub(crate) complete: bool,
    pub(crate) correct: bool,
    pub(crate) contacts: u32,
    pub(crate) sim_time: f64,
    /// Path length as a fraction of its bound, if there is one.
    pub(crate) of_bound: Option<f64>,
}

portable!(struct Checked { kind, seed, complete, correct, contacts, sim_time, of_bound });

/// Relative tolerance of the traced perimeters.
const TOLERANCE: f64 = 0.02;
/// Distance by which contours are traced nearer to obstacles than the middle of the narrowest corridor (m).
const RESERVE: f64 = 0.004;
/// Distance of a point outside every field (m).
const FAR: f64 = 1e3;

/// Runs the campaign.
pub(super) fn campaign(args: &Args) -> Result<Report, Failure> {
    let courses = args.runs.unwrap_or(1000);
    let checked = args.parts.share_out(&args.common.origin, "courses", courses, args.threads, |index| {
        check(args, args.common.seed.wrapping_add(index))
    })?;
    let checked: Vec<Checked> = checked.into_iter().flatten().collect();
    args.common.tell(text(args.bugs(), &checked));
    let good = checked.iter().all(|run| (run.correct || !run.complete) && !breaks(run));
    let outcome = if good { Outcome::verdict("passed") } else { Outcome::failure("wrong") };
    let report = Report {
        sim_time: Some(checked.iter().map(|run| run.sim_time).sum()),
        collisions: Some(checked.iter().map(|run| u64::from(run.contacts)).sum()),
        ..Report::new(outcome)
    }
    .field("courses", courses)
    .table("bugs", json(args.bugs(), &checked));
    job::drawn(args, report, None)
}

/// Drives all algorithms through the course of a seed.
pub(crate) fn check(args: &Args, seed: u64) -> Result<Vec<Checked>, Failure> {
    let setting = of_campaign(seed)?;
    let conditions = setting.conditions(args);
    let mut boundaries = None;
    let drive = |&kind| {
        let ride = ride(&setting.trip, kind, conditions)?;
        let bounded = args.common.noise == 0.0 && ride.guarantee.path_bound != PathBound::Unknown;
        if bounded && boundaries.is_none() {
            let parameters = parameters(&setting.trip, args.common.noise);
            let followed = parameters.robot_radius + parameters.clearance;
            // Robots go through passages too narrow for their usual clearance. So the contours are traced at
            // half the narrowest corridor, which separates nothing, and paths count as parallels of them.
            let traced = followed.min(0.5 * campaign_options().min_corridor - RESERVE);
            let lines = Boundaries::new(&setting.trip.scene.world, traced).map_err(Failure::run)?;
            boundaries = Some((lines, followed - traced));
        }
        let traced = boundaries.as_ref().filter(|_| bounded);
        Ok(Checked {
            kind,
            seed,
            complete: ride.guarantee.complete,
            correct: ride.is_correct(setting.reachable, args.common.noise),
            contacts: ride.contacts,
            sim_time: ride.sim_time,
            of_bound: traced
                .and_then(|(lines, apart)| Some(ride.path_length / bound(&setting, &ride, lines, *apart)?)),
        })
    };
    args.bugs().iter().map(drive).collect()
}

/// Bound on the length of a ride's path (m). The robot's centre follows parallels of the contours at a
/// distance of `apart` metres.
fn bound(setting: &Setting, ride: &Ride, boundaries: &Boundaries, apart: f64) -> Option<f64> {
    let (start, goal) = (setting.trip.start().position(), setting.trip.goal);
    let mut met: Vec<usize> =
        ride.follows.iter().filter_map(|&(from, to)| boundaries.followed(&ride.path[from..to])).collect();
    met.sort_unstable();
    met.dedup();
    // The robot's straight lines to the goal: from the start, and from each hit point.
    let ways: Vec<Segment> = [start].iter().chain(&ride.hits).map(|&from| Segment::new(from, goal)).collect();
    // An outer parallel of a closed line is longer by a full turn times the distance, an inner one shorter.
    let far = Segment::new(start, start + direction(0.4) * FAR);
    let terms = met.into_iter().map(|index| {
        let line = &boundaries.all[index];
        let is_inside = line.crossings(far) % 2 == 1;
        let parallel = line.perimeter + if is_inside { -TAU } else { TAU } * apart;
        let crossings = ways.iter().map(|&way| line.crossings(way)).max().unwrap_or(0);
        ((1.0 + TOLERANCE) * parallel, crossings)
    });
    ride.guarantee.path_bound.metres(setting.trip.distance(), &terms.collect::<Vec<_>>())
}

fn breaks(run: &Checked) -> bool {
    run.of_bound.is_some_and(|share| share > 1.0)
}

/// Summary of one algorithm.
struct Row {
    kind: BugKind,
    complete: bool,
    runs: usize,
    contacts: u32,
    wrong: Vec<u64>,
    touched: Vec<u64>,
    bounded: usize,
    broken: Vec<u64>,
    /// Largest fraction of a bound.
    closest: Option<f64>,
}

fn row(kind: BugKind, checked: &[Checked]) -> Row {
    let runs: Vec<&Checked> = checked.iter().filter(|run| run.kind == kind).collect();
    let seeds = |pick: &dyn Fn(&Checked) -> bool| {
        runs.iter().filter(|run| pick(run)).map(|run| run.seed).collect::<Vec<_>>()
    };
    Row {
        kind,
        complete: runs.iter().any(|run| run.complete),
        runs: runs.len(),
        contacts: runs.iter().map(|run| run.contacts).sum(),
        wrong: seeds(&|run| !run.correct),
        touched: seeds(&|run| run.contacts > 0),
        bounded: runs.iter().filter(|run| run.of_bound.is_some()).count(),
        broken: seeds(&breaks),
        closest: runs.iter().filter_map(|run| run.of_bound).reduce(f64::max),
    }
}

fn text(bugs: &[BugKind], checked: &[Checked]) -> String {
    let mut text = String::from("bug         runs  correct  contacts  bounds  broken  closest\n");
    let mut seeds = String::new();
    for row in bugs.iter().map(|&kind| row(kind, checked)) {
        writeln!(
            text,
            "{:<10}{:>6}{:>9}{:>10}{:>8}{:>8}{:>9}",
            row.kind.name(),
            row.runs,
            row.runs - row.wrong.len(),
            row.contacts,
            row.bounded,
            row.broken.len(),
            row.closest.map_or("-".into(), |share| format!("{share:.3}")),
        )
        .expect("writing to a string does not fail");
        for (what, list) in [("wrong", &row.wrong), ("contact", &row.touched), ("bound broken", &row.broken)]
        {
            if !list.is_empty() {
                writeln!(seeds, "{}, {what}: seeds {list:?}", row.kind.name())
                    .expect("writing to a string does not fail");
            }
        }
    }
    format!("{text}{seeds}closest: the largest part of its bound that a path has had")
}

fn json(bugs: &[BugKind], checked: &[Checked]) -> Value {
    let row = |kind: &BugKind| {
        let row = row(*kind, checked);
        json!({
            "bug": row.kind.name(),
            "complete": row.complete,
            "runs": row.runs,
            "correct": row.runs - row.wrong.len(),
            "contacts": row.contacts,
            "wrong_seeds": row.wrong,
            "contact_seeds": row.touched,
            "bounds_checked": row.bounded,
            "bounds_broken": row.broken,
            "closest": row.closest.map(rounded),
        })
    };
    bugs.iter().map(row).collect()
}
