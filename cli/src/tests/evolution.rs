//! The commands `genetic` and `starman` as wholes.

use std::path::{Path, PathBuf};
use std::{env, fs};

use super::support::{DATA, number, run, text};
use crate::starman;
use serde_json::Value;

#[test]
fn all_methods_find_the_same_spline() {
    let scales = ["genetic", "steady-state", "cma-es"].map(|method| {
        let options = ["--method", method, "--generations", "60"];
        let (status, report, err) = run("genetic", &options);
        assert_eq!((status, err.as_str()), (0, ""), "{report}");
        report["scale"].as_f64().unwrap()
    });
    assert!(scales.iter().all(|scale| (scale - scales[0]).abs() < 0.02), "{scales:?}");
}

#[test]
fn gains_of_a_wall_follower_get_better() {
    let options = ["--task", "wall", "--generations", "3", "--noise", "1"];
    let (status, report, err) = run("genetic", &options);
    assert_eq!((status, err.as_str()), (0, ""), "{report}");
    assert!(report["fitness"].as_f64().unwrap() > -0.02, "{report}");
}

#[test]
fn options_without_a_meaning_are_refused() {
    let (status, _, err) = run("genetic", &["--world", "a.wld"]);
    let expected = "--world: has no meaning for evolution; expected a command line without it\n";
    assert_eq!((status, err.as_str()), (2, expected));
}

const SMALL: [&str; 6] = ["--population", "8", "--generations", "6", "--seconds", "4"];

