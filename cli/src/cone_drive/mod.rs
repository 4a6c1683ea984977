//! The command `cone-drive`.

use std::path::PathBuf;

use roverlab::geometry::Pose;
use roverlab::io::control::until;
use roverlab::io::sim::{RobotTruth, SimOptions};
use roverlab::io::{self, LidarSettings, RobotIo};
use roverlab::picture::Picture;
use roverlab::race::{GapDriver, RaceScore};
use roverlab::world::RobotSpec;

use crate::common::{CommonArgs, Failure, OF_PARTS, Outcome, PartArgs, Report, Stage, portable, rounded};
use crate::cones::{Course, Judge, Passed, check_campaign, check_race, drawing, judged};

/// Command line of `cone-drive`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Drives between cones as the book's program does: to the gap between the nearest cones left and right of the scan's middle",
    after_help = "\
The car keeps its speed. Ten times a second it steers for the midpoint between the two cones nearest to the middle of
its scan. `cone_race` drives the same tracks with a map and a racing line.

JSON fields:
  laps, cones_hit, off_course, lap_times_s    by the referee
  distance_clean_m                            metres to the first hit cone or to leaving the course
  tracks, clean, clean_share                  campaign only
  picture
Outcomes: finished, collided (a cone was hit, with any other result), penalised (all laps, but the course was left with
all wheels), timed_out (also if the car was far off its track), failed (the car's program), raced (a campaign).
Tracks of events, an acceleration or a skidpad, are refused: `cone_race` drives them."
)]
pub(crate) struct Args {
    /// Track to drive on [default: a generated one].
    #[arg(long, value_name = "FILE")]
    pub(crate) track: Option<PathBuf>,

    /// Number of laps.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=100))]
    pub(crate) laps: u16,

    /// Speed in metres per second.
    #[arg(long, value_name = "M/S", default_value_t = 3.0)]
    pub(crate) speed: f64,

    /// Drive on this many generated tracks, starting with --seed.
    #[arg(long, value_name = "TRACKS", conflicts_with = "track", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) campaign: Option<u32>,

    /// The part to do.
    #[command(flatten)]
    pub(crate) parts: PartArgs,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [("!campaign", OF_PARTS)]);

/// Result of a drive.
struct Driven {
    verdict: RaceScore,
    /// Reason for an early end, if the car failed.
    error: Option<String>,
    truth: RobotTruth,
    time: f64,
    clean: f64,
    trail: Vec<Passed>,
}

/// The command's work.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    let common = &args.common;
    common.check_picture()?;
    check_race(common)?;
    if !(args.speed > 0.0 && args.speed <= 30.0) {
        return Err(Failure::input(format!("--speed {}: expected more than 0, at most 30 m/s", args.speed)));
    }
    if let Some(tracks) = args.campaign {
        return campaign(args, tracks);
    }
    let course = match &args.track {
        Some(path) => Course::from_file(common, path)?,
        None => Course::generated(common.seed)?,
    };
    let stage = common.stage(&course.scene(&[course.start]), options(args, common.seed))?;
    let driven = drive(&course, args, &stage)?;
    let report = report(args, &course, &driven);
    Ok(common.draw(report, "cone_drive.svg", || picture(&course, &driven)))
}

/// Report on a drive.
fn report(args: &Args, course: &Course, driven: &Driven) -> Report {
    let verdict = &driven.verdict;
    let done = verdict.lap_times.len() >= usize::from(args.laps);
    let word = match (done, verdict.cones_hit + verdict.off_course) {
        _ if driven.error.is_some() => Outcome::failure("failed"),
        (false, _) => Outcome::failure("timed_out"),
        (true, 0) => Outcome::verdict("finished"),
        (true, _) => Outcome::verdict("penalised"),
    };
    let times: Vec<f64> = verdict.lap_times.iter().map(|time| rounded(*time)).collect();
    let report = Report::new(word)
        .field("laps", times.len())
        .field("cones_hit", verdict.cones_hit)
        .field("off_course", verdict.off_course)
        .field("lap_times_s", times)
        .field("distance_clean_m", rounded(driven.clean));
    Report {
        sim_time: Some(driven.time),
        collisions: Some(driven.truth.contacts.into()),
        path_length: Some(driven.truth.path_length),
        pose: Some(driven.truth.pose),
        odometry: Some(course.start.compose(&driven.truth.odometry)),
        error: driven.error.clone(),
        ..report
    }
}

