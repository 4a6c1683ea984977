//! Tracks of cones, and lines on them.

use std::f64::consts::TAU;

use crate::sample::{samples, varied};
use roverlab::geometry::{Point, Pose, direction};
use roverlab::race::{
    CarLimits, CarOutline, Cone, ConeColour, ConeTrack, Corridor, LineTracker, LineTrackerParameters,
    SpeedProfile,
};

varied! {
    CarOutline => varied [CarOutline { half_width: 0.7, nose: 2.15, ahead: 0.9, room: 0.0 }];
    SpeedProfile => varied [
        SpeedProfile::closed(&circle(12, 5.0), &CarLimits::circle(10.0, 5.0, 8.0, 30.0)).expect("a circle")
    ];
}

/// Points on a circle around the origin.
fn circle(count: u32, radius: f64) -> Vec<Point> {
    let angle = |k: u32| TAU * f64::from(k) / f64::from(count);
    (0..count).map(|k| Point::origin() + direction(angle(k)) * radius).collect()
}

/// Points on a ring, with distances to its edges.
fn ring(count: u32, radius: f64, side: f64) -> Vec<(Point, f64, f64)> {
    circle(count, radius).into_iter().map(|point| (point, side, side)).collect()
}

/// A strip for an acceleration, with cones every 5 m, and the start pose of the car.
fn strip(half_width: f64, start: Pose) -> ConeTrack {
    let mut track = ConeTrack { start: Some(start), ..ConeTrack::default() };
    let mut both = |x: f64, colours: [ConeColour; 2]| {
        for (side, colour) in [1.0, -1.0].into_iter().zip(colours) {
            track.cones.push(Cone::new(Point::new(x, side * half_width), colour));
        }
    };
    for x in [-0.25, 0.25, 74.75, 75.25] {
        both(x, [ConeColour::BigOrange; 2]);
    }
    for k in 1..15 {
        both(5.0 * f64::from(k), [ConeColour::Blue, ConeColour::Yellow]);
    }
    for k in 16..=20 {
        both(5.0 * f64::from(k), [ConeColour::Orange; 2]);
    }
    track
}

/// The skidpad of the rules, and the start pose of the car.
fn skidpad(start: Pose) -> ConeTrack {
    let mut track = ConeTrack { start: Some(start), ..ConeTrack::default() };
    let mut put = |x: f64, y: f64, colour| track.cones.push(Cone::new(Point::new(x, y), colour));
    let (apart, inner, outer) = (9.125, 7.625, 10.625);
    for (side, near, far) in
        [(1.0, ConeColour::Blue, ConeColour::Yellow), (-1.0, ConeColour::Yellow, ConeColour::Blue)]
    {
        for arm in circle(16, 1.0) {
            put(arm.x * inner, side * apart + arm.y * inner, near);
            if arm.y * outer * side + apart > 1.0 {
                put(arm.x * outer, side * apart + arm.y * outer, far);
            }
        }
        for x in [-15.0, -11.0, 11.0, 16.0, 21.0] {
            put(x, side * (apart - inner), ConeColour::Orange);
        }
    }
    track
}

/// A track with one more cone.
fn with_cone(mut track: ConeTrack, place: Point, colour: ConeColour) -> ConeTrack {
    track.cones.push(Cone::new(place, colour));
    track
}

/// A line with a constant profile, which `change` may spoil.
fn tracker(
    points: Vec<Point>,
    closed: bool,
    change: impl FnOnce(&mut SpeedProfile, &mut LineTrackerParameters),
) -> Option<LineTracker> {
    let number = points.len();
    let (speeds, curvatures, lengths) = (vec![5.0; number], vec![0.1; number], vec![1.0; number]);
    let mut profile = SpeedProfile { speeds, curvatures, lengths, lap_time: 10.0 };
    let mut parameters = LineTrackerParameters::rolling();
    change(&mut profile, &mut parameters);
    LineTracker::new(points, profile, closed, parameters).ok()
}

