use roverlab::ParameterError;
use roverlab::geometry::{Point, Pose, direction};
use roverlab::race::{
    CarLimits, CarOutline, CentreLine, CentreLineParameters, Cone, ConeMap, ConeMapParameters, Corridor,
    EventParameters, EventRacer, GapDriver, GripLimit, LaneFinder, LaneParameters, LineTracker,
    LineTrackerParameters, Racer, RacerParameters, RacingLineParameters, SpeedProfile, TrackOptions, Tyres,
    generate, minimum_curvature,
};
use roverlab::world::RobotSpec;

use crate::check::{check, check_variant, ends};

fn cones() -> Vec<Cone> {
    let edge = |y: f64| (0..6).map(move |k| Cone::unknown(Point::new(3.0 * f64::from(k), y)));
    edge(1.6).chain(edge(-1.6)).collect()
}

fn ring(radius: f64) -> Vec<Point> {
    (0..60)
        .map(|k| Point::origin() + direction(std::f64::consts::TAU * f64::from(k) / 60.0) * radius)
        .collect()
}

#[test]
fn a_racer_refuses_what_it_drove_with_for_ever() {
    let good = RacerParameters::default;
    let fast = |top_speed| CarLimits { top_speed, ..good().limits };
    let refused = |parameters| -> ParameterError { Racer::new(parameters).unwrap_err() };
    let error = refused(RacerParameters { period: f64::NAN, ..good() });
    assert_eq!(error.to_string(), "control period is NaN; expected a positive, finite number");
    let error = refused(RacerParameters { period: 0.0, ..good() });
    assert_eq!((error.name(), error.value()), ("control period", 0.0));
    let error = refused(RacerParameters { limits: fast(-3.0), ..good() });
    assert_eq!((error.name(), error.value()), ("limits: top speed", -3.0));
    let error = roverlab::io::Error::from(error);
    assert_eq!(error.kind(), roverlab::io::ErrorKind::InvalidInput);
}

#[test]
fn racers() {
    let racer = RacerParameters::default;
    check!(RacerParameters = racer(), |p| ends(RobotSpec::s4(), Racer::new(p)?),
        { AnyCount: laps; Positive: period; } but limits, first_lap, outline, centre_line, map, lane, tracker);
    check!(CarLimits = racer().limits, |p| ends(RobotSpec::s4(), Racer::new(RacerParameters { limits: p, ..racer() })?),
        { Positive: drive, brake, top_speed; Above: turning; } but grip);
    check!(CarLimits = racer().first_lap, |p| Racer::new(RacerParameters { first_lap: p, ..racer() })?,
        { Positive: drive, brake, top_speed; Above: turning; } but grip);
    check!(Tyres = Tyres::default(), |p| {
            let limits = CarLimits { grip: GripLimit::Balance(p), ..racer().limits };
            Racer::new(RacerParameters { limits, ..racer() })?;
            let _ = SpeedProfile::closed(&ring(9.0), &limits)?;
        },
        { Positive: grip, front, wheelbase; Above: stiffness; Bounded: lock; });
    check!(CarOutline = racer().outline, |p| Racer::new(RacerParameters { outline: p, ..racer() })?,
        { Positive: half_width; Finite: nose, ahead; NotNegative: room; });
    check!(EventParameters = EventParameters::default(), |p| {
            EventRacer::skidpad(p)?;
            ends(RobotSpec::s4(), EventRacer::acceleration(p)?);
        },
        { Bounded: strip; Positive: entry, patience, period; BoundedFromZero: stop; } but limits, outline, map, tracker);
    check_variant!(GripLimit::Ellipse = GripLimit::Ellipse { across: 5.0, turned: 0.5, along: 5.0 },
        |p| Racer::new(RacerParameters { limits: CarLimits { grip: p, ..racer().limits }, ..racer() })?,
        { Positive: across, along; BoundedFromZero: turned; });
    for speed in [f64::NAN, -1.0, 0.0, 1e300] {
        assert!(GapDriver::with_speed(speed).is_err(), "{speed}");
    }
}

#[test]
fn maps() {
    check!(ConeMapParameters = ConeMapParameters::default(), |p| {
            let mut map = ConeMap::new(p)?;
            map.update(Pose::default(), &[]);
            map.update(Pose::new(0.1, 0.0, 0.0), &[]);
            Racer::new(RacerParameters { map: p, ..RacerParameters::default() })?;
        },
        { Positive: gate, farthest; AnyCount: confirmed; Finite: sensor; NotNegative: drift; });
}

#[test]
fn lanes() {
    check!(LaneParameters = LaneParameters::default(), |p| {
            let _ = LaneFinder::new(p)?.step(Pose::default(), &cones());
            Racer::new(RacerParameters { lane: p, ..RacerParameters::default() })?;
        },
        { Bounded: ahead, curvature, clearance, usual, loose, spacing, sharpest, half_width; });
}

#[test]
fn centre_lines() {
    check!(CentreLineParameters = CentreLineParameters::default(), |p| {
            p.validate()?;
            let _ = CentreLine::from_cones(&cones(), Pose::default(), &p);
            Racer::new(RacerParameters { centre_line: p, ..RacerParameters::default() })?;
        },
        { Bounded: width, spacing, horizon, step; FromZero: colour, shortest_loop; });
}

#[test]
fn followed_lines() {
    let profile = SpeedProfile::closed(&ring(9.0), &RacerParameters::default().limits).unwrap();
    check!(LineTrackerParameters = LineTrackerParameters::default(), |p| {
            let mut tracker = LineTracker::new(ring(9.0), profile.clone(), true, p)?;
            let _ = tracker.step(Pose::new(9.0, 0.0, 1.6), roverlab::geometry::Twist::new(3.0, 0.3));
        },
        { AroundZero: ahead; Bounded: length; Positive: curvature;
          BoundedFromZero: length_by_speed, steering_lag, speed_lag, speed_time, drag_time, yaw, swing; } but tyres);
}

#[test]
fn racing_lines_and_tracks() {
    let rows: Vec<_> = ring(12.0).into_iter().map(|place| (place, 2.0, 2.0)).collect();
    let corridor = Corridor::closed(&rows).unwrap();
    check!(RacingLineParameters = RacingLineParameters::default(), |p| {
            p.validate()?;
            let _ = minimum_curvature(&corridor, &p);
        },
        { NotNegative: margin; AnyCount: iterations; Positive: tolerance; });
    check!(TrackOptions = TrackOptions::default(), |p| generate(3, &p)?,
        { Bounded: length, width, spacing, radius; CountUpTo: hairpins; });
}
