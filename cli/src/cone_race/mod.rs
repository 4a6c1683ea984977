//! The command `cone-race`.

mod campaign;
mod drawing;
mod event;
mod log;
mod race;
mod rival;

use std::path::{Path, PathBuf};

use roverlab::geometry::{Point, Segment};
use roverlab::race::{ClosedSpline, Event, EventCourse, TrackFile, parse_track};

use crate::common::{CommonArgs, Failure, OF_PARTS, Outcome, PartArgs, Report, rounded};
use crate::cones::{Course, Spoils, check_race, refuse};
use race::{Ending, Settings};
use rival::{Contest, Rival};

/// Command line of `cone-race`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Races on an unknown track of cones: mapping in the first lap, then the racing line",
    after_help = "\
In the first lap the car drives between the visible cones and makes the map; in all others it follows the racing line
within the grip limits of both axles. The referee adds 2 s for a cone and 10 s for leaving the course with all wheels.
Tracks: FSSIM yaml, EUFS csv, TUM csv (lined with cones), or a generated one by the seed. Circuits of TUM are several
times as wide as Formula Student tracks: for them, the racer uses other widths of the lane, speeds and map ranges, and a
finer camera, but no other knowledge. Drive them by lidar: the camera alone rarely shows enough of such distant cones to
find the start of a lap again.

An acceleration strip or a skidpad, represented by the cones of the file, is driven as that event: one run, independent
of --laps. The car knows the event and the layout by the rules, and fits it to the visible cones. An acceleration has
one time, from line to line; it ends at rest in the lane behind the finish. A skidpad has two, those of the second lap
to the right and the second one to the left. The car's nose starts and stops the clock.

A log of a drive (JSON, as in ft-fsd-path-planning) contains a car's own map over time. There is no race: in each frame
the lane is computed and compared with the car's later path. With --sensors lidar, colours are ignored.

With --rival, two racers of different kinds race for places: this one, and the book's program or a racer that knows the
track from a recording. The slower one starts ahead. The faster one passes where the track is wide enough for two cars;
generated tracks are. One referee watches both, and ends the race when the first car has driven its laps.

JSON fields:
  event                                                laps, acceleration, skidpad, or log
  laps, cones_hit, off_course, lap_times_s, total_s    of the race; the total includes penalties, and the laps of an event
                                                       are its complete runs
  track_length_m, cones                                of the track
  racing_line_rms_m                                    distance of the racing line from that of --line, for at least two laps
  lap_over_optimum                                     of each flying lap: ratio of its time to the quasi-steady optimum for
                                                       the same car on the same line; of an event: ratio to the optimum from
                                                       standstill with a stop in the lane behind the finish, or around the
                                                       inner cones as closely as the car's width permits
  mapped                                               whether the whole track was planned after the first lap, or the
                                                       event's layout was found
  other_cones_hit, touched                             with a second car
  place, lead_m, passed, overtaken,                    with a rival: place of this car; its distance ahead at the end; whether
  overtakings, rival_off_course                        it, or the rival, has overtaken and is ahead at the end; times, and who
                                                       overtook; how often the rival left the course. The laps are those that
                                                       this car has completed when the first car has driven all of its own
  tracks, clean, clean_share, finished                 of a campaign: finished are all races with complete laps, clean are
                                                       those without hit cones, leaving the course or contacts
  laps, cones_hit, off_course                          of a campaign: of all tracks, by the referee
  mean_racing_speed_m_s                                of a campaign: over all laps except the first ones
  mean_lap_over_optimum, worst_lap_over_optimum        of a campaign: over all flying laps; null without any
  races, passed, passed_share, contacts, won           of a campaign with a rival: races in which the faster car passed, in
                                                       which the cars touched, and which this car won
  frames, planned, wrong_side                          of a log: frames; with a lane; with a lane that has a coloured cone on
                                                       the wrong side
  from_driven_rms_m, from_driven_most_m                of a log: distance of the lane from the next 8 m of the path
  picture, animation
