//! The command `base-station`.

mod drawing;
mod scene;
mod share;

use roverlab::io::sim::SimOptions;
use serde_json::{Value, json};

use crate::common::{CommonArgs, Failure, Outcome, Report, millimetres, rounded};
use crate::driving::paced;
use scene::Setting;
use share::Shared;

/// The command line of `base-station`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Lets model cars share a road by radio, and stops them from a base station",
    after_help = "\
The course is a figure of eight whose crossing has no signs and give-way lines on all four entries, or it is drawn by a seed, or
read from a file (docs/courses.md). Each car drives by its camera, and tells the others and the base station five times a second
where it is, in which lane, and what it is about to do. It keeps its distance to the car ahead, and at crossings lets those from
the right go first. The base station, a robot of its own beside the road, draws all of them on its display. At --stop-at it
orders them to stand, for five seconds.

JSON fields:
  course, course_length_m
  cars                        number of cars
  contacts                    number of contacts of cars with each other
  departures                  number of times that two wheels of a car left its lane
  distances_m                 of each car along its lane
  least_gap_mm                least distance between the middles of the rear axles of two cars
  reports                     number of cars that the base station has heard at the end
  stopped_s                   time from its order to stand until all cars stood, if they did
  went_on                     whether all cars drove on after its order to do so
  picture
Outcomes: shared (no contact, no departure, all cars moved, stopped and went on), touched, disturbed, timed_out (before the
order to stand), failed."
)]
pub(crate) struct Args {
    /// Course to drive: `eight`, a seed, or a file in the format of docs/courses.md.
    #[arg(long, value_name = "eight|SEED|FILE", default_value = "eight")]
    pub(crate) course: String,

    /// Number of cars, evenly spread over the course.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u8).range(1..=8), allow_hyphen_values = true)]
    pub(crate) cars: u8,

    /// Time at which the base station stops all cars (s).
    #[arg(long, value_name = "SECONDS", default_value_t = 20.0, value_parser = crate::common::parse_seconds, allow_hyphen_values = true)]
    pub(crate) stop_at: f64,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("always", &["world", "robot", "start", "goal", "quantised", "robios", "fault", "supervised"]),
]);

/// Runs the command.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    let common = &args.common;
    common.check_picture()?;
    let setting = Setting::of(args)?;
    let options = SimOptions::with_noise(common.noise, common.seed);
    let mut fleet = common.fleet(&setting.scene, options)?;
    let shared = share::drive(args, &setting, &mut *fleet, paced(common))?;
    drop(fleet);
    let report = report(args, &setting, &shared);
    Ok(common.draw(report, "base-station.svg", || drawing::picture(&setting, &shared)))
}

fn report(args: &Args, setting: &Setting, shared: &Shared) -> Report {
    let is_obeyed = shared.stopped.is_some() && shared.went_on == Some(true);
    let all_move = shared.cars.iter().all(|car| car.score.distance > 1.0);
    let departures: u32 = shared.cars.iter().map(|car| car.score.departures).sum();
    let word = match () {
        () if shared.contacts > 0 => Outcome::failure("touched"),
        () if !shared.is_ordered => Outcome::failure("timed_out"),
        () if is_obeyed && all_move && departures == 0 => Outcome::verdict("shared"),
        () => Outcome::failure("disturbed"),
    };
    let distances: Vec<Value> = shared.cars.iter().map(|car| json!(rounded(car.score.distance))).collect();
    Report { sim_time: Some(shared.time), collisions: Some(shared.contacts), ..Report::new(word) }
        .field("course", &args.course)
        .field("course_length_m", rounded(setting.course.line.length()))
        .field("cars", args.cars)
        .field("contacts", shared.contacts)
        .field("departures", departures)
        .field("distances_m", distances)
        .field("least_gap_mm", millimetres(shared.least_gap))
        .field("reports", shared.heard)
        .field("stopped_s", shared.stopped.map(rounded))
        .field("went_on", shared.went_on)
}
