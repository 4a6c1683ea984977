//! Picture of a manoeuvre: the road from above, the boxes, and the path of the car.

use roverlab::drive::parking::{ParkingKind, ParkingLot, parking_car};
use roverlab::geometry::{Aabb, Point};
use roverlab::picture::{Figure, Mark, Picture, Style};
use roverlab::world::road::RoadSide;
use roverlab::world::{Colour, Footprint, World};

use super::drive::Drive;
use crate::lane_keeping::{area, parking_sides, road};

/// Colours of the car and of boxes.
const CAR: u32 = 0x26_2d_3a;
const BOX: u32 = 0xb0_7a_3c;

/// The road's lines, the boxes, and the path of the car.
pub(super) fn picture(lot: &ParkingLot, drive: &Drive) -> Picture {
    let course = &lot.course;
    let mut picture = Picture::new(&World { floor: course.floor(), ..World::empty(1.0, 1.0) });
    picture.title("Parking");
    picture.caption(if drive.is_legal { "all wheels in the spot" } else { "not in the spot" });
    road(&mut picture, course);
    let side = if lot.kind == ParkingKind::Parallel { RoadSide::Right } else { RoadSide::Left };
    area(&mut picture, course, lot.spot, parking_sides(course, side), "free spot");
    for &(pose, length, width) in &lot.boxes {
        let half = Point::new(0.5 * length, 0.5 * width);
        let footprint = Footprint::Rectangle(Aabb::new(-half, half));
        let style = Style::new(Colour::from_hex(BOX)).labelled("box");
        picture.add(Figure::Robot { poses: vec![(0.0, pose)], footprint }, style);
    }
    picture.true_path(drive.trail.iter().map(|(_, pose)| pose.position()));
    let style = Style::new(Colour::from_hex(CAR)).labelled("car");
    picture.add(Figure::Robot { poses: drive.trail.clone(), footprint: parking_car().footprint }, style);
    picture.mark(Mark::Start, course.start().position());
    picture
}
