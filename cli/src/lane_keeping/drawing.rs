//! Picture of a drive: the road from above, and the path of the car.

use roverlab::geometry::Point;
use roverlab::picture::{Figure, Mark, Picture, Style};
use roverlab::world::road::{Centre, Line, RoadCourse, RoadMarkKind};
use roverlab::world::{Colour, RobotSpec, World};

use super::course::Setting;
use super::drive::Drive;

/// Distance between points of a line (m).
const STEP: f64 = 0.1;

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
}

fn draw(picture: &mut Picture, points: Vec<Point>, dashed: bool) {
    let style = Style::aid().width(1.2);
    picture.line(points, if dashed { style.dashed() } else { style });
}
