use std::fmt::Write as _;

use roverlab::geometry::units::{to_deg, to_mm};
use roverlab::geometry::{Pose, angle_difference};
use roverlab::scan::Hypothesis;
use roverlab::world::{RobotSpec, Scene};
use serde_json::{Value, json};

use super::job::run;
use super::worlds::{Place, Starts, worlds};
use super::{Args, Finding};
use crate::common::{Failure, Outcome, Report, millimetres, portable, rounded};
use crate::driving::Conditions;

/// Results of many starts in one world.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Row {
    pub(crate) world: String,
    /// Number of places from which the world looks the same.
    pub(crate) symmetry: usize,
    pub(crate) starts: u64,
    /// Required percentage of correct answers.
    pub(crate) share: u64,
    /// One place, the correct one; or all places that look the same, including the correct one.
    pub(crate) right: u64,
    /// More or fewer places, including the correct one.
    pub(crate) several: u64,
    pub(crate) lost: u64,
    /// Number of wrong answers.
    pub(crate) wrong: u64,
    pub(crate) contacts: u64,
    /// Largest errors of correct answers: position (m), stated deviations, heading (rad).
    pub(crate) worst_position: f64,
    pub(crate) worst_deviations: f64,
    pub(crate) worst_heading: f64,
    pub(crate) sim_time: f64,
    /// First seeds with wrong answers.
    pub(crate) amiss: Vec<u64>,
}

/// Maximum errors of a correct place.
const NEAR: Error = Error { position: 0.1, deviations: 5.0, heading: 3.0 * std::f64::consts::PI / 180.0 };
const LISTED: usize = 10;

/// Error of a place: position (m), the same in stated deviations, heading (rad).
#[derive(Debug, Clone, Copy, Default)]
struct Error {
    position: f64,
    deviations: f64,
    heading: f64,
}

portable!(struct Error { position, deviations, heading });

impl Error {
    fn of(place: &Hypothesis, truth: &Pose) -> Self {
        let position = place.pose.distance_to(truth.position());
        let heading = angle_difference(place.pose.heading, truth.heading).abs();
        Self { position, deviations: position / place.deviation(), heading }
    }

    fn is_small(&self) -> bool {
        let Self { position, deviations, heading } = NEAR;
        self.position <= position && self.deviations <= deviations && self.heading <= heading
    }
}

impl Row {
    fn new(place: &Place, starts: u64) -> Self {
        Self {
            world: place.name.clone(),
            symmetry: place.symmetry,
            starts,
            share: place.share,
            right: 0,
            several: 0,
            lost: 0,
            wrong: 0,
            contacts: 0,
            worst_position: 0.0,
            worst_deviations: 0.0,
            worst_heading: 0.0,
            sim_time: 0.0,
            amiss: Vec::new(),
        }
    }

    /// Whether enough answers are correct, none is wrong, and nothing was touched.
    pub(crate) fn is_good(&self) -> bool {
        100 * self.right >= self.share * self.starts && self.wrong == 0 && self.contacts == 0
    }

    fn add(&mut self, trial: &Trial) {
        self.sim_time += trial.sim_time;
        self.contacts += u64::from(trial.contacts);
        match trial.verdict {
            Verdict::Lost => self.lost += 1,
            Verdict::Several => self.several += 1,
            Verdict::Right => {
                self.right += 1;
                self.worst_position = self.worst_position.max(trial.error.position);
                self.worst_deviations = self.worst_deviations.max(trial.error.deviations);
                self.worst_heading = self.worst_heading.max(trial.error.heading);
            }
            Verdict::Wrong => {
                self.wrong += 1;
                if self.amiss.len() < LISTED {
                    self.amiss.push(trial.seed);
                }
            }
        }
    }
}

/// Judgement of an answer; see [`Row`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Verdict {
    Right,
    Several,
    Lost,
    Wrong,
}

portable!(
    enum Verdict {
        Right,
        Several,
        Lost,
        Wrong,
    }
);

impl Verdict {
    /// Judges an answer in a world with so many places that look the same. With the error of the nearest one.
    fn of(finding: Option<&Finding>, truth: &Pose, symmetry: usize) -> (Self, Error) {
        let count = finding.map_or(0, |finding| finding.localisation.count());
        let places = finding.iter().flat_map(|finding| finding.hypotheses.iter().take(count));
        let errors = places.map(|place| Error::of(place, truth));
        let nearest = errors.min_by(|a, b| a.position.total_cmp(&b.position));
        let verdict = match nearest {
            None => Self::Lost,
            Some(error) if error.is_small() && count == symmetry => Self::Right,
            Some(error) if error.is_small() && count > symmetry => Self::Several,
            Some(_) => Self::Wrong,
        };
        (verdict, nearest.unwrap_or_default())
    }
}

