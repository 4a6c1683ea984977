use roverlab::geometry::units;
use roverlab::picture::{Mark, Picture, Style};
use roverlab::world::Colour;

use super::course::Course;
use super::drive::Arrival;
use super::job::{is_missed, verdict};
use crate::driving::{Conditions, Run, pale};

/// Picture of a run: the first plan, true and estimated path, and seen obstacles missing from the map.
pub(crate) fn of(course: &Course, run: &Run<Arrival>, conditions: &Conditions) -> Picture {
    let trip = &course.trip;
    let spec = trip.spec();
    let mut picture = Picture::new(&trip.scene.world);
    let title = match &run.ending {
        _ if is_missed(course, run) => "goal missed",
        Ok(arrival) => verdict(arrival.outcome),
        Err(_) => "the robot failed",
    };
    let contacts = if run.truth.contacts == 0 { "" } else { ", with contacts" };
    picture.title(format!("Navigation: {title}{contacts}")).caption(caption(course, run, conditions));
    if let Ok(arrival) = &run.ending {
        picture.line(arrival.plan.iter().copied(), Style::plan());
        let style = Style::new(Colour::from_hex(0xc0_40_20)).labelled("detected, not on the map");
        picture.points(arrival.seen.iter().copied(), style);
    }
    for other in &trip.scene.robots[1..] {
        picture.robot_with(other.pose, &other.spec.footprint, pale());
    }
    run.draw(&mut picture, spec);
    picture.mark(Mark::Goal, trip.goal);
    picture
}

fn caption(course: &Course, run: &Run<Arrival>, conditions: &Conditions) -> String {
    let (metres, seconds) = (run.truth.path_length, run.sim_time);
    let off = units::to_mm(run.truth.pose.distance_to(course.trip.goal));
    let (noise, seed, unmapped) = (conditions.noise, conditions.seed, course.unmapped);
    format!(
        "{metres:.1} m in {seconds:.0} s, {off:.0} mm from the goal, {unmapped} obstacles unmapped, noise {noise}, seed {seed}"
    )
}