Outcomes: finished, collided (a cone or the second car was touched, with any other result), penalised (all laps or the event, but
the course was left with all wheels), timed_out, failed (the car's program), impassable (the car does not fit between the
cones, which is detected before the race), lost (no lane, or cones that contradict the map or the event: the car stops),
missed (the car stops outside the lane behind its event's finish, or its laps differ from the referee's count),
won, beaten (a race for places), raced (a campaign), passed, wrong (a campaign with a rival: 9 in 10 passes without a contact, or not), planned (a log)."
)]
pub(crate) struct Args {
    /// Track to race on [default: a generated one].
    #[arg(long, value_name = "FILE")]
    pub(crate) track: Option<PathBuf>,

    /// Number of laps, the first one for the map. Acceleration and skidpad have a single run.
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u16).range(1..=100))]
    pub(crate) laps: u16,

    /// Sensors that detect the cones.
    #[arg(long, value_enum, default_value = "lidar")]
    pub(crate) sensors: Sensors,

    /// Line to compare the racing line with, as a TUM race line.
    #[arg(long, value_name = "FILE")]
    pub(crate) line: Option<PathBuf>,

    /// Fraction of additional cones beside the track that belong to neither edge.
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, value_parser = share)]
    pub(crate) false_cones: f64,

    /// Fraction of missing cones.
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, value_parser = share)]
    pub(crate) missing: f64,

    /// Length over which one side of the track has no cones, in metres.
    #[arg(long, value_name = "M", default_value_t = 0.0, value_parser = metres)]
    pub(crate) gap: f64,

    /// A slow second car drives ahead, in the middle of the lane that it sees. Only a lidar detects it.
    #[arg(long)]
    pub(crate) other: bool,

    /// Race for places with another car, by lidar.
    #[arg(long, value_enum, value_name = "PROGRAM", conflicts_with = "other")]
    pub(crate) rival: Option<Rival>,

    /// Race on this many generated tracks, starting with --seed, and print a table.
    #[arg(long, value_name = "TRACKS", conflicts_with = "track", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) campaign: Option<u32>,

    /// The part to do.
    #[command(flatten)]
    pub(crate) parts: PartArgs,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

impl Args {
    /// Settings of a race apart from its course.
    fn settings(&self, seed: u64) -> Settings {
        let (noise, limit) = (self.common.noise, self.common.time_limit);
        Settings {
            laps: usize::from(self.laps),
            sensors: self.sensors,
            seed,
            noise,
            limit,
            other: self.other,
        }
    }
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [("!campaign", OF_PARTS)]);

/// Sensors that detect the cones.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Sensors {
    /// The low lidar: positions without colours.
    Lidar,
    /// The camera above the driver: colours, and positions whose uncertainty grows with distance.
    Camera,
    /// Positions by lidar, colours by camera; things without a cone's colour are discarded.
    Both,
}

fn share(text: &str) -> Result<f64, String> {
    let value = text.parse::<f64>().ok().filter(|value| (0.0..=0.9).contains(value));
    value.ok_or_else(|| "expected a share of 0 to 0.9".into())
}

fn metres(text: &str) -> Result<f64, String> {
    let value = text.parse::<f64>().ok().filter(|value| (0.0..=200.0).contains(value));
    value.ok_or_else(|| "expected 0 to 200 m".into())
}

/// The command's work.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    let common = &args.common;
    check_race(common)?;
    if args.other && args.sensors == Sensors::Camera {
        return Err(Failure::input(
            "--other: cars that drive by the camera alone do not see another one; expected lidar or both for --sensors",
        ));
    }
    if args.rival.is_some() {
        check_rival(args)?;
    }
    let spoils = Spoils { false_cones: args.false_cones, missing: args.missing, gap: args.gap };
    if let Some(tracks) = args.campaign {
        return campaign::run(args, tracks, spoils);
    }
    common.check_picture()?;
    let published = args.line.as_ref().map(|file| published(common, file)).transpose()?;
    let mut course = match &args.track {
        Some(path) => match Course::read(common, path)? {
            TrackFile::Log(frames) => return log::follow(args, &frames),
            file => Course::for_its_event(file, path)?,
        },
        None if args.rival.is_some() => Course::for_two(common.seed)?,
        None => Course::generated(common.seed)?,
    };
    if course.event.is_some() {
        check_event(args)?;
    }
    if let Some(line) = &published {
        check_line(&course, line)?;
    }
    if let Some(reason) = course.impassable() {
        return Ok(impassable(&course, reason));
    }
    course.spoil(spoils, common.seed);
    let settings = args.settings(common.seed);
    if let Some(rival) = args.rival {
        return for_places(common, &course.shared(), &settings, rival);
    }
    let stage = common.stage(&settings.scene(&course), settings.options())?;
    let outcome = race::race(&course, &settings, &stage)?;
    let rms = published.and_then(|other| distance(&other, &outcome.line));
    let report = report(&course, &outcome).field("racing_line_rms_m", rms.map(rounded));
    Ok(common.draw(report, "cone_race.svg", || drawing::picture(&course, &outcome)))
}

