use roverlab::drive::FirstStepsOutcome;
use roverlab::geometry::units;
use serde_json::json;

use super::Args;
use super::args::Task;
use super::job::{Drive, drive};
use super::scene::scene;
use crate::common::{Failure, Report, campaign_report, millimetres, portable, rounded, wrong_seeds};
use crate::driving::{Conditions, RESERVE};

/// Rooms without `--runs`.
const ROOMS: u64 = 100;
/// Largest errors of a good return (m, rad), and the fraction of returns that are to be good.
const POSITION: f64 = 0.02;
const HEADING: f64 = 2.0 / 180.0 * std::f64::consts::PI;
const GOOD: f64 = 0.95;

/// The errors of a run of a task.
#[derive(Debug, Clone, Copy)]
struct Trial {
    returned: bool,
    contacts: u32,
    position_error: f64,
    heading_error: f64,
}

portable!(struct Trial { returned, contacts, position_error, heading_error });

impl Trial {
    fn is_good(&self) -> bool {
        self.returned
            && self.contacts == 0
            && self.position_error <= POSITION
            && self.heading_error <= HEADING
    }
}

/// The campaign's work.
pub(super) fn campaign(args: &Args) -> Result<Report, Failure> {
    let trials = args.trials.trials(&args.common, "rooms", ROOMS, |seed| both(args, seed))?;
    args.common.tell("task    runs  good  position  largest  heading  largest");
    let (mut rows, mut passed) = (Vec::new(), true);
    for (index, task) in Task::ALL.into_iter().enumerate() {
        let of = || trials.iter().map(move |(_, both)| both[index]);
        let (runs, good) = (of().count(), of().filter(Trial::is_good).count());
        passed &= good as f64 >= GOOD * runs as f64;
        let position = median_and_largest(of().map(|trial| trial.position_error));
        let heading = median_and_largest(of().map(|trial| trial.heading_error));
        let [median, largest] = position.map(units::to_mm);
        let [turned, most] = heading.map(units::to_deg);
        args.common.tell(format_args!(
            "{:<6}  {runs:>4}  {good:>4}  {median:>5.1} mm  {largest:>4.1} mm  {turned:>5.2} deg {most:>5.2} deg",
            task.name()
        ));
        rows.push(json!({
            "task": task.name(), "runs": runs, "good": good,
            "position_error_mm": position.map(millimetres),
            "heading_error_deg": heading.map(|angle| rounded(units::to_deg(angle))),
        }));
    }
    let wrong = wrong_seeds(&trials, |both| both.iter().all(Trial::is_good));
    let contacts = trials.iter().flat_map(|(_, both)| both).map(|trial| u64::from(trial.contacts)).sum();
    Ok(campaign_report(passed, contacts, &wrong).table("rows", rows))
}

/// Both tasks in the room of a seed.
fn both(args: &Args, seed: u64) -> Result<[Trial; 2], Failure> {
    let scene = scene(seed);
    let conditions =
        Conditions { seed, common: None, reserve: RESERVE, ..Conditions::new(&args.common, 60.0)? };
    let trial = |task| -> Result<Trial, Failure> {
        let Drive { run, position_error, heading_error, .. } = drive(&scene, task, &conditions, |_| {})?;
        let returned = matches!(run.ending, Ok(FirstStepsOutcome::Returned));
        Ok(Trial { returned, contacts: run.truth.contacts, position_error, heading_error })
    };
    Ok([trial(Task::Wall)?, trial(Task::Circle)?])
}

/// Median and largest of some numbers.
fn median_and_largest(numbers: impl Iterator<Item = f64>) -> [f64; 2] {
    let mut numbers: Vec<f64> = numbers.collect();
    numbers.sort_by(f64::total_cmp);
    [numbers[numbers.len() / 2], numbers[numbers.len() - 1]]
}
