//! The parts of a race: tracks and their files, the lane between cones, the centre line, the racing line and
//! its speeds.

use roverlab::geometry::{Point, Pose};
use roverlab::io::Result;
use roverlab::kinematics::{Displacement, advance};
use roverlab::race::{
    CarLimits, CentreLine, CentreLineParameters, ClosedSpline, Cone, ConeColour, Corridor, EventCourse,
    GripLimit, LaneFinder, LaneParameters, LineTracker, LineTrackerParameters, RacerParameters,
    RacingLineParameters, SpeedProfile, TrackFile, TrackOptions, Tyres, generate, lined, minimum_curvature,
    parse_track, write_eufs, write_fssim, write_tum,
};

use super::races::{skidpad, strip};
use super::{Scenario, note, other};

pub(super) const SCENARIOS: &[Scenario] = &[
    Scenario::new("track-generator", generator),
    Scenario::new("track-files", files),
    Scenario::new("centre-line", centre_line),
    Scenario::new("racing-line", racing_line),
    Scenario::new("tyres", tyres),
    Scenario::new("lane-finder", lane_finder),
    Scenario::new("line-tracker", line_tracker),
];

fn note_corridor(log: &mut String, corridor: &Corridor) {
    note(log, "corridor", &(corridor.is_closed(), corridor.length()));
    for station in corridor.stations() {
        note(log, "station", &(station.position, station.normal, station.left, station.right));
    }
}

fn generator() -> Result<String> {
    let mut log = String::new();
    for seed in 50..53 {
        let generated = generate(seed, &TrackOptions::drawn(seed)).map_err(other)?;
        note(&mut log, "start", &(generated.track.start_pose(), &generated.track.gates));
        note(&mut log, "cones", &generated.track.cones);
        note_corridor(&mut log, &generated.corridor);
        if seed == 50 {
            let lined = lined(&generated.corridor, 4.0).map_err(other)?;
            note(&mut log, "lined", &(lined.track.start_pose(), lined.track.cones));
        }
    }
    Ok(log)
}

/// Every format read, printed, and read again.
fn files() -> Result<String> {
    let mut log = String::new();
    for (name, text) in [
        ("oval.csv", include_str!("../../data/cones/oval.csv")),
        ("oval.yaml", include_str!("../../data/cones/oval.yaml")),
        ("oval_tum.csv", include_str!("../../data/cones/oval_tum.csv")),
        ("oval_line.csv", include_str!("../../data/cones/oval_line.csv")),
        ("log.json", include_str!("../../data/cones/log.json")),
        ("broken.csv", include_str!("../../data/cones/broken.csv")),
    ] {
        match parse_track(text, name) {
            Ok(TrackFile::Cones(track)) => {
                note(&mut log, name, &(track.event(), track.start_pose(), &track.cones));
                for written in [write_eufs(&track), write_fssim(&track)] {
                    log += &written;
                    note(&mut log, "again", &parse_track(&written, name).map_err(other)?);
                }
            }
            Ok(TrackFile::Corridor(corridor)) => {
                note_corridor(&mut log, &corridor);
                log += &write_tum(&corridor);
            }
            Ok(file) => note(&mut log, name, &file),
            Err(error) => note(&mut log, name, &error.to_string()),
        }
    }
    Ok(log)
}

/// With the cones' colours, without them, and along a way that was driven.
fn centre_line() -> Result<String> {
    let generated = generate(51, &TrackOptions::drawn(51)).map_err(other)?;
    let start = generated.track.start_pose().unwrap_or_default();
    let parameters = CentreLineParameters::default();
    let plain: Vec<Cone> = generated.track.cones.iter().map(|cone| Cone::unknown(cone.position)).collect();
    let gappy: Vec<Cone> =
        plain.iter().enumerate().filter(|(k, _)| k % 9 != 4).map(|(_, cone)| *cone).collect();
    let mut log = String::new();
    for cones in [&generated.track.cones, &plain, &gappy] {
        let line = CentreLine::from_cones(cones, start, &parameters).map_err(other)?;
        note(&mut log, "edges", &(&line.left, &line.right));
        note_corridor(&mut log, &line.corridor);
    }
    let way: Vec<Point> = generated.corridor.stations().iter().map(|station| station.position).collect();
    match CentreLine::along(&plain, start, &way, &parameters) {
        Ok(line) => note_corridor(&mut log, &line.corridor),
        Err(error) => note(&mut log, "along", &error),
    }
    Ok(log)
}

