//! A track file of any format. What is read is written and read again, and a loop between its cones is judged.
#![no_main]

use libfuzzer_sys::fuzz_target;
use roverlab::race::{CentreLine, TrackFile, parse_eufs, parse_fssim, parse_track, write_eufs, write_fssim};

fuzz_target!(|text: &str| {
    let Ok(TrackFile::Cones(track)) = parse_track(text, "fuzz.track") else { return };
    let again = parse_eufs(&write_eufs(&track), "fuzz.csv").expect("the writer's track reads");
    assert_eq!(again.cones, track.cones);
    if let Ok(again) = parse_fssim(&write_fssim(&track), "fuzz.yaml") {
        assert!(again.cones.len() <= track.cones.len());
    }
    if let Some(start) = track.start_pose() {
        let _ = CentreLine::round_track(&track.cones, start);
    }
});
