use super::*;

const P: RowParameters =
    RowParameters { reach: 10.5, half_width: 1.8, narrowest: 1.4, loose: 0.8, sharpest: 1.9 };

fn best(cones: &[Cone], places: &[Pose], earlier: &[Passage], p: &RowParameters) -> Rows {
    rows(cones, places, earlier, p).swap_remove(0)
}

fn legs(cones: &[Cone], places: &[Pose], p: &RowParameters) -> Vec<[Point; 2]> {
    let rows = best(cones, places, &[], p);
    let leg = |pair: &[usize]| [cones[pair[0]].position, cones[pair[1]].position];
    rows.edges.iter().flat_map(|edge| edge.windows(2).map(leg)).collect()
}

fn at(places: &[(f64, f64)]) -> Vec<Cone> {
    places.iter().map(|&(x, y)| Cone::unknown(Point::new(x, y))).collect()
}

fn is_leg(legs: &[[Point; 2]], a: (f64, f64), b: (f64, f64)) -> bool {
    legs.contains(&[Point::new(a.0, a.1), Point::new(b.0, b.1)])
}

#[test]
fn rows_go_on_where_a_cone_is_missing() {
    let cones =
        at(&[(0.0, 1.8), (4.0, 1.8), (12.0, 2.0), (0.0, -1.8), (4.0, -1.8), (8.0, -1.8), (12.0, -1.6)]);
    let found = legs(&cones, &[Pose::default()], &P);
    assert!(
        is_leg(&found, (4.0, 1.8), (12.0, 2.0)) && is_leg(&found, (8.0, -1.8), (12.0, -1.6)),
        "{found:?}"
    );
    assert_eq!(found.len(), 5);
}

#[test]
fn a_leg_costs_more_the_more_it_turns_and_the_longer_it_is() {
    let end = End { cone: Some(0), place: Point::new(0.0, -1.8), heading: 0.0, share: 0.85 };
    let cost = |x: f64, y: f64| end.cost_to(Point::new(x, y), 10.5);
    assert!(cost(4.0, -1.8) < cost(5.0, -1.8) && cost(4.0, -1.8) < cost(3.0, 0.8));
    assert_eq!(cost(10.6, -1.8), None);
    // The direction of a row that has just begun is unknown.
    assert_eq!(End { share: 1.0, ..end }.cost_to(Point::new(4.0, -1.8), 10.5), None);
    assert_eq!(End { cone: None, ..end }.cost_to(Point::new(4.0, -1.8), 10.5), None);
}

#[test]
fn a_cone_is_of_the_row_that_goes_on_with_it_when_another_one_ends() {
    // The left row ends, one cone of the right one is missing, and two false ones stand beside it.
    let left = [(-4.0, 2.2), (0.0, 2.2), (3.7, 2.2)];
    let right = [(-4.0, -2.2), (2.2, -2.2), (5.9, -2.2), (13.0, -2.0)];
    let others = [(2.6, -4.1), (-4.5, -5.0)];
    let cones = at(&[&left[..], &right[..], &others[..]].concat());
    let found = best(&cones, &[Pose::new(-4.0, 0.0, 0.0), Pose::default()], &[], &P);
    let sides = found.sides(cones.len());
    assert_eq!(sides[..6], [1, 1, 1, -1, -1, -1], "{found:?}");
    assert!(sides[6] >= 0 || found.edges[1].ends_with(&[6]), "{found:?}");
}

#[test]
fn an_edge_turns_by_a_right_angle_where_the_other_one_is_missing() {
    let left = [(-2.5, 2.2), (0.0, 2.2), (2.5, 2.2)];
    let right = [(-2.5, -2.2), (2.5, -2.2), (2.7, -4.8), (2.9, -7.4), (3.0, -10.0), (3.0, -12.6)];
    let cones = at(&[&left[..], &right[..]].concat());
    let found = best(&cones, &[Pose::new(-2.5, 0.0, 0.0), Pose::default()], &[], &P);
    assert_eq!(found.edges[1], [3, 4, 5, 6, 7, 8], "{found:?}");
}

#[test]
fn readings_contradict_each_other_and_the_best_is_the_first() {
    let cones = at(&[
        (0.0, 1.8),
        (4.0, 1.8),
        (8.0, 1.8),
        (0.0, -1.8),
        (4.0, -1.8),
        (7.5, -3.0),
        (9.5, -5.5),
        (12.0, 0.0),
        (12.0, 3.0),
    ]);
    let found = rows(&cones, &[Pose::default()], &[], &P);
    assert!((2..=READINGS).contains(&found.len()), "{found:?}");
    assert!(found.is_sorted_by(|a, b| a.worth >= b.worth));
    for (at, one) in found.iter().enumerate() {
        for other in &found[..at] {
            let sides = [one, other].map(|rows| rows.sides(cones.len()));
            assert!((0..cones.len()).any(|cone| sides[0][cone] * sides[1][cone] < 0), "{one:?} {other:?}");
        }
    }
    assert_eq!(rows(&[], &[Pose::default()], &[], &P), [Rows { worth: -2.0, ..Rows::default() }]);
    assert_eq!(rows(&cones, &[], &[], &P), [Rows::default()]);
}

