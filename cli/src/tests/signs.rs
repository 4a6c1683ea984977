//! The command `signs` as a whole.

use std::fs;
use std::path::PathBuf;

use super::support::{assert_outcome, run, temporary};

#[test]
fn drawn_signs_are_found() {
    let ended = run("signs", &["--learn", "42", "--frames", "14"]);
    assert_outcome(&ended, "evaluated");
    assert!(ended.1["finds"] == true && ended.1["mean_f1"].as_f64() > Some(0.8), "{}", ended.1);
}

/// A folder of gray pictures with a white square each, on the left or the right, as signs that fill them.
fn folder(name: &str, table: &str) -> PathBuf {
    let folder = temporary(name);
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join("boxes.csv"), table).unwrap();
    for (picture, square) in [("left.pgm", 4), ("right.pgm", 20)] {
        let pixel = |i: usize| if (square..square + 16).contains(&(i % 40)) { 250 } else { 60 };
        let pixels: Vec<u8> = (0..40 * 40).map(pixel).collect();
        fs::write(folder.join(picture), [b"P5 40 40 255\n".as_slice(), &pixels].concat()).unwrap();
    }
    folder
}

#[test]
fn what_is_learned_from_a_folder_is_told_again() {
    let folder =
        folder("signs-two", "file,class,x1,y1,x2,y2\nleft.pgm,west,2,2,38,38\nright.pgm,east,2,2,38,38\n");
    let folder = folder.to_str().unwrap();
    let weights = |name: &str| format!("{folder}/{name}.safetensors");
    for name in ["one", "other"] {
        assert_outcome(&run("signs", &["--train", folder, "--out", &weights(name)]), "learned");
    }
    assert_eq!(
        fs::read(weights("one")).unwrap(),
        fs::read(weights("other")).unwrap(),
        "equal seeds learn the same"
    );
    let ended = run("signs", &["--evaluate", folder, "--weights", &weights("one")]);
    assert_outcome(&ended, "evaluated");
    assert!(ended.1["accuracy"] == 1.0 && ended.1["finds"] == false, "{}", ended.1);
}

/// The same bytes with other numbers of threads, and after an interruption.
#[cfg(feature = "learn")]
#[test]
fn a_network_learns_the_classes_of_a_folder() {
    let folder =
        folder("signs-net", "file,class,x1,y1,x2,y2\nleft.pgm,west,2,2,38,38\nright.pgm,east,2,2,38,38\n");
    let folder = folder.to_str().unwrap();
    let weights = |name: &str| format!("{folder}/{name}.safetensors");
    let train = |name: &str, more: &[&str]| {
        let out = weights(name);
        run("signs", &[&["--train", folder, "--out", &out, "--network", "--epochs", "30"], more].concat())
    };
    for (name, threads) in [("one", "1"), ("other", "2")] {
        assert_outcome(&train(name, &["--threads", threads]), "learned");
    }
    assert_eq!(fs::read(weights("one")).unwrap(), fs::read(weights("other")).unwrap());
    let ended = run("signs", &["--evaluate", folder, "--weights", &weights("one")]);
    assert_eq!(ended.1["accuracy"], 1.0, "{}", ended.1);
    let kept = format!("{}.training", weights("third"));
    fs::create_dir_all(&kept).unwrap();
    fs::write(format!("{kept}/options.txt"), "2 signs of others").unwrap();
    let (status, _, err) = train("third", &[]);
    assert!(status == 2 && err.contains("2 signs of others"), "{err}");
}

#[test]
fn bad_tables_are_refused_with_their_line() {
    for (table, said) in [
        ("", "boxes.csv:1"),
        ("file,class,x1\n", "expected file, class"),
        ("file,class,x1,y1,x2,y2\nleft.pgm,west,2,2,38\n", "boxes.csv:2: found 5 columns"),
        ("file,class,x1,y1,x2,y2\nleft.pgm,west,2,2,a,38\n", "boxes.csv:2"),
        ("file,class,x1,y1,x2,y2\nleft.pgm,west,9,2,4,38\n", "boxes.csv:2: found a box"),
        ("file,class,x1,y1,x2,y2\nnone.pgm,west,2,2,38,38\n", "none.pgm"),
        ("file,class,x1,y1,x2,y2\n", "no pictures"),
    ] {
        let folder = folder("signs-bad", table);
        let out = folder.join("w.safetensors");
        let (status, _, err) =
            run("signs", &["--train", folder.to_str().unwrap(), "--out", out.to_str().unwrap()]);
        assert!(status == 2 && err.contains(said), "{table}: {err}");
    }
    let folder = folder("signs-weights", "file,class,x1,y1,x2,y2\nleft.pgm,west,2,2,38,38\n");
    let boxes = folder.join("boxes.csv");
    let (status, _, err) =
        run("signs", &["--evaluate", folder.to_str().unwrap(), "--weights", boxes.to_str().unwrap()]);
    assert!(status == 2 && err.contains("boxes.csv: weights"), "{err}");
}
