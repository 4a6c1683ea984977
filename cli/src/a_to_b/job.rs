use nalgebra::Matrix2;
use roverlab::drive::{AToBOutcome, AToBParameters, Goal, PathFollowerParameters};
use roverlab::geometry::{Point, Pose, angle_difference, normalize_angle, units};
use roverlab::io::sim::NoiseModel;
use roverlab::kinematics::Differential;
use roverlab::world::{DriveSpec, RobotSpec};

use super::drive::{Arrival, Options, drive};
use super::{Args, campaign, chase, picture, scene};
use crate::common::{Failure, Outcome, Report, StandIn, Trip, millimetres, point_in_mm, rounded};
use crate::driving::{self, Conditions, Run, check_drive, paced};

/// 95 % quantile of the squared Mahalanobis distance in the plane.
pub(crate) const NINETY_FIVE: f64 = 5.991;

/// The command's work.
pub(crate) fn work(args: &Args) -> Result<Report, Failure> {
    if args.campaign {
        return campaign(args);
    }
    let common = &args.common;
    common.check_picture()?;
    let turns = |spec: &RobotSpec| !matches!(spec.drive, DriveSpec::Ackermann { .. } | DriveSpec::Craft(_));
    let stand_in = StandIn { suits: turns, ..StandIn::default() };
    let mut trip = common.trip_to_pose_of(&stand_in, || scene::scene(common.goal))?;
    check_drive(
        common,
        trip.spec(),
        turns(trip.spec()),
        "one on wheels that turns on the spot; the command `ackermann` drives cars",
    )?;
    let heading = scene::heading(common.goal, common.world.is_none());
    let limit = 60.0 + 20.0 * way(args, &trip);
    let conditions = Conditions { ideal_encoders: args.ideal_encoders, ..Conditions::new(common, limit)? };
    let mut options = options(args, &trip, heading, &conditions);
    options.behaviour().and_then(|behaviour| behaviour.plan(Pose::default())).map_err(Failure::input)?;
    if let Some(speed) = args.moving {
        if args.landmark || !args.via.is_empty() {
            return Err(Failure::input("--moving: found it with --landmark or --via; expected it alone"));
        }
        return chase::work(args, &trip, speed, &options, &conditions);
    }
    if args.landmark {
        add_landmarks(args, &mut trip, &mut options)?;
    }
    common.tell(format_args!("{} to {} mm by {}", trip.spec().name, in_words(trip.goal), args.method.name()));
    let run = conditions.run(&trip.scene, paced(common), |robot, step| drive(robot, &options, step))?;
    let report = report(args, &trip, &run, heading, conditions.time_limit);
    Ok(common.draw(report, "a_to_b.svg", || picture::of(args, &trip, &run, &conditions, heading)))
}

/// Length of the way to the goal through all waypoints (m).
fn way(args: &Args, trip: &Trip) -> f64 {
    let start = trip.start().position();
    let places: Vec<Point> =
        std::iter::once(start).chain(args.via.iter().copied()).chain([trip.goal]).collect();
    places.windows(2).map(|two| (two[1] - two[0]).norm()).sum()
}

/// Goal and method in the robot's odometry frame.
pub(crate) fn options(args: &Args, trip: &Trip, heading: Option<f64>, conditions: &Conditions) -> Options {
    let start = trip.start();
    let parameters = AToBParameters {
        follower: PathFollowerParameters {
            steering: args.follower.steering(),
            ..PathFollowerParameters::default()
        },
        spline_scale: args.scale,
        ..AToBParameters::default()
    };
    Options {
        method: args.method.method(),
        goal: Goal {
            position: start.to_local(trip.goal),
            heading: heading.map(|heading| normalize_angle(heading - start.heading)),
        },
        via: args.via.iter().map(|&place| start.to_local(place)).collect(),
        parameters,
        time_limit: conditions.time_limit,
        drive: Differential { track: driving::track(trip.spec()) },
        errors: conditions.odometry_errors(),
        landmarks: Vec::new(),
        range_error: NoiseModel::real().scaled(conditions.noise).range,
    }
}

