use super::*;
use crate::geometry::math;
use crate::race::landmark::SURE;

fn sighting(x: f64, y: f64) -> ConeSighting {
    let position = Point::new(x, y);
    let range = position.coords.norm();
    let colour = ConeColour::Unknown;
    ConeSighting { position, size: 0.1, confidence: 1.0, range, error: 0.03, colour }
}

/// Updates a map several times from one pose.
fn seen(map: &mut ConeMap, from: Pose, looks: usize, places: &[(f64, f64)]) {
    let sightings: Vec<ConeSighting> = places.iter().map(|&(x, y)| sighting(x, y)).collect();
    (0..looks).for_each(|_| map.update(from, &sightings));
}

#[test]
fn two_things_in_one_scan_are_two_cones() {
    let mut map = ConeMap::new(ConeMapParameters::default()).unwrap();
    seen(&mut map, Pose::default(), 10, &[(6.0, 1.5), (6.6, 1.5), (6.0, -1.5), (6.0, -1.3)]);
    // The last one is too close to its neighbour to be another cone.
    assert_eq!(map.cones().count(), 3);
}

#[test]
fn what_has_no_colour_among_cones_that_have_one_is_none_of_them() {
    let pale = |x, y| ConeSighting { confidence: 0.0, ..sighting(x, y) };
    let blue = |x, y| ConeSighting { colour: ConeColour::Blue, ..sighting(x, y) };
    let after = |looks: usize, sightings: &[ConeSighting]| {
        let mut map = ConeMap::new(ConeMapParameters::default()).unwrap();
        (0..looks).for_each(|_| map.update(Pose::default(), sightings));
        let places: Vec<f64> = map.cones().map(|cone| cone.position.x).collect();
        assert_eq!(places.len(), map.fresh_cones().count());
        places
    };
    let painted = [blue(5.0, 1.5), blue(6.5, 1.5), blue(8.0, 1.5), blue(9.5, 1.5), sighting(13.0, 1.5)];
    let mixed = [&painted[..], &[pale(6.0, 3.0)]].concat();
    assert_eq!(after(20, &mixed), [5.0, 6.5, 8.0, 9.5, 13.0]);
    // If only few cones have a colour, its absence means nothing.
    assert_eq!(after(20, &[pale(5.0, 1.5), pale(6.0, 3.0), blue(8.0, 1.5)]), [5.0, 6.0, 8.0]);
}

#[test]
fn what_has_no_colour_is_not_driven_into_and_a_known_cone_keeps_its_colour() {
    let painted = |x| ConeSighting { colour: ConeColour::Blue, ..sighting(x, 1.5) };
    let pale = |seen: ConeSighting| ConeSighting { confidence: 0.0, colour: ConeColour::Unknown, ..seen };
    let mut map = ConeMap::new(ConeMapParameters::default()).unwrap();
    let row = [painted(5.0), painted(6.5), painted(8.0), painted(9.5)];
    let seen = [&row[..], &[pale(sighting(6.0, 3.0))]].concat();
    (0..20).for_each(|_| map.update(Pose::default(), &seen));
    let others: Vec<Point> = map.fresh_others().collect();
    assert!(others.len() == 1 && (others[0] - Point::new(6.0, 3.0)).norm() < 0.01, "{others:?}");
    // A camera that fails later removes none of them.
    let dark: Vec<ConeSighting> = seen.into_iter().map(pale).collect();
    (0..200).for_each(|_| map.update(Pose::default(), &dark));
    assert_eq!(map.cones().count(), 4);
}

#[test]
fn what_is_hidden_is_not_forgotten() {
    for (hidden, left) in [(true, 2), (false, 1)] {
        let mut map = ConeMap::new(ConeMapParameters::default()).unwrap();
        seen(&mut map, Pose::default(), 10, &[(5.0, 1.0), (8.0, 1.9)]);
        // From there, the first one hides the second, or not.
        let before = if hidden { (5.0, 1.0) } else { (5.0, -1.0) };
        seen(&mut map, Pose::default(), 20, &[before]);
        let stays = map.cones().filter(|cone| (cone.position - Point::new(8.0, 1.9)).norm() < 0.1).count();
        assert_eq!(stays + 1, left, "{hidden}");
    }
}

#[test]
fn what_a_car_hides_is_not_forgotten() {
    let mut map = ConeMap::new(ConeMapParameters::default()).unwrap();
    seen(&mut map, Pose::default(), 10, &[(5.0, 1.9), (8.0, -0.6)]);
    // The second one is hidden behind the right end of the car.
    let car = ConeSighting { size: 1.4, ..sighting(6.0, 0.0) };
    (0..20).for_each(|_| map.update(Pose::default(), &[sighting(5.0, 1.9), car]));
    assert_eq!(map.cones().count(), 2);
    // The car is gone, and so is the cone.
    seen(&mut map, Pose::default(), 20, &[(5.0, 1.9)]);
    assert_eq!(map.cones().count(), 1);
}

