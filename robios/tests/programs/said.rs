//! What a run reports of calls that did not do what they say.

use serde_json::Value;

use super::{Folder, compiler, report, robios};

/// The warnings of a report, which has none where there is nothing to say.
fn warnings(report: &Value) -> Vec<&str> {
    let list = report["warnings"].as_array();
    list.into_iter().flatten().map(|warning| warning.as_str().unwrap()).collect()
}

#[test]
fn what_a_robot_lacks_is_said_once() {
    if !compiler() {
        return;
    }
    let folder = Folder::new("time-notes");
    let file = folder.write(
        "lacks.c",
        "#include \"eyebot.h\"\nint main() { BYTE image[QVGA_SIZE]; int i; for (i = 0; i < 100; i++) \
         PSDGet(77);\n\
         CAMGet(image); LIDARSet(720, 0, 10); SERVOSet(9, 10); VWGetSpeed(NULL, NULL); for (i = 20; i < 90; \
         i++)\n\
         PSDGet(i); return 0; }\n",
    );
    let output = robios(&["--json", file.to_str().unwrap()]);
    let told: Value = serde_json::from_slice(&output.stdout).unwrap();
    let warnings = warnings(&told);
    let messages = String::from_utf8_lossy(&output.stderr);
    for expected in [
        "PSDGet: the robot has no PSD 77",
        "CAMGet: camera is off",
        "LIDARSet: lidar range is 720",
        "no servo 9",
    ] {
        let found: Vec<_> = warnings.iter().filter(|warning| warning.contains(expected)).collect();
        assert_eq!(found.len(), 1, "{expected}: {warnings:?}");
        assert_eq!(messages.lines().filter(|line| line.contains(expected)).count(), 1, "{messages}");
    }
    assert_eq!(warnings.iter().filter(|warning| warning.contains("PSDGet")).count(), 3, "{warnings:?}");
}

#[test]
fn values_that_are_clipped_are_said() {
    if !compiler() {
        return;
    }
    let calls = [
        ("MOTORDrive(1, 300)", "MOTORDrive: 300; expected -100 to 100, taken as 100"),
        ("SERVOSet(1, 300)", "SERVOSet: 300; expected 0 to 255, taken as 255"),
        ("VWSetSpeed(99999, 0)", "VWSetSpeed: 99999 mm/s is more than this robot can"),
        ("VWSetSpeed(0, 9999)", "VWSetSpeed: 9999 degrees/s is more than this robot can"),
        ("VWStraight(10, 99999)", "VWStraight: 99999 mm/s is more than this robot can"),
        ("DIGITALRead(3)", "DIGITALRead: nothing is connected to the digital lines"),
        ("ANALOGRead(3)", "ANALOGRead: nothing is connected to analog channel 3"),
        ("SERInit(1, 9600, 0)", "SERInit: nothing is connected to serial port 1"),
        ("LCDSetMode(0x2000)", "LCDSetMode: the settings 0x2000 of the display have no effect"),
        ("VWTurn(10, 9999)", "VWTurn: 9999 degrees/s is more than this robot can"),
        (
            "VWSetSpeed(1600, 300)",
            "VWSetSpeed: 1600 mm/s and 300 degrees/s together need 1836 mm/s of a wheel",
        ),
        ("VWCurve(100, 90, 1600)", "VWCurve: 1600 mm/s and 1440 degrees/s together need"),
        ("MOTORSpeed(1, 9999)", "MOTORSpeed: 9999 encoder ticks in 10 ms is more than this robot can"),
        (
            "SIMSetRobot(1, 4000, 1000, 0, 0)",
            "SIMSetRobot: robot 1 is put to 4000, 1000 mm, in a wall; expected",
        ),
        (
            "SIMSetRobot(1, -500, 1000, 0, 0)",
            "SIMSetRobot: robot 1 is put to -500, 1000 mm, outside the world",
        ),
    ];
    let twice: String = calls.iter().flat_map(|(call, _)| [*call, ";\n", *call, ";\n"]).collect();
    let text = format!("#include \"eyebot.h\"\nint main() {{ {twice} return 0; }}\n");
    let all =
        report(&["--time-limit", "5", Folder::new("clipped").write("clips.c", &text).to_str().unwrap()]);
    for (call, said) in calls {
        let found = warnings(&all).iter().filter(|warning| warning.contains(said)).count();
        assert_eq!(found, 1, "{call}: {all}");
    }
    let usual = "#include \"eyebot.h\"\nint main() { VWSetSpeed(200, 45); MOTORDrive(1, 100); SERVOSet(1, \
                 255); return 0; }\n";
    let folder = Folder::new("clipped-none");
    let report = report(&[folder.write("usual.c", usual).to_str().unwrap()]);
    assert!(!report["warnings"].to_string().contains("more than this robot"), "{report}");
}

/// The number of warnings of a program with these calls that contain a text, with an Ackermann car or an S4.
fn said_of_car(calls: &str, text: &str) -> usize {
    let folder = Folder::new("said-car");
    let file =
        folder.write("drive.c", &format!("#include \"eyebot.h\"\nint main() {{ {calls}; return 0; }}\n"));
    let report = report(&["--robot", "Car", "--start", "2000,2000,0", file.to_str().unwrap()]);
    warnings(&report).iter().filter(|said| said.contains(text)).count()
}

