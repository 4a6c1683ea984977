use super::*;

fn known(cones: &[Cone]) -> Lane {
    let p = LaneParameters::default();
    let mut found = Lane::unknown(p.usual);
    // The width is learnt step by step.
    for _ in 0..20 {
        found = lane(cones, &[], Pose::default(), &found, &p).unwrap();
    }
    found
}

fn row(side: f64, places: impl Iterator<Item = u32>) -> Vec<Cone> {
    places.map(|k| Cone::unknown(Point::new(3.0 * f64::from(k), side))).collect()
}

#[test]
fn one_edge_is_enough() {
    let both = [row(1.6, 0..8), row(-1.6, 0..8)].concat();
    let found = known(&both);
    // At its end, a path may turn to have one more cone beside it.
    let beyond = |point: &Point| point.y.abs() > if point.x < 10.5 { 0.02 } else { 0.1 };
    assert!(!found.points.iter().any(beyond), "{found:?}");
    // Up to the look-ahead distance of 17.5 m.
    assert_eq!((found.edges[0].len(), found.edges[1].len()), (6, 6));
    // The left edge ends after six metres; two false cones stand beside the right one.
    let mut cones = [row(1.6, 0..3), row(-1.6, 0..8)].concat();
    cones.extend([Point::new(8.0, -3.0), Point::new(13.0, -3.4)].map(Cone::unknown));
    let found = known(&cones);
    assert!(found.points.len() > 12 && found.points.iter().all(|p| p.y.abs() < 0.3), "{found:?}");
}

#[test]
fn a_cone_that_stands_in_the_lane_is_given_room() {
    let mut cones = [row(1.8, 0..8), row(-1.8, 0..8)].concat();
    cones[3].position.y = 1.1;
    let found = known(&cones);
    let nearest = found.points.iter().map(|p| (p - cones[3].position).norm()).fold(f64::INFINITY, f64::min);
    assert!(nearest > 1.3, "{nearest}: {found:?}");
}

#[test]
fn a_lane_does_not_go_around_the_end_of_a_row() {
    // The left row ends; the way back lies behind it. The right one turns right, where two cones stand
    // opposite; without them, the lane might as well go left, between the end of one row and nothing.
    let ends = [(-3.0, 2.1), (0.0, 2.1), (2.5, 2.6), (3.5, 3.4), (3.8, 4.2), (8.4, 0.0), (11.0, -0.4)];
    let turns = [(-3.0, -2.1), (0.0, -2.1), (2.6, -1.6), (4.5, -3.4), (7.0, -4.0), (9.6, -4.2)];
    let cones: Vec<Cone> =
        [&ends[..], &turns[..]].concat().iter().map(|&(x, y)| Cone::unknown(Point::new(x, y))).collect();
    let found = known(&cones);
    assert!(found.points.iter().all(|point| point.x > -3.0 && point.y < 1.5), "{found:?}");
    assert!(found.points.last().is_some_and(|last| last.x > 7.0), "{found:?}");
}

#[test]
fn there_is_no_lane_beside_a_row_of_known_cones() {
    let left = |cone: Cone| Cone::new(cone.position, crate::race::ConeColour::Blue);
    let cones: Vec<Cone> = row(1.8, 0..8).into_iter().map(left).collect();
    let found = known(&cones);
    assert!(found.points.iter().all(|point| point.y < 0.5), "{found:?}");
    assert!(lane(&[], &[], Pose::default(), &found, &LaneParameters::default()).is_none());
}

#[test]
fn parameters_out_of_their_ranges_find_no_lane() {
    let cones = [row(1.6, 0..6), row(-1.6, 0..6)].concat();
    let p = LaneParameters::default();
    let find = |p: LaneParameters, half_width: f64| {
        lane(&cones, &[], Pose::default(), &Lane::unknown(half_width), &p).is_some()
    };
    assert!(find(p, 1.9));
    let wrong = [
        LaneParameters { half_width: [2.8, 1.4], ..p },
        LaneParameters { half_width: [f64::NAN, 2.8], ..p },
        LaneParameters { ahead: f64::INFINITY, ..p },
        LaneParameters { loose: 0.0, ..p },
        LaneParameters { curvature: 0.0, ..p },
    ];
    assert!(!wrong.into_iter().any(|wrong| find(wrong, 1.9)) && !find(p, 0.0));
}

#[test]
fn where_the_car_was_a_lap_ago_does_not_matter() {
    let cones = [row(1.6, 0..6), row(-1.6, 0..6)].concat();
    let find = |behind: &[Pose]| {
        lane(&cones, behind, Pose::default(), &Lane::unknown(1.9), &LaneParameters::default()).unwrap()
    };
    let lately = [-4.0, -2.0].map(|x| Pose::new(x, 0.0, 0.0));
    let earlier = [Pose::new(-1.0, 0.1, 0.0), Pose::new(30.0, 9.0, 1.5), Pose::new(-40.0, 2.0, 0.0)];
    assert_eq!(find(&[&earlier[..], &lately].concat()), find(&lately));
}