#[test]
fn cones_that_were_passed_before_tell_their_edge() {
    let mut map = ConeMap::new(ConeMapParameters::default()).unwrap();
    seen(&mut map, Pose::default(), 10, &[(6.0, -1.5)]);
    let place = map.cones().next().unwrap().position;
    (0..SURE).for_each(|_| map.vote_side([place].into_iter(), -1));
    // A loop with nothing in sight, back past its other end, with a small error.
    for step in 1..=40 {
        let angle = 0.157 * f64::from(step);
        map.update(Pose::new(8.0 * math::sin(angle), 8.0 - 8.0 * math::cos(angle), angle), &[]);
    }
    let back = map.pose();
    seen(&mut map, Pose::new(0.0, 0.0, 0.0), 10, &[(6.4, -1.0)]);
    assert!(map.way > FRESH, "{back:?}");
    let found: Vec<Cone> = map.fresh_cones().collect();
    assert!(found.len() == 1 && found[0].colour == ConeColour::Yellow, "{found:?}");
    assert!(!map.is_closed());
}

#[test]
fn a_short_lap_closes_of_itself() {
    let mut map = ConeMap::new(ConeMapParameters::default()).unwrap();
    seen(&mut map, Pose::default(), 10, &[(6.0, 1.5), (6.0, -1.5)]);
    assert!(map.close() && map.is_closed() && map.cones().count() == 2);
}

#[test]
fn of_a_short_lap_that_was_driven_again_one_is_left() {
    for laps in [1.3, 1.7, 2.4] {
        let mut map = ConeMap::new(ConeMapParameters::default()).unwrap();
        let at = |angle: f64| Pose::new(3.0 * math::sin(angle), 3.0 - 3.0 * math::cos(angle), angle);
        let cone = Point::new(0.0, 7.7);
        for step in 0..=(laps * 80.0) as u32 {
            let pose = at(f64::from(step) * std::f64::consts::TAU / 80.0);
            let local = pose.to_local(cone);
            map.update(pose, &[sighting(local.x, local.y)]);
        }
        assert!(map.close(), "{laps}");
        let trail: Vec<Point> = map.trail().map(|pose| pose.position()).collect();
        let n = trail.len();
        let legs: Vec<f64> = (0..n).map(|i| (trail[(i + 1) % n] - trail[i]).norm()).collect();
        assert!(legs.iter().all(|leg| (0.5..2.5 * STRIDE).contains(leg)), "{laps}: {legs:?}");
        // Slightly shorter than the circle, because of the chords.
        assert!((15.0..18.9).contains(&legs.iter().sum::<f64>()), "{laps}: {legs:?}");
    }
}

/// Pose on the centre line of a stadium (two straights, two half circles), at a distance from the middle of a
/// straight.
fn on_stadium(along: f64) -> Pose {
    const STRAIGHT: f64 = 120.0;
    const RADIUS: f64 = 20.0;
    let half = STRAIGHT + std::f64::consts::PI * RADIUS;
    let (turns, along) = ((along / half).floor(), along.rem_euclid(half));
    let within = if along < 0.5 * STRAIGHT {
        Pose::new(along, 0.0, 0.0)
    } else if along < half - 0.5 * STRAIGHT {
        let angle = (along - 0.5 * STRAIGHT) / RADIUS;
        Pose::new(0.5 * STRAIGHT + RADIUS * math::sin(angle), RADIUS - RADIUS * math::cos(angle), angle)
    } else {
        Pose::new(half - along, 2.0 * RADIUS, std::f64::consts::PI)
    };
    let turned = if turns.rem_euclid(2.0) > 0.5 { std::f64::consts::PI } else { 0.0 };
    Pose::new(0.0, RADIUS, turned).compose(&Pose::new(0.0, -RADIUS, 0.0)).compose(&within)
}

#[test]
fn a_lap_that_begins_later_closes_as_well() {
    let lap = 2.0 * (120.0 + std::f64::consts::PI * 20.0);
    let cones: Vec<Point> = (0..73)
        .map(|k| on_stadium(lap / 73.0 * f64::from(k) + 0.8 * math::sin(1.7 * f64::from(k))))
        .flat_map(|pose| [2.0, -2.0].map(|y| pose.to_world(Point::new(0.0, y))))
        .collect();
    // On the far half of the first bend, of the second one, and of the first one a lap later.
    for past in [80.0, 260.0, 440.0] {
        let mut map = ConeMap::new(ConeMapParameters::default()).unwrap();
        let mut along = 0.0;
        while along < lap + past {
            let car = on_stadium(along);
            let ahead = cones.iter().map(|cone| car.to_local(*cone));
            let near = ahead.filter(|place| place.x > 0.0 && place.coords.norm() < 15.0);
            let sightings: Vec<ConeSighting> = near.map(|place| sighting(place.x, place.y)).collect();
            (0..3).for_each(|_| map.update(car, &sightings));
            along += 1.0;
        }
        // Less than the fresh distance is no lap.
        map.begin_later(FRESH);
        map.begin_later(-1.0);
        assert!(
            map.trail().next().is_some_and(|pose| pose.position().coords.norm() < 2.0 * STRIDE),
            "{past}"
        );
        map.begin_later(lap + 15.0);
        assert!(map.close(), "{past}");
        let off = on_stadium(along - 1.0).to_local(map.pose().position());
        assert!(off.coords.norm() < 0.1, "{past}: {off}");
        assert!(map.cones().count() <= cones.len(), "{past}: {}", map.cones().count());
        let trail: Vec<Point> = map.trail().map(|pose| pose.position()).collect();
        let n = trail.len();
        let around: f64 = (0..n).map(|i| (trail[(i + 1) % n] - trail[i]).norm()).sum();
        assert!((around - lap).abs() < 5.0, "{past}: {around}");
    }
}
