//! Picture of a drive: the road from above, the boxes, and the path of the car.

use roverlab::geometry::{Aabb, Point};
use roverlab::picture::{Figure, Mark, Picture, Style};
use roverlab::world::{Colour, Footprint, RobotSpec, World};

use super::drive::Drive;
use super::setting::Setting;
use crate::lane_keeping::road;

/// Colours of the car and of boxes.
const CAR: u32 = 0x26_2d_3a;
const BOX: u32 = 0xb0_7a_3c;

/// The road's lines, the boxes, and the path of the car, coloured by speed.
pub(super) fn picture(setting: &Setting, drive: &Drive) -> Picture {
    let course = &setting.scene.course;
    let mut picture = Picture::new(&World { floor: course.floor(), ..World::empty(1.0, 1.0) });
    let score = &drive.score;
    picture.title(format!("Traffic on course {}", setting.name));
    picture.caption(format!(
        "{:.0} of {:.0} points, {} laps in {:.0} s, {} collisions",
        score.points(),
        drive.possible,
        score.laps,
        score.time,
        score.collisions
    ));
    road(&mut picture, course);
    picture.speed_trace(drive.trail.iter().map(|(time, pose, speed)| (*time, pose.position(), *speed)));
    for (item, poses) in setting.scene.boxes.iter().zip(&drive.boxes) {
        let half = Point::new(0.5 * item.size[0], 0.5 * item.size[1]);
        let footprint = Footprint::Rectangle(Aabb::new(-half, half));
        let style = Style::new(Colour::from_hex(BOX)).labelled("box");
        picture.add(Figure::Robot { poses: poses.clone(), footprint }, style);
    }
    let poses = drive.trail.iter().map(|(time, pose, _)| (*time, *pose)).collect();
    let style = Style::new(Colour::from_hex(CAR)).labelled("car");
    picture.add(Figure::Robot { poses, footprint: RobotSpec::road_car().footprint }, style);
    picture.mark(Mark::Start, course.start().position());
    picture
}
