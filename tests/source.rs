//! What the source itself has to keep to.

use std::fs;
use std::path::{Path, PathBuf};

/// All Rust files below a folder.
fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            found.push(path);
        }
    }
}

/// Otherwise each run would draw cases of its own, and fail for somebody who has changed nothing.
#[test]
fn every_property_draws_the_same_cases_for_everybody() {
    let mut files = Vec::new();
    for folder in ["src", "tests", "cli", "robios"] {
        rust_files(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder), &mut files);
    }
    let (mut properties, opening) = (0, ["proptest", "! {"].concat());
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        for (block, next) in
            text.lines().zip(text.lines().skip(1)).filter(|(line, _)| line.ends_with(&opening))
        {
            properties += 1;
            let file = file.display();
            assert!(next.contains("cases("), "{file}: `{block}` is followed by `{next}`");
        }
    }
    assert!(properties > 100, "{properties} were found");
}
