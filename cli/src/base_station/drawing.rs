//! Picture of the drive: the road from above, and the paths of the cars.

use roverlab::picture::{Figure, Picture, SERIES, Style};
use roverlab::world::{RobotSpec, World};

use super::scene::Setting;
use super::share::Shared;
use crate::lane_keeping::road;

/// The road's lines, and the cars with their paths.
pub(super) fn picture(setting: &Setting, shared: &Shared) -> Picture {
    let course = &setting.course;
    let mut picture = Picture::new(&World { floor: course.floor(), ..World::empty(1.0, 1.0) });
    picture.title("Cars that share a road by radio");
    picture.caption(format!(
        "{} cars, {:.0} s, {} contacts",
        shared.cars.len(),
        shared.time,
        shared.contacts
    ));
    road(&mut picture, course);
    for (index, car) in shared.cars.iter().enumerate() {
        let style = Style::new(SERIES[index % SERIES.len()]).labelled(format!("car {}", index + 1));
        let footprint = RobotSpec::road_car().footprint;
        picture.add(Figure::Robot { poses: car.trail.clone(), footprint }, style);
    }
    let station = &setting.scene.robots[setting.cars];
    picture.robot_with(station.pose, &station.spec.footprint, Style::plan().labelled("base station"));
    picture
}