/// A race for places.
fn for_places(
    common: &CommonArgs,
    course: &Course,
    settings: &Settings,
    rival: Rival,
) -> Result<Report, Failure> {
    let mut fleet = common.fleet(&rival.scene(course), settings.options())?;
    let contest = rival::race(course, settings, rival, &mut *fleet)?;
    drop(fleet);
    let report = places(report(course, &contest.outcome), &contest);
    Ok(common.draw(report, "cone_race.svg", || drawing::picture(course, &contest.outcome)))
}

/// Adds places and overtakings to a report.
fn places(report: Report, contest: &Contest) -> Report {
    let won = contest.places[0] == 1;
    let outcome = match &contest.outcome.ending {
        Ok(Ending::Finished) => Outcome::verdict(if won { "won" } else { "beaten" }),
        _ => report.outcome,
    };
    let by = |by: bool| if by { "rival" } else { "racer" };
    let overtakings: Vec<_> = contest
        .overtakings
        .iter()
        .map(|(time, rival)| serde_json::json!({ "time_s": rounded(*time), "by": by(*rival) }))
        .collect();
    Report { outcome, ..report }
        .field("place", contest.places[0])
        .field("lead_m", rounded(contest.lead))
        .field("passed", contest.has_passed(false))
        .field("overtaken", contest.has_passed(true))
        .field("overtakings", overtakings)
        .field("rival_off_course", contest.rival_off_course)
}

/// Report on a track on which no race can start.
fn impassable(course: &Course, reason: String) -> Report {
    let report = Report::new(Outcome::failure("impassable"))
        .field("event", event_name(course))
        .field("laps", 0)
        .field("cones_hit", 0)
        .field("off_course", 0)
        .field("lap_times_s", [0.0; 0])
        .field("track_length_m", rounded(course.corridor.length()))
        .field("cones", course.cones.len());
    Report { error: Some(reason), ..report }
}

/// Name of a course's event.
fn event_name(course: &Course) -> &'static str {
    match course.event.as_ref().map(EventCourse::event) {
        None | Some(Event::Laps) => "laps",
        Some(Event::Acceleration) => "acceleration",
        Some(Event::Skidpad) => "skidpad",
    }
}

/// Where and why a car was lost.
fn lost(course: &Course, outcome: &race::Outcome) -> String {
    let (found, expected) = if course.event.is_some() {
        ("found no cones that fit its event", format!("those of the {}", event_name(course)))
    } else if outcome.line.is_empty() {
        ("found no lane", "cones to both sides of one".into())
    } else {
        ("found no cones that fit its map", "those of the first lap".into())
    };
    let place = outcome.truth.pose;
    format!("at ({:.1}, {:.1}) m the car {found}, and stopped; expected {expected}", place.x, place.y)
}

