//! Results of programs, as JSON and as text.

use roverlab::geometry::{Pose, normalize_angle, units};
use roverlab::io::TrailPoint;
use serde_json::{Value, json};

use crate::report::{Report, Stance};

/// How a program's process ended.
#[derive(Debug, Clone, PartialEq)]
pub enum Ending {
    /// Exit status, and on failure its last words, or why it had no robot.
    Exit(i32, Option<String>),
    /// By a signal.
    Signal(i32),
    /// At a limit, with the reason.
    OutOfTime(String),
    /// By something that programs must not do.
    Offence(String),
    /// It could not be started, with the reason.
    NotStarted(String),
}

/// Ground truth of a robot at the end.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Truth {
    /// Time taken by its program (s).
    pub time: f64,
    /// True pose.
    pub pose: Pose,
    /// Attitude on hills.
    pub stance: Stance,
    /// Pose by odometry.
    pub odometry: Pose,
    /// Distance moved (m).
    pub path_length: f64,
    /// Number of contacts until its program ended.
    pub contacts: u64,
    /// Number of contacts after that.
    pub later_contacts: u64,
    /// True path, if it was asked for.
    pub trail: Vec<TrailPoint>,
}

impl Ending {
    /// At the limit of the simulated time.
    pub fn time_limit() -> Self {
        Self::OutOfTime("its simulated time was over".into())
    }
}

impl Truth {
    /// The truth of a report that knows it.
    pub fn reported(report: &Report, time_limit: f64) -> Self {
        Self {
            // A call that waits beyond the time limit is cut off there.
            time: report.time.min(time_limit),
            pose: report.pose,
            stance: report.stance,
            odometry: report.odometry,
            path_length: report.path_length,
            contacts: report.contacts,
            later_contacts: report.later_contacts,
            ..Self::default()
        }
    }
}

/// Result of a program and its robot.
#[derive(Debug)]
pub struct Verdict {
    program: String,
    robot: usize,
    ending: Ending,
    truth: Truth,
    lcd_text: String,
    sounds: u64,
    beyond_robots: Vec<&'static str>,
    notes: Vec<String>,
    /// Time since which it had been waiting for a radio message at its end (s).
    listening_since: Option<f64>,
}

impl Verdict {
    /// The result of the program with a name that drives the robot with an index.
    pub fn new(program: &str, robot: usize, ending: Ending, report: &Report, truth: Truth) -> Self {
        Self {
            program: program.to_owned(),
            robot,
            ending,
            truth,
            lcd_text: report.text.clone(),
            sounds: report.sounds,
            beyond_robots: report.beyond_robots(),
            notes: report.notes.clone(),
            listening_since: report.listening_since,
        }
    }

    /// Name of the robot in messages.
    fn name(&self) -> String {
        format!("robot {}, {}", self.robot + 1, self.program)
    }

    /// Warnings about the program, and the mishap of its robot.
    pub fn warnings(&self) -> impl Iterator<Item = String> {
        let name = self.name();
        let mishap = self.truth.stance.mishap.map(|mishap| format!("mishap: {mishap}"));
        self.notes.iter().cloned().chain(mishap).map(move |said| format!("{name}: {said}"))
    }

    /// Whether a limit ended it while it waited for a radio message.
    fn listens(&self) -> bool {
        self.listening_since.is_some() && matches!(self.ending, Ending::OutOfTime(_))
    }

    /// Outcome in one word.
    fn outcome(&self) -> &'static str {
        match self.ending {
            Ending::Signal(_) => "crashed",
            Ending::OutOfTime(_) => "timed_out",
            Ending::Exit(0, None) if self.truth.contacts > 0 => "collided",
            Ending::Exit(0, None) => "finished",
            Ending::Exit(..) | Ending::Offence(_) | Ending::NotStarted(_) => "failed",
        }
    }

    fn error(&self) -> Option<String> {
        match &self.ending {
            Ending::Exit(_, words) => words.clone(),
            Ending::Signal(signal) => Some(format!("ended by signal {signal}")),
            Ending::OutOfTime(message) | Ending::Offence(message) | Ending::NotStarted(message) => {
                Some(message.clone())
            }
        }
    }

    fn value(&self) -> Value {
        let exit = match self.ending {
            Ending::Exit(code, _) => Some(code),
            _ => None,
        };
        let mut value = json!({
            "program": self.program,
            "robot": self.robot + 1,
            "exit": exit,
            "outcome": self.outcome(),
            "sim_time_s": rounded(self.truth.time),
            "pose": place(self.truth.pose, &self.truth.stance),
            "odometry": pose(self.truth.odometry),
            "path_length_mm": rounded(units::to_mm(self.truth.path_length)),
            "collisions": self.truth.contacts,
            "lcd_text": self.lcd_text,
            "sounds": self.sounds,
        });
        if let Some(mishap) = self.truth.stance.mishap {
            value["mishap"] = mishap.to_string().into();
        }
        if self.truth.later_contacts > 0 {
            value["collisions_after_end"] = self.truth.later_contacts.into();
        }
        if !self.beyond_robots.is_empty() {
            value["beyond_robots"] = self.beyond_robots.clone().into();
        }
        if !self.truth.trail.is_empty() {
            value["trail"] = self.truth.trail.iter().map(point).collect();
        }
        if let Some(error) = self.error() {
            value["error"] = error.into();
        }
        value
    }
}