#[test]
fn limits_that_only_speed_and_turn_together_exceed_are_said() {
    if !compiler() {
        return;
    }
    assert_eq!(said_of_car("VWSetSpeed(200, 90)", "90 degrees/s at 200 mm/s is a tighter turn"), 1);
    assert_eq!(said_of_car("VWSetSpeed(0, 30)", "at most 0 degrees/s at this speed"), 1);
    assert_eq!(said_of_car("VWSetSpeed(200, 10)", "VWSetSpeed"), 0);
    let folder = Folder::new("said-both");
    for (speeds, expected) in [("200, 45", 0), ("1600, 300", 1)] {
        let text = format!("#include \"eyebot.h\"\nint main() {{ VWSetSpeed({speeds}); return 0; }}\n");
        let report = report(&[folder.write("both.c", &text).to_str().unwrap()]);
        let warnings = report["warnings"].to_string();
        assert_eq!(usize::from(warnings.contains("together need")), expected, "{speeds}: {report}");
    }
}

#[test]
fn things_put_where_they_cannot_stand_are_said() {
    if !compiler() {
        return;
    }
    let folder = Folder::new("said-put");
    let text = "#include \"eyebot.h\"\nint main() { SIMSetObject(2, 4000, 1000, 0, 0); OSWait(100);\n\
                SIMSetObject(2, 9000, 1000, 0, 0); SIMSetRobot(1, 1000, 2000, 0, 0); SIMSetObject(2, 2500, \
                2500, 0, 0);\n\
                SIMSetRobot(1, 1500, 1500, 0, 0); return 0; }\n";
    folder.write("put.c", text);
    folder.write("put.wld", "floor 4000 4000\n0 0 4000 0\n4000 0 4000 4000\n4000 4000 0 4000\n0 4000 0 0\n");
    let script =
        folder.write("put.sim", "world put.wld\nS4 500 600 90 put.x\ncan 1000 2000 0\ncan 1000 2000 0\n");
    for options in [&[][..], &["--call-costs", "free"], &["--picture", "put.svg"]] {
        let picture = folder.0.join("put.svg").display().to_string();
        let options: Vec<&str> =
            options.iter().map(|&word| if word == "put.svg" { picture.as_str() } else { word }).collect();
        let report = report(&[&options[..], &[script.to_str().unwrap()]].concat());
        let warnings = warnings(&report);
        let said = |text: &str| warnings.iter().filter(|said| said.contains(text)).count();
        assert_eq!(said("object 1 is put to 4000, 1000 mm, in a wall"), 1, "{report}");
        assert_eq!(said("object 1 is put to 9000, 1000 mm, outside the world"), 1, "{report}");
        assert_eq!(said("robot 1 is put to 1000, 2000 mm, in object 2"), 1, "{report}");
        assert_eq!(said(" is put to "), 3, "{report}");
    }
}

#[test]
fn a_robot_that_drowns_on_a_level_floor_is_said() {
    if !compiler() {
        return;
    }
    let folder = Folder::new("said-drowned");
    folder.write("wet.wld", "floor 4000 4000\nwater_level 900\n");
    let drive = "int main() { VWStraight(1000, 200); VWWait(); return 0; }\n";
    folder.write("drive.c", &format!("#include \"eyebot.h\"\n{drive}"));
    let script = folder.write("wet.sim", "world wet.wld\nS4 500 2000 0 drive.x\n");
    let report = report(&["--time-limit", "10", script.to_str().unwrap()]);
    assert_eq!(report["mishap"], "drowned", "{report}");
    assert!(warnings(&report).contains(&"robot 1, drive.x: mishap: drowned"), "{report}");
}

/// A walker stands on the floor wherever a script puts it, and is as high as it says.
#[test]
fn a_walkers_height_is_its_own() {
    if !compiler() {
        return;
    }
    let folder = Folder::new("said-walker");
    folder.write("stand.c", "#include \"eyebot.h\"\nint main() { OSWait(500); return 0; }\n");
    folder.write("flat.wld", "floor 4000 4000\n");
    let script =
        folder.write("flat.sim", "world flat.wld\nrobot starman.robi\nStarman 1000 300 1000 90 stand.x\n");
    for options in [&[][..], &["--trail", "0.1"]] {
        let report = report(&[options, &[script.to_str().unwrap()]].concat());
        let up = report["pose"]["z_mm"].as_f64().unwrap();
        assert!((120.0..140.0).contains(&up), "{report}");
    }
}

#[test]
fn a_world_taken_from_the_folder_is_said() {
    if !compiler() {
        return;
    }
    let folder = Folder::new("said-world");
    let file = folder.write("stand.c", "#include \"eyebot.h\"\nint main() { return OSWait(10); }\n");
    let warnings = || report(&[file.to_str().unwrap()])["warnings"].to_string();
    assert!(!warnings().contains("world"), "an empty folder has none to speak of");
    folder.write("one.maz", " _ _\n|S _|\n");
    assert!(warnings().contains("one.maz, the only one beside the program, is the world"), "{}", warnings());
    folder.write("two.maz", " _ _\n|S _|\n");
    let both = warnings();
    assert!(both.contains("2 files .maz lie beside the program, and none of them is taken"), "{both}");
    let named = report(&["--world", folder.0.join("one.maz").to_str().unwrap(), file.to_str().unwrap()]);
    assert!(!named["warnings"].to_string().contains("beside the program"), "{named}");
}
