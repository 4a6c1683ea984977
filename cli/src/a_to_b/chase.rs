use roverlab::drive::{Chase, ChaseOutcome, ChaseParameters};
use roverlab::geometry::{Pose, Twist, units};
use roverlab::io::{self, Clock, Drive, Odometry, StallDetector, control};
use roverlab::kinematics::{Displacement, advance};
use roverlab::picture::{Mark, Picture, Style};

use super::Args;
use super::drive::Options;
use crate::common::{Failure, Outcome, Report, Trip, millimetres, point_in_mm, rounded};
use crate::driving::{Conditions, Run, paced};

/// A goal that moves from its position along an arc.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Quarry {
    begin: Pose,
    speed: Twist,
}

impl Quarry {
    fn at(&self, time: f64) -> Pose {
        let motion = Displacement { length: self.speed.linear * time, angle: self.speed.angular * time };
        advance(self.begin, motion)
    }
}

/// Outcome of a chase, and its duration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Hunt {
    pub(crate) outcome: ChaseOutcome,
    pub(crate) seconds: f64,
}

/// Parses `MM` or `MM,DEG`, in millimetres and degrees per second.
pub(super) fn parse_moving(text: &str) -> Result<Twist, String> {
    let numbers: Option<Vec<f64>> = text
        .split(',')
        .map(|word| word.trim().parse().ok().filter(|number: &f64| number.is_finite()))
        .collect();
    let (speed, turn) = match numbers.as_deref() {
        Some([speed]) => (*speed, 0.0),
        Some([speed, turn]) => (*speed, *turn),
        _ => return Err("expected MM or MM,DEG: millimetres and degrees per second".into()),
    };
    if speed.abs() <= 1000.0 && turn.abs() <= 360.0 {
        return Ok(Twist::new(units::from_mm(speed), units::from_deg(turn)));
    }
    Err("expected at most 1000 mm and 360 degrees per second".into())
}

/// Drives a robot after a moving goal, whose position is given in the robot's odometry frame.
fn chase<R: Clock + Drive + Odometry + StallDetector + ?Sized>(
    robot: &mut R,
    options: &Options,
    quarry: &Quarry,
    mut watch: impl FnMut(),
) -> io::Result<Hunt> {
    let parameters = ChaseParameters {
        follower: options.parameters.follower,
        spline_scale: options.parameters.spline_scale,
        ..ChaseParameters::default()
    };
    let mut seconds = 0.0;
    let told = |_: &mut R, time| {
        seconds = time;
        Ok(quarry.at(time))
    };
    let mut chase = Chase::new(options.method, parameters)?;
    let outcome = control::run(robot, &mut chase.after(told), options.time_limit, |_, _, _| watch())?;
    Ok(Hunt { outcome, seconds })
}

/// The command's work with a moving goal.
pub(super) fn work(
    args: &Args,
    trip: &Trip,
    speed: Twist,
    options: &Options,
    conditions: &Conditions,
) -> Result<Report, Failure> {
    let common = &args.common;
    let start = trip.start();
    let place = options.goal.position;
    let quarry = Quarry { begin: Pose::new(place.x, place.y, options.goal.heading.unwrap_or(0.0)), speed };
    let run =
        conditions.run(&trip.scene, paced(common), |robot, step| chase(robot, options, &quarry, step))?;
    let seconds = run.ending.as_ref().map_or(run.sim_time, |hunt| hunt.seconds);
    let goal = start.compose(&quarry.at(seconds));
    let report = run.report(|hunt| match hunt.outcome {
        ChaseOutcome::Caught => Outcome::verdict("caught"),
        ChaseOutcome::Blocked => Outcome::failure("blocked"),
        _ => Outcome::failure("timed_out"),
    });
    let report = report
        .field("method", args.method.name())
        .field("goal", point_in_mm(goal.position()))
        .field("goal_heading_deg", rounded(units::to_deg(goal.heading)))
        .field("position_error_mm", millimetres(run.truth.pose.distance_to(goal.position())))
        .field("heading_error_deg", None::<f64>)
        .field("time_limit_s", conditions.time_limit);
    Ok(common.draw(report, "a_to_b.svg", || picture(args, trip, &run, &quarry, seconds)))
}

/// The paths of robot and goal.
fn picture(args: &Args, trip: &Trip, run: &Run<Hunt>, quarry: &Quarry, seconds: f64) -> Picture {
    const STEPS: u32 = 200;
    let start = trip.start();
    let mut picture = Picture::new(&trip.scene.world);
    let ending = match &run.ending {
        Ok(hunt) if hunt.outcome == ChaseOutcome::Caught => "caught",
        Ok(_) => "not caught",
        Err(_) => "the robot failed",
    };
    picture.title(format!("After a moving goal by {}: {ending}", args.method.name()));
    picture.caption(format!("{seconds:.0} s, noise {}, seed {}", args.common.noise, args.common.seed));
    let times = (0..=STEPS).map(|step| seconds * f64::from(step) / f64::from(STEPS));
    let way = times.map(|time| (time, start.to_world(quarry.at(time).position())));
    picture.trace(way, Style::plan().labelled("the goal"));
    run.draw(&mut picture, trip.spec());
    picture.mark(Mark::Goal, start.to_world(quarry.at(seconds).position()));
    picture
}
