//! Ends of programs: final calls, limits, faults, and processes left behind.

use std::fs;
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};
use std::thread;
use std::time::Duration;

use serde_json::Value;

use super::{Folder, compiler, programs, python, report, robios};

/// Runs a program with this text, and returns its report.
fn told(name: &str, text: &str, options: &[&str]) -> Value {
    let folder = Folder::new(&format!("endings-{name}"));
    let file = folder.write(name, text);
    let report = report(&[options, &[file.to_str().unwrap()]].concat());
    report["robots"][0].clone()
}

#[test]
fn last_calls_count_though_the_first_came_after_they_were_arranged() {
    if !compiler() {
        return;
    }
    let stops = "#include \"eyebot.h\"\nvoid stop() { VWSetSpeed(0, 0); LCDPrintf(\"stopped\"); }\n\
                 int main() { atexit(stop); VWSetSpeed(200, 0); OSWait(1000); return 0; }\n";
    let destructor = "#include \"eyebot.h\"\nstruct Robot { ~Robot() { VWSetSpeed(0, 0); LCDPrintf(\"stopped\"); } };\n\
                      Robot robot;\nint main() { VWSetSpeed(200, 0); OSWait(1000); return 0; }\n";
    for (name, text) in [("exit.c", stops), ("destructor.cpp", destructor)] {
        let robot = told(name, text, &[]);
        assert_eq!(robot["lcd_text"], "stopped", "{robot}");
        assert!(robot["path_length_mm"].as_f64().unwrap() < 250.0, "{robot}");
    }
}

#[test]
fn a_call_that_waits_past_the_end_of_time_ends_there() {
    if !python() {
        return;
    }
    let text = "from eye import *\nVWStraight(200, 100)\nOSWait(7777777)\n";
    let robot = told("late.py", text, &["--time-limit", "20"]);
    assert_eq!((&robot["outcome"], &robot["sim_time_s"]), (&"timed_out".into(), &20.0.into()), "{robot}");
}

#[test]
fn whoever_is_left_behind_with_an_open_pipe_is_not_waited_for() {
    if !compiler() {
        return;
    }
    let text = "#include \"eyebot.h\"\nint main() { int left = fork();\n\
                if (left == 0) { setsid(); execlp(\"sleep\", \"sleep\", \"100\", (char *)0); }\n\
                LCDPrintf(\"%d\", left); return 0; }\n";
    let robot = told("leave.c", text, &["--real-limit", "50"]);
    assert_eq!(robot["outcome"], "finished", "{robot}");
    let left = robot["lcd_text"].as_str().unwrap();
    let killed = Command::new("kill").args(["-9", left]).status().unwrap();
    assert!(killed.success(), "process {left} should still have been there");
}

/// Even one that makes no calls.
#[test]
fn a_program_ends_with_a_runner_that_is_killed() {
    if !compiler() || !cfg!(target_os = "linux") {
        return;
    }
    let folder = Folder::new("endings-killed");
    let text = "#include <stdio.h>\n#include <unistd.h>\n#include \"eyebot.h\"\n\
                int main() { printf(\"%d\\n\", getpid()); fflush(stdout); for (;;); }\n";
    let mut command = Command::new(env!("CARGO_BIN_EXE_robios"));
    command.arg("--json").arg(folder.write("endless.c", text)).stdout(Stdio::null()).stderr(Stdio::piped());
    let mut runner = command.spawn().unwrap();
    let said = BufReader::new(runner.stderr.take().unwrap());
    let number: u32 = said.lines().find_map(|line| line.unwrap().trim().parse().ok()).unwrap();
    let is_there = || fs::read(format!("/proc/{number}/cmdline")).is_ok_and(|words| !words.is_empty());
    assert!(is_there());
    runner.kill().unwrap();
    runner.wait().unwrap();
    let ends = (0..1000).any(|_| {
        thread::sleep(Duration::from_millis(10));
        !is_there()
    });
    assert!(ends, "process {number} goes on");
}

#[test]
fn of_endless_output_the_beginning_is_passed_on() {
    if !compiler() {
        return;
    }
    let folder = Folder::new("endings-output");
    let text = "#include <stdio.h>\n#include \"eyebot.h\"\nint main() { LCDPrintf(\"on\");\n\
                for (int i = 0; i < 3000000; i++) puts(\"line\"); LCDPrintf(\"ly\"); return 0; }\n";
    let file = folder.write("chatters.c", text);
    let output = robios(&["--json", file.to_str().unwrap()]);
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["robots"][0]["lcd_text"], "only", "{report}");
    let passed = output.stderr.len();
    assert!((60_000..70_000).contains(&passed), "{passed} bytes");
}

#[test]
fn random_numbers_come_from_the_seed() {
    if !python() {
        return;
    }
    let text = "from random import *\nfrom eye import *\nLCDPrintf('%d', randint(0, 1000000))\n";
    let number = |name: &str, seed: &str| told(name, text, &["--seed", seed])["lcd_text"].clone();
    assert_eq!(number("first.py", "1"), number("second.py", "1"));
    assert_ne!(number("first.py", "1"), number("second.py", "2"));
}

#[test]
fn limits_end_any_program() {
    if !compiler() {
        return;
    }
    let file = |name: &str| programs().join(name).display().to_string();
    let endless = report(&["--time-limit", "5", &file("endless.c")]);
    assert_eq!((&endless["outcome"], &endless["lcd_text"]), (&"timed_out".into(), &"busy".into()));
    assert_eq!(endless["sim_time_s"], 5.0);
    let hang = report(&["--real-limit", "0.5", &file("hang.c")]);
    assert_eq!((&hang["outcome"], &hang["lcd_text"]), (&"timed_out".into(), &"hanging".into()));
    let crash = report(&[&file("crash.c")]);
    assert_eq!(
        (&crash["outcome"], &crash["exit"], &crash["lcd_text"]),
        (&"crashed".into(), &Value::Null, &"before".into())
    );
    assert!((crash["path_length_mm"].as_f64().unwrap() - 100.0).abs() < 2.0, "{crash}");
}

#[test]
fn a_program_that_fails_is_quoted() {
    if !python() {
        return;
    }
    let folder = Folder::new("quoted");
    let file = folder.write("fails.py", "import no_such_module\n");
    let report = report(&[file.to_str().unwrap()]);
    let error = report["error"].as_str().unwrap();
    assert!(report["outcome"] == "failed" && error.contains("no_such_module"), "{report}");
}
