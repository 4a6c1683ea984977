//! Pictures of a race.

use roverlab::geometry::Point;
use roverlab::picture::{Figure, Picture, Style};
use roverlab::race::{Event, EventCourse};
use roverlab::world::RobotSpec;

use super::race::Outcome;
use crate::cones::{Course, drawing};

/// Track, cones, racing line, and driven line coloured by speed.
pub(crate) fn picture(course: &Course, outcome: &Outcome) -> Picture {
    let mut picture = Picture::new(&course.frame(&outcome.trail));
    picture.title(match course.event.as_ref().map(EventCourse::event) {
        Some(Event::Acceleration) => "Acceleration",
        Some(Event::Skidpad) => "Skidpad",
        _ => "Cone race",
    });
    for left in [true, false] {
        let mut edge = course.corridor.edge(left);
        close(&mut edge, course);
        picture.line(edge, Style::aid().width(1.0).opacity(0.4));
    }
    drawing::cones(&mut picture, course, |index| outcome.standing.get(index).copied().unwrap_or(true));
    let mut line = outcome.line.clone();
    close(&mut line, course);
    picture.line(line, Style::plan().width(1.0).labelled("racing line"));
    if let Some(other) = &outcome.other {
        let trail = other.trail.iter().map(|passed| (passed.time, passed.pose.position()));
        picture.trace(trail, Style::aid().labelled("second car"));
        let poses = other.trail.iter().map(|passed| (passed.time, passed.pose)).collect();
        picture.add(Figure::Robot { poses, footprint: RobotSpec::race_car().footprint }, Style::aid());
    }
    drawing::car(&mut picture, &outcome.trail);
    picture.caption(drawing::caption(&outcome.verdict));
    picture
}

/// Closes a line if the course is a loop.
fn close(line: &mut Vec<Point>, course: &Course) {
    if course.corridor.is_closed() {
        line.extend(line.first().copied());
    }
}
