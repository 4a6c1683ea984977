//! The command `micromouse` as a whole, and published mazes with known answers.
//!
//! The published mazes are not part of the project: the environment variable `ROVERLAB_DATA` names the folder
//! that contains `micromouse/`.

use std::fs;
#[cfg(unix)]
use std::{
    process::{Command, Stdio},
    thread,
    time::Duration,
};

use super::support::{self, Ended, published, temporary, text};
use crate::micromouse;
use roverlab::maze::files::{self, MazeFormat};
use roverlab::maze::{Preference, Unknown, distances_from_start, distances_to_goal, shortest_route};
use serde_json::Value;

fn run(options: &[&str]) -> Ended {
    support::run("micromouse", options)
}

#[test]
fn the_commands_own_maze_is_planned() {
    let (status, report, err) = run(&["--plan"]);
    assert_eq!((status, err.as_str()), (0, ""), "{report}");
    assert_eq!(report["outcome"], "planned");
    assert_eq!((&report["width"], &report["height"]), (&8.into(), &8.into()));
    assert_eq!(report["defects"].as_array().map(Vec::len), Some(0));
    let steps = report["shortest_steps"].as_i64().unwrap();
    assert_eq!(report["route"].as_str().unwrap().len() as i64, steps);
    assert!(report["fewest_turns"].as_i64() <= report["min_turns"].as_i64());
}

#[test]
fn what_the_mazes_file_says_is_no_option() {
    for option in [["--start", "900,900,0"], ["--goal", "200,200"], ["--robot", "nowhere.robi"]] {
        let (status, report, err) = run(&[&["--plan"], &option[..]].concat());
        assert_eq!((status, report, err.lines().count()), (2, Value::Null, 1), "{err}");
        assert!(err.contains(&format!("{}: found one; expected none", option[0])), "{err}");
    }
}

#[test]
fn turns_are_counted_from_north() {
    let file = temporary("heading_east.maz");
    fs::write(&file, " _ _ _\n|r   G|\n|_ _ _|\n").unwrap();
    let (status, report, err) = run(&["--plan", "--maze", file.to_str().unwrap()]);
    assert_eq!((status, err.as_str()), (0, ""), "{report}");
    assert_eq!((&report["start_heading"], &report["shortest_steps"]), (&"east".into(), &2.into()));
    assert_eq!((&report["min_turns"], &report["fewest_turns"]), (&1.into(), &1.into()));
}

#[test]
fn the_commands_own_maze_is_explored_and_raced() {
    for noise in ["0", "1"] {
        let (status, report, err) = run(&["--explore", "--noise", noise, "--seed", "3"]);
        assert_eq!((status, err.as_str()), (0, ""), "{report}");
        assert_eq!((&report["outcome"], &report["collisions"]), (&"raced".into(), &0.into()));
        assert_eq!(report["proved_optimal"], true);
        let number = |name: &str| report[name].as_f64().unwrap();
        let (planned, driven) = (number("fast_run_planned_s"), number("fast_run_s"));
        assert!((driven - planned).abs() < 0.02 * planned, "{report}");
        assert!(number("goal_error_mm") < 10.0, "{report}");
        assert!(number("visited_cells") <= 64.0 && number("localisation_error_mm") < 10.0, "{report}");
    }
}

#[test]
fn what_was_explored_is_told_even_if_the_fast_run_fails() {
    let (_, whole, _) = run(&["--explore"]);
    let during_the_fast_run = whole["exploration_s"].as_f64().unwrap() + 0.5;
    let (status, report, _) = run(&["--explore", "--fault", &format!("stuck@{during_the_fast_run}")]);
    assert_eq!((status, &report["outcome"]), (1, &"collided".into()), "{report}");
    for same in ["proved_optimal", "visited_cells", "looks", "fast_run_planned_s"] {
        assert_eq!(report[same], whole[same], "{same}");
    }
    assert_eq!(report["fast_run_s"], Value::Null);
}

