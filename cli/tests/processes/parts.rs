//! Campaigns in parts, by several processes.

use std::path::Path;

use super::{roverlab, said};

/// Whatever the whole campaign prints, its table included, the merged parts print as well.
#[test]
fn processes_share_a_campaign() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let campaign = ["ping", "--campaign", "--runs", "5", "--seed", "7"];
    let files = ["processes-1.jsonl", "processes-2.jsonl", "processes-3.jsonl"];
    let parts = (1..).zip(files).map(|(number, file)| {
        let part = format!("{number}/3");
        let words = [&campaign[..], &["--part", &part, "--out", file]].concat();
        roverlab(&words).current_dir(folder).spawn().unwrap()
    });
    for mut part in parts.collect::<Vec<_>>() {
        assert!(part.wait().unwrap().success());
    }
    for more in [&[][..], &["--json"]] {
        let whole = said(&mut roverlab(&[&campaign[..], more].concat()));
        let merged = said(roverlab(&[&["merge"], &files[..], more].concat()).current_dir(folder));
        assert!(whole.0 == 0 && whole.1.contains("messages"), "{whole:?}");
        assert_eq!(merged, whole);
    }
}
