//! The programs of the page: what the runner says of them is what the page has to say.

use std::fs;
use std::path::Path;
use std::process::Command;

use super::python;

const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../web/programs");
const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../web/tests/programs.txt");

/// The options that a program asks for in a line such as `# robios --world=maze.maz`.
fn options(text: &str) -> Vec<&str> {
    text.lines()
        .find_map(|line| line.strip_prefix("# robios "))
        .map_or_else(Vec::new, |words| words.split_whitespace().collect())
}

/// `REGENERATE=1` writes the file anew.
#[test]
fn the_programs_of_the_page_end_as_its_tests_expect() {
    if !python() {
        return;
    }
    let mut found = String::new();
    for folder in ["book", "own"] {
        let files = fs::read_dir(Path::new(FOLDER).join(folder)).unwrap();
        let mut names: Vec<_> =
            files.map(|file| format!("{folder}/{}", file.unwrap().file_name().display())).collect();
        names.sort();
        for name in names {
            let text = fs::read_to_string(Path::new(FOLDER).join(&name)).unwrap();
            let run = Command::new(env!("CARGO_BIN_EXE_robios"))
                .arg("--json")
                .args(options(&text))
                .arg(&name)
                .current_dir(FOLDER)
                .output()
                .unwrap();
            found.extend([&name, " ", &String::from_utf8(run.stdout).unwrap()]);
        }
    }
    if std::env::var_os("REGENERATE").is_some() {
        fs::write(FILE, found).unwrap();
    } else {
        let text = fs::read_to_string(FILE).unwrap();
        assert_eq!(text, found, "REGENERATE=1 writes it anew, if this is meant");
    }
}