samples! {
    Corridor => [
        Corridor::closed(&ring(60, 20.0, 2.0)).ok()?, Corridor::open(&ring(60, 20.0, 2.0)).ok()?,
        Corridor::closed(&ring(5, 1.0, 3.0)).ok()?, Corridor::open(&ring(2, 1e3, 1e-3)).ok()?
    ];
    ConeTrack => [
        strip(1.5, Pose::new(-2.45, 0.0, 0.0)), skidpad(Pose::new(-17.0, 0.0, 0.0)), ConeTrack::default(),
        strip(1.5, Pose::new(-2.45, f64::NAN, 0.0)), strip(1.5, Pose::new(-2.45, 0.0, f64::INFINITY)),
        strip(1.5, Pose::new(-1e9, 0.0, 0.0)), skidpad(Pose::new(-1e9, 0.0, 0.0)),
        skidpad(Pose::new(-1e300, 0.0, 0.0)), skidpad(Pose::default()),
        with_cone(strip(1.5, Pose::new(-2.45, 0.0, 0.0)), Point::new(1e9, 1.5), ConeColour::Orange),
        with_cone(strip(1.5, Pose::new(-2.45, 0.0, 0.0)), Point::new(1e300, 1.5), ConeColour::Orange),
        with_cone(strip(1.5, Pose::new(-2.45, 0.0, 0.0)), Point::new(1e9, 1.5), ConeColour::BigOrange),
        with_cone(strip(1.5, Pose::new(-2.45, 0.0, 0.0)), Point::new(f64::NAN, f64::NAN), ConeColour::Orange),
        with_cone(skidpad(Pose::new(-17.0, 0.0, 0.0)), Point::new(1e9, 1.5), ConeColour::Orange),
        with_cone(skidpad(Pose::new(-17.0, 0.0, 0.0)), Point::new(f64::INFINITY, 0.0), ConeColour::Blue),
        ConeTrack { gates: vec![[Point::new(1e300, 0.0); 2]], ..strip(1.5, Pose::new(-2.45, 0.0, 0.0)) },
        ConeTrack { gates: vec![[Point::new(f64::NAN, 0.0); 2]], ..strip(1.5, Pose::new(-2.45, 0.0, 0.0)) },
        ConeTrack { start: None, ..strip(1.5, Pose::default()) }
    ];
    LineTracker => [
        tracker(circle(12, 5.0), true, |_, _| ())?,
        tracker(circle(12, 5.0), false, |_, _| ())?,
        tracker(circle(2, 5.0), true, |_, _| ())?,
        tracker(vec![Point::origin(); 3], true, |profile, _| profile.lengths = vec![0.0; 3])?,
        tracker(vec![Point::origin(); 2], false, |_, _| ())?,
        tracker(circle(12, 5.0), true, |profile, _| profile.lengths = Vec::new())?,
        tracker(circle(12, 5.0), true, |profile, _| profile.lengths = vec![-1.0; 12])?,
        tracker(circle(12, 5.0), true, |profile, _| profile.lengths = vec![f64::NAN; 12])?,
        tracker(circle(12, 5.0), true, |profile, _| profile.lengths = vec![1e-300; 12])?,
        tracker(circle(12, 5.0), true, |profile, _| profile.curvatures = Vec::new())?,
        tracker(circle(12, 5.0), true, |profile, _| profile.curvatures = vec![f64::INFINITY; 12])?,
        tracker(circle(12, 5.0), true, |profile, _| profile.speeds = vec![f64::NAN; 12])?,
        tracker(circle(12, 5.0), true, |profile, _| profile.speeds = vec![-1e300; 12])?,
        tracker(circle(12, 1e300), true, |_, _| ())?,
        tracker(vec![Point::new(f64::NAN, f64::NAN); 12], true, |_, _| ())?,
        tracker(circle(12, 5.0), true, |_, parameters| {
            (parameters.ahead, parameters.length, parameters.curvature) = (-1e3, 1e-300, 1e300);
        })?,
        tracker(circle(12, 5.0), true, |_, parameters| {
            (parameters.steering_lag, parameters.speed_lag, parameters.speed_time) = (1e3, 1e3, 1e3);
        })?,
        tracker(circle(12, 5.0), true, |_, parameters| {
            (parameters.drag_time, parameters.yaw, parameters.swing) = (1e3, 1e3, 1e3);
        })?
    ];
}

/// Whether the samples are what their names say.
#[cfg(test)]
mod tests {
    use super::*;
    use crate::Sample;
    use roverlab::race::{Event, EventCourse};

    #[test]
    fn tracks_are_of_events() {
        let outline = CarOutline::nth(0).unwrap();
        let event = |index| EventCourse::of(&ConeTrack::nth(index).unwrap(), &outline).unwrap().event();
        assert_eq!([event(0), event(1)], [Event::Acceleration, Event::Skidpad]);
    }
}