/// Report on a race.
fn report(course: &Course, outcome: &race::Outcome) -> Report {
    let verdict = &outcome.verdict;
    let (word, lacking) = match &outcome.ending {
        Err(error) => (Outcome::failure("failed"), Some(error.clone())),
        Ok(Ending::Finished) if outcome.is_clean() => (Outcome::verdict("finished"), None),
        Ok(Ending::Finished) => (Outcome::failure("penalised"), None),
        Ok(Ending::TimedOut) => (Outcome::failure("timed_out"), None),
        Ok(Ending::Lost) => (Outcome::failure("lost"), Some(lost(course, outcome))),
        Ok(Ending::Missed) => (Outcome::failure("missed"), None),
    };
    let times: Vec<f64> = verdict.lap_times.iter().map(|time| rounded(*time)).collect();
    let laps = if course.event.is_some() {
        usize::from(matches!(outcome.ending, Ok(Ending::Finished)))
    } else {
        times.len()
    };
    let report = Report::new(word)
        .field("event", event_name(course))
        .field("laps", laps)
        .field("cones_hit", verdict.cones_hit)
        .field("off_course", verdict.off_course)
        .field("lap_times_s", times)
        .field("total_s", rounded(verdict.total()))
        .field(
            "lap_over_optimum",
            outcome.over_optimum.iter().map(|ratio| rounded(*ratio)).collect::<Vec<_>>(),
        )
        .field("track_length_m", rounded(course.corridor.length()))
        .field("cones", course.cones.len())
        .field("mapped", !outcome.line.is_empty())
        .field("other_cones_hit", outcome.other.as_ref().map(|other| other.cones_hit))
        .field("touched", outcome.other.as_ref().map(|_| outcome.touched));
    Report {
        sim_time: Some(outcome.time),
        collisions: Some(outcome.truth.contacts.into()),
        path_length: Some(outcome.truth.path_length),
        pose: Some(outcome.truth.pose),
        odometry: Some(course.start.compose(&outcome.truth.odometry)),
        error: lacking,
        ..report
    }
}

/// The racing line in a file.
fn published(common: &CommonArgs, file: &Path) -> Result<Vec<Point>, Failure> {
    let bytes = common.read("line", file).map_err(Failure::input)?;
    let name = file.display().to_string();
    let text = String::from_utf8_lossy(&bytes);
    match parse_track(&text, &name).map_err(Failure::input)? {
        TrackFile::Line(line) => Ok(line),
        _ => Err(Failure::input(format!("--line {name}: found a track; expected a line without widths"))),
    }
}

/// Maximum distance of a line from the middle of its track, beyond half the width (m).
const OFF_TRACK: f64 = 10.0;

/// Fails if a line does not belong to a course.
fn check_line(course: &Course, line: &[Point]) -> Result<(), Failure> {
    let stations = course.corridor.stations();
    let half_width = stations.iter().map(|station| station.left.max(station.right)).fold(0.0, f64::max);
    let away = |place: &Point| {
        stations.iter().map(|station| (station.position - place).norm()).fold(f64::INFINITY, f64::min)
    };
    let farthest = line.iter().map(away).fold(0.0, f64::max);
    if farthest <= half_width + OFF_TRACK {
        return Ok(());
    }
    Err(Failure::input(format!(
        "--line: found a point {farthest:.0} m from the middle of the track; expected a line on it"
    )))
}

/// Root mean square distance of a racing line from another one. `None` without one.
fn distance(other: &[Point], line: &[Point]) -> Option<f64> {
    let spline = ClosedSpline::through(line).ok()?;
    let n = other.len();
    let squared = |p: Point| {
        let away = (0..n).map(|i| Segment::new(other[i], other[(i + 1) % n]).distance_to(p));
        let least = away.fold(f64::INFINITY, f64::min);
        least * least
    };
    let places = spline.resample(2.0);
    let sum: f64 = places.iter().map(|place| squared(place.position)).sum();
    Some((sum / places.len() as f64).sqrt())
}

/// Fails for an option without meaning for a race for places.
fn check_rival(args: &Args) -> Result<(), Failure> {
    let common = &args.common;
    let given = [
        ("--sensors", args.sensors != Sensors::Lidar),
        ("--line", args.line.is_some()),
        ("--supervised", common.supervised),
        ("--fault", !common.fault.is_empty()),
    ];
    refuse(&given, "found a race for places, by lidar alone and without faults; expected it with one car")
}

/// Fails for an option without meaning for an acceleration or skidpad.
fn check_event(args: &Args) -> Result<(), Failure> {
    let given = [("--other", args.other), ("--rival", args.rival.is_some()), ("--line", args.line.is_some())];
    refuse(
        &given,
        "found a track of an acceleration or a skidpad; expected one of laps, or a command line without it",
    )
}