/// Adds to programs that a limit ended while waiting for radio messages which others waited too.
pub fn name_deadlocks(verdicts: &mut [Verdict]) {
    let waits: Vec<_> = verdicts
        .iter()
        .map(|verdict| {
            verdict.listening_since.filter(|_| verdict.listens()).map(|since| (verdict.name(), since))
        })
        .collect();
    for (index, verdict) in verdicts.iter_mut().enumerate() {
        let (Some((_, since)), Ending::OutOfTime(message)) = (&waits[index], &mut verdict.ending) else {
            continue;
        };
        let others = waits.iter().enumerate().filter(|&(other, _)| other != index);
        let others: Vec<String> = others
            .filter_map(|(_, wait)| wait.as_ref())
            .map(|(name, since)| format!("{name} (since {since:.2} s)"))
            .collect();
        let others = if others.is_empty() {
            String::new()
        } else {
            format!(", and so has {}: none of them sends", others.join(", "))
        };
        *message = format!("{message}; it has waited for a radio message since {since:.2} s{others}");
    }
}

/// Results of all programs of a run.
#[derive(Debug)]
pub struct Summary {
    /// Results, robot by robot.
    pub verdicts: Vec<Verdict>,
    /// Warnings about files and programs.
    pub warnings: Vec<String>,
    /// Seed of the run.
    pub seed: u64,
    /// Noise level of the run.
    pub noise: f64,
    /// Wall-clock time (s), if requested.
    pub wall_time: Option<f64>,
}

impl Summary {
    /// 0 if every program ended properly, without a contact.
    pub fn status(&self) -> u8 {
        u8::from(self.verdicts.iter().any(|verdict| verdict.outcome() != "finished"))
    }

    /// One JSON object on one line: the first robot's fields, and all robots in a list.
    pub fn json(&self) -> String {
        let robots: Vec<Value> = self.verdicts.iter().map(Verdict::value).collect();
        let worst = ["crashed", "failed", "timed_out", "collided"];
        let worst = worst.into_iter().find(|word| self.verdicts.iter().any(|v| v.outcome() == *word));
        let mut value = robots.first().cloned().unwrap_or_else(|| json!({}));
        value["example"] = "robios".into();
        value["outcome"] = worst.unwrap_or("finished").into();
        value["seed"] = self.seed.into();
        value["noise"] = self.noise.into();
        value["robots"] = robots.into();
        value["warnings"] = self.warnings.clone().into();
        if let Some(time) = self.wall_time {
            value["timing"] = json!({ "wall_time_s": rounded(time) });
        }
        value.to_string()
    }

    /// The same as readable text.
    pub fn words(&self) -> String {
        let mut lines = Vec::new();
        for verdict in &self.verdicts {
            let truth = &verdict.truth;
            lines.push(format!("robot {}, {}: {}", verdict.robot + 1, verdict.program, verdict.outcome()));
            let (x, y) = (units::to_mm(truth.pose.x).round(), units::to_mm(truth.pose.y).round());
            let heading = units::to_deg(normalize_angle(truth.pose.heading));
            lines.push(format!("  pose               {x}, {y} mm, {heading:.1} deg"));
            if truth.stance != Stance::default() {
                lines.push(format!("  in space           {}", stance(&truth.stance)));
            }
            lines.push(format!("  path length        {:.0} mm", units::to_mm(truth.path_length)));
            lines.push(format!("  collisions         {}", truth.contacts));
            lines.push(format!("  simulated time     {:.2} s", truth.time));
            if let Some(error) = verdict.error() {
                lines.push(format!("  error              {error}"));
            }
            lines.extend(verdict.lcd_text.lines().map(|line| format!("  | {line}")));
        }
        lines.extend(self.wall_time.map(|time| format!("{time:.2} s on the wall clock")));
        lines.join("\n")
    }
}

/// Report of a run that could not start.
pub fn refusal(message: &str, warnings: &[String]) -> String {
    let value = json!({
        "example": "robios",
        "outcome": "failed",
        "error": message,
        "warnings": warnings,
        "robots": [],
    });
    value.to_string()
}

/// A pose in space: the angles are rotations about the forward, left and up axes, in this order.
fn place(at: Pose, stance: &Stance) -> Value {
    let mut value = pose(at);
    value["z_mm"] = rounded(units::to_mm(stance.elevation)).into();
    value["roll_deg"] = rounded(units::to_deg(stance.roll)).into();
    value["pitch_deg"] = rounded(units::to_deg(stance.pitch)).into();
    value
}

fn stance(stance: &Stance) -> String {
    let (roll, pitch) = (units::to_deg(stance.roll), units::to_deg(stance.pitch));
    let mishap = stance.mishap.map_or_else(String::new, |mishap| format!(", {mishap}"));
    let height = units::to_mm(stance.elevation).round();
    format!("{height} mm up, roll {roll:.1}, pitch {pitch:.1} deg{mishap}")
}

fn pose(pose: Pose) -> Value {
    json!({
        "x_mm": rounded(units::to_mm(pose.x)),
        "y_mm": rounded(units::to_mm(pose.y)),
        "heading_deg": rounded(units::to_deg(normalize_angle(pose.heading))),
    })
}

/// A point of a path: seconds, millimetres, millimetres and degrees.
fn point(at: &TrailPoint) -> Value {
    let TrailPoint { time, pose, .. } = at;
    let heading = units::to_deg(normalize_angle(pose.heading));
    let tenths = |value: f64| (value * 10.0).round() / 10.0 + 0.0;
    json!([rounded(*time), tenths(units::to_mm(pose.x)), tenths(units::to_mm(pose.y)), tenths(heading)])
}

/// Without spurious digits from unit conversion, and without negative zero.
fn rounded(value: f64) -> f64 {
    (value * 1e6).round() / 1e6 + 0.0
}
