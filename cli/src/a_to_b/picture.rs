use roverlab::drive::AToBOutcome;
use roverlab::geometry::{Point, Pose, direction, units};
use roverlab::picture::{Mark, Picture, Style};
use roverlab::world::Colour;

use super::Args;
use super::drive::Arrival;
use super::job::ellipse;
use crate::common::Trip;
use crate::driving::{Conditions, Run, pale};

/// Picture of a run: plan, true and estimated path, and the uncertainty of odometry.
pub(crate) fn of(
    args: &Args,
    trip: &Trip,
    run: &Run<Arrival>,
    conditions: &Conditions,
    heading: Option<f64>,
) -> Picture {
    let start = trip.start();
    let mut picture = Picture::new(&trip.scene.world);
    picture.title(title(args, run)).caption(caption(trip, run, conditions, heading));
    if let Ok(arrival) = &run.ending {
        if let Some(plan) = &arrival.plan {
            let points = plan.points().iter().map(|point| start.to_world(point.pose.position()));
            picture.line(points, Style::plan());
        }
        let style =
            Style::new(Colour::from_hex(0xb0_60_20)).filled(0.15).labelled("95 % ellipse of odometry");
        picture.polygon(outline(start, arrival), style);
    }
    picture.robot_with(start, &trip.spec().footprint, pale());
    if let Some(heading) = heading {
        picture.robot_with(Pose::new(trip.goal.x, trip.goal.y, heading), &trip.spec().footprint, pale());
    }
    run.draw(&mut picture, trip.spec());
    for &waypoint in &args.via {
        picture.mark(Mark::Waypoint, waypoint);
    }
    picture.mark(Mark::Goal, trip.goal);
    picture
}

/// The 95 % ellipse in the world.
fn outline(start: Pose, arrival: &Arrival) -> Vec<Point> {
    let ([long, short], along) = ellipse(arrival);
    let middle = arrival.odometry.pose();
    let frame = Pose::new(middle.x, middle.y, along);
    let corner = |i: i32| {
        let on_circle = direction(f64::from(i) * std::f64::consts::TAU / 48.0);
        start.to_world(frame.to_world(Point::new(long * on_circle.x, short * on_circle.y)))
    };
    (0..48).map(corner).collect()
}

fn title(args: &Args, run: &Run<Arrival>) -> String {
    let ending = match &run.ending {
        Ok(arrival) if arrival.outcome == AToBOutcome::Reached => "goal reached",
        Ok(_) => "goal missed",
        Err(_) => "the robot failed",
    };
    let contact = if run.truth.contacts > 0 { ", with contact" } else { "" };
    format!("From A to B by {}: {ending}{contact}", args.method.name())
}

fn caption(trip: &Trip, run: &Run<Arrival>, conditions: &Conditions, heading: Option<f64>) -> String {
    let off = units::to_mm(run.truth.pose.distance_to(trip.goal));
    let turned = heading.map_or(String::new(), |heading| {
        format!(" and {:.1} deg", units::to_deg(super::job::heading_error(run, heading)))
    });
    let (seconds, noise, seed) = (run.sim_time, conditions.noise, conditions.seed);
    format!("{off:.1} mm{turned} off after {seconds:.0} s, noise {noise}, seed {seed}")
}
