//! The command `omni`.

use roverlab::drive::{OmniDriver, OmniOutcome, OmniParameters, OmniTracker};
use roverlab::geometry::{Point, Pose, Segment, angle_difference, math, units};
use roverlab::io::{self, Clock, Motors, Odometry, control};
use roverlab::kinematics::Omni;
use roverlab::picture::{Mark, Picture, Style};
use roverlab::world::{DriveSpec, RobotSpec, Scene, World};

use crate::common::{CommonArgs, Failure, Outcome, Report, StandIn, Trip, millimetres, point_in_mm, rounded};
use crate::driving::{Conditions, Run, check_drive, paced, pale};

/// Command line of `omni`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Drives a robot on Mecanum wheels by its four motors: in a square without turning, or straight while it spins",
    after_help = "\
Without --world, the robot drives on an empty floor. The square is ahead and to the left of the start. The line ends at
--goal, or after a side of the square.

JSON fields:
  task                        square or spin
  goal                        [x, y] mm: end of the path
  position_error_mm           final true distance to it
  max_deviation_mm            largest true distance to the path
  max_heading_error_deg       square: largest true change of the heading
  turned_deg                  spin: total true rotation of the robot
  time_limit_s, picture
Outcomes: reached, missed (both by its own odometry; the error is the truth), timed_out, collided, failed."
)]
pub(crate) struct Args {
    /// Task to drive.
    #[arg(long, value_enum, default_value = "square")]
    pub(crate) task: Task,

    /// Length of the square's sides, or of the line, in millimetres.
    #[arg(long, value_name = "MM", default_value_t = 1000.0, value_parser = parse_side, allow_hyphen_values = true)]
    pub(crate) side: f64,

    /// Spin rate in degrees per second.
    #[arg(long, value_name = "DEG", default_value_t = 60.0, value_parser = parse_spin, allow_hyphen_values = true)]
    pub(crate) spin: f64,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs, unheeded: [
    ("task=square", &["spin"]),
]);

/// A task of section 7.4.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Task {
    /// A square without turning.
    Square,
    /// A straight line while spinning.
    Spin,
}

fn parse_side(text: &str) -> Result<f64, String> {
    let side = text.parse().ok().filter(|side: &f64| (1.0..=1e6).contains(side));
    side.ok_or_else(|| "expected 1 to 1000000 mm".into())
}

fn parse_spin(text: &str) -> Result<f64, String> {
    let spin = text.parse().ok().filter(|spin: &f64| spin.abs() <= 180.0);
    spin.ok_or_else(|| "expected -180 to 180 degrees per second".into())
}

/// Route and options, in the odometry frame.
#[derive(Debug, Clone)]
pub(crate) struct Options {
    pub(crate) route: Vec<Point>,
    pub(crate) parameters: OmniParameters,
    pub(crate) driver: OmniDriver,
    /// Time limit (s).
    pub(crate) time_limit: f64,
}

/// Drives a robot along a route. `watch` is called after each step.
pub(crate) fn drive<R: Clock + Odometry + Motors + ?Sized>(
    robot: &mut R,
    options: &Options,
    mut watch: impl FnMut(),
) -> io::Result<OmniOutcome> {
    let tracker = OmniTracker::new(robot.pose()?, &options.route, options.parameters)?;
    control::run(robot, &mut tracker.by(options.driver), options.time_limit, |_, _, _| watch())
}

/// The command's work.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    let common = &args.common;
    common.check_picture()?;
    let trip = trip(args)?;
    let driver = driver(common, trip.spec())?;
    let start = trip.start();
    let route = route(args, start.to_local(trip.goal));
    let spin = if args.task == Task::Spin { units::from_deg(args.spin) } else { 0.0 };
    let parameters = OmniParameters { spin, ..OmniParameters::default() };
    let tracker = OmniTracker::new(Pose::default(), &route, parameters).map_err(Failure::input)?;
    let conditions = Conditions::new(common, 10.0 + 1.5 * tracker.duration())?;
    let options = Options { parameters, driver, route, time_limit: conditions.time_limit };
    let run = conditions.run(&trip.scene, paced(common), |robot, step| drive(robot, &options, step))?;
    let way: Vec<Point> = std::iter::once(start.position())
        .chain(options.route.iter().map(|&point| start.to_world(point)))
        .collect();
    let report = report(args, &run, &way).field("time_limit_s", conditions.time_limit);
    Ok(common.draw(report, "omni.svg", || picture(args, &trip, &run, &way, &conditions)))
}

