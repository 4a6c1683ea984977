//! Picture of a manoeuvre: the road from above, the boxes, and the path of the car.

use roverlab::drive::parking::{ParkingLot, parking_car};
use roverlab::geometry::{Aabb, Point};
use roverlab::picture::{Figure, Mark, Picture, Style};
use roverlab::world::{Colour, Footprint, World};

use super::drive::Drive;
use crate::lane_keeping::road;

/// Colours of the car and of boxes.
const CAR: u32 = 0x26_2d_3a;
const BOX: u32 = 0xb0_7a_3c;
/// Length of road that is drawn around the spot (m).
const AROUND: f64 = 2.5;

/// The road's lines, the boxes, and the path of the car.
pub(super) fn picture(lot: &ParkingLot, drive: &Drive) -> Picture {
    let middle = lot.course.line.beside(0.5 * (lot.spot.0 + lot.spot.1), 0.0);
    let floor = Aabb::new(middle, middle).inflated(AROUND);
    let mut picture = Picture::new(&World { floor, ..World::empty(1.0, 1.0) });
    picture.title("Parking");
    picture.caption(if drive.is_legal { "all wheels in the spot" } else { "not in the spot" });
    road(&mut picture, &lot.course);
    for &(pose, length, width) in &lot.boxes {
        let half = Point::new(0.5 * length, 0.5 * width);
        let footprint = Footprint::Rectangle(Aabb::new(-half, half));
        let style = Style::new(Colour::from_hex(BOX)).labelled("box");
        picture.add(Figure::Robot { poses: vec![(0.0, pose)], footprint }, style);
    }
    picture.true_path(drive.trail.iter().map(|(_, pose)| pose.position()));
    let style = Style::new(Colour::from_hex(CAR)).labelled("car");
    picture.add(Figure::Robot { poses: drive.trail.clone(), footprint: parking_car().footprint }, style);
    picture.mark(Mark::Start, lot.course.start().position());
    picture
}
