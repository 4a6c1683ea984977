//! Scripts in the wild: with missing, wrong or differently named parts.

use serde_json::Value;

use super::{Folder, compiler, python, report};

/// A program that reports its identity and position.
const WHO: &str =
    "from eye import *\nx, y, z, phi = SIMGetRobot(0)\nLCDPrintf('%d at %d %d', OSMachineID(), x, y)\n";

fn texts(report: &Value) -> Vec<&str> {
    let robots = report["robots"].as_array().unwrap();
    robots.iter().map(|robot| robot["lcd_text"].as_str().unwrap()).collect()
}

fn run(script: &std::path::Path) -> Value {
    report(&[script.to_str().unwrap()])
}

#[test]
fn robots_and_objects_are_numbered_as_they_were_placed() {
    if !python() {
        return;
    }
    let folder = Folder::new("numbers");
    folder.write(
        "ask.py",
        "from eye import *\nme, (count, ids) = RADIOGetID(), RADIOStatus()\nassert list(ids[:count]) == [2, 4]\n\
         assert SIMGetRobot(me) == SIMGetRobot(0) and SIMGetRobotCount() == SIMGetObjectCount() == 2\n\
         assert [SIMGetObject(i)[0].value for i in (1, 3)] == [300, 900]\n\
         assert [SIMGetRobot(i)[0].value for i in (2, 4)] == [600, 1200]\n\
         assert SIMGetObject(2)[0] == 900 and SIMGetRobot(1)[0] == 600, 'by their own count'\n\
         RADIOSend(6 - me, 'hello')\nassert RADIOReceive() == [6 - me, 'hello']\nRADIOSend(0, 'all')\n\
         assert RADIOReceive() == [6 - me, 'all']\nLCDPrintf('%d', me)\n",
    );
    let script = folder
        .write("mixed.sim", "can 300 500 0\nS4 600 500 0 ask.py\ncan 900 500 0\nLabBot 1200 500 0 ask.py\n");
    assert_eq!(texts(&run(&script)), ["2", "4"]);
}

/// A sensor that looks straight down, and an inertial unit, on a ramp of 10 %.
#[test]
fn programs_feel_hills_and_see_the_ground() {
    if !python() {
        return;
    }
    let folder = Folder::new("hills");
    folder.write("ramp.png", "P6 2 2 255 \0\0\0\x7f\x7f\x7f\0\0\0\x7f\x7f\x7f");
    folder.write("ramp.wld", "terrain 4000 4000 803 ramp.png\n");
    folder.write(
        "probe.robi",
        "drive DIFFERENTIAL_DRIVE\nname Probe\nwheel 54 3600 1100 45\npsd 5 DOWN 90 0 80 90 0 0\n\
         inertial 1 2 3 4 5 6 7 9 10\n",
    );
    folder.write(
        "feel.py",
        "from eye import *\nOSWait(1000)\n\
         LCDPrintf('%d %d', PSDGet(5), SIMGetRobot(0)[2].value)\n\
         for channel in (1, 2, 3, 4, 5, 6, 7, 9, 10, 8):\n    LCDPrintf(' %d', ANALOGRead(channel))\n",
    );
    let script = folder.write("hills.sim", "world ramp.wld\nrobot probe.robi\nProbe 2000 2000 0 feel.py\n");
    let shown = run(&script);
    let numbers: Vec<i32> =
        texts(&shown)[0].split_whitespace().map(|number| number.parse().unwrap()).collect();
    let expected = [80, 200, 0, -57, 0, 0, 0, 0, 976, 0, 9761, 0];
    assert_eq!(numbers.len(), expected.len(), "{numbers:?}");
    for (found, expected) in numbers.iter().zip(expected) {
        assert!((found - expected).abs() <= 2 + expected.abs() / 100, "{numbers:?}");
    }
}

#[test]
fn what_programs_move_does_not_hang_on_who_is_faster() {
    if !python() {
        return;
    }
    let folder = Folder::new("moves");
    // Both move the can in the same tick, and both see the result of the robot placed last.
    let text = "from eye import *\nif DELAY == OSMachineID():\n    sum(range(10000000))\n\
                SIMSetObject(3, 500 + OSMachineID(), 1500, 0, 0)\nLCDPrintf('%d', SIMGetObject(3)[0].value)\n";
    for delayed in ["1", "2"] {
        folder.write("move.py", &text.replace("DELAY", delayed));
        let script =
            folder.write("two.sim", "S4 500 500 0 move.py\nS4 1500 500 0 move.py\ncan 1000 1500 0\n");
        assert_eq!(texts(&run(&script)), ["502", "502"]);
    }
}

#[test]
fn scripts_with_errors_run_as_far_as_they_make_sense() {
    if !python() {
        return;
    }
    let folder = Folder::new("errors");
    folder.write("who.py", WHO);
    folder.write("bad.wld", "floor 3000\n0 0 x\n");
    for world in ["world missing.wld\n", "world bad.wld\n", "world maze.maz\n", "world a.txt\n"] {
        let script = folder.write(
            "odd.sim",
            &format!("{world}can 1\nmarker 5\nS4 500\nfrobnicate\nS4 S who.py\nLabBot 400 500 90 who.py\n"),
        );
        let all = run(&script);
        assert_eq!(texts(&all), ["1 at 500 500", "2 at 400 500"], "{all}");
        assert!(all["warnings"].as_array().unwrap().len() >= 4, "{all}");
    }
}

