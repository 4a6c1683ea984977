use proptest::prelude::*;

use super::paint::{is_convex, quads};
use super::*;
use crate::geometry::cross;
use crate::world::formats::course as file;

#[test]
fn every_seed_gives_a_course_and_the_file_gives_it_back() {
    for seed in 0..40 {
        let course = generate(seed, &RoadCourseOptions::default()).unwrap();
        course.check().unwrap();
        let text = file::print(&course);
        let again = file::parse(&text, "x.course").unwrap_or_else(|error| panic!("{seed}: {error}\n{text}"));
        assert_eq!(again.marks.len(), course.marks.len(), "{text}");
        for (one, other) in again.marks.iter().zip(&course.marks) {
            assert!((one.at - other.at).abs() < 1e-6, "{one:?} {other:?}");
        }
        let places = again.line.stations().iter().zip(course.line.stations());
        assert!(places.fold(0.0, |most: f64, (a, b)| most.max(a.pose.distance_to(b.pose.position()))) < 1e-5);
    }
}

#[test]
fn bends_are_tighter_where_that_is_asked_for() {
    let tightest = |options: &RoadCourseOptions| {
        let courses = (0..12).map(|seed| generate(seed, options).unwrap());
        let elements = courses.flat_map(|course| course.line.elements().to_vec());
        1.0 / elements.flat_map(|element| element.curvature).fold(0.0, |most: f64, bend| most.max(bend.abs()))
    };
    let rules = RoadCourseOptions { lane_width: [0.4, 0.45], ..RoadCourseOptions::default() };
    assert!(tightest(&rules) >= 1.43);
    let tight = RoadCourseOptions { inner_radius: 0.0, ..rules };
    assert!((0.999..1.1).contains(&tightest(&tight)), "{}", tightest(&tight));
    assert!(generate(1, &RoadCourseOptions { inner_radius: -0.1, ..rules }).is_err());
}

#[test]
fn what_is_no_course_is_refused_by_name() {
    for (text, expected) in [
        ("", "x:1:1: found an empty file; expected `course 1`"),
        ("road 1", "x:1:1: found `road`; expected `course 1`"),
        ("course 2", "x:1:8: found `2`; expected the version of the format, a whole number from 1 to 1"),
        ("course 1\nstraight 1000", "x:1:1: found a road of 1 m; expected one of 6 to 500 m"),
        (
            "course 1\nlane 300\nstraight 3000\narc 1500 180\nstraight 3000\narc 1500 180",
            "x:1:1: found lanes of 0.3 m; expected 0.35 to 0.45 m",
        ),
        (
            "course 1\nstraight 9000",
            "x:1:1: found the road ends 9.000 m and 0.00 degrees off its beginning; expected less than 0.1 m and 3 degrees",
        ),
        (
            "course 1\nstraight 3000\narc 700 180\nstraight 3000\narc 700 180",
            "x:1:1: found at 3.000 m the road's middle has a radius of 0.700 m; expected at least 1 m",
        ),
        (
            "course 1\nstraight 6000\narc 1500 270\nstraight 3000\narc 1500 -270\nstraight -3",
            "x:6:10: found `-3`; expected the length in millimetres, more than 0",
        ),
        ("course 1\nstraight 3000 7", "x:2:15: found `7`; expected the end of the line"),
        ("course 1\nstraight 3000\nlane 400", "x:3:1: found `lane`; expected it before the first section"),
        ("course 1\ngap middle 300", "x:2:5: found `middle`; expected left, centre, right"),
        ("course 1\narc 1500 nan", "x:2:10: found `nan`; expected the angle in degrees, a number"),
    ] {
        let error = file::parse(text, "x").unwrap_err().to_string();
        assert!(error.starts_with(expected) || expected.starts_with(&error), "{error}\n{expected}");
    }
}

#[test]
fn a_road_that_crosses_itself_needs_a_crossing() {
    let eight = |mark: &str| {
        format!(
            "course 1\nstraight 3000\n{mark}straight 3000\narc 3000 270\nstraight 3000\n{mark}straight 3000\narc 3000 -270\n"
        )
    };
    let error = file::parse(&eight(""), "x").unwrap_err().to_string();
    assert!(error.contains("crosses itself"), "{error}");
    let course = file::parse(&eight("crossing 90 none\n"), "x").unwrap();
    assert_eq!(course.crossings().count(), 2);
}

