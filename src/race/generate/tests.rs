use super::*;

#[test]
fn a_course_that_crosses_itself_is_free_where_it_does() {
    let eight = (0..500).map(|i| {
        let angle = TAU * f64::from(i) / 500.0;
        (Point::new(80.0 * math::sin(angle), 30.0 * math::sin(2.0 * angle)), 4.0, 4.0)
    });
    let corridor = Corridor::closed(&eight.collect::<Vec<_>>()).unwrap().resampled(1.0).unwrap();
    let all = place_cones(&mut Stream::new(0), &corridor, &TrackOptions::default()).cones.len();
    let GeneratedTrack { track, corridor } = lined(&corridor, 5.0).unwrap();
    assert!(track.cones.iter().all(|cone| !is_on_track(cone.position, &corridor)));
    // The four edges end before the crossing, and nowhere else.
    assert!(track.cones.len() + 4 < all && track.cones.len() + 40 > all, "{} of {all}", track.cones.len());
}

/// Cones of an edge in order, beginning with the large one before the line.
fn edge_of(track: &ConeTrack, left: bool) -> Vec<Point> {
    let colour = if left { ConeColour::Blue } else { ConeColour::Yellow };
    let gate = track.of(ConeColour::BigOrange).skip(if left { 0 } else { 2 }).take(2);
    gate.chain(track.of(colour)).collect()
}

/// Maximum distance between adjacent cones of an edge (m).
fn widest_gap(track: &ConeTrack) -> f64 {
    let gaps = [true, false].into_iter().flat_map(|left| {
        let edge = edge_of(track, left);
        (0..edge.len()).map(move |i| (edge[(i + 1) % edge.len()] - edge[i]).norm())
    });
    gaps.fold(0.0, f64::max)
}

/// Maximum difference between the distance of two cones and that of their nominal positions (m).
const BESIDE: f64 = 0.142;

#[test]
fn drawn_tracks_are_legal() {
    let tracks = if cfg!(debug_assertions) { 40 } else { 1000 };
    for seed in 0..tracks {
        let options = TrackOptions::drawn(seed);
        let GeneratedTrack { track, corridor } = generate(seed, &options).unwrap();
        let length = corridor.length();
        assert!((200.0..=500.0).contains(&length), "{seed}: {length}");
        let stations = corridor.stations();
        let n = stations.len();
        for (i, station) in stations.iter().enumerate() {
            let width = station.left + station.right;
            assert!(width >= options.width[0] - 1e-9 && width <= options.width[1] + 1e-9, "{seed}: {width}");
            let around = [i + n - 1, i, i + 1].map(|k| stations[k % n].position);
            assert!(curvature(around).abs() <= 1.0 / options.radius, "{seed}: a bend at {i}");
        }
        let start = track.start.unwrap();
        for left in [true, false] {
            let edge = corridor.edge(left);
            for cone in edge_of(&track, left) {
                let nearest = edge.iter().map(|p| (p - cone).norm()).fold(f64::INFINITY, f64::min);
                assert!(nearest < 1.0, "{seed}: a cone {nearest} m off its edge");
                assert!(start.distance_to(cone) > 1.2);
            }
        }
        let widest = widest_gap(&track);
        assert!(widest <= options.spacing[1] + BESIDE, "{seed}: {widest} of {:?}", options.spacing);
    }
}

#[test]
fn edges_that_are_lined_have_no_gap() {
    for (radius, spacing) in (0..40).map(|k| (30.0 + 0.37 * f64::from(k), 0.5 + 0.15 * f64::from(k))) {
        let ring = (0..60).map(|i| {
            let arm = direction(TAU * f64::from(i) / 60.0);
            (Point::origin() + arm * radius, 3.0, 3.0)
        });
        let corridor = Corridor::closed(&ring.collect::<Vec<_>>()).unwrap();
        let widest = widest_gap(&lined(&corridor, spacing).unwrap().track);
        // The large cones themselves are one metre apart.
        assert!(widest <= spacing.max(2.0 * GATE) + BESIDE, "{widest} of {spacing}");
    }
}

#[test]
fn no_corridor_is_lined_that_is_too_short_or_too_long() {
    for (points, radius) in [(8, 0.75), (500, 90_000.0)] {
        let ring = (0..points).map(|i| {
            let arm = direction(TAU * f64::from(i) / f64::from(points));
            (Point::origin() + arm * radius, 0.5, 0.5)
        });
        let error = lined(&Corridor::closed(&ring.collect::<Vec<_>>()).unwrap(), 4.8).unwrap_err();
        assert!(error.to_string().ends_with("expected a closed corridor of 30 to 50000 m"), "{error}");
    }
    let strip: Vec<_> = (0..50).map(|i| (Point::new(f64::from(i), 0.0), 2.0, 2.0)).collect();
    assert!(lined(&Corridor::open(&strip).unwrap(), 4.8).is_err());
}

#[test]
fn seeds_differ_and_repeat() {
    let options = TrackOptions::default();
    let [a, again, b] = [1, 1, 2].map(|seed| generate(seed, &options).unwrap());
    assert!(a == again && a != b);
}

#[test]
fn hairpins_are_tight() {
    let options = TrackOptions { hairpins: 3, radius: 4.0, ..TrackOptions::default() };
    let tight = (0..20).filter(|&seed| {
        let corridor = generate(seed, &options).unwrap().corridor;
        let p: Vec<Point> = corridor.stations().iter().map(|s| s.position).collect();
        let n = p.len();
        (0..n).any(|i| curvature([p[(i + n - 2) % n], p[i], p[(i + 2) % n]]).abs() > 1.0 / 5.5)
    });
    assert!(tight.count() > 10);
}

#[test]
fn contradictions_are_named() {
    let options = TrackOptions { width: [6.0, 9.0], ..TrackOptions::default() };
    let error = generate(1, &options).unwrap_err();
    assert_eq!(error.to_string(), "radius is 4; expected more than half the width, up to 100 m");
    let options = TrackOptions { hairpins: usize::MAX, ..TrackOptions::default() };
    assert!(generate(1, &options).unwrap_err().to_string().ends_with("expected at most 20"));
}
