//! Picture of a drive: the road from above, and the path of the car.

use roverlab::geometry::Point;
use roverlab::picture::{Figure, Mark, Picture, Style};
use roverlab::world::road::{Centre, Line, RightOfWay, RoadCourse, RoadMarkKind, RoadSide};
use roverlab::world::{Colour, RobotSpec, World};

use super::course::Setting;
use super::drive::Drive;

/// Distance between points of a line (m).
const STEP: f64 = 0.1;
/// Length of a crosswalk along the road, and depth of parking areas on the right and on the left, by the
/// rules (m).
const CROSSWALK: f64 = 0.4;
const PARKING: [f64; 2] = [0.3, 0.5];

/// The road's lines, the lane's centre line, and the path of the car, coloured by speed.
pub(super) fn picture(setting: &Setting, drive: &Drive) -> Picture {
    let course = &setting.course;
    let mut picture = Picture::new(&World { floor: course.floor(), ..World::empty(1.0, 1.0) });
    let score = &drive.score;
    picture.title(format!("Lane keeping on course {}", setting.name));
    picture.caption(format!(
        "{:.1} m, {} departures, {} interventions, {:.1} mm off the lane's middle",
        score.distance,
        score.departures,
        score.interventions,
        1000.0 * score.offset_rms()
    ));
    road(&mut picture, course);
    picture.speed_trace(drive.trail.iter().map(|(time, pose, speed)| (*time, pose.position(), *speed)));
    let poses = drive.trail.iter().map(|(time, pose, _)| (*time, *pose)).collect();
    let style = Style::new(Colour::from_hex(0x26_2d_3a)).labelled("car");
    picture.add(Figure::Robot { poses, footprint: RobotSpec::road_car().footprint }, style);
    picture.mark(Mark::Start, course.start().position());
    picture
}

/// Draws the lines of a road, and the centre line of its own lane.
pub(crate) fn road(picture: &mut Picture, course: &RoadCourse) {
    let count = (course.line.length() / STEP).ceil() as usize;
    let along = |i: usize| course.line.length() * i as f64 / count as f64;
    let edge = course.edge();
    for (line, left) in [(Line::Left, edge), (Line::Centre, 0.0), (Line::Right, -edge)] {
        let is_missing = |at: f64| {
            course.marks.iter().any(|mark| match mark.kind {
                RoadMarkKind::Gap(of, long) => of == line && (mark.at..mark.at + long).contains(&at),
                _ => false,
            })
        };
        let mut points: Vec<Point> = Vec::new();
        for i in 0..=count {
            if is_missing(along(i)) {
                draw(picture, std::mem::take(&mut points), line == Line::Centre);
            } else {
                points.push(course.line.beside(along(i), left));
            }
        }
        draw(picture, points, line == Line::Centre && course.centre_at(0.0) == Centre::Dashed);
    }
    let middle = (0..=count).map(|i| course.pose(along(i), 0.0).position());
    picture.line(middle, Style::plan().width(0.8).opacity(0.5).labelled("middle of the lane"));
    markings(picture, course);
}

/// Draws what markings ask of drivers.
fn markings(picture: &mut Picture, course: &RoadCourse) {
    let edge = course.edge();
    for mark in &course.marks {
        let at = mark.at;
        match mark.kind {
            RoadMarkKind::StopLine => across(picture, course, at, false),
            RoadMarkKind::GiveWayLine => across(picture, course, at, true),
            RoadMarkKind::Crossing(crossing) if crossing.right_of_way != RightOfWay::Priority => {
                let gives_way = crossing.right_of_way != RightOfWay::Stop;
                across(picture, course, at - course.crossing_reach(&crossing), gives_way);
            }
            RoadMarkKind::Zebra => {
                let to = at + CROSSWALK * course.size;
                area(picture, course, (at, to), (-edge, edge), "crosswalk");
            }
            RoadMarkKind::Parking(side, long) => {
                area(picture, course, (at, at + long), parking_sides(course, side), "parking area");
            }
            RoadMarkKind::Barred(side, long, wide) => {
                let sign = if side == RoadSide::Left { 1.0 } else { -1.0 };
                area(picture, course, (at, at + long), (sign * edge, sign * (edge - wide)), "barred area");
            }
            RoadMarkKind::Speed(number, is_end) => {
                let words = if is_end { format!("end of {number}") } else { number.to_string() };
                picture.text(course.pose(at, 0.0).position(), words);
            }
            _ => {}
        }
    }
}

/// Where a parking area lies, to the left of the road's centre line (m).
pub(crate) fn parking_sides(course: &RoadCourse, side: RoadSide) -> (f64, f64) {
    let (sign, depth) = if side == RoadSide::Left { (1.0, PARKING[1]) } else { (-1.0, PARKING[0]) };
    (sign * course.edge(), sign * (course.edge() + depth * course.size))
}

/// A line across the own lane at which cars stop or give way.
fn across(picture: &mut Picture, course: &RoadCourse, at: f64, gives_way: bool) {
    let ends = [0.0, course.lane_middle().signum() * course.edge()];
    let style = Style::aid().width(2.4);
    let style =
        if gives_way { style.dashed().labelled("give-way line") } else { style.labelled("stop line") };
    picture.line(ends.map(|left| course.line.beside(at, left)), style);
}

/// An area along the road, between two distances to the left of its centre line (m).
pub(crate) fn area(
    picture: &mut Picture,
    course: &RoadCourse,
    (from, to): (f64, f64),
    (one, other): (f64, f64),
    label: &str,
) {
    let count = ((to - from) / STEP).ceil() as usize;
    let along = |i: usize| from + (to - from) * i as f64 / count as f64;
    let there = (0..=count).map(|i| course.line.beside(along(i), one));
    let back = (0..=count).rev().map(|i| course.line.beside(along(i), other));
    picture.polygon(there.chain(back), Style::aid().width(0.8).filled(0.15).labelled(label));
}

fn draw(picture: &mut Picture, points: Vec<Point>, dashed: bool) {
    let style = Style::aid().width(1.2);
    picture.line(points, if dashed { style.dashed() } else { style });
}