/// With large odometry errors in a long corridor, a robot must not mistake a wall for that of the next cell.
#[test]
#[ignore = "needs published data: ROVERLAB_DATA=FOLDER .ci/run tests"]
fn long_corridors_are_explored_right_with_odometry_that_is_far_off() {
    let folder = published("micromouse");
    for (name, seconds) in [("32MM2022HX", 38.590_468), ("32MM2012HX", 25.228_637)] {
        let maze = folder.join(format!("kerikun11/data/{name}.maze"));
        let options = ["--explore", "--maze", maze.to_str().unwrap(), "--noise", "1", "--seed", "29"];
        let (status, report, err) = run(&options);
        assert_eq!((status, err.as_str()), (0, ""), "{report}");
        assert_eq!((&report["proved_optimal"], &report["collisions"]), (&true.into(), &0.into()), "{report}");
        let planned = report["fast_run_planned_s"].as_f64().unwrap();
        assert!((planned - seconds).abs() < 2e-3, "{name}: {planned}");
    }
}

#[test]
fn a_campaign_tells_of_every_maze() {
    let (status, report, err) = run(&["--campaign", "../tests/data/mazes", "--runs", "3"]);
    assert_eq!((status, err.as_str()), (0, ""), "{report}");
    assert_eq!((&report["outcome"], &report["mazes"]), (&"passed".into(), &2.into()));
    let all = report["rows"].as_array().unwrap().last().unwrap();
    assert_eq!((&all["size"], &all["runs"], &all["proved"]), (&"all".into(), &6.into(), &6.into()));
    assert_eq!(report["failures"].as_array().map(Vec::len), Some(0));
    let empty = temporary("no_mazes");
    fs::create_dir_all(&empty).unwrap();
    let (status, _, err) = run(&["--campaign", empty.to_str().unwrap()]);
    assert_eq!(status, 2);
    assert_eq!(err, format!("{}: found no file that holds a maze; expected one or more\n", empty.display()));
}

#[test]
fn the_smallest_maze_is_visited_and_gaps_outside_are_no_wrong_walls() {
    let folder = temporary("odd_mazes");
    fs::create_dir_all(&folder).unwrap();
    let smallest = folder.join("smallest.maze");
    fs::write(&smallest, "+---+\n| G |\n+---+\n").unwrap();
    let (status, report, err) = run(&["--explore", "--maze", smallest.to_str().unwrap()]);
    assert_eq!((status, &report["visited_cells"]), (0, &1.into()), "{err} {report}");
    fs::write(folder.join("gap.maze"), "+---+---+\n|     G |\n+   +---+\n| S |    \n+---+---+\n").unwrap();
    let (_, report, err) = run(&["--campaign", folder.to_str().unwrap(), "--noise", "0"]);
    assert_eq!(report["mazes"], 2, "{err}");
    assert!(!report["failures"].to_string().contains("known wrongly"), "{report}");
}

/// A left-hand mouse for mms, as a shell script.
const LEFT_HAND: &str = r#"ask() { echo "$1"; read -r answer; }
for i in $(seq 300); do
    ask wallLeft; [ "$answer" = false ] && ask turnLeft
    ask wallFront
    while [ "$answer" = true ]; do ask turnRight; ask wallFront; done
    ask moveForward; echo nonsense
    ask "getStat best-run-turns"; [ "$answer" != -1 ] && exit 0
done
"#;

/// Runs a shell script as a mouse.
#[cfg(unix)]
fn run_script(name: &str, script: &str) -> (u8, Value, String) {
    let file = std::env::temp_dir().join(format!("roverlab-{}-{name}.sh", std::process::id()));
    fs::write(&file, script).unwrap();
    let command = format!("sh {}", file.display());
    let result = run(&["--maze", "../tests/data/mazes/tiny.maz", "--mms-run", &command, "--patience", "1"]);
    fs::remove_file(&file).unwrap();
    result
}

