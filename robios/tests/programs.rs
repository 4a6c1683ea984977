//! Programs in C, C++ and Python with the library, through the runner.
//!
//! Without a C compiler, or without Python, the tests that need one say so and pass.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

use serde_json::Value;

#[path = "programs/compiling.rs"]
mod compiling;
#[path = "programs/endings.rs"]
mod endings;
#[path = "programs/hills.rs"]
mod hills;
#[path = "programs/library.rs"]
mod library;
#[path = "programs/limits.rs"]
mod limits;
#[path = "programs/menu.rs"]
mod menu;
#[path = "programs/page.rs"]
mod page;
#[path = "programs/roads.rs"]
mod roads;
#[path = "programs/said.rs"]
mod said;
#[path = "programs/same.rs"]
mod same;
#[path = "programs/scripts.rs"]
mod scripts;
#[path = "programs/sight.rs"]
mod sight;
#[path = "programs/three.rs"]
mod three;
#[path = "programs/time.rs"]
mod time;
#[path = "programs/water.rs"]
mod water;

fn programs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/programs")
}

fn there_is(command: &str) -> bool {
    Command::new(command).arg("--version").output().is_ok_and(|output| output.status.success())
}

/// Whether there is a C compiler.
fn compiler() -> bool {
    static FOUND: OnceLock<bool> = OnceLock::new();
    *FOUND.get_or_init(|| {
        let found = there_is("cc");
        if !found {
            eprintln!("skipped: no C compiler `cc` was found");
        }
        found
    })
}

fn python() -> bool {
    let found = there_is("python3");
    if !found {
        eprintln!("skipped: no `python3` was found");
    }
    found
}

/// A test's own folder.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    /// Copies a program from here, under a name.
    fn copy(&self, program: &str, name: &str) -> PathBuf {
        std::fs::copy(programs().join("check.h"), self.0.join("check.h")).unwrap();
        std::fs::copy(programs().join(program), self.0.join(name)).unwrap();
        self.0.join(name)
    }

    fn write(&self, name: &str, text: &str) -> PathBuf {
        std::fs::write(self.0.join(name), text).unwrap();
        self.0.join(name)
    }
}

/// The library of this build: the newest one beside the runner.
fn library() -> PathBuf {
    let folder = Path::new(env!("CARGO_BIN_EXE_robios")).parent().unwrap();
    let files = [folder.to_owned(), folder.join("deps")].map(|folder| folder.join("libeyesim.so"));
    let built = files.into_iter().filter_map(|file| Some((file.metadata().ok()?.modified().ok()?, file)));
    built.max().expect("a library").1
}

/// Compiles a program beside its source text, like the appropriate script.
fn compiled(file: &Path) -> PathBuf {
    let program = file.with_extension("x");
    let script = if file.extension().is_some_and(|kind| kind == "cpp") { "bin/g++sim" } else { "bin/gccsim" };
    let done = Command::new(Path::new(env!("CARGO_MANIFEST_DIR")).join(script))
        .args([file.as_os_str(), "-o".as_ref(), program.as_os_str()])
        .env("ROBIOS_LIBRARY_DIR", library().parent().unwrap())
        .status();
    assert!(done.unwrap().success());
    program
}

fn robios(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_robios")).args(arguments).output().unwrap()
}

/// Runs a program and returns the report.
fn report(arguments: &[&str]) -> Value {
    let output = robios(&[&["--json"], arguments].concat());
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let messages = String::from_utf8_lossy(&output.stderr).into_owned();
    let value: Value =
        serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error}: {text}{messages}"));
    if value["outcome"] == "failed" {
        eprintln!("{messages}");
    }
    value
}

/// Runs one of the programs here, which must find no errors.
fn check(program: &str, options: &[&str]) -> Value {
    let folder = Folder::new(&format!("check-{program}"));
    let file = folder.copy(program, program);
    let report = report(&[options, &[file.to_str().unwrap()]].concat());
    assert!(report["outcome"] == "finished" || report["outcome"] == "collided", "{program}: {report}");
    assert_eq!(report["exit"], 0, "{program}");
    report
}

/// The options that let Mako swim in a pool.
fn in_water(pool: &Path) -> [&str; 8] {
    let pool = pool.to_str().unwrap();
    ["--robot", "Mako", "--world", pool, "--start", "12500,5000,0", "--time-limit", "300"]
}

/// Key presses expected by `keys.c` and `keys.py`.
const SCRIPT: &str = "KEY2@1s,KEY1@2s,KEY4@4s,TOUCH:12:34@5s,IRTV_OK@6s";