#[test]
fn lanes_lie_on_the_side_of_the_traffic() {
    let text = |side: &str| {
        format!("course 1\ntraffic {side}\nscale 2\nstraight 3000\narc 1500 180\nstraight 3000\narc 1500 180")
    };
    let right = file::parse(&text("right"), "x").unwrap();
    let left = file::parse(&text("left"), "x").unwrap();
    assert_eq!(right.start().y, -left.start().y);
    assert!((right.start().y + 0.105).abs() < 1e-9, "half of 210 mm at a scale of 2:1");
    // The inner lane of a left bend is the left one.
    let bend = 2.0;
    let radius = |course: &RoadCourse| 1.0 / course.locate(&course.pose(bend, 0.0), None).curvature;
    assert!((radius(&left) - 0.645).abs() < 1e-3 && (radius(&right) - 0.855).abs() < 1e-3);
}

#[test]
fn a_picture_shows_lines_where_they_are() {
    let text = "course 1\nstart 2000 2000 0\nstraight 3000\narc 1500 180\nstraight 3000\narc 1500 180\n";
    let course = file::parse(text, "x").unwrap();
    let image = course.floor_image(&Appearance { pixel: 0.001, ..Appearance::default() }).unwrap();
    let floor = course.floor();
    let shade = |x: f64, y: f64| {
        let (column, row) = ((x - floor.min.x) * 1000.0, (floor.max.y - y) * 1000.0);
        image.get_pixel(column as u32, row as u32).0[0]
    };
    for (x, y, paint) in [
        (2.1, 2.0, true),
        (2.3, 2.0, false),
        (2.3, 2.42, true),
        (2.3, 1.58, true),
        (2.3, 1.60, false),
        (2.3, 2.40, false),
    ] {
        assert_eq!(shade(x, y) > 150, paint, "{x} {y}: {}", shade(x, y));
    }
    let error = course.floor_image(&Appearance { pixel: 1e-5, ..Appearance::default() }).unwrap_err();
    assert!(matches!(error, CourseError::TooLarge { .. }), "{error}");
}

/// Lengths of the pieces of paint along the middle of a road (m), to 10 mm.
fn pieces(course: &RoadCourse) -> Vec<f64> {
    let quads = quads(course);
    let is_painted = |along: f64| {
        let place = course.line.at(along).pose.position();
        quads.iter().any(|quad| {
            let sides = (0..4).map(|i| cross(quad[(i + 1) % 4] - quad[i], place - quad[i]));
            let (left, right) =
                (sides.clone().all(|side| side >= 0.0), sides.clone().all(|side| side <= 0.0));
            left || right
        })
    };
    let cells: Vec<bool> = (0..400).map(|i| is_painted(1.005 + 0.01 * f64::from(i))).collect();
    let runs = cells.chunk_by(|one, next| one == next).filter(|run| run[0]);
    runs.map(|run| 0.01 * run.len() as f64).collect()
}

#[test]
fn dashes_go_on_where_their_kind_is_named_again() {
    let half = "straight 3000\narc 1500 180\n";
    let text = format!("course 1\nstraight 1950\ncentre dashed\nstraight 1050\narc 1500 180\n{half}");
    let pieces = pieces(&file::parse(&text, "oval").unwrap());
    assert!(pieces.len() > 5 && pieces.iter().all(|long| *long < 0.22), "{pieces:?}");
}

proptest! {
    #![proptest_config(crate::testing::cases(24))]
    #[test]
    fn everything_that_is_painted_is_convex(course in crate::testing::courses()) {
        prop_assert!(quads(&course).iter().all(is_convex));
    }

    #[test]
    fn any_text_is_read_or_refused(text in "(course 1\n)?((straight|arc|clothoid|gap left|crossing|zebra|speed)( -?[0-9]{1,7}){0,3}\n){0,12}") {
        let _ = file::parse(&text, "x");
    }
}