fn folder(name: &str) -> PathBuf {
    let folder = env::temp_dir().join(format!("roverlab-starman-{name}-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    folder
}

fn evolved(folder: &Path, options: &[&str]) -> Value {
    let picture = folder.join("starman.svg");
    let options = [&SMALL[..], &["--picture", picture.to_str().unwrap()], options].concat();
    let (status, report, err) = run("starman", &options);
    assert_eq!((status, err.as_str()), (0, ""), "{report}");
    report
}

#[test]
fn threads_do_not_change_the_population() {
    let folder = folder("threads");
    let hashes =
        ["1", "2", "8"].map(|threads| evolved(&folder, &["--threads", threads])["population_hash"].clone());
    assert!(hashes.iter().all(|hash| *hash == hashes[0] && hash.is_string()), "{hashes:?}");
    assert_ne!(evolved(&folder, &["--seed", "2"])["population_hash"], hashes[0]);
    assert!(fs::read_to_string(folder.join("starman.svg")).unwrap().starts_with("<svg"));
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn the_best_gait_gets_better_and_moves_in_its_picture() {
    let folder = folder("better");
    let animation = folder.join("walk.svg");
    let report = evolved(&folder, &["--init", "uniform", "--animation", animation.to_str().unwrap()]);
    let number = |name: &str| number(&report, name);
    assert!(number("best_last") >= number("best_first") && number("best_first") > 1.0, "{report}");
    assert_eq!(number("evaluations"), 48.0);
    let moving = fs::read_to_string(animation).unwrap();
    assert_eq!(moving.matches("attributeName=\"d\"").count(), 6, "a body and five limbs");
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn only_a_program_that_is_told_so_works_for_another() {
    assert!(starman::work_for_another(&["roverlab".into(), "starman".into()]).is_none());
}

/// An evolution that saves checkpoints.
fn resumable(folder: &Path) -> Value {
    let checkpoint = folder.join("run.json");
    let options = ["--leading", "2", "--threads", "1"];
    evolved(folder, &[&options[..], &["--checkpoint", checkpoint.to_str().unwrap()]].concat())
}

/// A checkpoint of an earlier commit, after two of four generations.
#[test]
fn a_checkpoint_of_before_goes_on() {
    let folder = folder("before");
    let checkpoint = folder.join("starman.json");
    fs::copy(Path::new(DATA).join("checkpoints/starman.json"), &checkpoint).unwrap();
    let options = ["--population", "4", "--generations", "4", "--seconds", "4", "--leading", "2"];
    let whole = run("starman", &options).1;
    let resumed = run("starman", &[&options[..], &["--checkpoint", text(&checkpoint)]].concat()).1;
    assert_eq!(
        (&resumed["generations"], &resumed["population_hash"]),
        (&4.into(), &whole["population_hash"])
    );
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn what_shapes_a_run_changes_the_population() {
    let folder = folder("recipes");
    let hash = |options: &[&str]| evolved(&folder, options)["population_hash"].clone();
    let usual = hash(&["--threads", "1"]);
    for other in
        [["--selection", "wheel"], ["--crossover", "one-point"], ["--figure", "planar"], ["--mutations", "2"]]
    {
        assert_ne!(hash(&other), usual, "{other:?}");
    }
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn statistics_are_kept_as_rows_and_as_a_picture() {
    let folder = folder("statistics");
    let file = |name: &str| folder.join(name).display().to_string();
    evolved(&folder, &["--statistics", &file("rows.csv")]);
    let rows = fs::read_to_string(file("rows.csv")).unwrap();
    assert_eq!(rows.lines().count(), 7, "names and six generations: {rows}");
    evolved(&folder, &["--statistics", &file("chart.svg")]);
    assert!(fs::read_to_string(file("chart.svg")).unwrap().contains("diversity"));
    fs::remove_dir_all(folder).unwrap();
}

fn refused(options: &[&str]) -> String {
    let (status, _, err) = run("starman", options);
    assert_eq!(status, 2, "{err}");
    err
}

#[test]
fn what_cannot_be_done_is_refused_before_a_run() {
    let expected = "--seconds 1.5: expected more than the 2 s to come to rest, at most 3600\n";
    assert_eq!(refused(&["--seconds", "1.5"]), expected);
    assert!(refused(&["--seconds", "1e300"]).contains("at most 3600"));
    assert!(refused(&["--animation", "walk.gif"]).contains("expected a name that ends in .svg"));
    assert!(refused(&["--animation", "/no/such/walk.svg"]).contains("found no folder /no/such"));
    assert!(refused(&["--statistics", "rows.txt"]).contains("expected the ending .csv, .svg, .png"));
    assert!(refused(&["--checkpoint", "/no/such/run.json"]).contains("found no folder /no/such"));
    assert!(refused(&["--checkpoint", "/dev/null"]).contains("/dev/null: is a device; expected"));
    assert!(refused(&["--figure", "snake"]).contains("expected book, planar, biped, hexapod, star, worm"));
    assert!(refused(&["--figure", "no.toml"]).contains("no.toml"));
    assert!(refused(&["--body"]).contains("found the figure book; expected one of limbs"));
}

#[test]
fn bodies_evolve_with_their_gaits() {
    let folder = folder("bodies");
    for figure in ["biped", "hexapod", "worm"] {
        let alone = evolved(&folder, &["--figure", figure]);
        let together = evolved(&folder, &["--figure", figure, "--body"]);
        let genes = |report: &Value| report["best_gait"].as_array().unwrap().len();
        assert!(genes(&together) > genes(&alone), "{together}");
    }
    // Two generations of four are too few; of six they are enough for this body and seed.
    for (figure, individuals, outcome) in [("worm", "4", (1, "no_better")), ("biped", "6", (0, "better"))] {
        let size = ["--population", individuals, "--generations", "2", "--seconds", "4"];
        let (status, report, err) =
            run("starman", &[&["--compare", "1", "--body", "--figure", figure], &size[..]].concat());
        assert_eq!((status, report["outcome"].as_str().unwrap()), outcome, "{report} {err}");
        assert!(report["rows"][0]["together"].is_f64(), "{report}");
    }
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_checkpoint_that_was_changed_is_refused() {
    let folder = folder("changed");
    resumable(&folder);
    let file = folder.join("run.json");
    let whole: Value = serde_json::from_str(&fs::read_to_string(&file).unwrap()).unwrap();
    let changes: [(&str, Value); 5] = [
        ("seed", 99.into()),
        ("genomes", vec![vec![1_u8]; 8].into()),
        ("fitness", vec![1.0].into()),
        ("history", Value::Array(Vec::new())),
        ("best", Value::Null),
    ];
    for (field, value) in changes {
        let mut changed = whole.clone();
        changed["state"][field] = value;
        fs::write(&file, changed.to_string()).unwrap();
        let options = ["--leading", "2", "--checkpoint", file.to_str().unwrap()];
        let err = refused(&[&SMALL[..], &options].concat());
        assert!(err.starts_with(file.to_str().unwrap()) && err.contains("; expected "), "{field}: {err}");
    }
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_checkpoint_of_another_run_is_refused() {
    let folder = folder("other");
    resumable(&folder);
    let checkpoint = folder.join("run.json");
    let options = ["--population", "9", "--seconds", "4", "--checkpoint", checkpoint.to_str().unwrap()];
    let (status, _, err) = run("starman", &options);
    assert_eq!(status, 2, "{err}");
    assert!(
        err.contains("a run with population 8") && err.contains("expected one with population 9"),
        "{err}"
    );
    fs::remove_dir_all(folder).unwrap();
}
