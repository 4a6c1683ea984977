//! Programs of all kinds, good and bad, are graded by one rubric.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::{roverlab, said};

/// Drives to the goal by odometry, looks where it is, and writes a file.
const GOOD: &str = "from eye import *\nVWStraight(1000, 300)\nVWWait()\nLCDPrintf('arrived\\n')\n";
const CHEAT: &str = "from eye import *\nx = SIMGetRobot(0)[0].value\nVWStraight(2000 - x, 300)\nVWWait()\n";
const WRITER: &str = "open('notes.txt', 'w').write('x')\nfrom eye import *\nVWStraight(300, 300)\nVWWait()\n";
const WALL: &str = "from eye import *\nVWStraight(3000, 300)\nVWWait()\n";
const WRONG: &str = "from eye import *\nraise ValueError('no idea')\n";
const CRASH: &str =
    "#include \"eyebot.h\"\nint main() { VWStraight(100, 100); *(volatile int *)0 = 1; return 0; }\n";
const ENDLESS: &str = "int main() { for (;;) { } }\n";
const BROKEN: &str = "int main() { return x; }\n";

fn folder() -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("graded");
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// A rubric with `seeds` runs, and its world.
fn rubric(folder: &Path, seeds: u32) {
    let world = "floor 3000 2000\n0 0 3000 0\n3000 0 3000 2000\n3000 2000 0 2000\n0 2000 0 0\n";
    let rubric = format!(
        "title = 'One metre'\nseeds = {seeds}\ntime_limit = 20\nreal_limit = 2\n\
         [[world]]\nfile = 'room.wld'\nstart = [1000, 1000, 0]\nend = [2000, 1000, 60]\n"
    );
    fs::write(folder.join("room.wld"), world).unwrap();
    fs::write(folder.join("rubric.toml"), rubric).unwrap();
}

fn there_is(command: &str) -> bool {
    std::process::Command::new(command).arg("--version").output().is_ok_and(|output| output.status.success())
}

#[test]
fn each_program_gets_what_it_deserves() {
    if !there_is("python3") || !there_is("cc") {
        eprintln!("skipped: no `python3` or no C compiler `cc` was found");
        return;
    }
    let folder = folder();
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
    rubric(&folder, 3);
    let cases = [
        ("good.py", GOOD, "reached"),
        ("cheat.py", CHEAT, "reached"),
        ("writer.py", WRITER, "missed"),
        ("wall.py", WALL, "collided"),
        ("wrong.py", WRONG, "failed"),
        ("crash.c", CRASH, "crashed"),
        ("endless.c", ENDLESS, "timed_out"),
        ("broken.c", BROKEN, "failed"),
        ("roverlab a-to-b --goal 2000,1000", "", "reached"),
        ("roverlab a-to-b --goal 1500,1000", "", "missed"),
    ];
    for (name, text, _) in cases.iter().filter(|case| !case.1.is_empty()) {
        write(name, text);
    }
    let mut words = vec!["grade", "rubric.toml", "--json", "--html", "page.html"];
    words.extend(cases.iter().map(|case| case.0));
    let (status, text) = said(roverlab(&words).current_dir(&folder));
    assert_eq!(status, 0, "{text}");
    let report: Value = serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error}: {text}"));
    for ((name, _, outcome), program) in cases.iter().zip(report["programs"].as_array().unwrap()) {
        assert_eq!(
            (&program["program"], &program["outcomes"][outcome]),
            (&(*name).into(), &3.into()),
            "{program}"
        );
    }
    let program = |index: usize| &report["programs"][index];
    assert!(program(0)["output"] == "arrived" && program(0)["beyond_robots"] == serde_json::json!([]));
    assert_eq!(program(1)["beyond_robots"], serde_json::json!(["SIMGetRobot"]));
    assert_eq!(program(2)["written"], serde_json::json!(["notes.txt"]));
    assert!(program(4)["error"].as_str().unwrap().contains("no idea"), "{}", program(4));
    assert!(program(6)["error"].as_str().unwrap().contains("real seconds"), "{}", program(6));
    assert!(program(7)["error"].as_str().unwrap().contains("does not compile"), "{}", program(7));
    assert!(!folder.join("notes.txt").exists(), "a run has a folder of its own");
    let page = fs::read_to_string(folder.join("page.html")).unwrap();
    assert_eq!(page.matches("<figure>").count(), cases.len());
    assert!(page.contains("calls SIMGetRobot"));
}

#[test]
fn what_cannot_be_graded_is_refused() {
    for (words, expected) in [
        (&["grade", "none.toml", "x.c"][..], "none.toml"),
        (&["grade", concat!(env!("CARGO_MANIFEST_DIR"), "/rubrics/wall.toml"), "x.c"], "x.c: no such file"),
    ] {
        let (status, text) = said(&mut roverlab(words));
        assert!(status == 2 && text.contains(expected), "{text}");
    }
    let folder = folder().join("refused");
    fs::create_dir_all(&folder).unwrap();
    rubric(&folder, 1);
    let text = fs::read_to_string(folder.join("rubric.toml")).unwrap();
    fs::write(folder.join("rubric.toml"), text.replace("start = [1000", "start = [-1000")).unwrap();
    let (status, text) = said(roverlab(&["grade", "rubric.toml", "roverlab distbug"]).current_dir(&folder));
    assert!(status == 2 && text.contains("found a start outside the world"), "{text}");
}

mod campaigns {
    use super::*;

    /// The time that the test prints is to be 60 s at most, on two cores.
    #[test]
    #[ignore = "a campaign: cargo test --release -p roverlab-cli --test processes grade::campaigns -- --ignored"]
    fn thirty_programs_with_twenty_seeds_each() {
        let folder = folder().join("thirty");
        fs::create_dir_all(&folder).unwrap();
        let write = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
        rubric(&folder, 20);
        let mut programs: Vec<String> =
            (0..27).map(|number| format!("{number}.{}", ["c", "py"][number % 2])).collect();
        for (number, program) in programs.iter().enumerate() {
            let drive = format!("VWStraight(1000, {});", 150 + 5 * number);
            let text = match number % 2 {
                0 => format!("#include \"eyebot.h\"\nint main() {{ {drive} VWWait(); return 0; }}\n"),
                _ => format!("from eye import *\n{drive} VWWait()\n"),
            };
            write(program, &text);
        }
        for (name, text) in [("crash.c", CRASH), ("endless.c", ENDLESS), ("writer.py", WRITER)] {
            write(name, text);
            programs.push(name.into());
        }
        let mut words = vec!["grade", "rubric.toml", "--json", "--html", "page.html"];
        words.extend(programs.iter().map(String::as_str));
        let (status, text) = said(roverlab(&words).current_dir(&folder));
        assert_eq!(status, 0, "{text}");
        let report: Value = serde_json::from_str(&text).unwrap();
        let rows = report["programs"].as_array().unwrap();
        let all = |row: usize, outcome: &str| rows[row]["outcomes"][outcome] == report["runs"];
        assert_eq!((rows.len(), &report["runs"]), (30, &20.into()), "{text}");
        assert!(all(27, "crashed") && all(28, "timed_out"), "{} {}", rows[27], rows[28]);
        assert_eq!(rows[29]["written"], serde_json::json!(["notes.txt"]));
        for row in &rows[..27] {
            let ended = ["reached", "missed", "collided"]
                .map(|outcome| row["outcomes"][outcome].as_u64().unwrap_or(0));
            assert_eq!(ended.iter().sum::<u64>(), 20, "{row}");
        }
        fs::remove_dir_all(folder).unwrap();
    }
}