/// The line of least curvature on two tracks and around the courses of events, with the speeds of three
/// models of grip.
fn racing_line() -> Result<String> {
    let outline = RacerParameters::default().outline;
    let limits = RacerParameters::default().limits;
    let ellipse = CarLimits { grip: GripLimit::Ellipse { across: 5.0, turned: 1.0, along: 5.0 }, ..limits };
    let mut log = String::new();
    for seed in [52, 53] {
        let corridor = generate(seed, &TrackOptions::drawn(seed)).map_err(other)?.corridor;
        let corridor = corridor.resampled(1.5).map_err(other)?;
        let line = minimum_curvature(&corridor, &RacingLineParameters::default()).map_err(other)?;
        note(&mut log, "line", &(line.bending_energy, line.iterations, &line.points, &line.offsets));
        let spline = ClosedSpline::through(&line.points).map_err(other)?;
        note(&mut log, "spline", &(spline.length(), spline.bending_energy(), spline.resample(10.0)));
        for limits in [limits, ellipse, CarLimits::circle(10.0, 5.0, 8.0, 30.0)] {
            let profile = SpeedProfile::closed(&line.points, &limits).map_err(other)?;
            note(&mut log, "lap", &(profile.lap_time, &profile.speeds, &profile.curvatures));
            let profile = SpeedProfile::open(&line.points, &limits, 3.0, 0.0).map_err(other)?;
            note(&mut log, "once", &(profile.lap_time, &profile.speeds));
        }
    }
    for track in [strip(), skidpad()] {
        let Some(course) = EventCourse::of(&track, &outline) else { continue };
        note(&mut log, "event", &(course.event(), course.layout(), course.timed()));
        note(&mut log, "optima", &course.optima(&limits, &outline));
        note_corridor(&mut log, course.corridor());
    }
    Ok(log)
}

/// What is left of the grip along the way, by how much there is across it.
fn tyres() -> Result<String> {
    let tyres = Tyres::default();
    let ellipse = GripLimit::Ellipse { across: 5.0, turned: 1.0, along: 4.0 };
    let mut log = String::new();
    for (curvature, across) in [(0.0, 0.0), (0.02, 3.0), (0.1, 6.0), (0.2, 9.0), (-0.3, 10.5)] {
        note(&mut log, "slips", &(tyres.slips(across, 1.0), tyres.left_along(curvature, across)));
        note(&mut log, "steering", &tyres.steering(curvature, across, -2.0));
        for hold in [ellipse, GripLimit::Balance(tyres)] {
            let along = (hold.forwards(curvature, across, 8.0), hold.backwards(curvature, across, 9.0));
            note(&mut log, "hold", &(hold.across(curvature, 5.0), along));
        }
    }
    Ok(log)
}

/// The lane that a car sees ahead on its way round a track, with cones that have no colours and some that are
/// missing.
fn lane_finder() -> Result<String> {
    let generated = generate(54, &TrackOptions::drawn(54)).map_err(other)?;
    let cones: Vec<Cone> = generated
        .track
        .cones
        .iter()
        .enumerate()
        .filter(|(k, _)| k % 11 != 7)
        .map(|(k, cone)| if k % 3 == 0 { *cone } else { Cone::unknown(cone.position) })
        .collect();
    let stations = generated.corridor.stations();
    let mut finder = LaneFinder::new(LaneParameters::default())?;
    let mut log = String::new();
    for pair in stations.windows(2).take(60) {
        let ahead = pair[1].position - pair[0].position;
        let car = Pose::new(
            pair[0].position.x,
            pair[0].position.y,
            roverlab::geometry::math::atan2(ahead.y, ahead.x),
        );
        let near: Vec<Cone> = cones
            .iter()
            .copied()
            .filter(|cone| {
                (cone.position - car.position()).norm() < 18.0 && car.to_local(cone.position).x > -3.0
            })
            .collect();
        match finder.step(car, &near) {
            Some(lane) => note(&mut log, "lane", &(car, &lane.points, &lane.edges, lane.half_width)),
            None => note(&mut log, "no lane", &car),
        }
    }
    note(&mut log, "sides", &ConeColour::ALL.map(|colour| (colour.side(), colour.radius(), colour.height())));
    Ok(log)
}

/// A car that does as it is told, along a racing line from beside it.
fn line_tracker() -> Result<String> {
    let corridor = generate(55, &TrackOptions::drawn(55)).map_err(other)?.corridor;
    let line = minimum_curvature(&corridor, &RacingLineParameters::default()).map_err(other)?;
    let limits = RacerParameters::default().limits;
    let profile = SpeedProfile::closed(&line.points, &limits).map_err(other)?;
    let mut log = String::new();
    for parameters in [LineTrackerParameters::default(), LineTrackerParameters::rolling()] {
        let mut tracker = LineTracker::new(line.points.clone(), profile.clone(), true, parameters)?;
        let ahead = line.points[1] - line.points[0];
        let heading = roverlab::geometry::math::atan2(ahead.y, ahead.x);
        let mut pose =
            Pose::new(line.points[0].x, line.points[0].y, heading).compose(&Pose::new(0.0, 0.4, 0.05));
        let mut moving = roverlab::geometry::Twist::STOP;
        for step in 0..400 {
            let Some((command, aside)) = tracker.step(pose, moving) else { break };
            moving = command;
            pose = advance(pose, Displacement { length: 0.05 * moving.linear, angle: 0.05 * moving.angular });
            if step % 4 == 0 {
                let way = tracker.distance_to(pose.to_world(Point::new(9.0, 0.3)), 2.0, 30.0);
                note(&mut log, "step", &(command, aside, pose, way));
            }
        }
    }
    Ok(log)
}
