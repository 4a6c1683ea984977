//! The command `quadtree` as a whole.

use std::fs;

use super::support::{said, temporary};
use serde_json::{Value, json};

fn run(options: &[&str]) -> (u8, String, String) {
    said("quadtree", options)
}

fn report(options: &[&str]) -> Value {
    let options: Vec<&str> = options.iter().copied().chain(["--json"]).collect();
    let (status, out, err) = run(&options);
    assert_eq!((status, err.as_str(), out.lines().count()), (0, "", 1));
    serde_json::from_str(&out).unwrap()
}

/// A picture of 8 x 8 pixels whose lower right quarter is black except for its last pixel. Each test writes
/// its own file, as tests run concurrently.
fn picture(name: &str) -> String {
    let file = temporary(name);
    let black = |x: usize, y: usize| x >= 4 && y >= 4 && (x, y) != (7, 7);
    let pixels = (0..64).map(|i| if black(i % 8, i / 8) { 0 } else { 255 });
    fs::write(&file, b"P5 8 8 255\n".iter().copied().chain(pixels).collect::<Vec<u8>>()).unwrap();
    file.to_str().unwrap().into()
}

#[test]
fn free_squares_are_listed_in_the_books_order() {
    let map = picture("listed.pgm");
    let report_of_map = report(&["--map", &map, "--list"]);
    let list = ["free 0 0 (4)", "free 4 0 (4)", "free 0 4 (4)", "free 7 7 (1)"];
    assert_eq!(report_of_map["list"], json!(list));
    assert_eq!((&report_of_map["free_leaves"], &report_of_map["blocked_leaves"]), (&json!(4), &json!(6)));
    assert_eq!(report_of_map["links"], json!(2));
    let drawn = temporary("listed.svg");
    let told = run(&["--map", &map, "--list", "--picture", drawn.to_str().unwrap()]).1;
    assert!(told.starts_with(&(list.join("\n") + "\n")), "{told}");
    let coarse = report(&["--map", &map, "--minimum", "2"]);
    assert_eq!((&coarse["free_leaves"], &coarse["blocked_leaves"]), (&json!(3), &json!(4)));
}

#[test]
fn paths_are_found_or_there_are_none() {
    let map = picture("paths.pgm");
    let found = report(&["--map", &map, "--from", "0,7", "--to", "7,0"]);
    // Straight past the corner of the black quarter.
    assert_eq!(found["outcome"], "found");
    assert!((found["path"]["cost"].as_f64().unwrap() - 98f64.sqrt()).abs() < 1e-9, "{found}");
    assert_eq!(report(&["--map", &map, "--from", "0,0", "--to", "7,7"])["outcome"], "unreachable");
    let own = report(&[]);
    assert_eq!((own["outcome"].as_str(), own["width"].as_u64()), (Some("decomposed"), Some(128)));
}

#[test]
fn what_is_wrong_is_named() {
    let map = picture("wrong.pgm");
    let empty = temporary("empty.map");
    fs::write(&empty, "type octile\nheight 0\nwidth 5\nmap\n").unwrap();
    let empty = empty.to_str().unwrap().to_owned();
    for (options, message) in [
        (vec!["--map", "nowhere.png"], "nowhere.png:1:1: found"),
        (vec!["--minimum", "3"], "minimum leaf is 3; expected a power of two"),
        (vec!["--map", &map, "--from", "0,0", "--to", "5,5"], "the goal (5, 5) is blocked"),
        (vec!["--map", &map, "--from", "0,0", "--to", "8,0"], "the goal (8, 0) lies outside"),
        (vec!["--map", &map, "--from", "5,5", "--to", "0,0"], "the start (5, 5) is blocked"),
        (vec!["--map", &map, "--from", "0,9", "--to", "0,0"], "the start (0, 9) lies outside"),
        (vec!["--map", &empty, "--from", "0,0", "--to", "0,0"], "empty.map:2:8: found"),
        (vec!["--from", "-1,0", "--to", "2,2"], "expected COLUMN,ROW"),
        (vec!["--from", "nan,0", "--to", "2,2"], "expected COLUMN,ROW"),
        (vec!["--from", "0,0"], "--to"),
        (vec!["--from", "1", "--to", "2,2"], "expected COLUMN,ROW"),
    ] {
        let (status, out, err) = run(&options);
        assert!(status == 2 && out.is_empty() && err.contains(message) && err.lines().count() == 1, "{err}");
    }
}
