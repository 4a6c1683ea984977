use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use roverlab::geometry::{Point, units};
use roverlab::io::log::Log;
use serde_json::Value;

use super::place::Place;
use super::program::{Kind, Program, runner};
use super::rubric::Rubric;
use super::workplace::Workplace;
use crate::common::{own_program, recording_bytes};
use crate::replay::true_path;

/// Result of one run of a program.
#[derive(Debug, Clone, Default)]
pub(super) struct Ran {
    /// Index of the world.
    pub(super) place: usize,
    /// How it ended: `reached`, `missed`, `collided`, `timed_out`, `crashed` or `failed`.
    pub(super) outcome: &'static str,
    pub(super) contacts: u64,
    /// Simulated time (s), and length of the true path (m).
    pub(super) time: f64,
    pub(super) length: f64,
    pub(super) path: Vec<Point>,
    /// Functions called that no robot has.
    pub(super) beyond: Vec<String>,
    /// Files written.
    pub(super) written: Vec<String>,
    /// The program's last line, and what went wrong.
    pub(super) output: String,
    pub(super) error: Option<String>,
    /// Whether the limit of real time ended it.
    pub(super) is_endless: bool,
}

/// Interval between the points of a path (s).
const TRAIL: &str = "0.1";
/// Limits of a run: memory (KiB), and size of each file that it writes (blocks of 512 bytes), which includes
/// the 17 MB that the runner shares with its program.
const LIMITS: &str = "ulimit -v 4194304; ulimit -f 65536; exec \"$0\" \"$@\"";

/// Conditions of a run.
#[derive(Debug, Clone, Copy)]
pub(super) struct Terms<'a> {
    pub(super) rubric: &'a Rubric,
    pub(super) place: &'a Place,
    pub(super) index: usize,
    pub(super) seed: u64,
    /// Files of all programs to grade.
    pub(super) files: &'a [PathBuf],
}

/// Runs a program once.
pub(super) fn run(program: &Program, terms: &Terms<'_>) -> Result<Ran, String> {
    let mut folder = Workplace::new().map_err(|error| error.to_string())?;
    let ran = match &program.kind {
        Kind::Robios { file, source } => robios(file, source, &mut folder, terms)?,
        Kind::Lab(words) => lab(words, &folder, terms)?,
    };
    let outcome = judged(&ran, terms.place);
    Ok(Ran { place: terms.index, outcome, ..ran })
}

/// How a run ended, with regard to what was to be done. A program that was to stay somewhere must end by
/// itself; others may go on until their time is over.
fn judged(ran: &Ran, place: &Place) -> &'static str {
    match ran.outcome {
        "crashed" | "failed" => ran.outcome,
        _ if ran.contacts > 0 => "collided",
        ended => {
            let is_over = ended == "timed_out";
            match place.is_done(&ran.path, !is_over) {
                true => "reached",
                false if is_over => "timed_out",
                false => "missed",
            }
        }
    }
}

/// Runs a program for RoBIOS.
fn robios(file: &Path, source: &Path, folder: &mut Workplace, terms: &Terms<'_>) -> Result<Ran, String> {
    let others: Vec<PathBuf> = terms.files.iter().filter(|other| *other != source).cloned().collect();
    let file = folder.bring(file, source, &others).map_err(|error| error.to_string())?;
    let Terms { rubric, place, seed, .. } = terms;
    let [x, y, heading] = place.task.start;
    let options = [
        ("--world", whole(&place.task.file)),
        ("--robot", rubric.robot.clone().into()),
        ("--start", format!("{x},{y},{heading}").into()),
        ("--seed", seed.to_string().into()),
        ("--noise", rubric.noise.to_string().into()),
        ("--time-limit", rubric.time_limit.to_string().into()),
        ("--real-limit", rubric.real_limit.to_string().into()),
        ("--hang-limit", rubric.real_limit.to_string().into()),
        ("--trail", TRAIL.into()),
    ];
    let mut command = limited(runner()?);
    command
        .arg("--json")
        .args(options.iter().flat_map(|(name, value)| [OsString::from(name), value.clone()]));
    let (report, said) = answer(command.arg(&file), folder)?;
    let text = |name: &str| report[name].as_str().unwrap_or_default();
    let numbers = |point: &Value| {
        let [x, y] = [1, 2].map(|index| units::from_mm(point[index].as_f64().unwrap_or_default()));
        Point::new(x, y)
    };
    let mut path: Vec<Point> = report["trail"].as_array().into_iter().flatten().map(numbers).collect();
    if let (Some(x), Some(y)) = (report["pose"]["x_mm"].as_f64(), report["pose"]["y_mm"].as_f64()) {
        path.push(Point::new(units::from_mm(x), units::from_mm(y)));
    }
    let ended = || format!("the runner gives no report: {said}");
    let error = report["error"].as_str().map(str::to_owned).or_else(|| report.is_null().then(ended));
    let last = |text: &str| text.lines().rfind(|line| !line.trim().is_empty()).map(str::to_owned);
    let names = report["beyond_robots"].as_array().into_iter().flatten();
    Ok(Ran {
        outcome: if report.is_null() { "failed" } else { word(text("outcome")) },
        path,
        beyond: names.filter_map(|name| name.as_str().map(str::to_owned)).collect(),
        written: folder.written(),
        output: last(text("lcd_text")).or_else(|| last(&said)).unwrap_or_default(),
        is_endless: error.as_ref().is_some_and(|error| error.contains("real seconds")),
        error,
        ..figures(&report)
    })
}

