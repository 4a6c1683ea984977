//! Published files, and complete plans.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::PathBuf;

use super::*;
use crate::geometry::{Point, Pose, Segment, direction};

/// Published tracks of a kind, sorted by name.
fn files(folder: &str, ending: &str) -> Vec<PathBuf> {
    let data = std::env::var_os("ROVERLAB_DATA").expect("ROVERLAB_DATA names the folder of published data");
    let mut names: Vec<PathBuf> = std::fs::read_dir(PathBuf::from(data).join("tracks").join(folder))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == ending))
        .collect();
    names.sort();
    names
}

fn read(path: &std::path::Path) -> TrackFile {
    parse_track(&std::fs::read_to_string(path).unwrap(), &path.display().to_string()).unwrap()
}

fn name(path: &std::path::Path) -> String {
    path.file_stem().unwrap().to_string_lossy().into_owned()
}

#[test]
#[ignore = "needs published data: ROVERLAB_DATA=FOLDER .ci/run tests"]
fn published_cone_maps_have_a_way_between_their_cones() {
    let mut paths = files("fssim/fssim_gazebo/models/track/tracks_yaml", "yaml");
    paths.extend(files("eufs/eufs_tracks/csv", "csv"));
    let mut open = Vec::new();
    for path in &paths {
        let TrackFile::Cones(track) = read(path) else { panic!("{path:?} has no cones") };
        if track.event() != Event::Laps {
            continue;
        }
        let start = track.start_pose().unwrap();
        let cones: Vec<Cone> = track.cones.iter().map(|cone| Cone::unknown(cone.position)).collect();
        for (cones, how) in [(&track.cones, "colours"), (&cones, "blind")] {
            let line = CentreLine::from_cones(cones, start, &CentreLineParameters::default());
            if !line.as_ref().is_ok_and(|line| line.corridor.is_closed()) {
                let length = line.map(|line| line.corridor.length());
                open.push(format!("{} {how}: {length:?}", name(path)));
            }
        }
    }
    assert!(open.is_empty(), "{open:#?}");
}

#[test]
#[ignore = "needs published data: ROVERLAB_DATA=FOLDER .ci/run tests"]
fn published_circuits_bend_no_more_than_the_published_lines() {
    // That of the racing car, which is 1.4 m wide.
    const HALF_WIDTH: f64 = 0.7;
    let mut table = String::new();
    let mut worst = (0.0_f64, f64::INFINITY);
    for path in files("tum/tracks", "csv") {
        let TrackFile::Corridor(corridor) = read(&path) else { panic!("{path:?}") };
        let line = path.parent().unwrap().with_file_name("racelines").join(path.file_name().unwrap());
        let TrackFile::Line(published) = read(&line) else { panic!("{line:?}") };
        let parameters =
            RacingLineParameters { margin: HALF_WIDTH + 0.06, ..RacingLineParameters::default() };
        let fine = corridor.resampled(2.5).unwrap();
        let ours = minimum_curvature(&fine, &parameters).unwrap();
        let spline = ClosedSpline::through(&ours.points).unwrap();
        let theirs = ClosedSpline::through(&published).unwrap();
        let ratio = spline.bending_energy() / theirs.bending_energy();
        let n = published.len();
        let squares: f64 = spline
            .resample(1.0)
            .iter()
            .map(|p| {
                let away =
                    |i: usize| Segment::new(published[i], published[(i + 1) % n]).distance_to(p.position);
                let least = (0..n).map(away).fold(f64::INFINITY, f64::min);
                least * least
            })
            .sum();
        let rms = (squares / spline.resample(1.0).len() as f64).sqrt();
        // The spline itself, also between its points, keeps the car between both edges.
        let stations = fine.stations();
        let least = (0..stations.len())
            .flat_map(|i| (0..4).map(move |k| (i, 0.25 * f64::from(k))))
            .map(|(i, share)| {
                let place = spline.at(i, share).position;
                let (a, b) = (&stations[i], &stations[(i + 1) % stations.len()]);
                let mix = |a: f64, b: f64| a + (b - a) * share;
                let normal = (a.normal + (b.normal - a.normal) * share).normalize();
                let middle = a.position + (b.position - a.position) * share;
                let aside = (place - middle).dot(&normal);
                (mix(a.left, b.left) - aside).min(mix(a.right, b.right) + aside)
            })
            .fold(f64::INFINITY, f64::min);
        let _ = writeln!(
            table,
            "{:15} {:.5} {:.5} ratio {ratio:.4} rms {rms:.2} m, {least:.3} m to an edge, {} programs",
            name(&path),
            spline.bending_energy(),
            theirs.bending_energy(),
            ours.iterations
        );
        worst = (f64::max(worst.0, ratio), f64::min(worst.1, least));
    }
    eprint!("{table}");
    assert!(worst.0 <= 1.02 && worst.1 >= HALF_WIDTH, "{worst:?}");
}

