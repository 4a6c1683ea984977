//! One run of an acceleration or skidpad event.

use roverlab::geometry::Point;
use roverlab::io::control::SensedBy;
use roverlab::io::{self, Resolution, RobotIo};
use roverlab::race::{EventCourse, EventParameters, EventRacer, EventShape};

use super::race::{Ending, Eyes, Outcome, Settings, limits};
use crate::common::{Failure, Stage};
use crate::cones::{Course, Judge, judged};

/// Default time limit of a run (s).
const LIMIT: f64 = 90.0;

/// Drives the event of a course. The car knows the event, but not the course.
pub(crate) fn race(
    course: &Course,
    event: &EventCourse,
    settings: &Settings,
    stage: &Stage,
) -> Result<Outcome, Failure> {
    let mut judge = Judge::new(course, stage.truth(0)?, 0).map_err(Failure::run)?;
    let mut car = stage.robot(0)?;
    let mut racer = match event.layout().shape {
        EventShape::Strip { .. } => EventRacer::acceleration(EventParameters::default())?,
        EventShape::Eight { .. } => EventRacer::skidpad(EventParameters::default())?,
    };
    let driven = drive(settings, car.as_mut(), &mut judge, &mut racer);
    drop(car);
    let optima = event.optima(&limits()?, &Course::outline());
    let verdict = judge.verdict().clone();
    Ok(Outcome {
        over_optimum: verdict.lap_times.iter().zip(optima).map(|(time, optimum)| time / optimum).collect(),
        verdict,
        ending: driven.map_err(|error| Failure::from(error).to_string()),
        truth: judge.truth().clone(),
        time: judge.time(),
        trail: judge.trail().to_vec(),
        line: line(course, &racer),
        standing: judge.standing(),
        touched: judge.touched(),
        other: None,
    })
}

fn drive<R: RobotIo + ?Sized>(
    settings: &Settings,
    car: &mut R,
    judge: &mut Judge,
    racer: &mut EventRacer,
) -> io::Result<Ending> {
    let mut eyes = Eyes::new(settings.sensors, Resolution::Vga, car)?;
    let mut seeing = SensedBy::new(racer, |car: &mut R, _, seen: &mut _| eyes.look(car, seen));
    let outcome = judged(car, &mut seeing, settings.limit.unwrap_or(LIMIT), judge, |_, _, _| ())?;
    Ok(Ending::of(outcome, judge.is_complete()))
}

/// The followed line from the start on, in the world.
fn line(course: &Course, racer: &EventRacer) -> Vec<Point> {
    let Some((layout, line)) = racer.layout().zip(racer.line()) else { return Vec::new() };
    let place = course.start.compose(&layout.pose);
    let points = line.points().iter().map(|point| place.to_world(*point));
    points.skip_while(|point| course.start.to_local(*point).x < 0.0).collect()
}