/// Runs a command of this program.
fn lab(words: &[String], folder: &Workplace, terms: &Terms<'_>) -> Result<Ran, String> {
    let Terms { rubric, place, seed, .. } = terms;
    let [x, y, heading] = place.task.start;
    let log = folder.path().join("run.mcap");
    let options = [
        ("--world", whole(&place.task.file)),
        ("--robot", rubric.robot.clone().into()),
        ("--start", format!("{x},{y},{heading}").into()),
        ("--seed", seed.to_string().into()),
        ("--noise", rubric.noise.to_string().into()),
        ("--time-limit", rubric.time_limit.to_string().into()),
        ("--record", log.clone().into()),
    ];
    let own = own_program().map_err(|error| error.to_string())?;
    let mut command = Command::new(own);
    command.args(words).arg("--json");
    command.args(options.iter().flat_map(|(name, value)| [OsString::from(name), value.clone()]));
    let (report, said) = answer(&mut command, folder)?;
    let outcome = report["outcome"].as_str().unwrap_or_default();
    let read = recording_bytes(&log).ok().and_then(|bytes| Log::read(bytes).ok());
    Ok(Ran {
        // What a command calls its success is its own word.
        outcome: if report.is_null() { "failed" } else { word(outcome) },
        path: read.map(|log| true_path(&log, 0)).unwrap_or_default(),
        output: outcome.to_owned(),
        error: report["error"].as_str().map(str::to_owned).or_else(|| report.is_null().then_some(said)),
        ..figures(&report)
    })
}

/// Contacts, time and length in a report.
fn figures(report: &Value) -> Ran {
    let number = |name: &str| report[name].as_f64().unwrap_or_default();
    Ran {
        contacts: report["collisions"].as_u64().unwrap_or_default(),
        time: number("sim_time_s"),
        length: units::from_mm(number("path_length_mm")),
        ..Ran::default()
    }
}

/// The outcome of a report as one of those that are told apart here.
fn word(outcome: &str) -> &'static str {
    match outcome {
        "crashed" => "crashed",
        "failed" => "failed",
        "timed_out" => "timed_out",
        _ => "finished",
    }
}

fn whole(file: &Path) -> OsString {
    std::path::absolute(file).unwrap_or_else(|_| file.into()).into()
}

/// A program with limits of memory and of the size of files.
fn limited(program: PathBuf) -> Command {
    let mut command = Command::new("sh");
    command.arg("-c").arg(LIMITS).arg(program);
    command
}

/// Runs a command in a folder, and returns its JSON, or null, and the last line that it said otherwise.
fn answer(command: &mut Command, folder: &Workplace) -> Result<(Value, String), String> {
    let output = command
        .current_dir(folder.path())
        .env("TMPDIR", folder.path())
        .env("HOME", folder.path())
        .stdin(Stdio::null())
        .output()
        .map_err(|error| error.to_string())?;
    let said = String::from_utf8_lossy(&output.stderr);
    let said = said.lines().rfind(|line| !line.trim().is_empty()).unwrap_or_default().to_owned();
    Ok((serde_json::from_slice(&output.stdout).unwrap_or(Value::Null), said))
}
