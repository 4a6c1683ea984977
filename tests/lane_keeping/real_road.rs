//! Pictures of a real road, published, beside where a person sees its lines: `tests/data/lanes/table.csv`.

use std::collections::BTreeMap;
use std::path::Path;

use image::GrayImage;
use roverlab::geometry::{Point, Segment, units};
use roverlab::vision::GrayView;
use roverlab::vision::lane_markings::{LaneEstimate, LaneMarkingFinder, RoadCamera, RoadModel};

use super::book_loop;

/// The robot's camera: of the lenses, tilts and heights on a grid, what fits nine other pictures best.
fn camera() -> RoadCamera {
    RoadCamera {
        field_of_view: units::from_deg(58.0),
        fisheye: false,
        tilt: 0.058,
        height: 0.077,
        ahead: 0.0,
    }
}

const SIZE: (u32, u32) = (320, 240);
/// Numbers of the pictures from the right lane; the others are from the left one, or between them.
const IN_THE_RIGHT_LANE: std::ops::RangeInclusive<u32> = 71..=109;
/// Pixels from a line that count as on it.
const NEAR: f64 = 5.0;
/// Metres along a line between its places that are compared.
const STEP: f64 = 0.01;

/// A place on a line: how many lanes the line is to the left of the centre line, and where that is (pixels).
struct Mark {
    lanes: f64,
    at: Point,
}

/// The marks of each picture.
fn marks() -> BTreeMap<String, Vec<Mark>> {
    let rows = include_str!("../data/lanes/table.csv").lines().filter(|row| !row.starts_with('#')).skip(1);
    let mut pictures: BTreeMap<String, Vec<Mark>> = BTreeMap::new();
    for row in rows {
        let fields: Vec<&str> = row.split(',').collect();
        let lanes = match fields[1] {
            "left" => 1.0,
            "centre" => 0.0,
            "right" => -1.0,
            other => panic!("{row}: found {other}"),
        };
        // The middle of a pixel is half a pixel from its edge.
        let [row, column] = [fields[2], fields[3]].map(|number| number.parse::<f64>().unwrap() + 0.5);
        pictures.entry(fields[0].into()).or_default().push(Mark { lanes, at: Point::new(column, row) });
    }
    pictures
}

/// Pixels from a mark to its line by an estimate, of a robot in a lane whose middle is some lanes to the left
/// of the centre line.
fn off(lane: &LaneEstimate, middle: f64, mark: &Mark) -> f64 {
    let aside = Point::new(0.0, (mark.lanes - middle) * lane.edge);
    let places = (0..150).map(|step| lane.place(STEP * f64::from(step)).to_world(aside));
    let seen = places.filter_map(|place| camera().project(place, lane.pitch, SIZE));
    let line: Vec<Point> = seen.map(|(column, row)| Point::new(column, row)).collect();
    let parts = line.windows(2).map(|ends| Segment::new(ends[0], ends[1]).distance_to(mark.at));
    parts.fold(f64::INFINITY, f64::min)
}

/// Each picture alone: its lines are found without those before it.
#[test]
#[ignore = "needs published data: ROVERLAB_DATA=FOLDER cargo test --test lane_keeping real_road -- --ignored"]
fn lines_are_where_a_person_sees_them() {
    let data = std::env::var_os("ROVERLAB_DATA").expect("ROVERLAB_DATA names the folder of published data");
    let folder = Path::new(&data).join("images/lanes/carolo_table");
    let course = book_loop::course();
    let (mut all, mut near, mut whole, mut fair) = (0, 0, 0, 0);
    let marks = marks();
    for (name, marks) in &marks {
        let image: GrayImage = image::open(folder.join(name)).unwrap().into_luma8();
        let number: u32 = name.trim_start_matches("image").trim_end_matches(".png").parse().unwrap();
        let left_hand = !IN_THE_RIGHT_LANE.contains(&number);
        let road = RoadModel { size: course.size, line_width: course.line_width, left_hand };
        let view = GrayView::new(image.as_raw(), SIZE.0 as usize, SIZE.1 as usize).unwrap();
        let lane = LaneMarkingFinder::new(camera(), road).unwrap().see(view, (0.0, 0.0));
        let middle = if left_hand { 0.5 } else { -0.5 };
        let offs: Vec<f64> = marks.iter().map(|mark| off(&lane, middle, mark)).collect();
        let right = offs.iter().filter(|off| **off <= NEAR).count();
        all += offs.len();
        near += right;
        whole += usize::from(right == offs.len());
        fair += usize::from(offs.iter().sum::<f64>() <= NEAR * offs.len() as f64);
    }
    println!(
        "{near} of {all} places; of {} pictures, all places in {whole}, in the mean in {fair}",
        marks.len()
    );
    assert!(marks.len() == 100 && 100 * near >= 95 * all && fair >= 95);
}