#[test]
fn what_is_written_is_read_again() {
    for seed in 0..5 {
        let GeneratedTrack { track, corridor } = generate(seed, &TrackOptions::drawn(seed)).unwrap();
        let again = parse_fssim(&write_fssim(&track), "a.yaml").unwrap();
        for colour in ConeColour::ALL {
            assert!(track.of(colour).eq(again.of(colour)));
        }
        // The file contains the position of the front wing.
        let (start, before) = (again.start.unwrap(), track.start.unwrap());
        assert!((start.position() - before.position()).norm() < 1e-9 && start.heading == before.heading);
        assert_eq!(again.gates, track.gates);
        let again = parse_eufs(&write_eufs(&track), "a.csv").unwrap();
        assert_eq!((&again.cones, again.start), (&track.cones, track.start));
        let again = parse_tum(&write_tum(&corridor), "a.csv").unwrap();
        assert_eq!(again, corridor);
    }
}

#[test]
fn a_circuit_goes_around_once_and_in_order() {
    let row = |k: u32| {
        let place = direction(TAU * f64::from(k) / 200.0) * 60.0;
        format!("{},{},4,4\n", place.x, place.y)
    };
    let said = |order: &[u32]| {
        let text: String = order.iter().map(|&k| row(k)).collect();
        parse_tum(&format!("# x_m,y_m,w_tr_right_m,w_tr_left_m\n{text}"), "t")
            .map_err(|error| error.to_string())
    };
    let mut order: Vec<u32> = (0..200).collect();
    assert!(said(&order).is_ok_and(|ring| (ring.length() - 377.0).abs() < 0.5));
    let twice = said(&[order.clone(), order.clone()].concat()).unwrap_err();
    assert_eq!(twice, "t:1:1: found a line that goes around 2 times; expected one lap");
    order.swap(50, 55);
    let swapped = said(&order).unwrap_err();
    assert!(swapped.contains("found a line that turns back at ("), "{swapped}");
}

#[test]
fn the_wing_is_where_a_file_says() {
    let text = "cones_left:\n- [1, 2]\nstarting_pose_front_wing: [3.0, 4.0, 0.5]\n";
    let start = parse_fssim(text, "t").unwrap().start.unwrap();
    let wing = start.to_world(Point::new(2.15, 0.0));
    assert!((wing - Point::new(3.0, 4.0)).norm() < 1e-9 && start.heading == 0.5, "{start:?}");
}

