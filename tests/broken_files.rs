//! Broken files of every format, each beside the message that it must give.
//!
//! `REGENERATE=1 cargo test --test broken_files` writes the messages anew.

use std::fs;
use std::path::{Path, PathBuf};

use roverlab::world::formats::{FormatError, load_object, load_robot, load_scene, movingai};

fn message(path: &Path) -> Option<Result<(), FormatError>> {
    let ending = path.extension()?.to_str()?;
    Some(match ending {
        "robi" => load_robot(path).map(drop),
        "esObj" => load_object(path).map(drop),
        "map" => movingai::load_map(path).map(drop),
        "scen" => movingai::load_scenarios(path).map(drop),
        "sim" | "wld" | "maz" | "yaml" => load_scene(path).map(drop),
        _ => return None,
    })
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

#[test]
fn every_broken_file_gives_its_message() {
    let mut wrong = Vec::new();
    let mut counts = Vec::new();
    for folder in files(Path::new("tests/data/broken")) {
        let mut count = 0;
        for path in files(&folder) {
            let Some(result) = message(&path) else { continue };
            count += 1;
            let found = result.map_or_else(|error| error.to_string(), |()| "no error".into()) + "\n";
            let expected = path.with_extension("expected");
            if std::env::var_os("REGENERATE").is_some() {
                fs::write(&expected, &found).unwrap();
            }
            if fs::read_to_string(&expected).unwrap_or_default() != found {
                wrong.push(found);
            }
        }
        counts.push((folder.file_name().unwrap().to_str().unwrap().to_owned(), count));
    }
    // Exact, so that a file that gets lost is noticed.
    let expected = [
        ("esobj", 18),
        ("maz", 16),
        ("movingai_map", 17),
        ("movingai_scen", 13),
        ("robi", 26),
        ("ros_map", 24),
        ("sim", 22),
        ("wld", 19),
    ];
    assert_eq!(counts, expected.map(|(format, count)| (format.to_owned(), count)));
    assert!(wrong.is_empty(), "{} other messages than expected:\n{}", wrong.len(), wrong.concat());
}

#[test]
fn whole_files_load_and_a_missing_one_is_named() {
    for path in files(Path::new("tests/data/formats")) {
        if let Some(Err(error)) = message(&path) {
            panic!("{error}");
        }
    }
    let error = load_scene("tests/data/formats/nowhere.wld").unwrap_err().to_string();
    assert_eq!(
        error,
        "tests/data/formats/nowhere.wld:1:1: found `tests/data/formats/nowhere.wld`, which does not exist; expected a file that exists"
    );
}