/// Gives the robot the world's poles; on the empty floor it adds one.
pub(crate) fn add_landmarks(args: &Args, trip: &mut Trip, options: &mut Options) -> Result<(), Failure> {
    let start = trip.start();
    if args.common.world.is_none() {
        let plan = options
            .behaviour()
            .and_then(|behaviour| behaviour.plan(Pose::default()))
            .map_err(Failure::input)?;
        let way: Vec<Point> = match plan {
            Some(path) => path.points().iter().map(|point| start.to_world(point.pose.position())).collect(),
            // A dog curve stays near the straight line.
            None => (0..=20)
                .map(|i| start.position() + (trip.goal - start.position()) * (f64::from(i) / 20.0))
                .collect(),
        };
        scene::add_pole(&mut trip.scene, trip.goal, &way);
    }
    options.landmarks = scene::poles(&trip.scene, start);
    if options.landmarks.is_empty() {
        return Err(Failure::input(
            "--landmark: found no pole in the world; expected an upright cylinder such as a can",
        ));
    }
    if trip.spec().lidar.is_none() {
        return Err(Failure::input("--landmark: found a robot without a lidar; expected one with a lidar"));
    }
    Ok(())
}

fn report(args: &Args, trip: &Trip, run: &Run<Arrival>, heading: Option<f64>, limit: f64) -> Report {
    let report = run.report(|arrival| match arrival.outcome {
        AToBOutcome::Reached => Outcome::verdict("reached"),
        AToBOutcome::Missed => Outcome::failure("missed"),
        AToBOutcome::Blocked => Outcome::failure("blocked"),
        _ => Outcome::failure("timed_out"),
    });
    let heading_error = heading.map(|heading| heading_error(run, heading));
    let arrival = run.ending.as_ref().ok();
    let inside = arrival
        .filter(|_| !args.landmark && args.common.noise > 0.0)
        .map(|arrival| inside_ellipse(trip.start(), run, arrival));
    report
        .field("method", args.method.name())
        .field("goal", point_in_mm(trip.goal))
        .field("goal_heading_deg", heading.map(|heading| rounded(units::to_deg(heading))))
        .field("position_error_mm", millimetres(run.truth.pose.distance_to(trip.goal)))
        .field("heading_error_deg", heading_error.map(|error| rounded(units::to_deg(error))))
        .field("ellipse_mm", arrival.map(|arrival| ellipse(arrival).0.map(millimetres)))
        .field("inside_ellipse", inside)
        .field("landmark_scans", arrival.map(|arrival| arrival.sightings))
        .field("time_limit_s", limit)
}

/// Difference between the robot's true heading and the goal's (rad).
pub(crate) fn heading_error(run: &Run<Arrival>, heading: f64) -> f64 {
    angle_difference(run.truth.pose.heading, heading).abs()
}

/// Whether the robot's true position is in odometry's 95 % ellipse.
pub(crate) fn inside_ellipse(start: Pose, run: &Run<Arrival>, arrival: &Arrival) -> bool {
    arrival.odometry.distance_squared(start.to_local(run.truth.pose.position())) <= NINETY_FIVE
}

/// Semi-axes of the 95 % ellipse, the longer one first (m), and the direction of that one in the odometry
/// frame (rad).
pub(crate) fn ellipse(arrival: &Arrival) -> ([f64; 2], f64) {
    let covariance: Matrix2<f64> = arrival.odometry.covariance().fixed_view::<2, 2>(0, 0).into_owned();
    let middle = 0.5 * (covariance[(0, 0)] + covariance[(1, 1)]);
    let difference = 0.5 * (covariance[(0, 0)] - covariance[(1, 1)]);
    let spread = roverlab::geometry::math::hypot(difference, covariance[(0, 1)]);
    let axes = [middle + spread, middle - spread].map(|variance| (NINETY_FIVE * variance.max(0.0)).sqrt());
    (axes, 0.5 * roverlab::geometry::math::atan2(covariance[(0, 1)], difference))
}

fn in_words(point: Point) -> String {
    let [x, y] = [point.x, point.y].map(|metres| units::to_mm(metres).round() + 0.0);
    format!("{x}, {y}")
}