#[test]
fn a_row_that_ends_does_not_go_over_to_the_other_one() {
    // The left row ends; the right one continues across its direction, in a bend to the left.
    let right: Vec<(f64, f64)> = (0..8)
        .map(|k| 0.22 * f64::from(k))
        .map(|a| (13.0 * math::sin(a), 11.2 - 13.0 * math::cos(a)))
        .collect();
    let left = [(-2.8, 1.8), (0.0, 1.8), (2.7, 2.2)];
    let cones = at(&[&left[..], &right[..]].concat());
    let found = legs(&cones, &[Pose::new(-2.8, 0.0, 0.0), Pose::default()], &P);
    let crosses = |[a, b]: &[Point; 2]| left.contains(&(a.x, a.y)) && right.contains(&(b.x, b.y));
    assert!(found.len() >= 8 && !found.iter().any(crosses), "{found:?}");
}

#[test]
fn an_inner_row_turns_on_one_cone() {
    // A hairpin to the right: four inner cones and one at the apex, nine outer ones.
    let inner = [(0.0, -1.8), (3.0, -2.0), (5.2, -4.0), (3.0, -6.0), (0.0, -6.2)];
    let outer = [
        (0.0, 1.8),
        (3.5, 1.8),
        (6.8, 1.0),
        (9.0, -1.2),
        (9.6, -4.0),
        (9.0, -6.8),
        (6.8, -9.0),
        (3.5, -9.8),
        (0.0, -9.8),
    ];
    let found = best(&at(&[&outer[..], &inner[..]].concat()), &[Pose::default()], &[], &P);
    assert_eq!(found.edges, [(0..9).collect::<Vec<_>>(), (9..14).collect()]);
}

#[test]
fn a_row_does_not_go_over_to_another_lane() {
    // A right-angle bend to the left; beyond its outer row, another lane crosses the car's direction.
    let left = [(-3.0, 1.8), (0.0, 1.8), (2.0, 3.4), (2.2, 6.5), (2.2, 9.5)];
    let right = [(-3.0, -1.8), (0.0, -1.8), (3.0, -1.2), (5.4, 1.2), (6.0, 4.2), (6.0, 7.2), (6.0, 10.2)];
    let other = [
        (9.0, -9.0),
        (9.0, -5.5),
        (9.2, -2.0),
        (9.5, 1.5),
        (9.5, 5.0),
        (13.0, -5.5),
        (13.0, -2.0),
        (13.2, 1.5),
    ];
    let cones = at(&[&left[..], &right[..], &other[..]].concat());
    let found = best(&cones, &[Pose::new(-3.0, 0.0, 0.0), Pose::default()], &[], &P);
    // At their ends, rows may be wrong.
    assert!(found.edges[0].starts_with(&[0, 1, 2, 3, 4]), "{found:?}");
    assert!(found.edges[1].starts_with(&[5, 6, 7, 8, 9, 10]), "{found:?}");
    assert_eq!(found.sides(cones.len())[..10], [1, 1, 1, 1, 1, -1, -1, -1, -1, -1]);
}

#[test]
fn ways_pass_through_legs() {
    let leg = [Point::new(2.0, -1.0), Point::new(2.0, 3.0)];
    assert!(passes([Point::origin(), Point::new(4.0, 0.5)], leg));
    assert!(!passes([Point::origin(), Point::new(1.5, 0.0)], leg));
    assert!(!passes([Point::origin(), Point::new(4.0, -3.0)], leg));
}

#[test]
fn no_row_leads_back_by_the_way_the_car_came_earlier() {
    // A lane that ends where another one comes from the right.
    let before = [(0.0, 1.8), (4.0, 1.8), (8.0, 1.8), (0.0, -1.8), (4.0, -1.8)];
    let aside = [(6.2, -4.0), (6.2, -8.0), (9.8, -1.0), (9.8, -4.0), (9.8, -8.0)];
    let cones = at(&[&before[..], &aside[..]].concat());
    // The car came along that one.
    let upwards = |k| Pose::new(8.0, f64::from(k) * 2.0 - 12.0, 0.5 * std::f64::consts::PI);
    let earlier: Vec<Passage> = (0..7).map(|k| upwards(k).into()).collect();
    let last = |earlier: &[Passage]| {
        let found = best(&cones, &[Pose::default()], earlier, &P);
        found.edges.iter().flatten().map(|&cone| cones[cone].position.y).fold(0.0, f64::min)
    };
    assert!(last(&[]) < -7.0 && last(&earlier) > -5.0, "{} {}", last(&[]), last(&earlier));
    assert!(leads_back(Pose::new(8.5, -5.0, -1.6).into(), &earlier, 1.8));
    // Allowed: the same direction again, across it, and beside it.
    for pose in [Pose::new(8.5, -5.0, 1.6), Pose::new(8.0, -5.0, 0.0), Pose::new(11.4, -5.0, -1.6)] {
        assert!(!leads_back(pose.into(), &earlier, 1.8), "{pose:?}");
    }
}