/// Options of a drive's simulation.
fn options(args: &Args, seed: u64) -> SimOptions {
    SimOptions::with_noise(args.common.noise, seed)
}

fn drive(course: &Course, args: &Args, stage: &Stage) -> Result<Driven, Failure> {
    let mut judge = Judge::new(course, stage.truth(0)?, 0).map_err(Failure::run)?;
    let mut car = stage.robot(0)?;
    let ending = laps(course, args, car.as_mut(), &mut judge);
    drop(car);
    Ok(Driven {
        verdict: judge.verdict().clone(),
        error: ending.err().map(|error| Failure::from(error).to_string()),
        truth: judge.truth().clone(),
        time: judge.time(),
        clean: judge.clean_metres(),
        trail: judge.trail().to_vec(),
    })
}

/// Drives until all laps are done, time is over, or the car is lost.
fn laps<R: RobotIo + ?Sized>(course: &Course, args: &Args, car: &mut R, judge: &mut Judge) -> io::Result<()> {
    let mut driver = GapDriver::with_speed(args.speed / RobotSpec::race_car().drive.top_speed())?;
    let laps = usize::from(args.laps);
    let usual = 1.5 * course.corridor.length() * laps as f64 / args.speed + 10.0;
    let limit = args.common.time_limit.unwrap_or(usual);
    // The book's setting: 180 points over 180 degrees.
    car.configure_lidar(LidarSettings { field_of_view: std::f64::consts::PI, tilt: 0.0, points: 180 })?;
    judged(car, &mut driver, limit, judge, |_, _, judge| {
        let verdict = judge.verdict();
        // Far off the track there are no cones to steer by.
        let lost = verdict.off_course > 0 && lost(course, judge.truth().pose);
        until(lost || verdict.lap_times.len() >= laps)
    })?;
    Ok(())
}

/// Whether a car is far from its track.
fn lost(course: &Course, pose: Pose) -> bool {
    course.corridor.stations().iter().all(|station| pose.distance_to(station.position) > 25.0)
}

/// Result of a drive.
#[derive(Debug, Clone)]
struct Trial {
    laps: usize,
    cones_hit: usize,
    off_course: usize,
    /// Distance without a fault (m).
    metres: f64,
}

portable!(struct Trial { laps, cones_hit, off_course, metres });

fn campaign(args: &Args, tracks: u32) -> Result<Report, Failure> {
    check_campaign(&args.common)?;
    let trials = args.parts.share_out(&args.common.origin, "tracks", tracks.into(), None, |track| {
        let seed = args.common.seed.wrapping_add(track);
        let course = Course::generated(seed)?;
        let scene = course.scene(&[course.start]);
        let stage = Stage::simulated(&scene, options(args, seed), args.common.faults()?)?;
        let driven = drive(&course, args, &stage)?;
        let verdict = &driven.verdict;
        Ok(Trial {
            laps: verdict.lap_times.len(),
            cones_hit: verdict.cones_hit,
            off_course: verdict.off_course,
            metres: driven.clean,
        })
    })?;
    let is_clean =
        |trial: &&Trial| trial.laps >= usize::from(args.laps) && trial.cones_hit + trial.off_course == 0;
    let clean = trials.iter().filter(is_clean).count();
    let sum = |of: fn(&Trial) -> usize| trials.iter().map(of).sum::<usize>();
    let metres: f64 = trials.iter().map(|trial| trial.metres).sum();
    let share = |sum: f64| rounded(sum / f64::from(tracks));
    Ok(Report::new(Outcome::verdict("raced"))
        .field("tracks", tracks)
        .field("clean", clean)
        .field("clean_share", share(clean as f64))
        .field("laps", sum(|trial| trial.laps))
        .field("cones_hit", sum(|trial| trial.cones_hit))
        .field("off_course", sum(|trial| trial.off_course))
        .field("distance_clean_m", share(metres)))
}

fn picture(course: &Course, driven: &Driven) -> Picture {
    let mut picture = Picture::new(&course.frame(&driven.trail));
    picture.title("Cone drive, as printed").caption(drawing::caption(&driven.verdict));
    drawing::cones(&mut picture, course, |_| true);
    drawing::car(&mut picture, &driven.trail);
    picture
}