#[test]
fn every_group_of_functions_does_what_it_should() {
    if !compiler() {
        return;
    }
    check("display.c", &[]);
    check("camera.c", &[]);
    check("images.c", &[]);
    check("system.c", &[]);
    check("clocks.c", &[]);
    check("lines.c", &[]);
    // The motors are set in successive frames, as on EyeSim, and the robot turns a little in between.
    check("motors.c", &["--call-costs", "free"]);
    check("driving.c", &[]);
    check("threads.c", &[]);
    check("crowd.c", &[]);
    check("keys.c", &["--keys", SCRIPT]);
    check("older.c", &[]);
    check("timers.c", &[]);
    check("sensors.c", &["--start", "1000,2000,0"]);
}

#[test]
fn every_chapter_has_its_program() {
    if !compiler() {
        return;
    }
    check("chapter02.c", &["--start", "1000,1000,0"]);
    check("chapter03.c", &["--start", "1000,1000,0"]);
    check("chapter04.c", &["--start", "2000,2000,0"]);
    check("chapter06.c", &["--start", "2000,2000,0", "--time-limit", "300"]);
    check("chapter07.c", &["--robot", "Omni", "--start", "2000,2000,0", "--call-costs", "free"]);
    check("chapter11.c", &["--start", "1000,1000,0"]);
    check("chapter12.c", &["--start", "2000,2000,0", "--time-limit", "300"]);
    check("chapter13.c", &["--start", "1000,2000,0"]);
    check("chapter14.c", &["--robot", "Car", "--start", "2000,2000,0"]);

    let folder = Folder::new("chapters");
    let pool = folder.write("pool.wld", "floor 25000 50000\nwater_level 1900\n");
    check("chapter08.c", &in_water(&pool));
    let field = folder.write(
        "wall.wld",
        "floor 4000 4000\n0 0 4000 0\n4000 0 4000 4000\n4000 4000 0 4000\n0 4000 0 0\n1800 1500 1800 2200\n",
    );
    let file = folder.copy("chapter10.c", "chapter10.c");
    let around =
        report(&["--world", field.to_str().unwrap(), "--start", "500,2000,0", file.to_str().unwrap()]);
    assert_eq!((&around["exit"], &around["collisions"]), (&0.into(), &0.into()), "{around}");
    folder.copy("chapter05.c", "follow.c");
    folder.write("lead.py", "from eye import *\nVWSetSpeed(200, 15)\n");
    folder
        .write("field.wld", "floor 6000 6000\n0 0 6000 0\n6000 0 6000 6000\n6000 6000 0 6000\n0 6000 0 0\n");
    let script =
        folder.write("chase.sim", "world field.wld\nLabBot 2500 2000 0 lead.py\nS4 1500 2000 0 follow.x\n");
    if python() {
        let all = report(&["--time-limit", "20", script.to_str().unwrap()]);
        assert_eq!(all["robots"][1]["exit"], 0, "{all}");
        assert!(all["robots"][0]["path_length_mm"].as_f64().unwrap() > 2000.0, "it drives on: {all}");
    }
    let maze = folder.write("maze.maz", " _ _ _ _\n|_     _|\n|  _| | |\n|S|_ _ _|\n360\n");
    let file = folder.copy("chapter09.c", "chapter09.c");
    let start = ["--world", maze.to_str().unwrap(), "--start", "180,180,90"];
    let all = report(&[&start[..], &[file.to_str().unwrap()]].concat());
    assert_eq!((&all["exit"], &all["collisions"]), (&0.into(), &0.into()), "{all}");
}

#[test]
fn hostile_arguments_are_answered_with_codes() {
    if compiler() {
        let report = check("hostile.c", &["--time-limit", "100000"]);
        assert_eq!(report["lcd_text"].as_str().unwrap().lines().last(), Some("survived"));
    }
}

#[test]
fn a_square_ends_where_it_began() {
    if !compiler() {
        return;
    }
    let report = check("square.c", &["--robot", "S4", "--start", "1000,1000,0", "--time-limit", "60"]);
    assert_eq!((&report["outcome"], &report["lcd_text"]), (&"finished".into(), &"done".into()));
    let near = |value: &Value, expected: f64, most: f64| (value.as_f64().unwrap() - expected).abs() <= most;
    assert!(
        near(&report["pose"]["x_mm"], 1000.0, 10.0) && near(&report["pose"]["y_mm"], 1000.0, 10.0),
        "{report}"
    );
    assert!(near(&report["pose"]["heading_deg"], 0.0, 2.0), "{report}");
    assert!(near(&report["path_length_mm"], 1600.0, 10.0), "{report}");
    assert_eq!((&report["collisions"], &report["robots"][0]["collisions"]), (&0.into(), &0.into()));
}

