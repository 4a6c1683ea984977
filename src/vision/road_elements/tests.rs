//! Pictures of a straight road, painted by the camera's own projection.

use std::ops::Range;

use super::*;
use crate::geometry::Point;
use crate::vision::GrayView;
use crate::vision::lane_markings::{LaneMarkingFinder, RoadCamera, RoadModel};

const CAMERA: RoadCamera =
    RoadCamera { field_of_view: 1.6, fisheye: false, tilt: -0.4, height: 0.25, ahead: 0.06 };
/// Distance from the road's middle to its edge lines (m).
const EDGE: f64 = 0.42;

/// A picture of a road on which a car is in the middle of its lane.
struct Picture(Vec<u8>, RoadCamera);

impl Picture {
    /// The lines of the road.
    fn road() -> Self {
        Self::road_by(CAMERA)
    }

    fn road_by(camera: RoadCamera) -> Self {
        let mut picture = Self(vec![40; 320 * 240], camera);
        for left in [-0.5 * EDGE, 0.5 * EDGE, 1.5 * EDGE] {
            picture.paint(0.2..3.0, left - 0.01..left + 0.01, 220);
        }
        picture
    }

    /// Paints a rectangle of the ground: distances ahead, and to the left of the lane's middle (m).
    fn paint(&mut self, ahead: Range<f64>, left: Range<f64>, gray: u8) {
        const STEP: f64 = 0.002;
        let count = |range: &Range<f64>| ((range.end - range.start) / STEP) as usize;
        for (i, k) in (0..count(&ahead)).flat_map(|i| (0..count(&left)).map(move |k| (i, k))) {
            let place = Point::new(ahead.start + STEP * i as f64, left.start + STEP * k as f64);
            if let Some((column, row)) = self.1.project(place, 0.0, (320, 240))
                && (0.0..320.0).contains(&column)
                && (0.0..240.0).contains(&row)
            {
                self.0[row as usize * 320 + column as usize] = gray;
            }
        }
    }

    /// What a finder has found after some images of it.
    fn found(&self) -> RoadElementFinder {
        let mut finder = RoadElementFinder::new(CAMERA, RoadModel::default()).unwrap();
        self.look(&mut finder, 5, 0.0);
        finder
    }

    /// Shows it to a finder in some images, each after the car has driven a distance (m).
    fn look(&self, finder: &mut RoadElementFinder, count: usize, metres: f64) {
        let mut lane = LaneMarkingFinder::new(CAMERA, RoadModel::default()).unwrap();
        let view = GrayView::new(&self.0, 320, 240).unwrap();
        for _ in 0..count {
            let lane = lane.see(view, (0.0, 0.0));
            finder.see(view, &lane, metres, 0.04);
        }
    }
}

#[test]
fn a_line_beyond_a_crossing_is_no_box_and_a_box_is_one() {
    for far in (0..8).map(|step| 1.0 + 0.06 * f64::from(step)) {
        let mut line = Picture::road();
        line.paint(far..far + 0.04, 0.5 * EDGE..1.5 * EDGE, 220);
        assert!(!line.found().sees_box((0.45, 1.65), 0.25, 0.0), "a line at {far}");
        // The front of a box 110 mm high covers the ground up to 1.8 times its distance from the camera.
        let mut front = Picture::road();
        front.paint(far..1.8 * far, -0.2..0.0, 220);
        assert!(front.found().sees_box((0.45, 1.65), 0.25, 0.0), "a box at {far}");
    }
}

#[test]
fn a_box_is_seen_of_which_only_a_part_is_where_it_is_looked_for() {
    let mut front = Picture::road();
    front.paint(1.0..1.8, -1.0..-0.3, 220);
    assert!(front.found().sees_box((0.45, 1.65), 0.25, 0.0));
}

#[test]
fn a_box_that_seemed_to_drive_away_is_forgotten_where_it_is_not() {
    let has_box = |finder: &RoadElementFinder| {
        finder.elements().any(|it| matches!(it.kind, RoadElementKind::Obstacle { .. }))
    };
    let mut finder = RoadElementFinder::new(CAMERA, RoadModel::default()).unwrap();
    for far in (0..6).map(|step| 1.0 + 0.02 * f64::from(step)) {
        let mut front = Picture::road();
        front.paint(far..1.8 * far, -0.2..0.0, 220);
        front.look(&mut finder, 1, 0.0);
    }
    assert!(has_box(&finder));
    // The car is slower than the box seemed to be.
    Picture::road().look(&mut finder, 60, 0.015);
    assert!(!has_box(&finder), "{:?}", finder.elements().collect::<Vec<_>>());
}

#[test]
fn a_give_way_line_of_which_a_dash_is_worn_is_found() {
    let mut road = Picture::road();
    // Dashes of 80 mm and gaps of 60 mm, of which the left one has lost its half.
    for (left, long) in [(-0.17, 0.08), (-0.03, 0.08), (0.11, 0.04)] {
        road.paint(0.7..0.738, left..left + long, 220);
    }
    let found: Vec<RoadElementKind> = road.found().elements().map(|it| it.kind).collect();
    assert_eq!(found, [RoadElementKind::GiveWayLine]);
}

#[test]
fn a_crosswalk_is_kept_while_a_narrow_lens_sees_little_but_the_own_lane() {
    let camera = RoadCamera { field_of_view: 1.05, fisheye: false, tilt: 0.0, height: 0.13, ahead: 0.13 };
    let mut lane = LaneMarkingFinder::new(camera, RoadModel::default()).unwrap();
    let mut finder = RoadElementFinder::new(camera, RoadModel::default()).unwrap();
    for near in (0..60).map(|step| 0.8 - 0.01 * f64::from(step)) {
        let mut picture = Picture::road_by(camera);
        for left in (0..11).map(|stripe| -0.2 + 0.078 * f64::from(stripe)) {
            picture.paint(near.max(0.2)..near + 0.4, left..left + 0.039, 220);
        }
        let view = GrayView::new(&picture.0, 320, 240).unwrap();
        let lane = lane.see(view, (0.01, 0.0));
        finder.see(view, &lane, 0.01, 0.04);
        let found = finder.elements().find(|it| it.kind == RoadElementKind::Zebra);
        // Where the view ends, no crosswalk begins.
        let is_there = found.is_some_and(|it| (it.ahead - near).abs() < 0.05);
        assert!(is_there || near > 0.75, "{near}: {found:?}");
    }
}