#[cfg(unix)]
#[test]
fn a_mouse_of_another_language_is_run() {
    let (status, report, err) = run_script("left", LEFT_HAND);
    assert_eq!((status, err.as_str()), (0, ""), "{report}");
    assert_eq!((&report["outcome"], &report["solved"]), (&"solved".into(), &true.into()));
    assert_eq!(report["ignored_lines"], report["total_distance"]);
    assert!(report["score"].as_f64().unwrap() < 100.0, "{report}");
}

#[cfg(unix)]
#[test]
fn hostile_mice_are_stopped_and_named() {
    for (name, script, expected) in [
        ("dies", "echo mazeWidth; exit 3", "ended with exit status: 3; expected exit status 0"),
        ("hangs", "echo mazeWidth; exec sleep 60", "found silence for 1 s; expected commands"),
        ("floods", "exec yes mazeWidth", "does not read its answers"),
        ("raves", "exec yes abracadabra", "lines that are no commands, the first \"abracadabra\""),
        ("rants", "exec head -c 100000 /dev/zero", "found a line of more than 4096 bytes"),
        ("mumbles", "exec >&-; exec sleep 60", "closed its output and goes on"),
    ] {
        let (status, report, err) = run_script(name, script);
        assert_eq!((status, &report["outcome"]), (1, &"failed".into()), "{name}");
        assert!(err.contains(expected), "{name}: {err}");
        assert_eq!(report["score"], 2000.0);
    }
    // What a mouse has started ends with it.
    let (pid, forks) = (temporary("fork.pid"), "sleep 60 >&- & echo $! > PID; echo mazeWidth; exec sleep 60");
    run_script("forks", &forks.replace("PID", text(&pid)));
    let child = fs::read_to_string(&pid).unwrap();
    let is_alive = || Command::new("kill").args(["-0", child.trim()]).stderr(Stdio::null()).status().unwrap();
    let mut looks = 0..500;
    while is_alive().success() {
        assert!(looks.next().is_some(), "process {child} goes on");
        thread::sleep(Duration::from_millis(10));
    }
    let dawdles = temporary("dawdles.sh");
    fs::write(&dawdles, "while :; do echo mazeWidth; read -r answer; sleep 0.1; done").unwrap();
    let command = format!("sh {}", dawdles.display());
    let (status, _, err) = run(&["--mms-run", &command, "--mms-limit", "1"]);
    assert!(status == 1 && err.contains("found no end after 1 s"), "{err}");
    let (status, report, err) = run(&["--mms-run", "no/such/mouse"]);
    assert_eq!((status, report), (2, Value::Null));
    assert!(err.starts_with("--mms-run no/such/mouse: found "), "{err}");
    let (status, report, _) = run_script("quits", "exit 0");
    assert_eq!((status, &report["outcome"]), (1, &"unsolved".into()));
}

#[test]
fn a_simulator_that_goes_away_is_named() {
    for (answers, expected) in [
        ("16\n", "the simulator has ended"),
        ("16\n16\nmaybe\n", "found the answer \"maybe\""),
        ("16\n16\nfalse\ntrue\ntrue\ncrash\n", "expected ack"),
    ] {
        let error = micromouse::mms::converse(&mut answers.as_bytes(), &mut Vec::new()).unwrap_err();
        assert!(error.to_string().contains(expected), "{error}");
    }
}

#[test]
fn a_file_that_is_missing_is_named() {
    let (status, report, err) = run(&["--plan", "--maze", "no/such.maze"]);
    assert_eq!((status, report), (2, Value::Null));
    assert_eq!(
        err,
        "no/such.maze:1:1: found `no/such.maze`, which does not exist; expected a file that exists\n"
    );
}

/// A picture of a maze, or prose, is not a maze.
#[test]
#[ignore = "needs published data: ROVERLAB_DATA=FOLDER .ci/run tests"]
fn prose_about_mazes_is_no_maze() {
    let text = published("micromouse").join("mms/FORMATS-from-README.md");
    assert!(files::load(&text).is_err(), "{}", text.display());
}