#[test]
fn broken_files_are_told_where() {
    let eufs = "tag,x,y,direction,x_variance,y_variance,xy_covariance\n";
    let tum = "# x_m,y_m,w_tr_right_m,w_tr_left_m\n";
    for (text, message) in [
        (String::new(), "t:1:1: found the end of the file; expected keys with lists"),
        (
            format!("{eufs}pink,1,2,0"),
            "t:2:1: found `pink`; expected blue, yellow, orange, big_orange, unknown, car_start or midpoint",
        ),
        (format!("{eufs}blue,1"), "t:2:7: found the end of the line; expected a number of metres"),
        (format!("{eufs}blue,1,NaN,0"), "t:2:8: found `NaN`; expected a number of metres"),
        (format!("{eufs}blue,1,1e9,0"), "t:2:8: found `1e9`; expected a number of metres"),
        (
            format!("{eufs}car_start,0,0,0\ncar_start,0,0,0"),
            "t:3:1: found a second start; expected one start",
        ),
        (eufs.into(), "t:1:1: found no cones; expected at least one cone"),
        (
            "tag,x\n".into(),
            "t:1:1: found `tag`; expected the line tag,x,y,direction,x_variance,y_variance,xy_covariance",
        ),
        (format!("{tum}1,2,3\n"), "t:2:6: found the end of the line; expected a number of metres"),
        (format!("{tum}1,2,3,4,5\n"), "t:2:9: found `5`; expected the end of the line"),
        (format!("{tum}1,2,3,4\n"), "t:1:1: found 1 points; expected at least 4 points"),
        (
            format!("{tum}0,0,1,1\n9,0,1,1\n9,9,-1,1\n0,9,1,1\n"),
            "t:4:1: found -1; expected a width to the right of more than 0, at most 100 m",
        ),
        (
            format!("{tum}0,0,1,1\n9,0,1,101\n9,9,1,1\n0,9,1,1\n"),
            "t:3:1: found 101; expected a width to the left of more than 0, at most 100 m",
        ),
        (
            format!("{tum}0,0,1,1\n9,0,1,1\n9,0,1,1\n9,9,1,1\n0,9,1,1\n"),
            "t:1:1: found point 1 is no number or the same as its neighbour; expected distinct points; expected a closed centre line",
        ),
        (
            format!("{tum}0,0,1,1\n1,0,1,1\n2,0,1,1\n2,1,1,1\n1,1,1,1\n0,20,1,1\n"),
            "t:6:1: found a step of 19.0 m to the next point; \
             expected at most 10 times the usual step of 1.0 m",
        ),
        (
            "cones_left:\n- - 1.0\n  - here\n".into(),
            "t:3:5: found `here`; expected a number of metres or radians",
        ),
        ("cones_left:\n- 1.0\n".into(), "t:2:3: found `1.0`; expected a list of x and y"),
        ("cones_left:\n- [1, 2, 3]\n".into(), "t:2:10: found `3`; expected the end of the list"),
        ("cones_left: []\n".into(), "t:1:1: found no cones; expected at least one cone"),
        ("cones_left: 3\n".into(), "t:1:13: found `3`; expected a list"),
        ("- 3\n".into(), "t:1:1: found a list; expected keys with lists"),
        (
            "cones_left: [[1, 2]]\ntk_device: [[1, 2], [3, 4], [5, 6]]\n".into(),
            "t:2:1: found 3 points; expected two for each line",
        ),
        (
            "cones_left: []\ncones_left: []\n".into(),
            "t:2:1: found a second `cones_left`; expected each key once",
        ),
        (
            "starting_pose_front_wing: [1, 2]\n".into(),
            "t:1:1: found 2 numbers; expected x, y and the heading",
        ),
    ] {
        assert_eq!(parse_track(&text, "t").unwrap_err().to_string(), message);
    }
    let csv = "expected a line that begins with tag,x,y (EUFS), # x_m,y_m,w_tr_right_m,w_tr_left_m (TUM), or # x_m,y_m";
    for (text, file, found) in [
        ("", "a.csv", "a.csv:1:1: found an empty file; "),
        ("1,2,3,4\n", "t", "t:1:1: found `1,2,3,4`; "),
        ("x_m,y_m\n", "a.CSV", "a.CSV:1:1: found `x_m,y_m`; "),
    ] {
        let error = parse_track(text, file).unwrap_err().to_string();
        assert!(error.starts_with(&format!("{found}{csv}")), "{error}");
    }
    // The content of a file counts more than its name.
    assert!(parse_track("cones_left: [[1, 2]]\n", "a.csv").is_ok());
    assert!(parse_track("cones_left: [[[[[[\n", "t").is_err());
    assert!(parse_track("a: &a [1]\nb: *a\n", "t").is_err());
}

