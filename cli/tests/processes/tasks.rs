//! Every command in the table of the book's tasks ends as the table says, with a picture, and its test
//! exists.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Mutex;

use serde_json::Value;

use super::said;

/// A row of the table.
#[derive(Debug)]
struct Task {
    number: String,
    command: String,
    ends: String,
    picture: bool,
    test: String,
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The rows of the table.
fn tasks() -> Vec<Task> {
    let text = fs::read_to_string(root().join("docs/tasks.md")).unwrap();
    let is_row = |line: &&str| {
        line.strip_prefix("| ").is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()))
    };
    let task = |row: &str| {
        let cells: Vec<&str> =
            row.trim_matches('|').split('|').map(|cell| cell.trim().trim_matches('`')).collect();
        let [number, _, command, ends, picture, test] = cells[..] else { panic!("six cells in {row}") };
        Task {
            number: number.into(),
            command: command.into(),
            ends: ends.into(),
            picture: picture == "yes",
            test: test.into(),
        }
    };
    text.lines().filter(is_row).map(task).collect()
}

/// The command of a task. Its picture goes to a file.
fn command(task: &Task, picture: &Path) -> Command {
    let (program, words) = match task.command.strip_prefix("robios ") {
        Some(words) => (Path::new(env!("CARGO_BIN_EXE_roverlab")).with_file_name("robios"), words),
        None => (env!("CARGO_BIN_EXE_roverlab").into(), task.command.as_str()),
    };
    let mut words = words.split_whitespace();
    let mut command = Command::new(&program);
    if program.ends_with("roverlab") {
        command.args(words.next());
    }
    command.arg("--json").arg("--picture").arg(picture).args(words).current_dir(root());
    command
}

/// What is wrong with a task.
fn wrong(task: &Task) -> Option<String> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("tasks");
    fs::create_dir_all(&folder).unwrap();
    let picture = folder.join(format!("{}.svg", task.number));
    let _ = fs::remove_file(&picture);
    let (status, text) = said(&mut command(task, &picture));
    // Warnings may stand on standard error.
    let report: Value = text.lines().find_map(|line| serde_json::from_str(line).ok()).unwrap_or_default();
    let outcome = report["outcome"].as_str().unwrap_or_default();
    if status != 0 || outcome != task.ends || picture.is_file() != task.picture {
        return Some(format!("{} `{}` ends with {status}, {outcome}: {text}", task.number, task.command));
    }
    None
}

#[test]
fn all_sixty_are_in_the_table_in_order() {
    let numbers: Vec<String> = tasks().into_iter().map(|task| task.number).collect();
    let chapters =
        [(1.8, 4), (2.13, 4), (3.7, 4), (4.3, 3), (5.4, 3), (6.3, 3), (7.4, 7), (8.5, 3), (9.8, 3)];
    let chapters = chapters.into_iter().chain([(10.7, 5), (11.6, 3), (12.5, 3), (13.7, 11), (14.6, 4)]);
    let expected: Vec<String> = chapters
        .flat_map(|(chapter, tasks)| (1..=tasks).map(move |task| format!("{chapter}-{task}")))
        .collect();
    assert_eq!(expected.len(), 60);
    assert_eq!(numbers, expected);
}

#[test]
fn every_command_ends_as_the_table_says() {
    let has_compiler = Command::new("cc").arg("--version").output().is_ok();
    let runs = |task: &Task| task.command != "–" && (has_compiler || !task.command.starts_with("robios"));
    let queue = Mutex::new(tasks().into_iter().filter(runs).collect::<Vec<_>>());
    let failed = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while let Some(task) = { queue.lock().unwrap().pop() } {
                    failed.lock().unwrap().extend(wrong(&task));
                }
            });
        }
    });
    let failed = failed.into_inner().unwrap();
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}

/// Text of all Rust files below a folder.
fn source(folder: &Path, text: &mut String) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() && !path.ends_with("target") {
            source(&path, text);
        } else if path.extension().is_some_and(|kind| kind == "rs") {
            *text += &fs::read_to_string(path).unwrap();
        }
    }
}

#[test]
fn the_tests_of_the_table_exist() {
    let mut text = String::new();
    for folder in ["src", "cli", "robios", "tests"] {
        source(&root().join(folder), &mut text);
    }
    for task in tasks() {
        let is_there = text.contains(&format!("fn {}(", task.test));
        assert_eq!(is_there, task.command != "–", "{}: {}", task.number, task.test);
    }
}
