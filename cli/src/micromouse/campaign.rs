use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use roverlab::maze::files::{self, MazeFile};
use roverlab::maze::{Direction, ExplorationOutcome, FastPlanner, Unknown, WallState};
use serde_json::{Value, json};

use super::Args;
use super::explore::{Told, drive, goal_error, kit, limit, stage};
use crate::common::{Failure, Outcome, Report, millimetres, portable, rounded};
use crate::driving::{Conditions, RESERVE, Run};

/// Result of a run through a maze.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Trial {
    pub(crate) maze: String,
    pub(crate) side: usize,
    pub(crate) seed: u64,
    /// Whether the run had no noise. With noise, a short run may exceed the allowed delay.
    pub(crate) ideal: bool,
    pub(crate) proved: bool,
    pub(crate) contacts: u32,
    /// Number of walls in the robot's map that are wrong.
    pub(crate) wrong_walls: usize,
    /// Whether its plan is as fast as that for the true maze.
    pub(crate) best_plan: bool,
    /// Relative delay of the fast run compared with the plan; `None` without a way.
    pub(crate) late: Option<f64>,
    /// True distance of the fast run's end from the middle of the goal (cells); `None` without one.
    pub(crate) goal_error: Option<f64>,
    /// Final error of the robot's pose estimate (m).
    pub(crate) lost: f64,
    pub(crate) sim_time: f64,
    pub(crate) error: Option<String>,
}

portable!(struct Trial {
    maze, side, seed, ideal, proved, contacts, wrong_walls, best_plan, late, goal_error, lost, sim_time, error,
});

impl Trial {
    /// Maximum relative delay compared with the plan.
    const LATE: f64 = 0.02;
    /// Maximum distance of a fast run's end from the middle of the goal (cells).
    const NEAR: f64 = 0.25;

    pub(crate) fn is_good(&self) -> bool {
        self.trouble().is_none()
    }

    fn keeps_to_plan(&self) -> bool {
        self.late.is_none_or(|late| late.abs() <= Self::LATE)
    }

    /// Description of the failures.
    fn trouble(&self) -> Option<String> {
        let mut list: Vec<String> = self.error.iter().cloned().collect();
        let mut add = |wrong: bool, what: String| {
            if wrong {
                list.push(what);
            }
        };
        add(self.contacts > 0, format!("{} contacts", self.contacts));
        add(!self.proved && self.error.is_none(), "nothing proved".into());
        add(self.wrong_walls > 0, format!("{} walls known wrongly", self.wrong_walls));
        add(self.proved && !self.best_plan, "not the fastest plan".into());
        add(
            self.ideal && !self.keeps_to_plan(),
            format!("{:+.1} % of the planned time", 100.0 * self.late.unwrap_or(0.0)),
        );
        let missed = self.goal_error.filter(|error| *error > Self::NEAR);
        add(missed.is_some(), format!("the fast run ended {:.2} cells from the goal", missed.unwrap_or(0.0)));
        (!list.is_empty()).then(|| list.join(", "))
    }
}

/// Explores and races through all mazes of a folder.
pub(crate) fn campaign(args: &Args, folder: &Path) -> Result<Report, Failure> {
    let mazes = mazes(folder)?;
    let count = mazes.len() as u64 * args.runs;
    let trials = args.parts.share_out(&args.common.origin, "drives", count, args.threads, |index| {
        let (name, file) = &mazes[(index / args.runs) as usize];
        trial(args, name, file, args.common.seed.wrapping_add(index % args.runs))
    })?;
    args.common.tell(text(&trials));
    let good = trials.iter().all(Trial::is_good);
    let outcome = if good { Outcome::verdict("passed") } else { Outcome::failure("wrong") };
    let failures = trials.iter().filter_map(|trial| {
        Some(json!({ "maze": trial.maze, "seed": trial.seed, "trouble": trial.trouble()? }))
    });
    // Contacts are in the rows, which determine the outcome.
    Ok(Report { sim_time: Some(trials.iter().map(|trial| trial.sim_time).sum()), ..Report::new(outcome) }
        .field("folder", folder)
        .field("mazes", mazes.len())
        .table("rows", rows(&trials).iter().map(Row::json).collect::<Vec<_>>())
        .field("failures", failures.collect::<Vec<_>>()))
}

