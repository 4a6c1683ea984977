//! Programs for driverless cars (book, chapter 13): in a lane by camera, under a base station, and into a
//! parking spot; in C and in Python.

use std::fmt::Write as _;
use std::fs;

use roverlab::geometry::Pose;
use roverlab::world::formats::course;
use roverlab::world::road::{Appearance, RoadCourse};
use serde_json::Value;

use super::{Folder, compiled, compiler, programs, python, report};

/// Lanes of 200 mm.
const ROAD: &str = "course 1
scale 2
straight 3000
arc 2500 180
straight 3000
arc 2500 180
";

fn folder(name: &str, language: &str) -> Folder {
    let folder = Folder::new(name);
    let check = programs().join("check.h");
    fs::copy(check, folder.0.join("check.h")).unwrap();
    for program in ["car", "base", "park"] {
        let file = format!("{program}.{language}");
        fs::copy(programs().join("roads").join(&file), folder.0.join(&file)).unwrap();
        if language == "c" {
            compiled(&folder.0.join(&file));
        }
    }
    folder
}

/// Runs a script, which must end without contact.
fn run(folder: &Folder, name: &str, script: &str) -> Value {
    let script = folder.write(name, script);
    let options = ["--noise", "1", "--time-limit", "120", "--real-limit", "600"];
    let all = report(&[&options[..], &[script.to_str().unwrap()]].concat());
    assert_eq!(all["outcome"], "finished", "{all}");
    for robot in all["robots"].as_array().unwrap() {
        assert_eq!(robot["exit"], 0, "{all}");
    }
    all
}

/// The road as a world, whose corner is its origin.
fn road(folder: &Folder) -> RoadCourse {
    let course = course::parse(ROAD, "road").unwrap();
    let image = course.floor_image(&Appearance::default()).unwrap();
    image.save(folder.0.join("road.png")).unwrap();
    let size = course.floor().size();
    let (width, height) = (1e3 * size.x, 1e3 * size.y);
    folder.write("road.wld", &format!("floor {width:.0} {height:.0}\nfloor_texture road.png\n"));
    course
}

/// Two cars drive, stop and go on under a base station that stands beside the road.
fn cars_keep_in_their_lane(language: &str, ending: &str) {
    let folder = folder(&format!("roads-{language}"), language);
    let course = road(&folder);
    let corner = course.floor().min;
    let place = |along: f64| {
        let pose = course.pose(along, 0.0);
        let (x, y) = (1e3 * (pose.x - corner.x), 1e3 * (pose.y - corner.y));
        format!("{x:.0} {y:.0} {:.0}", pose.heading.to_degrees())
    };
    let (first, second) = (place(0.2), place(0.5 * course.line.length() + 0.2));
    let script = format!(
        "world road.wld\nS4 {first} car.{ending}\nS4 {second} car.{ending}\n\
         S4 150 150 0 base.{ending}\n"
    );
    let all = run(&folder, "roads.sim", &script);
    for robot in &all["robots"].as_array().unwrap()[..2] {
        let pose = &robot["pose"];
        let number = |name: &str| pose[name].as_f64().unwrap_or_else(|| panic!("{name} in {all}"));
        let (x, y) = (1e-3 * number("x_mm") + corner.x, 1e-3 * number("y_mm") + corner.y);
        let lane = course.locate(&Pose::new(x, y, number("heading_deg").to_radians()), None);
        assert!(lane.offset.abs() < 0.06 && lane.heading.abs() < 0.3, "{lane:?} in {all}");
        let driven = robot["path_length_mm"].as_f64().unwrap();
        assert!((1300.0..2600.0).contains(&driven), "{driven} mm in {all}");
    }
}

/// A car parks in a gap of 400 mm behind one of 150 mm.
fn a_car_parks(language: &str, ending: &str) {
    let folder = folder(&format!("parking-{language}"), language);
    let mut world = String::from("floor 4000 2000\n");
    for (from, to) in [(900, 1200), (1350, 1650), (2050, 2350)] {
        for [x, y, u, v] in
            [[from, 600, to, 600], [to, 600, to, 850], [to, 850, from, 850], [from, 850, from, 600]]
        {
            writeln!(world, "{x} {y} {u} {v}").unwrap();
        }
    }
    folder.write("lot.wld", &world);
    let all = run(&folder, "park.sim", &format!("world lot.wld\nS4 500 1000 0 park.{ending}\n"));
    let robot = &all["robots"][0];
    let pose = &robot["pose"];
    let (x, y) = (pose["x_mm"].as_f64().unwrap(), pose["y_mm"].as_f64().unwrap());
    assert!((x - 1850.0).abs() < 60.0 && (y - 750.0).abs() < 60.0, "{all}");
}

#[test]
fn c_programs_drive_and_park_on_roads() {
    if compiler() {
        cars_keep_in_their_lane("c", "x");
        a_car_parks("c", "x");
    }
}

#[test]
fn python_programs_drive_and_park_on_roads() {
    if python() {
        cars_keep_in_their_lane("py", "py");
        a_car_parks("py", "py");
    }
}