#[test]
#[ignore = "needs published data: ROVERLAB_DATA=FOLDER .ci/run tests"]
fn published_mazes_have_the_known_answers() {
    let folder = published("micromouse");
    let table = fs::read_to_string(folder.join("shortest.csv")).unwrap();
    let mut lines = table.lines().map(fields);
    let names = lines.next().unwrap();
    let mut counts = [0; 6];
    for row in lines {
        let column = |name: &str| row[names.iter().position(|other| other == name).unwrap()].as_str();
        let number = |name: &str| column(name).parse::<i64>().unwrap();
        let path = folder.join(column("file"));
        let file = files::load(&path).unwrap_or_else(|error| panic!("{error}"));
        let maze = &file.maze;
        counts[file.format as usize] += 1;
        assert_eq!((maze.width() as i64, maze.height() as i64), (number("width"), number("height")));
        assert_eq!(format!("{} {}", maze.start().x, maze.start().y), column("start_xy"), "{row:?}");
        let goals: Vec<String> = maze.goals().map(|goal| goal.to_string()).collect();
        let mut expected: Vec<&str> = column("goals_xy").split(' ').collect();
        expected
            .sort_by_key(|goal| goal.split(',').rev().map(|n| n.parse::<u16>().unwrap()).collect::<Vec<_>>());
        assert_eq!(goals, expected, "{row:?}");
        let from_start = distances_from_start(maze, Unknown::Closed);
        assert_eq!(from_start.reached() as i64, number("cells_reachable"), "{row:?}");
        let walls = maze.wall_count() + maze.unknown_walls();
        assert_eq!(walls as i64, number("walls_total"), "{row:?}");
        let to_goal = distances_to_goal(maze, Unknown::Closed).get(maze.start());
        assert_eq!(to_goal.map_or(-1, i64::from), number("shortest_steps"), "{row:?}");
        for (preference, steps, turns) in [
            (Preference::Steps, "shortest_steps", "min_turns_among_shortest"),
            (Preference::Turns, "fewest_turn_route_steps", "fewest_turns"),
            (Preference::StepsAndTurns, "min_steps_plus_turns_steps", "min_steps_plus_turns_turns"),
        ] {
            let route = shortest_route(maze, Unknown::Closed, preference);
            let found = route.map_or((-1, -1), |route| (route.steps() as i64, route.turns() as i64));
            assert_eq!(found, (number(steps), number(turns)), "{preference:?} of {row:?}");
        }
        let reachable = number("shortest_steps") >= 0;
        let said = file.defects.iter().any(|defect| defect.message == "the goal cannot be reached");
        assert_eq!(said, !reachable, "{row:?}");
    }
    let [_, maze, map, num, ..] = counts;
    println!("{maze} .maze, {map} map, {num} num");
    assert_eq!([maze, map, num], [80, 4, 41], "{counts:?}");
    assert_eq!(MazeFormat::Maze as usize, 1);
}

/// The fields of a table line, some of them quoted.
fn fields(line: &str) -> Vec<String> {
    let mut fields = vec![String::new()];
    let mut quoted = false;
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => fields.push(String::new()),
            _ => fields.last_mut().unwrap().push(c),
        }
    }
    fields
}

/// Nothing is proved before the limit, also if the clock has jumped beyond it.
#[test]
fn a_mouse_without_time_says_so() {
    for options in [&["--time-limit", "3"][..], &["--fault", "clock=1000@2", "--time-limit", "20"]] {
        let (status, report, err) = run(&[&["--noise", "0"], options].concat());
        assert_eq!(
            (status, report["outcome"].as_str()),
            (1, Some("timed_out")),
            "{options:?}: {report} {err}"
        );
        assert_eq!((&report["proved_optimal"], &report["fast_run_s"]), (&false.into(), &Value::Null));
        assert!(report["unknown_walls"].as_u64().unwrap() > 0, "{report}");
        assert!(report["sim_time_s"].as_f64().unwrap() <= 3.0 + 1e-9, "{report}");
    }
}