/// The mazes of a folder and its subfolders, ordered by name; other files are ignored.
fn mazes(folder: &Path) -> Result<Vec<(String, MazeFile)>, Failure> {
    let mut paths = BTreeSet::new();
    collect(folder, &mut paths)?;
    let named = |path: PathBuf| {
        let name = path.strip_prefix(folder).unwrap_or(&path).display().to_string();
        Some((name, files::load(&path).ok()?))
    };
    let mazes: Vec<_> = paths.into_iter().filter_map(named).collect();
    if mazes.is_empty() {
        let message = format!("{}: found no file that holds a maze; expected one or more", folder.display());
        return Err(Failure::input(message));
    }
    Ok(mazes)
}

fn collect(folder: &Path, paths: &mut BTreeSet<PathBuf>) -> Result<(), Failure> {
    let unreadable = |error: std::io::Error| {
        Failure::input(format!("{}: found {error}; expected a folder that can be read", folder.display()))
    };
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let entry = entry.map_err(unreadable)?;
        let path = entry.path();
        // Links are not followed, to avoid loops.
        if entry.file_type().map_err(unreadable)?.is_dir() {
            collect(&path, paths)?;
        } else {
            paths.insert(path);
        }
    }
    Ok(())
}

fn trial(args: &Args, name: &str, file: &MazeFile, seed: u64) -> Result<Trial, Failure> {
    let (spec, scale, _) = kit(args.doubled);
    let scene = stage(file, &spec, scale);
    let conditions = Conditions {
        seed,
        noise: args.common.noise,
        light: 1.0,
        keys: Vec::new(),
        pushing: false,
        others: Vec::new(),
        ideal_encoders: false,
        time_limit: args.common.time_limit.unwrap_or_else(|| limit(&file.maze)),
        reserve: RESERVE,
        common: None,
    };
    let mut told = None;
    let run = conditions.run(
        &scene,
        |_| {},
        |robot, step| drive(robot, args, &file.maze, &conditions, &mut told, step),
    )?;
    Ok(judged(args, name, file, seed, &run, told.as_ref()))
}

fn judged(args: &Args, name: &str, file: &MazeFile, seed: u64, run: &Run<()>, told: Option<&Told>) -> Trial {
    let truth = &file.maze;
    let plan = told.and_then(|told| told.plan.as_ref());
    Trial {
        maze: name.to_owned(),
        side: truth.width().max(truth.height()),
        seed,
        ideal: args.common.noise == 0.0,
        proved: told.is_some_and(|told| {
            matches!(told.exploration.verdict, ExplorationOutcome::Optimal | ExplorationOutcome::Unreachable)
        }),
        contacts: run.truth.contacts,
        wrong_walls: told.map_or(0, |told| {
            let sides = truth.cells().flat_map(|cell| Direction::ALL.map(|side| (cell, side)));
            // A robot assumes the outer wall; gaps in it are defects of the file.
            let sides = sides.filter(|&(cell, side)| truth.neighbour(cell, side).is_some());
            let wrong = |&(cell, side): &(_, _)| {
                let known = told.known.wall(cell, side);
                // An unknown wall of the file exists in the world.
                let stands = truth.wall(cell, side) != WallState::Absent;
                known != WallState::Unknown && (known == WallState::Present) != stands
            };
            sides.filter(wrong).count()
        }),
        best_plan: best_time(args, file)
            .is_none_or(|best| plan.is_some_and(|plan| (plan.time - best).abs() < 2e-3)),
        late: plan
            .zip(told.and_then(|told| told.race))
            .and_then(|(plan, race)| (plan.time > 0.0).then(|| race / plan.time - 1.0)),
        goal_error: told.and_then(|told| told.race).map(|_| {
            let scale = kit(args.doubled).1;
            goal_error(run.truth.pose, truth, scale) / scale.cell
        }),
        lost: told.map_or(0.0, |told| run.truth.pose.distance_to(told.pose.position())),
        sim_time: run.sim_time,
        error: run.ending.as_ref().err().cloned(),
    }
}

