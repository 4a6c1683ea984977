use std::f64::consts::{FRAC_PI_2, PI};

use roverlab::drive::AToBOutcome;
use roverlab::geometry::{Pose, direction};
use roverlab::random::Stream;
use roverlab::world::{RobotSpec, Scene, World};

use super::drive::drive;
use super::job::{add_landmarks, heading_error, inside_ellipse, options};
use super::{Args, table};
use crate::common::{Failure, Outcome, Report, Trip, portable};
use crate::driving::{Conditions, RESERVE, Way};

/// Conditions of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// No noise, exact encoders.
    Ideal,
    /// No noise, encoder ticks.
    Ticks,
    /// Noise as on the real robot, with odometry alone.
    Odometry,
    /// The same with a landmark.
    Landmark,
}

/// Results of many runs.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Row {
    pub(crate) kind: Kind,
    pub(crate) way: Way,
    pub(crate) runs: u64,
    pub(crate) reached: u64,
    pub(crate) contacts: u64,
    /// Position error (m) and heading error (rad).
    pub(crate) worst_position: f64,
    pub(crate) mean_position: f64,
    pub(crate) worst_heading: f64,
    /// Number of runs that ended in the predicted ellipse.
    pub(crate) inside: u64,
    pub(crate) sim_time: f64,
}

impl Kind {
    pub(crate) const ALL: [Self; 4] = [Self::Ideal, Self::Ticks, Self::Odometry, Self::Landmark];

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Ideal => "ideal encoders",
            Self::Ticks => "encoder ticks",
            Self::Odometry => "odometry",
            Self::Landmark => "landmark",
        }
    }

    pub(crate) fn noise(self) -> f64 {
        match self {
            Self::Ideal | Self::Ticks => 0.0,
            Self::Odometry | Self::Landmark => 1.0,
        }
    }

    /// Acceptable errors, in millimetres and degrees.
    pub(crate) fn limits(self) -> Option<(f64, f64)> {
        match self {
            Self::Ideal => Some((1.0, 0.1)),
            Self::Ticks => Some((6.0, 0.3)),
            Self::Landmark => Some((20.0, f64::INFINITY)),
            Self::Odometry => None,
        }
    }
}

impl Row {
    /// Percentage of runs that ended in the ellipse.
    pub(crate) fn percent_inside(&self) -> f64 {
        100.0 * self.inside as f64 / self.runs as f64
    }

    /// Whether the results are acceptable. The fraction inside the ellipse is judged for a thousand runs or
    /// more.
    pub(crate) fn is_good(&self) -> bool {
        use roverlab::geometry::units::{to_deg, to_mm};
        let arrived = self.reached == self.runs && self.contacts == 0;
        let near = self.kind.limits().is_none_or(|(position, heading)| {
            to_mm(self.worst_position) <= position && to_deg(self.worst_heading) <= heading
        });
        let honest =
            self.kind != Kind::Odometry || self.runs < 1000 || (93.5..=96.5).contains(&self.percent_inside());
        arrived && near && honest
    }
}

/// Runs the campaign.
pub(crate) fn campaign(args: &Args) -> Result<Report, Failure> {
    let rows = rows(args)?;
    let good = rows.iter().all(Row::is_good);
    args.common.tell(table::text(&rows));
    let outcome = if good { Outcome::verdict("passed") } else { Outcome::failure("wrong") };
    Ok(Report {
        sim_time: Some(rows.iter().map(|row| row.sim_time).sum()),
        collisions: Some(rows.iter().map(|row| row.contacts).sum()),
        mixed_noise: true,
        ..Report::new(outcome)
    }
    .table("rows", table::json(&rows)))
}

/// Drives the rows of the table.
pub(crate) fn rows(args: &Args) -> Result<Vec<Row>, Failure> {
    let mut rows: Vec<Row> = Kind::ALL
        .into_iter()
        .flat_map(|kind| Way::ALL.into_iter().map(move |way| row(args, kind, way)))
        .collect();
    let runs: Vec<(Kind, Way, u64)> =
        rows.iter().flat_map(|row| (0..row.runs).map(|index| (row.kind, row.way, index))).collect();
    let trials = args.parts.share_out(&args.common.origin, "runs", runs.len() as u64, None, |run| {
        let (kind, way, index) = runs[run as usize];
        trial(args, kind, way, args.common.seed.wrapping_add(index))
    })?;
    let mut trials = trials.iter();
    for row in &mut rows {
        trials.by_ref().take(row.runs as usize).for_each(|trial| row.add(trial));
        row.mean_position /= row.runs as f64;
    }
    Ok(rows)
}

fn row(args: &Args, kind: Kind, way: Way) -> Row {
    Row {
        kind,
        way,
        runs: if kind == Kind::Odometry { args.runs } else { args.runs.div_ceil(10) },
        reached: 0,
        contacts: 0,
        worst_position: 0.0,
        mean_position: 0.0,
        worst_heading: 0.0,
        inside: 0,
        sim_time: 0.0,
    }
}

/// Result of a run.
#[derive(Debug, Clone)]
struct Trial {
    reached: bool,
    inside: bool,
    contacts: u32,
    /// Position error (m) and heading error (rad).
    position: f64,
    heading: f64,
    sim_time: f64,
}

portable!(struct Trial { reached, inside, contacts, position, heading, sim_time });

fn trial(args: &Args, kind: Kind, way: Way, seed: u64) -> Result<Trial, Failure> {
    let args = Args { method: way, ..args.clone() };
    let (mut trip, heading) = trip(seed);
    let conditions = Conditions {
        seed,
        noise: kind.noise(),
        ideal_encoders: kind == Kind::Ideal,
        time_limit: 120.0,
        reserve: RESERVE,
        light: 1.0,
        keys: Vec::new(),
        pushing: false,
        others: Vec::new(),
        common: None,
    };
    let mut options = options(&args, &trip, Some(heading), &conditions);
    if kind == Kind::Landmark {
        add_landmarks(&args, &mut trip, &mut options)?;
    }
    let run = conditions.run(&trip.scene, |_| {}, |robot, step| drive(robot, &options, step))?;
    let arrival = run.ending.as_ref().ok();
    Ok(Trial {
        reached: arrival.is_some_and(|arrival| arrival.outcome == AToBOutcome::Reached),
        inside: arrival.is_some_and(|arrival| inside_ellipse(trip.start(), &run, arrival)),
        contacts: run.truth.contacts,
        position: run.truth.pose.distance_to(trip.goal),
        heading: heading_error(&run, heading),
        sim_time: run.sim_time,
    })
}

impl Row {
    fn add(&mut self, trial: &Trial) {
        self.worst_position = self.worst_position.max(trial.position);
        self.mean_position += trial.position;
        self.worst_heading = self.worst_heading.max(trial.heading);
        self.contacts += u64::from(trial.contacts);
        self.sim_time += trial.sim_time;
        self.reached += u64::from(trial.reached);
        self.inside += u64::from(trial.inside);
    }
}

/// A trip of 0.5 to 2 m over an empty floor, with a final heading.
fn trip(seed: u64) -> (Trip, f64) {
    let mut stream = Stream::new(seed).child("trip", 0);
    let start = Pose::new(5.0, 5.0, stream.between(-PI, PI));
    let bearing = start.heading + stream.between(-FRAC_PI_2, FRAC_PI_2);
    let goal = start.position() + direction(bearing) * stream.between(0.5, 2.0);
    let heading = bearing + stream.between(-FRAC_PI_2, FRAC_PI_2);
    (Trip { scene: Scene::with_robot(World::empty(10.0, 10.0), RobotSpec::s4(), start), goal }, heading)
}