#[test]
fn runs_are_the_same_each_time() {
    if !compiler() {
        return;
    }
    let run = || check("square.c", &["--noise", "1", "--seed", "3"]);
    assert_eq!(run(), run());
}

#[test]
fn a_minute_of_driving_takes_no_time_to_speak_of() {
    if compiler() {
        let report = check("speed.c", &["--start", "2000,2000,0", "--timing", "--call-costs", "free"]);
        let simulated = report["sim_time_s"].as_f64().unwrap();
        assert!(simulated >= 60.0);
        assert!(report["timing"]["wall_time_s"].as_f64().unwrap() < simulated / 3.0);
    }
}

#[test]
fn robots_share_a_world() {
    if !compiler() {
        return;
    }
    let folder = Folder::new("shared");
    folder.copy("radio.c", "radio.c");
    let script = folder.write("two.sim", "S4 400 600 0 radio.x\nLabBot 1000 600 180 radio.x\n");
    let all = report(&["--time-limit", "600", script.to_str().unwrap()]);
    assert_eq!(all["outcome"], "finished", "{all}");
    let texts: Vec<&str> =
        all["robots"].as_array().unwrap().iter().map(|robot| robot["lcd_text"].as_str().unwrap()).collect();
    assert_eq!(texts, ["robot 1: 1000", "robot 2: 999"]);

    folder.copy("simulation.c", "simulation.c");
    folder.copy("square.c", "square.c");
    let script =
        folder.write("can.sim", "S4 500 600 90 simulation.x\nS4 1500 600 180 square.x\ncan 1000 1200 0\n");
    // With the first call, before the other robot has driven off.
    let all = report(&["--call-costs", "free", script.to_str().unwrap()]);
    assert_eq!((&all["robots"][0]["exit"], &all["robots"][1]["exit"]), (&0.into(), &0.into()), "{all}");
    assert_eq!(all["robots"][0]["pose"]["x_mm"], 800.0);
}

#[test]
fn what_one_program_does_wrong_harms_no_other() {
    if !compiler() {
        return;
    }
    let folder = Folder::new("wrong");
    for name in ["square", "crash", "hang", "endless", "nonsense"] {
        folder.copy(&format!("{name}.c"), &format!("{name}.c"));
    }
    let script = folder.write(
        "all.sim",
        "world all.wld\nS4 500 500 0 square.x\nS4 3000 500 0 crash.x\nS4 3000 1500 0 hang.x\nS4 3000 2500 0 endless.x\n\
         S4 3000 3500 0 nonsense.x\nS4 1000 3500 0 missing.x\n",
    );
    folder.write("all.wld", "0 0 4000 0\n4000 0 4000 4000\n4000 4000 0 4000\n0 4000 0 0\n");
    let all = report(&["--time-limit", "40", "--hang-limit", "1", script.to_str().unwrap()]);
    let outcomes: Vec<&str> =
        all["robots"].as_array().unwrap().iter().map(|robot| robot["outcome"].as_str().unwrap()).collect();
    assert_eq!(outcomes, ["finished", "crashed", "timed_out", "timed_out", "failed", "failed"], "{all}");
    assert_eq!(all["robots"][0]["lcd_text"], "done");
    assert_eq!(all["robots"][1]["lcd_text"], "before");
    assert_eq!(all["robots"][2]["lcd_text"], "hanging");
    assert!(all["robots"][4]["error"].as_str().unwrap().contains("a question of"), "{all}");
    assert!(all["robots"][5]["error"].as_str().unwrap().contains("missing.x"), "{all}");
}

#[test]
fn runs_are_recorded_and_drawn() {
    if !compiler() {
        return;
    }
    let folder = Folder::new("recorded");
    let file = folder.copy("square.c", "square.c").display().to_string();
    let [log, picture, lcd] =
        ["run.mcap", "run.svg", "lcd.png"].map(|name| folder.0.join(name).display().to_string());
    let watched = report(&["--record", &log, "--picture", &picture, "--lcd", &lcd, "--noise", "1", &file]);
    let alone = report(&["--noise", "1", &file]);
    // The run is the same in the runner's process and in the program's own.
    for field in ["outcome", "pose", "odometry", "path_length_mm", "sim_time_s", "lcd_text"] {
        assert_eq!(watched[field], alone[field], "{field}");
    }
    assert!(std::fs::read(&log).unwrap().starts_with(b"\x89MCAP"));
    assert!(std::fs::read_to_string(&picture).unwrap().contains("</svg>"));
    assert!(std::fs::read(&lcd).unwrap().starts_with(b"\x89PNG"));
}

