//! The command `end-to-end` as a whole.

use std::fs;

use super::support::{assert_outcome, run, temporary, text};

#[test]
fn a_network_keeps_the_lane_on_an_unseen_course() {
    let ended = run("end_to_end", &["--course", "3", "--minutes", "0.15"]);
    assert_outcome(&ended, "kept");
    assert_eq!(ended.1["autonomy_percent"].as_f64(), Some(100.0));
    let same = run("lane_keeping", &["--driver", "net", "--course", "3", "--minutes", "0.15"]);
    assert_eq!(same.1["distance_m"], ended.1["distance_m"]);
}

/// On the road's lines, which are white.
#[test]
fn a_picture_shows_what_the_network_looks_at() {
    let file = temporary("attention.png");
    let ended = run("end_to_end", &["--course", "3", "--minutes", "0.05", "--attention", text(&file)]);
    assert_outcome(&ended, "kept");
    let image = image::open(&file).unwrap().into_rgb8();
    let red = |y: u32| {
        let row = (0..image.width()).map(|x| image.get_pixel(x, y).0);
        row.filter(|[red, green, _]| i32::from(*red) - i32::from(*green) > 60).count()
    };
    assert_eq!((0..60).map(red).sum::<usize>(), 0, "it does not look at the sky");
    assert!((60..220).map(red).sum::<usize>() > 200);
    let (status, _, err) = run("end_to_end", &["--attention", "attention.txt"]);
    assert!(status == 2 && err.contains(".png"), "{err}");
}

#[test]
fn what_is_no_network_is_refused() {
    let file = temporary("none.safetensors");
    fs::write(&file, "no weights").unwrap();
    for words in [["--drive", text(&file)], ["--drive", "missing.safetensors"]] {
        let (status, _, err) = run("end_to_end", &words);
        assert!(status == 2 && err.contains("safetensors"), "{err}");
    }
    let (status, _, err) = run("lane_keeping", &["--weights", text(&file)]);
    assert!(status == 2 && err.contains("--weights"), "{err}");
    let (status, _, err) = run("end_to_end", &["--epochs", "2"]);
    assert!(status == 2 && err.contains("--train"), "{err}");
}

/// A network too small to drive, from a lesson of its own, with and without an interruption.
#[cfg(feature = "learn")]
#[test]
fn equal_seeds_train_equal_weights_after_an_interruption_too() {
    const SMALL: [&str; 6] =
        ["--architecture", "8x20x1 conv4/5/2 dense10", "--lessons", "1", "--epochs", "2"];
    let train = |name: &str, rounds: &str, threads: &str| {
        let file = temporary(name);
        let words = ["--train", "--out", text(&file), "--rounds", rounds, "--threads", threads];
        (run("end_to_end", &[&words[..], &SMALL].concat()), file)
    };
    let (ended, whole) = train("whole.safetensors", "2", "2");
    assert_outcome(&ended, "learned");
    // What was learned before something could not be written is not lost.
    let again = temporary("again.safetensors");
    let kept = again.with_file_name("again.safetensors.training");
    // What an earlier run that failed has left.
    let _ = fs::remove_dir_all(&kept);
    fs::create_dir(&kept).unwrap();
    fs::write(kept.join("diary.txt"), "of somebody").unwrap();
    let ((status, _, err), _) = train("again.safetensors", "2", "1");
    assert!(status == 2 && err.contains("something else"), "{err}");
    fs::remove_file(kept.join("diary.txt")).unwrap();
    let options = "8x20x1 conv4/5/2 dense10; lessons 1, epochs 2, disturbance 1.5, seed 1, noise 1\n";
    fs::write(kept.join("options.txt"), options).unwrap();
    let obstacle = kept.join("round-1.safetensors");
    fs::create_dir(&obstacle).unwrap();
    let ((status, ..), _) = train("again.safetensors", "2", "1");
    assert!(status == 1 && kept.join("state.safetensors").exists());
    fs::remove_dir(&obstacle).unwrap();
    let ((status, _, err), _) = train("again.safetensors", "2", "1");
    assert_eq!(status, 0, "{err}");
    assert!(!kept.exists(), "nothing is left over");
    assert_eq!(fs::read(again).unwrap(), fs::read(whole).unwrap());
}
