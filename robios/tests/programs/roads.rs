//! Programs for driverless cars (book, chapter 13): in a lane by camera, under a base station, and into a
//! parking spot, and by a network; in C and in Python.

use std::fmt::Write as _;
use std::fs;

use roverlab::geometry::Pose;
use roverlab::world::formats::course;
use roverlab::world::road::{Appearance, LanePose, RoadCourse};
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
fn paint(folder: &Folder, course: &RoadCourse) {
    let image = course.floor_image(&Appearance::default()).unwrap();
    image.save(folder.0.join("road.png")).unwrap();
    let size = course.floor().size();
    let (width, height) = (1e3 * size.x, 1e3 * size.y);
    folder.write("road.wld", &format!("floor {width:.0} {height:.0}\nfloor_texture road.png\n"));
}

/// Place in the world of a car in its lane, along the road (m).
fn place(course: &RoadCourse, along: f64) -> String {
    let (pose, corner) = (course.pose(along, 0.0), course.floor().min);
    let (x, y) = (1e3 * (pose.x - corner.x), 1e3 * (pose.y - corner.y));
    format!("{x:.0} {y:.0} {:.0}", pose.heading.to_degrees())
}

/// Where a robot of a report is in its lane.
fn lane_of(course: &RoadCourse, robot: &Value) -> LanePose {
    let corner = course.floor().min;
    let number = |name: &str| robot["pose"][name].as_f64().unwrap_or_else(|| panic!("{name} in {robot}"));
    let (x, y) = (1e-3 * number("x_mm") + corner.x, 1e-3 * number("y_mm") + corner.y);
    course.locate(&Pose::new(x, y, number("heading_deg").to_radians()), None)
}

/// Two cars drive, stop and go on under a base station that stands beside the road.
fn cars_keep_in_their_lane(language: &str, ending: &str) {
    let folder = folder(&format!("roads-{language}"), language);
    let course = course::parse(ROAD, "road").unwrap();
    paint(&folder, &course);
    let (first, second) = (place(&course, 0.2), place(&course, 0.5 * course.line.length() + 0.2));
    let script = format!(
        "world road.wld\nS4 {first} car.{ending}\nS4 {second} car.{ending}\n\
         S4 150 150 0 base.{ending}\n"
    );
    let all = run(&folder, "roads.sim", &script);
    for robot in &all["robots"].as_array().unwrap()[..2] {
        let lane = lane_of(&course, robot);
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

/// The network that comes with the program `roverlab` steers a car on a road that it has never seen.
fn a_network_steers(language: &str, ending: &str) {
    let folder = Folder::new(&format!("network-{language}"));
    let source = folder.0.join(format!("net.{language}"));
    fs::copy(programs().join("roads").join(format!("net.{language}")), &source).unwrap();
    fs::copy(programs().join("check.h"), folder.0.join("check.h")).unwrap();
    let weights = programs().join("../../../cli/nets/steering.safetensors");
    fs::copy(weights, folder.0.join("steering.safetensors")).unwrap();
    if language == "c" {
        compiled(&source);
    }
    let course = course::parse(&ROAD.replace("scale 2", "scale 1"), "road").unwrap();
    paint(&folder, &course);
    let script = format!("world road.wld\nRoadCar {} net.{ending}\n", place(&course, 0.2));
    let all = run(&folder, "network.sim", &script);
    let lane = lane_of(&course, &all["robots"][0]);
    assert!(lane.offset.abs() < 0.1 && lane.heading.abs() < 0.3, "{lane:?} in {all}");
    let driven = all["robots"][0]["path_length_mm"].as_f64().unwrap();
    assert!(driven > 6000.0, "{driven} mm in {all}");
}

#[test]
fn c_programs_drive_and_park_on_roads() {
    if compiler() {
        a_network_steers("c", "x");
        cars_keep_in_their_lane("c", "x");
        a_car_parks("c", "x");
    }
}

#[test]
fn python_programs_drive_and_park_on_roads() {
    if python() {
        a_network_steers("py", "py");
        cars_keep_in_their_lane("py", "py");
        a_car_parks("py", "py");
    }
}
