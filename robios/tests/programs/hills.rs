//! Programs on hills: scripts as section 7.3 of the book has them, with images of our own.

use std::fs;
use std::path::Path;

use super::{Folder, compiled, compiler, programs, python, report};

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &target);
        } else {
            fs::copy(entry.path(), target).unwrap();
        }
    }
}

/// Runs both scripts with the program in a folder beside them.
fn drives_over_hills(name: &str, program: &str) {
    let folder = Folder::new(name);
    copy(&programs().join("terrain"), &folder.0);
    let scripts = folder.0.join("simulations/terrain");
    fs::copy(programs().join("check.h"), scripts.join("check.h")).unwrap();
    fs::copy(folder.0.join(program), scripts.join(program)).unwrap();
    if Path::new(program).extension().is_some_and(|kind| kind == "c") {
        compiled(&scripts.join(program));
    }
    for script in ["crater.sim", "levels-steel.sim"] {
        let all = report(&[scripts.join(script).to_str().unwrap()]);
        let robot = &all["robots"][0];
        assert_eq!((&robot["outcome"], &robot["exit"]), (&"finished".into(), &0.into()), "{script}: {all}");
        let pose = &robot["pose"];
        let number = |name: &str| pose[name].as_f64().unwrap_or_else(|| panic!("{name} in {all}"));
        if script == "crater.sim" {
            assert!(number("z_mm") > 400.0 && number("pitch_deg").abs() < 30.0, "{all}");
        } else {
            assert!(number("z_mm").abs() < 10.0 && number("roll_deg").abs() < 2.0, "{all}");
        }
    }
}

#[test]
fn c_programs_drive_over_hills() {
    if compiler() {
        drives_over_hills("hills-c", "terrain.c");
    }
}

#[test]
fn python_programs_drive_over_hills() {
    if python() {
        drives_over_hills("hills-python", "terrain.py");
    }
}
