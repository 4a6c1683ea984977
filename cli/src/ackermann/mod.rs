//! The command `ackermann`.

use roverlab::drive::{CarDriver, CarOutcome, CarToB, CarToBParameters, Goal, Method, Path};
use roverlab::geometry::{Pose, angle_difference, normalize_angle, units};
use roverlab::io::control::run;
use roverlab::io::{self, Clock, Motors, Odometry, Servos, StallDetector};
use roverlab::kinematics::Ackermann;
use roverlab::picture::{Mark, Picture, Style};
use roverlab::world::{Colour, DriveSpec, Marker, RobotSpec, Scene, World};

use crate::common::{
    CommonArgs, Failure, GoalOption, Outcome, Report, StandIn, Trip, millimetres, point_in_mm, rounded,
};
use crate::driving::{Conditions, Run, Way, check_drive, paced, pale};

/// Command line of `ackermann`.
#[derive(Debug, Clone, clap::Parser)]
#[command(
    about = "Drives a car by its motor and its steering servo to a goal, within its turning circle",
    after_help = "\
Without --world, the car drives on an empty floor. Where a method would turn too tightly, the car follows its turning
circle. Every method reaches the heading in --goal, because a car cannot turn at the end.

JSON fields:
  method                      turn, arc, dog or spline
  goal, goal_heading_deg      [x, y] mm; the heading or null
  position_error_mm           true distance to the goal at the end
  heading_error_deg           true error of the heading, or null
  turning_radius_mm           radius of the turning circle
  time_limit_s, picture
Outcomes: reached, missed (both by its own odometry; the error is the truth), blocked, timed_out, collided, failed."
)]
pub(crate) struct Args {
    /// Method of driving to the goal.
    #[arg(long, value_enum, default_value = "spline")]
    pub(crate) method: Way,

    #[command(flatten)]
    pub(crate) common: CommonArgs,
}

crate::common::shares_options!(Args, common: CommonArgs);

/// Goal and method, in the odometry frame.
#[derive(Debug, Clone)]
pub(crate) struct Options {
    pub(crate) method: Method,
    pub(crate) goal: Goal,
    pub(crate) driver: CarDriver,
    /// Time limit (s).
    pub(crate) time_limit: f64,
}

/// Outcome of a drive, and the planned path.
#[derive(Debug, Clone)]
pub(crate) struct Arrival {
    pub(crate) outcome: CarOutcome,
    pub(crate) plan: Option<Path>,
}

/// Drives a car to a goal. `watch` is called after each step.
pub(crate) fn drive<R: Clock + Odometry + StallDetector + Motors + Servos + ?Sized>(
    robot: &mut R,
    options: &Options,
    mut watch: impl FnMut(),
) -> io::Result<Arrival> {
    let mut behaviour =
        CarToB::new(options.method, options.goal, options.driver, CarToBParameters::default())?;
    let plan = behaviour.plan(robot.pose()?)?;
    let outcome = run(robot, &mut behaviour, options.time_limit, |_, _, _| watch())?;
    Ok(Arrival { outcome, plan })
}

/// The command's work.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    let common = &args.common;
    common.check_picture()?;
    let trip = trip(common)?;
    check_drive(
        common,
        trip.spec(),
        is_car(trip.spec()),
        "a car; the command `a-to-b` drives robots that turn on the spot",
    )?;
    let driver = driver(trip.spec())?;
    let heading = match common.goal {
        Some(goal) => goal.heading,
        None => common.world.is_none().then_some(HEADING),
    };
    let conditions = Conditions::new(common, 90.0 + 30.0 * trip.distance())?;
    let start = trip.start();
    let options = Options {
        method: args.method.method(),
        goal: Goal {
            position: start.to_local(trip.goal),
            heading: heading.map(|heading| normalize_angle(heading - start.heading)),
        },
        driver,
        time_limit: conditions.time_limit,
    };
    let run = conditions.run(&trip.scene, paced(common), |robot, step| drive(robot, &options, step))?;
    let report = report(args, &trip, &run, heading)
        .field("turning_radius_mm", millimetres(driver.kinematics().turning_radius()))
        .field("time_limit_s", conditions.time_limit);
    Ok(common.draw(report, "ackermann.svg", || picture(args, &trip, &run, &conditions, heading)))
}