/// The trip of the options. A robot on other wheels is replaced by an Omni.
fn trip(args: &Args) -> Result<Trip, Failure> {
    let common = &args.common;
    let (side, square) = (units::from_mm(args.side), args.task == Task::Square);
    if square && common.goal.is_some() {
        return Err(Failure::input("--goal: a square ends where it starts; expected --task spin"));
    }
    if common.goal.is_some_and(|goal| goal.heading.is_some()) {
        return Err(Failure::input("--goal: found a heading; expected X,Y: the robot turns as --spin says"));
    }
    let scene =
        common.placed_of(&StandIn { spec: RobotSpec::omni().into(), suits: is_omni }, || scene(side))?;
    let ahead = Point::new(if square { 0.0 } else { side }, 0.0);
    let goal = common.goal.map_or_else(|| scene.robots[0].pose.to_world(ahead), |goal| goal.position);
    Ok(Trip { scene, goal })
}

/// An empty floor with room for the square.
fn scene(side: f64) -> Scene {
    let extent = side + 1.0;
    let start = Pose::new(0.5, 0.5, 0.0);
    Scene::with_robot(World::empty(extent, extent), RobotSpec::omni(), start)
}

/// The route in the robot's frame.
fn route(args: &Args, goal: Point) -> Vec<Point> {
    let side = units::from_mm(args.side);
    match args.task {
        Task::Square => {
            [(side, 0.0), (side, side), (0.0, side), (0.0, 0.0)].map(|(x, y)| Point::new(x, y)).into()
        }
        Task::Spin => vec![goal],
    }
}

fn is_omni(spec: &RobotSpec) -> bool {
    matches!(spec.drive, DriveSpec::Omni { .. })
}

fn driver(common: &CommonArgs, spec: &RobotSpec) -> Result<OmniDriver, Failure> {
    let expected = "one on Mecanum wheels";
    check_drive(common, spec, is_omni(spec), expected)?;
    let DriveSpec::Omni { wheel_diameter, track, wheelbase, max_wheel_speed, .. } = spec.drive else {
        return Err(Failure::input(format!("found another robot; expected {expected}")));
    };
    let kinematics = Omni::mecanum(track, wheelbase).map_err(Failure::input)?;
    OmniDriver::new(kinematics, 0.5 * wheel_diameter * max_wheel_speed).map_err(Failure::input)
}

fn report(args: &Args, run: &Run<OmniOutcome>, way: &[Point]) -> Report {
    let report = run.report(|outcome| match outcome {
        OmniOutcome::Reached => Outcome::verdict("reached"),
        OmniOutcome::Missed => Outcome::failure("missed"),
        _ => Outcome::failure("timed_out"),
    });
    let goal = way[way.len() - 1];
    let deviation = run.positions().map(|place| distance_to_way(place, way)).fold(0.0, f64::max);
    let report = report
        .field("task", if args.task == Task::Square { "square" } else { "spin" })
        .field("goal", point_in_mm(goal))
        .field("position_error_mm", millimetres(run.truth.pose.distance_to(goal)))
        .field("max_deviation_mm", millimetres(deviation));
    match args.task {
        Task::Square => {
            let first = run.trail[0].1.heading;
            let errors = run.trail.iter().map(|(_, pose)| angle_difference(pose.heading, first).abs());
            report.field("max_heading_error_deg", rounded(units::to_deg(errors.fold(0.0, f64::max))))
        }
        Task::Spin => {
            let turns =
                run.trail.windows(2).map(|pair| angle_difference(pair[1].1.heading, pair[0].1.heading));
            report.field("turned_deg", rounded(units::to_deg(turns.sum())))
        }
    }
}

/// Distance of a place from the nearest leg of a path (m).
fn distance_to_way(place: Point, way: &[Point]) -> f64 {
    let legs = way.windows(2).map(|ends| Segment::new(ends[0], ends[1]).distance_to(place));
    legs.fold(f64::INFINITY, f64::min)
}

/// The route, and the robot's path and headings.
fn picture(
    args: &Args,
    trip: &Trip,
    run: &Run<OmniOutcome>,
    way: &[Point],
    conditions: &Conditions,
) -> Picture {
    let outline = trip.spec().footprint;
    let mut picture = Picture::new(&trip.scene.world);
    picture.title(match args.task {
        Task::Square => "Omni: a square without turning",
        Task::Spin => "Omni: straight on while it spins",
    });
    let off = units::to_mm(run.truth.pose.distance_to(way[way.len() - 1]));
    let (seconds, noise, seed) = (run.sim_time, conditions.noise, conditions.seed);
    picture.caption(format!("{off:.1} mm off after {seconds:.0} s, noise {noise}, seed {seed}"));
    picture.line(way.iter().copied(), Style::plan());
    for pose in stations(run) {
        picture.robot_with(pose, &outline, pale());
    }
    run.draw(&mut picture, trip.spec());
    picture.mark(Mark::Goal, way[way.len() - 1]);
    picture
}

/// Poses of the run at a distance from each other.
fn stations(run: &Run<OmniOutcome>) -> Vec<Pose> {
    const APART: f64 = 0.33;
    let mut stations = vec![run.trail[0].1];
    for &(_, pose) in &run.trail {
        let last = stations[stations.len() - 1];
        if math::hypot(pose.x - last.x, pose.y - last.y) >= APART {
            stations.push(pose);
        }
    }
    stations
}