#[test]
fn broken_logs_are_told_where() {
    let frame = |position: &str, direction: &str, cones: &str| {
        format!("[{{\"car_position\": {position}, \"car_direction\": {direction}, \"slam_cones\": {cones}}}]")
    };
    let cones = "[[], [[1, -1]], [[1, 1]], [], []]";
    let TrackFile::Log(frames) = parse_track(&frame("[1, 2]", "[0, 3]", cones), "t").unwrap() else {
        panic!()
    };
    let [ConeFrame { car, speed: None, cones: seen }] = &frames[..] else { panic!("{frames:?}") };
    assert!(
        (car.heading - std::f64::consts::FRAC_PI_2).abs() < 1e-9 && car.position() == Point::new(1.0, 2.0)
    );
    assert_eq!(
        seen.iter().map(|cone| cone.colour).collect::<Vec<_>>(),
        [ConeColour::Yellow, ConeColour::Blue]
    );
    for (text, message) in [
        ("[]".into(), "t:1:1: found no frames; expected at least one"),
        ("[3]".into(), "t:1:2: found `3`; expected a frame with keys"),
        ("[{}]".into(), "t:1:2: found a frame without car_position; expected one with it"),
        (
            frame("[1]", "[1, 0]", cones),
            "t:1:21: found the end of a list; expected a number of metres or radians",
        ),
        (frame("[1, 0]", "[0, 0]", cones), "t:1:44: found a vector without length; expected a direction"),
        (frame("[1, 0]", "[1, 0]", "[[], []]"), "t:1:73: found the end of a list; expected a list"),
        (
            frame("[1, 0]", "[1, 0]", "[[], [], [], [], [], []]"),
            "t:1:87: found a list; expected the end of the five lists",
        ),
        (
            "[{\"colour\": 3}]".into(),
            "t:1:3: found `colour`; expected car_position, car_direction, car_speed or slam_cones",
        ),
        (
            "[{\"car_speed\": 3, \"car_speed\": 3}]".into(),
            "t:1:19: found a second `car_speed`; expected each key once in a frame",
        ),
    ] {
        assert_eq!(parse_track(&text, "t").unwrap_err().to_string(), message);
    }
    // A truncated log is rejected.
    let whole = frame("[1, 0]", "[1, 0]", cones);
    for end in 1..whole.len() {
        assert!(parse_track(&whole[..end], "t").is_err(), "{}", &whole[..end]);
    }
}

#[test]
#[ignore = "needs published data: ROVERLAB_DATA=FOLDER .ci/run tests"]
fn a_lane_is_found_in_each_frame_of_a_real_drive() {
    let logs = files("ft-fsd", "json").into_iter().filter(|path| name(path).starts_with("fsg"));
    for path in logs {
        let TrackFile::Log(frames) = read(&path) else { panic!("{path:?}") };
        let mut finder = LaneFinder::new(LaneParameters::default()).unwrap();
        let mut wrong = 0;
        for (k, frame) in frames.iter().enumerate() {
            let blind: Vec<Cone> = frame.cones.iter().map(|cone| Cone::unknown(cone.position)).collect();
            let lane = finder.step(frame.car, &blind).unwrap_or_else(|| panic!("no lane in frame {k}"));
            let sides = lane.edges.iter().zip([1, -1]);
            let amiss = |(edge, side): (&Vec<usize>, i8)| {
                edge.iter().filter(|&&cone| frame.cones[cone].colour.side() == -side).count()
            };
            wrong += usize::from(sides.map(amiss).sum::<usize>() > 0);
        }
        // Far ahead, an edge sometimes includes a cone of the other one, until it is seen from closer.
        assert!(wrong * 20 < frames.len(), "{wrong} of {}", frames.len());
    }
}

#[test]
fn events_are_told_by_their_cones() {
    let cone = |x: f64, y: f64, colour| Cone::new(Point::new(x, y), colour);
    let mut strip = ConeTrack::default();
    for i in 0..15 {
        strip.cones.push(cone(5.0 * f64::from(i), 1.5, ConeColour::Blue));
        strip.cones.push(cone(5.0 * f64::from(i), -1.5, ConeColour::Yellow));
    }
    assert_eq!(strip.event(), Event::Laps);
    assert_eq!(strip.start_pose(), Some(Pose::new(0.0, 0.0, 0.0)));
    strip.cones.push(cone(80.0, 0.0, ConeColour::Orange));
    assert_eq!(strip.event(), Event::Acceleration);
    assert_eq!(ConeTrack::default().start_pose(), None);
}