/// Heading at the default goal.
const HEADING: f64 = std::f64::consts::FRAC_PI_2;

/// The trip of the options. Another robot is replaced by a car.
fn trip(common: &CommonArgs) -> Result<Trip, Failure> {
    common.trip_to_pose_of(&StandIn { spec: RobotSpec::car().into(), suits: is_car }, || scene(common.goal))
}

fn is_car(spec: &RobotSpec) -> bool {
    matches!(spec.drive, DriveSpec::Ackermann { .. })
}

/// An empty floor of 5 m x 5 m with a marker at the goal, by default ahead to the left.
fn scene(goal: Option<GoalOption>) -> Scene {
    let mut world = World::empty(5.0, 5.0);
    let start = Pose::from_mm_deg(1500.0, 1500.0, 0.0);
    let own = Pose::from_mm_deg(3200.0, 2700.0, 0.0).position();
    let position = goal.map_or(own, |goal| goal.position);
    world.markers.push(Marker { position, colour: Colour::GREEN, alpha: 255 });
    Scene::with_robot(world, RobotSpec::car(), start)
}

fn driver(spec: &RobotSpec) -> Result<CarDriver, Failure> {
    let DriveSpec::Ackermann { wheel_diameter, track, wheelbase, max_steering, max_wheel_speed, .. } =
        spec.drive
    else {
        return Err(Failure::input("found no car; expected one"));
    };
    let kinematics = Ackermann::new(wheelbase, track, max_steering).map_err(Failure::input)?;
    CarDriver::new(kinematics, 0.5 * wheel_diameter * max_wheel_speed).map_err(Failure::input)
}

fn report(args: &Args, trip: &Trip, run: &Run<Arrival>, heading: Option<f64>) -> Report {
    let report = run.report(|arrival| match arrival.outcome {
        CarOutcome::Reached => Outcome::verdict("reached"),
        CarOutcome::Missed => Outcome::failure("missed"),
        CarOutcome::Blocked => Outcome::failure("blocked"),
        _ => Outcome::failure("timed_out"),
    });
    let turned = heading.map(|heading| angle_difference(run.truth.pose.heading, heading).abs());
    report
        .field("method", args.method.name())
        .field("goal", point_in_mm(trip.goal))
        .field("goal_heading_deg", heading.map(|heading| rounded(units::to_deg(heading))))
        .field("position_error_mm", millimetres(run.truth.pose.distance_to(trip.goal)))
        .field("heading_error_deg", turned.map(|error| rounded(units::to_deg(error))))
}

/// Plan, true and estimated path, and goal.
fn picture(
    args: &Args,
    trip: &Trip,
    run: &Run<Arrival>,
    conditions: &Conditions,
    heading: Option<f64>,
) -> Picture {
    let (start, outline) = (trip.start(), trip.spec().footprint);
    let mut picture = Picture::new(&trip.scene.world);
    let ending = match &run.ending {
        Ok(arrival) if arrival.outcome == CarOutcome::Reached => "goal reached",
        Ok(_) => "goal missed",
        Err(_) => "the robot failed",
    };
    picture.title(format!("A car by {}: {ending}", args.method.name()));
    let off = units::to_mm(run.truth.pose.distance_to(trip.goal));
    let (seconds, noise, seed) = (run.sim_time, conditions.noise, conditions.seed);
    picture.caption(format!("{off:.0} mm off after {seconds:.0} s, noise {noise}, seed {seed}"));
    if let Ok(Arrival { plan: Some(plan), .. }) = &run.ending {
        let points = plan.points().iter().map(|point| start.to_world(point.pose.position()));
        picture.line(points, Style::plan());
    }
    picture.robot_with(start, &outline, pale());
    if let Some(heading) = heading {
        picture.robot_with(Pose::new(trip.goal.x, trip.goal.y, heading), &outline, pale());
    }
    run.draw(&mut picture, trip.spec());
    picture.mark(Mark::Goal, trip.goal);
    picture
}