#[test]
fn a_run_that_cannot_begin_is_reported_too() {
    let folder = Folder::new("refused");
    let script = folder.write("empty.sim", "can 1\nS4 500 500 0\n");
    let all = report(&[script.to_str().unwrap()]);
    assert_eq!((&all["outcome"], all["robots"].as_array().unwrap().len()), (&"failed".into(), 0));
    assert!(all["error"].as_str().unwrap().contains("no robot has a program"), "{all}");
    assert!(all["warnings"][0].as_str().unwrap().contains("empty.sim:1:6"), "{all}");
    let all = report(&["--world", "missing.wld", "missing.py"]);
    assert!(all["error"].as_str().unwrap().contains("missing.wld"), "{all}");
}

#[test]
fn programs_are_found_by_names_of_other_systems() {
    if !compiler() || !python() {
        return;
    }
    let folder = Folder::new("named");
    folder.write("drive.c", "#include \"eyebot.h\"\nint main() { LCDPrintf(\"C\"); return 0; }\n");
    folder.write("drive.py", "from eye import *\nLCDPrintf('Python')\n");
    folder.write("Only.py", "from eye import *\nLCDPrintf('only')\n");
    folder.write("broken.x", "an executable of another system");
    folder.write("broken.py", "from eye import *\nLCDPrintf('instead')\n");
    let script = folder.write(
        "all.sim",
        "S4 300 500 0 drive.x\nS4 600 500 0 drive.exe\nS4 900 500 0 drive\nS4 1200 500 0 drive.py\n\
         S4 1500 500 0 only.exe\nS4 300 1000 0 elsewhere\\only.x\nS4 600 1000 0 broken.x\n",
    );
    let all = run(&script);
    assert_eq!(texts(&all), ["C", "C", "C", "Python", "only", "only", "instead"], "{all}");
    let alone = report(&[folder.0.join("drive.x").to_str().unwrap()]);
    assert_eq!(alone["lcd_text"], "C", "{alone}");
}

/// A script may start what lies beside it and below, wherever links lead.
#[cfg(unix)]
#[test]
fn programs_outside_the_scripts_folder_need_leave() {
    if !python() {
        return;
    }
    let folder = Folder::new("outside");
    let inside = folder.0.join("inside");
    std::fs::create_dir(&inside).unwrap();
    folder.write("who.py", "from eye import *\nLCDPrintf('outside')\n");
    std::os::unix::fs::symlink(folder.0.join("who.py"), inside.join("link.py")).unwrap();
    for name in ["../who.py", "link.py", "/bin/id"] {
        let script = folder.write("inside/all.sim", &format!("S4 500 500 0 {name}\n"));
        let all = run(&script);
        assert_eq!(all["outcome"], "failed", "{all}");
        let error = all["error"].as_str().unwrap();
        assert!(error.contains("outside of") && error.contains("--allow-outside"), "{name}: {error}");
    }
    let script = folder.write("inside/all.sim", "S4 500 500 0 ../who.py\n");
    let all = report(&["--allow-outside", script.to_str().unwrap()]);
    assert_eq!(all["lcd_text"], "outside", "{all}");
}

/// The report names what ran, not what was asked for.
#[test]
fn the_only_source_text_takes_a_programs_place_with_a_warning() {
    if !compiler() {
        return;
    }
    let folder = Folder::new("instead");
    folder.write("look.c", "#include \"eyebot.h\"\nint main() { LCDPrintf(\"looks\"); return 0; }\n");
    let all = run(&folder.write("all.sim", "S4 500 500 0 nothere.x\n"));
    assert_eq!((&all["program"], &all["lcd_text"]), (&"look.c".into(), &"looks".into()), "{all}");
    let told = "robot 1: its program nothere.x is not there; look.c, the only source text in the folder, runs instead";
    assert_eq!(all["warnings"], serde_json::json!([told]), "{all}");
}

#[test]
fn what_a_robot_touches_after_its_program_is_not_the_programs_doing() {
    if !python() {
        return;
    }
    let folder = Folder::new("after");
    folder.write("go.py", "from eye import *\nVWSetSpeed(300, 0)\nOSWait(1000)\n");
    let alone = folder.write("alone.sim", "S4 500 500 0 go.py\n");
    let together = folder.write("together.sim", "S4 500 500 0 go.py\nLabBot 500 1500 0 go.py\n");
    for script in [alone, together] {
        let all = run(&script);
        for robot in all["robots"].as_array().unwrap() {
            assert_eq!((&robot["outcome"], &robot["collisions"]), (&"finished".into(), &0.into()), "{all}");
            assert_eq!(robot["collisions_after_end"], 1, "{all}");
            assert!(robot["sim_time_s"].as_f64().unwrap() < 1.1, "{all}");
            assert!(robot["pose"]["x_mm"].as_f64().unwrap() > 1500.0, "it has driven on: {all}");
        }
    }
}

#[test]
fn robots_on_one_spot_are_warned_of() {
    if !python() {
        return;
    }
    let folder = Folder::new("one-spot");
    folder.write("rest.py", "from eye import *\nOSWait(100)\n");
    let report =
        run(&folder.write("spot.sim", "S4 500 500 0 rest.py\nS4 520 500 0 rest.py\nS4 1500 500 0 rest.py\n"));
    let warnings = report["warnings"].as_array().unwrap();
    let texts = warnings.iter().map(|warning| warning.as_str().unwrap());
    let found: Vec<_> = texts.filter(|text| text.contains("free floor")).collect();
    assert_eq!(found, ["robot 2 starts at 520, 500 mm, in robot 1; expected free floor"], "{report}");
}
