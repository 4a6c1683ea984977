//! A lesson: a drive on a course of its own, and what is to be learned from it.

use image::Rgba;
use roverlab::drive::end_to_end::{NetworkDriver, SteeringExamples, SteeringTeacher, TeacherParameters};
use roverlab::drive::lane_keeping::LaneKeeperParameters;
use roverlab::drive::traffic::{FreeDrive, FreeDriveRules};
use roverlab::geometry::Vector;
use roverlab::io::control::{run, until};
use roverlab::io::sim::Simulation;
use roverlab::random::Stream;
use roverlab::vision::network::Network;
use roverlab::world::road::{RoadCourse, RoadCourseOptions};
use roverlab::world::{RobotSpec, Texture, World};

use super::Args;
use crate::common::Failure;
use crate::lane_keeping::{Setting, keeper};

/// Duration of a lesson (s).
const LESSON: f64 = 20.0;
/// Speed in lessons (m/s).
const SPEED: f64 = 1.0;
/// Size of a cell of the map of what is near the road (m).
const CELL: f64 = 0.02;
/// Brightness from which a pixel of the floor is paint, 0 to 255.
const PAINT: u8 = 170;

/// A lesson on a course of its own, which ends early if the car goes astray.
pub(super) fn lesson(
    args: &Args,
    seed: u64,
    pupil: Option<&Network>,
) -> Result<(SteeringExamples, bool), Failure> {
    let mut random = Stream::new(seed).child("scenery", 0);
    let options = if random.chance(0.5) { tight(&mut random) } else { RoadCourseOptions::default() };
    let setting = Setting::drawn_by(seed, &options)?;
    let mut scene = setting.scene()?;
    if random.chance(0.5) {
        surround(&mut scene.world, &setting.course, &mut random);
    }
    let spec = RobotSpec::road_car();
    let simulation = Simulation::new(&scene, setting.options(args.common.noise)).map_err(Failure::input)?;
    let (mut car, truth) = (simulation.robot(0).map_err(Failure::run)?, simulation.truth());
    let mut referee =
        FreeDrive::new(setting.course.clone(), &spec, FreeDriveRules::default()).map_err(Failure::input)?;
    let keeper = keeper(&setting.course, LaneKeeperParameters::default())?;
    let seed = Stream::new(seed).child("lesson", 0).bits();
    let parameters = TeacherParameters {
        speed: SPEED,
        disturbance: args.disturbance,
        seed,
        ..TeacherParameters::default()
    };
    let mut teacher = SteeringTeacher::new(keeper, args.architecture.input(), parameters)?;
    if let Some(network) = pupil {
        teacher = teacher.with_pupil(NetworkDriver::new(network.clone(), SPEED)?);
    }
    let mut astray = false;
    run(&mut car, &mut teacher, LESSON, |_, _, _| {
        astray = referee.see(truth.time(), &truth.pose(0).expect("there is a car"));
        until(astray)
    })?;
    Ok((teacher.into_examples(), astray))
}

/// Courses with bends as tight as in the book's loop, for the width of its lanes.
fn tight(random: &mut Stream) -> RoadCourseOptions {
    RoadCourseOptions {
        inner_radius: 0.0,
        lane_width: [0.4, 0.45],
        size: random.between(0.85, 1.0),
        ..RoadCourseOptions::default()
    }
}

/// Has another floor begin somewhere beside the road, in any shade, so that brightness there does not matter.
/// Paint stays, as that of crossing roads.
fn surround(world: &mut World, course: &RoadCourse, random: &mut Stream) {
    let reach = course.edge() + random.between(0.06, 0.6);
    let grey = random.between(0.0, 255.0);
    let shade = [(); 3].map(|()| (grey + random.between(-60.0, 60.0)) as u8);
    let Some(image) = world.floor_texture.as_ref().and_then(|texture| texture.image.as_deref()) else {
        return;
    };
    let (floor, mut image) = (world.floor, image.clone());
    let [columns, rows] = [floor.size().x, floor.size().y].map(|side| (side / CELL).ceil() as usize);
    let mut near = vec![false; columns * rows];
    for station in course.line.stations().iter().step_by(2) {
        let place = station.pose.position() - floor.min;
        let cells = |middle: f64, most: usize| {
            let low = ((middle - reach) / CELL).max(0.0) as usize;
            low..(((middle + reach) / CELL) as usize + 1).min(most)
        };
        for row in cells(place.y, rows) {
            for column in cells(place.x, columns) {
                let middle = Vector::new((column as f64 + 0.5) * CELL, (row as f64 + 0.5) * CELL);
                near[row * columns + column] |= (middle - place).norm() < reach;
            }
        }
    }
    let (wide, high) = (image.width() as usize, image.height() as usize);
    for (x, y, pixel) in image.enumerate_pixels_mut() {
        // The picture's first row is the far one.
        let (x, y) = (x as usize * columns / wide, (high - 1 - y as usize) * rows / high);
        if !near[y * columns + x] && pixel.0[0] < PAINT {
            *pixel = Rgba([shade[0], shade[1], shade[2], 255]);
        }
    }
    world.floor_texture = Some(Texture::new("course.png", image));
}

#[cfg(test)]
mod tests {
    use roverlab::world::road::{Appearance, generate};

    use super::*;

    #[test]
    fn another_floor_begins_beside_the_road_and_leaves_its_paint() {
        let mut random = Stream::new(1);
        let course = generate(5, &tight(&mut random)).unwrap();
        let mut world = course.world(&Appearance { pixel: 0.01, ..Appearance::default() }).unwrap();
        let picture = |world: &World| world.floor_texture.as_ref().unwrap().image.as_deref().unwrap().clone();
        let before = picture(&world);
        surround(&mut world, &course, &mut random);
        let after = picture(&world);
        assert_eq!(before.dimensions(), after.dimensions());
        let (mut near, mut other) = (0, 0);
        for (x, y, pixel) in after.enumerate_pixels() {
            let place = Vector::new(f64::from(x) + 0.5, f64::from(before.height() - y) - 0.5) * 0.01;
            let (_, aside) = course.line.locate(world.floor.min + place, None);
            let same = pixel == before.get_pixel(x, y);
            if aside.abs() < course.edge() {
                near += 1;
                assert!(same, "the road is as it was, {aside} m aside at {x} {y}");
            } else if aside.abs() > course.edge() + 0.7 && before.get_pixel(x, y).0[0] < PAINT {
                assert!(!same, "{aside} m aside at {x} {y}");
                other += 1;
            }
        }
        assert!(near > 10_000 && other > 10_000, "{near} {other}");
    }
}