/// Duration of the fastest run through the true maze (s).
fn best_time(args: &Args, file: &MazeFile) -> Option<f64> {
    let (_, scale, parameters) = kit(args.doubled);
    let mut planner = FastPlanner::new(scale, parameters.racing).ok()?;
    Some(planner.plan(&file.maze, Unknown::Closed)?.time)
}

/// Trials of one size, or all of them.
#[derive(Debug, Clone, PartialEq)]
struct Row {
    name: String,
    mazes: usize,
    runs: usize,
    proved: usize,
    collided: usize,
    best_plans: usize,
    raced: usize,
    on_time: usize,
    worst_late: f64,
    worst_lost: f64,
}

impl Row {
    fn new<'a>(name: String, trials: &(impl Iterator<Item = &'a Trial> + Clone)) -> Self {
        let count = |good: fn(&Trial) -> bool| trials.clone().filter(|trial| good(trial)).count();
        let worst = |value: fn(&Trial) -> f64| trials.clone().map(value).fold(0.0, f64::max);
        Self {
            name,
            mazes: trials.clone().map(|trial| &trial.maze).collect::<BTreeSet<_>>().len(),
            runs: trials.clone().count(),
            proved: count(|trial| trial.proved),
            collided: count(|trial| trial.contacts > 0),
            best_plans: count(|trial| trial.best_plan),
            raced: count(|trial| trial.late.is_some()),
            on_time: count(|trial| trial.late.is_some() && trial.keeps_to_plan()),
            worst_late: worst(|trial| trial.late.map_or(0.0, f64::abs)),
            worst_lost: worst(|trial| trial.lost),
        }
    }

    fn json(&self) -> Value {
        json!({
            "size": self.name,
            "mazes": self.mazes,
            "runs": self.runs,
            "proved": self.proved,
            "collided": self.collided,
            "best_plans": self.best_plans,
            "raced": self.raced,
            "on_time": self.on_time,
            "worst_late_percent": rounded(100.0 * self.worst_late),
            "worst_localisation_error_mm": millimetres(self.worst_lost),
        })
    }
}

fn rows(trials: &[Trial]) -> Vec<Row> {
    let sides: BTreeSet<usize> = trials.iter().map(|trial| trial.side).collect();
    let of = |side: usize| Row::new(side.to_string(), &trials.iter().filter(move |trial| trial.side == side));
    sides.into_iter().map(of).chain([Row::new("all".into(), &trials.iter())]).collect()
}

/// The table, and the failures.
fn text(trials: &[Trial]) -> String {
    let mut text = String::from(
        "size  mazes  runs  proved  collided  best plan  raced  on time  worst late %  worst lost mm\n",
    );
    for row in rows(trials) {
        writeln!(
            text,
            "{:>4}  {:>5}  {:>4}  {:>6}  {:>8}  {:>9}  {:>5}  {:>7}  {:>12.2}  {:>13.1}",
            row.name,
            row.mazes,
            row.runs,
            row.proved,
            row.collided,
            row.best_plans,
            row.raced,
            row.on_time,
            100.0 * row.worst_late,
            1000.0 * row.worst_lost
        )
        .expect("writing to a string does not fail");
    }
    for trial in trials {
        if let Some(trouble) = trial.trouble() {
            writeln!(text, "{}, seed {}: {trouble}", trial.maze, trial.seed)
                .expect("writing to a string does not fail");
        }
    }
    text
}
