//! The command `bug-compare` as a whole: tables, the campaign, its measures, and refusals.

use std::f64::consts::{PI, TAU};
use std::fs;

use super::support::{DATA, folder, said, temporary};
use crate::bug_compare::{Boundaries, interval};
use roverlab::geometry::{Point, Segment, direction};
use roverlab::random::Stream;
use roverlab::world::{Wall, World};
use serde_json::Value;

/// Runs the command with options. Returns status, standard output, and standard error.
fn run(options: &[&str]) -> (u8, String, String) {
    said("bug_compare", options)
}

/// The report of a run.
fn report(options: &[&str]) -> Value {
    let (status, out, err) = run(&[&["--json"], options].concat());
    assert_eq!((status, err.as_str(), out.lines().count()), (0, "", 1), "{out}");
    serde_json::from_str(&out).unwrap()
}

fn data(name: &str) -> String {
    format!("{DATA}/{name}")
}

#[test]
fn the_table_has_a_row_for_every_bug_and_family() {
    let options =
        ["--noise", "0", "--runs", "2", "--bugs", "bug2,distbug", "--families", "semi_convex,unreachable"];
    let with_threads = |threads| report(&[options.as_slice(), &["--threads", threads]].concat());
    let report = with_threads("1");
    assert_eq!(report, with_threads("2"), "the number of threads makes a difference");
    assert_eq!(report["outcome"], "compared");
    let rows = report["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 4);
    for row in rows {
        assert_eq!((&row["runs"], &row["correct"]), (&2.into(), &2.into()), "{row}");
        let [low, high] = [0, 1].map(|end| row["path_ci_mm"][end].as_f64().unwrap());
        let mean = row["mean_path_mm"].as_f64().unwrap();
        assert!(low <= mean && mean <= high, "{row}");
        let reachable = row["family"] == "semi-convex";
        assert_eq!(row["mean_ratio"].as_f64().is_some(), reachable, "{row}");
        assert!(!reachable || row["mean_ratio"].as_f64().unwrap() > 0.9, "{row}");
    }
    let runs = report["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 8);
    // All drive through the same courses.
    let shortest = |bug: &str| {
        let of_bug = runs.iter().filter(|run| run["bug"] == bug);
        of_bug.map(|run| (run["seed"].clone(), run["shortest_mm"].clone())).collect::<Vec<_>>()
    };
    assert_eq!(shortest("Bug2"), shortest("DistBug"));
}

#[test]
fn a_world_of_ones_own_is_compared_and_drawn() {
    let folder = temporary("bug_compare");
    fs::create_dir_all(&folder).unwrap();
    let (file, field) = (folder.join("paths.svg"), data("field.wld"));
    let name = file.to_str().unwrap();
    let report = report(&[
        "--world",
        &field,
        "--goal",
        "3600,3500",
        "--noise",
        "0",
        "--runs",
        "1",
        "--bugs",
        "Bug1,TangentBug",
        "--picture",
        name,
    ]);
    assert_eq!(report["picture"], name);
    assert_eq!(report["rows"][0]["family"], "world");
    let svg = fs::read_to_string(&file).unwrap();
    for part in ["Bug1: ", "TangentBug: ", "shortest way"] {
        assert!(svg.contains(part), "{part} is missing");
    }
}

/// Goals in a wall and outside, which the robots find out.
#[test]
fn goals_that_nobody_can_reach_are_told() {
    let field = data("field.wld");
    for goal in ["0,2000", "9000,2000"] {
        let world = ["--world", &field, "--goal", goal, "--noise", "0", "--runs", "1"];
        let report = report(&world);
        for run in report["runs"].as_array().unwrap() {
            let outcome = run["outcome"].as_str().unwrap();
            assert!(["unreachable", "no_room"].contains(&outcome) && run["correct"] == true, "{run}");
        }
    }
}

/// The truth is that of the algorithms' own disc: a gap of the robot's width is closed, and a goal is reached
/// from beside it if a wall is too near to it.
#[test]
fn verdicts_are_compared_with_the_truth_for_the_same_disc() {
    let folder = temporary("bug_compare_disc");
    fs::create_dir_all(&folder).unwrap();
    let file = folder.join("gap.wld");
    let run = |gap: u32, goal: &str| {
        let edges = (1000 - gap / 2, 1000 + gap / 2);
        let wall = format!("1000 0 1000 {} 10 500\n1000 {} 1000 2000 10 500\n", edges.0, edges.1);
        let border = "0 0 2000 0\n2000 0 2000 2000\n2000 2000 0 2000\n0 2000 0 0\n";
        fs::write(&file, format!("floor 2000 2000\n{border}{wall}")).unwrap();
        let world = ["--world", file.to_str().unwrap(), "--start", "400,400,0", "--goal", goal];
        let report = report(&[&world[..], &["--noise", "0", "--runs", "1"]].concat());
        for run in report["runs"].as_array().unwrap() {
            assert_eq!(run["correct"], true, "{gap} {run}");
        }
        report["runs"][0]["reachable"].clone()
    };
    assert_eq!(run(125, "1600,1500"), false);
    assert_eq!(run(145, "1600,1500"), Value::Null, "some millimetres decide");
    assert_eq!(run(300, "1600,1500"), true);
    assert_eq!(run(300, "1600,1935"), true, "within the tolerance of a place with room");
}

#[test]
fn the_campaign_checks_verdicts_and_bounds() {
    let report = report(&["--campaign", "--noise", "0", "--runs", "3", "--bugs", "bug1,bug2,class1"]);
    assert_eq!(report["outcome"], "passed");
    for bug in report["bugs"].as_array().unwrap() {
        assert_eq!(
            (&bug["runs"], &bug["correct"], &bug["contacts"]),
            (&3.into(), &3.into(), &0.into()),
            "{bug}"
        );
        let bounded = bug["bug"] != "Class1";
        assert_eq!(bug["bounds_checked"], if bounded { 3 } else { 0 }, "{bug}");
        let closest = bug["closest"].as_f64();
        assert!(
            if bounded { closest.is_some_and(|c| c > 0.1 && c <= 1.0) } else { closest.is_none() },
            "{bug}"
        );
    }
}

/// Lines to the goal that graze an obstacle or continue behind the goal, ends of thin walls before narrow
/// gaps, obstacles met where others are as near, leave points visible only for a moment, thin walls seen
/// edge-on, ends at which a robot turns back, ways that seem to lead out of a closed room, dead ends in which
/// it turns the other way, and leave points passed the other way round a corner.
#[test]
fn hard_worlds_are_done_right() {
    for (seed, bugs) in [
        ("1017", "bug2"),
        ("1096", "bug2,alg1"),
        ("1224", "leavebug"),
        ("1284", "leavebug"),
        ("1318", "bug2,alg1"),
        ("1361", "bug1"),
        ("1381", "bug1,leavebug"),
        ("1837", "bug2"),
        ("2727", "bug1"),
        ("10015", "class1"),
        ("10070", "tangentbug"),
        ("10209", "rev2"),
        ("10258", "tangentbug"),
        ("20654", "leavebug"),
        ("20660", "distbug"),
    ] {
        let report = report(&["--campaign", "--noise", "0", "--seed", seed, "--runs", "1", "--bugs", bugs]);
        assert_eq!((&report["outcome"], &report["collisions"]), (&"passed".into(), &0.into()), "{report}");
    }
}

#[test]
fn the_first_course_of_the_campaign_is_drawn() {
    let folder = temporary("bug_campaign");
    fs::create_dir_all(&folder).unwrap();
    let file = folder.join("paths.svg");
    let name = file.to_str().unwrap();
    let options = ["--campaign", "--noise", "0", "--seed", "3", "--runs", "1", "--bugs", "onebug"];
    assert_eq!(report(&[&options[..], &["--picture", name]].concat())["picture"], name);
    let svg = fs::read_to_string(&file).unwrap();
    for part in ["The bug family: course", "seed 3", "OneBug: unreachable"] {
        assert!(svg.contains(part), "{part} is missing");
    }
}

#[test]
fn too_little_time_is_a_wrong_verdict() {
    let (status, out, _) =
        run(&["--json", "--campaign", "--noise", "0", "--runs", "1", "--bugs", "bug1", "--time-limit", "1"]);
    let report: Value = serde_json::from_str(&out).unwrap();
    assert_eq!((status, report["outcome"].as_str()), (1, Some("wrong")), "{out}");
    assert_eq!(report["bugs"][0]["wrong_seeds"], serde_json::json!([1]));
}

#[test]
fn what_makes_no_sense_is_refused() {
    let field = data("field.wld");
    for (options, part) in [
        (&["--bugs", "bug7"][..], "unknown bug `bug7`; expected one of Bug1, Bug2"),
        (&["--families", "swamp"], "unknown family of courses `swamp`"),
        (&["--runs", "0"], "--runs"),
        (&["--threads", "0"], "--threads"),
        (&["--goal", "1,2"], "--goal: found no --world"),
        (&["--realtime"], "--realtime: found it for a comparison"),
        (&["--fault", "stuck@3"], "--fault: found it for a comparison"),
        (&["--campaign", "--world", &field], "--campaign: found --world"),
        (&["--world", &field, "--goal", "30,2000,7"], "--goal: found a heading"),
        (&["--world", "no/such.wld"], "no/such.wld:1:1"),
        (&["--world", &field, "--start", "-500,2000,0"], "--start: found a start at -500, 2000 mm, outside"),
        (&["--world", &field, "--start", "0,2000,0"], "--start: found a start at 0, 2000 mm, in a wall"),
        (&["--world", &field, "--goal", "nan,1"], "--goal"),
        (&["--world", &field, "--start", "1,inf,0"], "--start"),
    ] {
        let (status, out, err) = run(&[&["--json"], options].concat());
        assert_eq!((status, out.as_str(), err.lines().count()), (2, "", 1), "{options:?}: {err}");
        assert!(err.contains(part), "{options:?}: {err}");
    }
}

#[test]
fn boundaries_have_the_perimeters_that_geometry_says() {
    let mut world = World::walled(3.0, 3.0);
    let corner = |x: f64, y: f64| Point::new(x, y);
    let block = [corner(1.0, 1.0), corner(2.0, 1.0), corner(2.0, 1.6), corner(1.0, 1.6)];
    world.walls.extend((0..4).map(|k| Wall { thickness: 0.0, ..Wall::new(block[k], block[(k + 1) % 4]) }));
    let boundaries = Boundaries::new(&world, 0.1).unwrap();
    // Inside the block, round it, and inside the border. Squares of 6 mm cut each of four corners.
    let mut perimeters: Vec<f64> = boundaries.all.iter().map(|line| line.perimeter).collect();
    perimeters.sort_by(f64::total_cmp);
    let border = 4.0 * (3.0 - 2.0 * (0.1 + 0.5 * Wall::DEFAULT_THICKNESS));
    for (found, expected) in perimeters.iter().zip([2.0 * (0.8 + 0.4), 3.2 + TAU * 0.1, border]) {
        assert!((found - expected).abs() < 0.001 * expected + 4.0 * 0.006, "{found} for {expected}");
    }
    // Also round the whole of it.
    assert!((3..=4).contains(&perimeters.len()), "{perimeters:?}");
    let round = &boundaries.all[boundaries.nearest(corner(0.85, 1.3)).unwrap()];
    assert!((round.perimeter - (3.2 + TAU * 0.1)).abs() < 0.02);
    // A path that begins nearer to the border still goes round the block.
    let path = [corner(0.2, 1.3), corner(0.9, 1.4), corner(0.91, 1.2), corner(0.9, 1.0)];
    assert_eq!(boundaries.followed(&path), boundaries.nearest(corner(0.85, 1.3)));
    assert_eq!(boundaries.followed(&[]), None);
    assert_eq!(round.crossings(Segment::new(corner(0.5, 1.3), corner(2.5, 1.3))), 2);
    assert_eq!(round.crossings(Segment::new(corner(0.5, 1.3), corner(1.5, 1.3))), 1);
    assert_eq!(round.crossings(Segment::new(corner(0.5, 0.5), corner(2.5, 0.5))), 0);
}

#[test]
fn a_ring_of_walls_has_a_round_boundary() {
    let mut world = World::walled(2.0, 2.0);
    let at = |k: i32| Point::new(1.0, 1.0) + direction(PI * f64::from(k) / 40.0) * 0.3;
    world.walls.extend((0..80).map(|k| Wall { thickness: 0.0, ..Wall::new(at(k), at(k + 1)) }));
    let boundaries = Boundaries::new(&world, 0.1).unwrap();
    let outside = &boundaries.all[boundaries.nearest(Point::new(1.4, 1.0)).unwrap()];
    assert!((outside.perimeter / (TAU * 0.4) - 1.0).abs() < 0.004, "{}", outside.perimeter);
}

/// Of 200 samples with a known mean, about 95 % of the intervals contain it: slightly fewer, as samples are
/// small.
#[test]
fn intervals_hold_the_mean_as_often_as_they_say() {
    let mut stream = Stream::new(3);
    let hold = (0..200).filter(|_| {
        let values: Vec<f64> = (0..30).map(|_| 5.0 + stream.normal()).collect();
        interval(&values).is_some_and(|i| i.low <= 5.0 && 5.0 <= i.high)
    });
    let share = hold.count();
    assert!((178..=198).contains(&share), "{share} of 200");
    assert!(interval(&[]).is_none());
    let one = interval(&[2.5]).unwrap();
    assert_eq!((one.mean, one.low, one.high), (2.5, 2.5, 2.5));
}

/// A robot that stands in a door closes it.
#[test]
fn other_robots_are_in_the_way() {
    let folder = folder();
    let walls =
        "3000 0 3000 1850\n3000 2150 3000 4000\n0 0 6000 0\n6000 0 6000 4000\n6000 4000 0 4000\n0 4000 0 0\n";
    fs::write(folder.join("door.wld"), format!("floor 6000 4000\n{walls}")).unwrap();
    let scene = folder.join("door.sim");
    fs::write(&scene, "world door.wld\nS4 1000 2000 0\nLabBot 3000 2000 0\nmarker 5000 2000 0 255 0\n")
        .unwrap();
    let report = report(&[
        "--world",
        scene.to_str().unwrap(),
        "--runs",
        "1",
        "--noise",
        "0",
        "--bugs",
        "DistBug,Bug1",
    ]);
    assert_eq!(report["outcome"], "compared", "{report}");
}