#[test]
fn python_programs_run() {
    if !python() {
        return;
    }
    let report = check("basics.py", &["--start", "1000,1000,0", "--time-limit", "600"]);
    assert!(report["lcd_text"].as_str().unwrap().ends_with("python is done"), "{report}");
    let report = check("sleepy.py", &["--time-limit", "600"]);
    assert_eq!(report["lcd_text"], "slept 100 s");
    if cfg!(target_os = "linux") {
        assert_eq!(check("foreign.py", &[])["lcd_text"], "number 7");
    }
}

#[test]
fn every_group_of_functions_does_what_it_should_in_python() {
    if !python() {
        return;
    }
    check("display.py", &[]);
    check("keys.py", &["--keys", SCRIPT]);
    check("images.py", &[]);
    check("system.py", &[]);
    check("arrays.py", &[]);
    if cfg!(target_os = "linux") {
        check("waits.py", &["--time-limit", "600"]);
    }
    check("lines.py", &[]);
    check("driving.py", &["--start", "1000,2000,0"]);
    let folder = Folder::new("simulation-py");
    let pool = folder.write("pool.wld", "floor 25000 50000\nwater_level 1900\n");
    check("chapter08.py", &in_water(&pool));
    folder.copy("simulation.py", "simulation.py");
    let script = folder
        .write("two.sim", "S4 500 600 90 simulation.py\nS4 1500 600 180 simulation.py\ncan 1000 1200 0\n");
    let all = report(&[script.to_str().unwrap()]);
    let texts: Vec<_> = all["robots"].as_array().unwrap().iter().map(|robot| &robot["lcd_text"]).collect();
    assert_eq!(texts, ["robot 1 is done", "robot 2 is done"], "{all}");
}

#[test]
fn somebody_at_the_terminal_presses_keys() {
    if !compiler() {
        return;
    }
    let folder = Folder::new("terminal");
    let file = folder.write(
        "typed.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n    LCDMenu(\"ONE\", \"TWO\", \"\", \"END\");\n    \
         LCDPrintf(\"%d \", KEYGet());\n    LCDPrintf(\"%d\", KEYWait(KEY4));\n    return 0;\n}\n",
    );
    let mut runner = Command::new(env!("CARGO_BIN_EXE_robios"))
        .args(["--json", "--keys", "TERMINAL", file.to_str().unwrap()])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    runner.stdin.take().unwrap().write_all(b"2\n1\n4\n").unwrap();
    let output = runner.wait_with_output().unwrap();
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&report["outcome"], &report["lcd_text"]), (&"finished".into(), &"2 8".into()), "{report}");
    let shown = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(shown.contains("[1] ONE  [2] TWO  [3]   [4] END"), "{shown}");
}

#[test]
fn scripts_run_without_files_that_they_name() {
    if !compiler() {
        return;
    }
    let folder = Folder::new("without");
    folder.copy("square.c", "square.c");
    let script = folder.write(
        "alone.sim",
        "world ../worlds/Missing.wld\nrobot robots/Cubot.robi\nobject Sign.esObj\nSign 3000 3000 0\n\
         Cubot 7000 7000 0 square.x\n",
    );
    let report = report(&[script.to_str().unwrap()]);
    assert_eq!((&report["outcome"], &report["lcd_text"]), (&"finished".into(), &"done".into()), "{report}");
}

#[test]
fn wrong_command_lines_are_refused() {
    for (arguments, expected) in [
        (&["missing.x"][..], "missing.x"),
        (&["--start", "1,2", "x"], "X,Y,DEG"),
        (&["--keys", "KEY9@1", "x"], "KEY9@1"),
        (&["--noise", "9", "x"], "0 to 5"),
        (&["--world", "missing.wld", "/bin/true"], "missing.wld"),
        (&["--robot", "R2D2", "/bin/true"], "R2D2"),
        (&[], "PROGRAM"),
    ] {
        let output = robios(arguments);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(output.stdout.is_empty() && message.lines().count() == 1, "{arguments:?}: {message}");
        assert!(message.contains(expected), "{arguments:?}: {message}");
    }
}
