use super::*;
use crate::geometry::{Point, math};
use crate::random::Stream;
use crate::vision::GrayView;

const SIZE: (u32, u32) = (320, 240);

fn pinhole() -> RoadCamera {
    RoadCamera { field_of_view: 1.65, fisheye: false, tilt: -0.42, height: 0.25, ahead: 0.06 }
}

/// An image of the lines of a circular road whose lane centre is `offset` to the right of the car.
fn road(camera: &RoadCamera, (offset, heading, bend): (f64, f64, f64), lines: &[f64], pitch: f64) -> Vec<u8> {
    let mut random = Stream::new(7);
    let mut image: Vec<u8> = (0..SIZE.0 * SIZE.1).map(|_| 36 + random.below(12) as u8).collect();
    let (sin, cos) = math::sin_cos(heading);
    for line in lines {
        // The road's centre is half a lane to the left of the lane's.
        let left = line + 0.21 - offset;
        for step in 0..6000 {
            let along = f64::from(step) * 5e-4;
            for across in -8..=8 {
                let aside = left + f64::from(across) * 1.25e-3;
                let (x, y) = if bend == 0.0 {
                    (along, aside)
                } else {
                    let (s, c) = math::sin_cos(along * bend);
                    ((1.0 / bend - line) * s, aside + (1.0 / bend - line) * (1.0 - c))
                };
                let place = Point::new(cos * x + sin * y, cos * y - sin * x);
                let Some((column, row)) = camera.project(place, pitch, SIZE) else { continue };
                if (0.0..320.0).contains(&column) && (0.0..240.0).contains(&row) && place.x > 0.1 {
                    image[row as usize * 320 + column as usize] = 225;
                }
            }
        }
    }
    image
}

fn look(camera: RoadCamera, image: &[u8], frames: usize) -> LaneEstimate {
    let mut finder = LaneMarkingFinder::new(camera, RoadModel::default()).unwrap();
    let view = || GrayView::new(image, 320, 240).unwrap();
    for _ in 1..frames {
        finder.see(view(), (0.0, 0.0));
    }
    finder.see(view(), (0.0, 0.0))
}

#[test]
fn three_lines_tell_offset_heading_and_curvature() {
    let truth = (0.03, 0.05, 0.4);
    let lane = look(pinhole(), &road(&pinhole(), truth, &[0.42, 0.0, -0.42], 0.0), 6);
    assert!((lane.offset - truth.0).abs() < 0.012, "{lane:?}");
    assert!((lane.heading - truth.1).abs() < 0.03, "{lane:?}");
    assert!((lane.curvature - 0.4 / (1.0 + 0.4 * 0.21)).abs() < 0.12, "{lane:?}");
    assert!(!lane.lost && lane.support > 10.0);
}

#[test]
fn a_camera_that_looks_higher_than_it_is_said_to_is_noticed() {
    let lines = [0.42, 0.0, -0.42];
    for pitch in [-0.015, 0.0, 0.02] {
        let lane = look(pinhole(), &road(&pinhole(), (0.0, 0.0, 0.0), &lines, pitch), 12);
        assert!((lane.pitch - pitch).abs() < 0.006, "{pitch}: {lane:?}");
        assert!(lane.offset.abs() < 0.01 && lane.heading.abs() < 0.03, "{pitch}: {lane:?}");
    }
}

#[test]
fn a_fisheye_sees_the_same_road() {
    let camera = RoadCamera { field_of_view: 2.6, fisheye: true, ..pinhole() };
    let lane = look(camera, &road(&camera, (-0.02, 0.04, -0.5), &[0.42, 0.0, -0.42], 0.0), 6);
    assert!((lane.offset + 0.02).abs() < 0.015, "{lane:?}");
}

#[test]
fn what_is_wider_than_a_line_or_not_bright_is_none() {
    let mut filter = MarkingFilter::new(pinhole(), 0.02, 2.0).unwrap();
    let mut points = Vec::new();
    for (wide, shade) in [(0.14, 230), (0.02, 46)] {
        let mut image = vec![40_u8; 320 * 240];
        for step in 100..2000 {
            for across in -100..100 {
                let place = Point::new(f64::from(step) * 1e-3, f64::from(across) * 0.005 * wide);
                if let Some((x, y)) = pinhole().project(place, 0.0, SIZE)
                    && (0.0..320.0).contains(&x)
                    && (0.0..240.0).contains(&y)
                {
                    image[y as usize * 320 + x as usize] = shade;
                }
            }
        }
        filter.find(GrayView::new(&image, 320, 240).unwrap(), &mut points);
        assert!(points.len() < 4, "{wide} {shade}: {points:?}");
    }
}

#[test]
fn a_road_that_is_gone_is_lost_after_a_gap_and_found_again() {
    let image = road(&pinhole(), (0.0, 0.0, 0.0), &[0.42, 0.0, -0.42], 0.0);
    let blank = vec![40_u8; 320 * 240];
    let mut finder = LaneMarkingFinder::new(pinhole(), RoadModel::default()).unwrap();
    let mut see = |image: &[u8]| finder.see(GrayView::new(image, 320, 240).unwrap(), (0.1, 0.0));
    assert!(!see(&image).lost);
    let lost = (0..30).map(|_| see(&blank)).position(|lane| lane.lost);
    assert_eq!(lost, Some(15), "after 1.6 m, which is longer than a gap");
    assert!(!see(&image).lost);
}

#[test]
fn nonsense_is_refused_by_name() {
    let name = |camera| LaneMarkingFinder::new(camera, RoadModel::default()).unwrap_err().name().to_owned();
    assert_eq!(name(RoadCamera { height: 0.0, ..pinhole() }), "camera height");
    assert_eq!(name(RoadCamera { field_of_view: f64::NAN, ..pinhole() }), "field of view");
    assert_eq!(name(RoadCamera { tilt: 2.0, ..pinhole() }), "camera tilt");
    let size = RoadModel { size: 0.0, ..RoadModel::default() };
    assert_eq!(LaneMarkingFinder::new(pinhole(), size).unwrap_err().name(), "size of the road");
}