/// Result of a start.
#[derive(Debug, Clone)]
struct Trial {
    seed: u64,
    verdict: Verdict,
    error: Error,
    contacts: u32,
    sim_time: f64,
}

portable!(struct Trial { seed, verdict, error, contacts, sim_time });

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

/// A row for each world.
pub(crate) fn rows(args: &Args) -> Result<Vec<Row>, Failure> {
    let places = match &args.common.world {
        None => worlds(),
        Some(file) => {
            let scene = args.common.load_scene("world", file).map_err(Failure::input)?;
            let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            vec![Place { name, world: scene.world, symmetry: 1, share: 0 }]
        }
    };
    let mut rows: Vec<Row> = places.iter().map(|place| Row::new(place, starts(args, place))).collect();
    let free = places.iter().map(|place| {
        Starts::new(&place.world, RobotSpec::s4().footprint.bounding_radius()).map_err(Failure::input)
    });
    let free = free.collect::<Result<Vec<_>, _>>()?;
    let all: Vec<(usize, u64)> =
        (0..).zip(&rows).flat_map(|(place, row)| (0..row.starts).map(move |index| (place, index))).collect();
    let trials = args.parts.share_out(&args.common.origin, "starts", all.len() as u64, None, |index| {
        let (place, index) = all[index as usize];
        trial(args, &places[place], &free[place], args.common.seed.wrapping_add(index))
    })?;
    for ((place, _), trial) in all.iter().zip(&trials) {
        rows[*place].add(trial);
    }
    Ok(rows)
}

/// Number of starts in a world.
fn starts(args: &Args, place: &Place) -> u64 {
    if place.symmetry > 1 { args.starts.div_ceil(5) } else { args.starts }
}

fn trial(args: &Args, place: &Place, free: &Starts, seed: u64) -> Result<Trial, Failure> {
    let pose = free.draw(seed);
    let pose = pose.ok_or_else(|| Failure::run(format!("no free floor in the world {}", place.name)))?;
    let scene = Scene::with_robot(place.world.clone(), RobotSpec::s4(), pose);
    let conditions =
        Conditions { seed, common: None, ..Conditions::new(&args.common, args.patience + 30.0)? };
    let run = run(args, &scene, &conditions, |_| {})?;
    let (verdict, error) = Verdict::of(run.ending.as_ref().ok(), &run.truth.pose, place.symmetry);
    Ok(Trial { seed, verdict, error, contacts: run.truth.contacts, sim_time: run.sim_time })
}

/// The table, without anything that differs between machines.
pub(crate) fn text(rows: &[Row]) -> String {
    let mut text = String::from(
        "world        looks alike  starts  right  several  lost  wrong  contacts  worst mm  deviations  worst deg  mean s  good\n",
    );
    for row in rows {
        writeln!(
            text,
            "{:<12} {:>11}  {:>6}  {:>5}  {:>7}  {:>4}  {:>5}  {:>8}  {:>8.2}  {:>10.2}  {:>9.2}  {:>6.1}  {}",
            row.world,
            row.symmetry,
            row.starts,
            row.right,
            row.several,
            row.lost,
            row.wrong,
            row.contacts,
            to_mm(row.worst_position),
            row.worst_deviations,
            to_deg(row.worst_heading),
            row.sim_time / row.starts as f64,
            if row.is_good() { "yes" } else { "NO" },
        )
        .expect("writing to a string does not fail");
        if !row.amiss.is_empty() {
            writeln!(text, "  wrong with seeds {:?}", row.amiss).expect("writing to a string does not fail");
        }
    }
    let Error { position, deviations, heading } = NEAR;
    write!(
        text,
        "right: as many places as look alike, one within {} mm, {deviations} deviations and {:.0} degrees; lost: nothing said",
        to_mm(position),
        to_deg(heading),
    )
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
            "several": row.several,
            "lost": row.lost,
            "wrong": row.wrong,
            "contacts": row.contacts,
            "worst_position_error_mm": millimetres(row.worst_position),
            "worst_deviations": rounded(row.worst_deviations),
            "worst_heading_error_deg": rounded(to_deg(row.worst_heading)),
            "amiss": row.amiss,
            "good": row.is_good(),
        })
    };
    rows.iter().map(one).collect()
}
