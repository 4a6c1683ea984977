//! A craft in a pool, whose program does what keys say (book, chapter 8).

use std::fs;
use std::path::Path;

use super::{Folder, compiled, compiler, programs, python, report};

/// Runs the script with a program, and checks the distances to the floor that it has printed.
fn dives_as_keys_say(folder: &Folder, program: &str) {
    let text = fs::read_to_string(programs().join("mako/mako.sim")).unwrap();
    let script = folder.write("mako.sim", &text.replace("keys.x", program));
    let keys = "KEY1@1s,KEY2@4s,KEY3@8s,KEY4@20s";
    let all = report(&[script.to_str().unwrap(), "--keys", keys]);
    assert_eq!(
        (&all["outcome"], &all["exit"], &all["collisions"]),
        (&"finished".into(), &0.into(), &0.into())
    );
    let [afloat, deep, later, up] = printed(&folder.0)[..] else { panic!("four lines: {all}") };
    assert!(deep < afloat - 300, "it dives: {afloat}, {deep}");
    // In 4 s by itself, after it has come to rest; then in 12 s, the last of them afloat.
    let (slow, fast) = (later - deep, up - later);
    assert!((20..200).contains(&slow) && fast > 6 * slow, "it rises slowly, then fast: {slow}, {fast}");
    assert!((up - afloat).abs() < 60, "and ends at the surface: {afloat}, {up}");
    let pose = |name: &str| all["pose"][name].as_f64().unwrap_or_else(|| panic!("{name}: {all}"));
    assert!((pose("z_mm") - f64::from(afloat)).abs() < 60.0, "{all}");
    assert!(pose("roll_deg").abs() < 2.0 && pose("pitch_deg").abs() < 5.0, "{all}");
}

/// The numbers that a program has written to its file.
fn printed(folder: &Path) -> Vec<i32> {
    let text = fs::read_to_string(folder.join("down.txt")).unwrap();
    text.lines().map(|line| line.parse().unwrap()).collect()
}

/// A folder with the programs and their world.
fn folder(name: &str) -> Folder {
    let folder = Folder::new(name);
    for file in ["pool.wld", "keys.c", "keys.py"] {
        fs::copy(programs().join("mako").join(file), folder.0.join(file)).unwrap();
    }
    folder
}

#[test]
fn a_c_program_dives_and_rises_as_keys_say() {
    if compiler() {
        let folder = folder("mako-c");
        compiled(&folder.0.join("keys.c"));
        dives_as_keys_say(&folder, "keys.x");
    }
}

#[test]
fn a_python_program_dives_and_rises_as_keys_say() {
    if python() {
        dives_as_keys_say(&folder("mako-python"), "keys.py");
    }
}
