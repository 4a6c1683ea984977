//! The command `safety`.

mod base;
mod crew;
mod drive;

use std::path::PathBuf;

use roverlab::io::sim::SimOptions;
use roverlab::picture::{Picture, Style};
use roverlab::world::Colour;

use crate::common::{CommonArgs, Failure, Outcome, Report, rounded};
use crate::cones::{Course, check_race, drawing};
use crew::Event;
use drive::{Driven, Stopped};

/// Command line of `safety`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "A racing car with its safety system: it is armed and started, stops after an incident, and is started again",
    after_help = "\
The car drives between cones at up to 6 m/s. After any incident it must stop within the distance proved for its model,
and stand until it is armed again. A car without calls for 0.3 s stops by itself. Each incident must be answered within
one control period after it becomes detectable. Faults of `--fault` come in addition; while a sensor is faulty, it is
not confirmed, and the car is not armed again.

JSON fields:
  stops               for each: event, state, causes, time_s, reaction_ms after the event, speed_m_s, distance_m, bound_m
  takeovers           the same for each handover to the driver, up to reaction_ms
  states              [seconds, state] of every change
  picture
Outcomes: stood (every stop within its bound), overran, late (an incident was not answered in time), timed_out, failed (the car is
out of reach)."
)]
pub(crate) struct Args {
    /// Track to drive on [default: a generated one].
    #[arg(long, value_name = "FILE")]
    pub(crate) track: Option<PathBuf>,

    /// Events, in this order [default: all]. May be repeated.
    #[arg(long, value_enum)]
    pub(crate) event: Vec<Event>,

    /// Distance from the start that the car must not exceed along either axis, in metres.
    #[arg(long, value_name = "M")]
    pub(crate) fence: Option<f64>,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs);

/// The command's work.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    let common = &args.common;
    common.check_picture()?;
    check_race(common)?;
    if common.supervised {
        return Err(Failure::input(
            "--supervised: here the car always is; expected a command line without it",
        ));
    }
    if args.fence.is_some_and(|fence| !(fence > 0.0 && fence <= 1e4)) {
        return Err(Failure::input("--fence: expected more than 0, at most 10000 m"));
    }
    let course = match &args.track {
        Some(path) => Course::from_file(common, path)?,
        None => Course::generated(common.seed)?,
    };
    let options = SimOptions::with_noise(common.noise, common.seed);
    let stage = common.stage(&course.scene(&[course.start]), options)?.with_deadman();
    let driven = drive::drive(&course, args, &stage)?;
    for stop in &driven.stops {
        common.tell(stop);
    }
    for takeover in &driven.takeovers {
        common.tell(takeover);
    }
    Ok(common.draw(report(&course, &driven), "safety.svg", || picture(&course, &driven)))
}

fn report(course: &Course, driven: &Driven) -> Report {
    let word = if driven.stops.iter().any(|stop| !stop.is_within()) {
        Outcome::failure("overran")
    } else if !driven.prompt {
        Outcome::failure("late")
    } else {
        match driven.ending {
            Ok(true) => Outcome::verdict("stood"),
            Ok(false) => Outcome::failure("timed_out"),
            Err(_) => Outcome::failure("failed"),
        }
    };
    let states: Vec<(f64, String)> =
        driven.states.iter().map(|(time, state)| (rounded(*time), format!("{state:?}"))).collect();
    let truth = driven.judge.truth();
    let report = Report::new(word)
        .field("stops", driven.stops.iter().map(Stopped::told).collect::<Vec<_>>())
        .field("takeovers", driven.takeovers.iter().map(drive::told).collect::<Vec<_>>())
        .field("states", states);
    Report {
        sim_time: Some(driven.judge.time()),
        collisions: Some(truth.contacts.into()),
        path_length: Some(truth.path_length),
        pose: Some(truth.pose),
        odometry: Some(course.start.compose(&truth.odometry)),
        error: driven.ending.as_ref().err().cloned(),
        ..report
    }
}

/// The path, coloured by speed, and the stops.
fn picture(course: &Course, driven: &Driven) -> Picture {
    let mut picture = Picture::new(&course.ground());
    picture.title("Stops under the safety system");
    drawing::cones(&mut picture, course, |_| true);
    for stop in &driven.stops {
        let [from, to] = stop.places().map(|pose| pose.position());
        picture.disc(
            from,
            1.6,
            Style::new(Colour::from_hex(0xc8_3e_4d)).filled(0.5).labelled("a stop begins"),
        );
        picture.disc(to, 1.6, Style::new(Colour::from_hex(0x2e_8b_57)).filled(0.5).labelled("it stands"));
    }
    drawing::car(&mut picture, driven.judge.trail());
    let worst = driven.stops.iter().map(Stopped::share).fold(0.0, f64::max);
    picture.caption(format!("{} stops, {:.0} % of the bound at worst", driven.stops.len(), 100.0 * worst));
    picture
}
